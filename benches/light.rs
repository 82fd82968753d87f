//! Times of the stages of a light solution on shipped scenes: form factors, and the solution for
//! all bands.
//!
//! `cargo bench --bench light`; stored results stand in `benches/README.md`.

#![allow(clippy::unwrap_used, missing_docs)]

use criterion::{Criterion, criterion_group, criterion_main};
use fredholm::coupling::form_factor::PairIntegrator;
use fredholm::coupling::{Assembled, Extent, Radiosity, assemble};
use fredholm::iterative::GaussSeidel;
use fredholm::linop::{MultiVector, Quiet, SecondKind, Solver, Stop};
use fredholm::mesh::Mesh;
use fredholm::scene::Scene;
use fredholm::visibility::Occluders;
use std::hint::black_box;
use std::path::Path;

/// A shipped scene with one element a face.
fn scene(name: &str) -> Scene {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("scenes").join(name);
    let text = std::fs::read_to_string(&path).unwrap();
    let lines = text.lines().filter(|line| !line.starts_with("elements_per_face"));
    Scene::from_str(&lines.collect::<Vec<_>>().join("\n"), path).unwrap()
}

fn form_factors(mesh: &Mesh) -> Assembled<f64> {
    let occluders = Occluders::new(mesh.occluders()).unwrap();
    let integrator = PairIntegrator::new(mesh.patches(), &occluders, 1e-3);
    assemble(&integrator, &Quiet).unwrap()
}

fn assembly(c: &mut Criterion) {
    let mut group = c.benchmark_group("form factors, tolerance 1e-3");
    group.sample_size(10);
    for name in ["cornell_planar.toml", "occluder.toml"] {
        let mesh = scene(name).mesh().unwrap();
        group.bench_function(name, |b| b.iter(|| black_box(form_factors(&mesh))));
    }
}

fn solution(c: &mut Criterion) {
    let scene = scene("cornell_planar.toml");
    let mesh = scene.mesh().unwrap();
    let assembled = form_factors(&mesh);
    let bands = scene.bands().len();
    let sizes = mesh.patches().map(|patch| Extent { area: patch.area(), exposed: patch.area() }).collect();
    let values = |v: Vec<f64>| MultiVector::from_vec(mesh.len(), bands, v).unwrap();
    let radiosity =
        Radiosity::new(sizes, values(scene.reflectance(&mesh)), values(scene.exitance(&mesh))).unwrap();
    let system = SecondKind::new(&assembled.matrix, radiosity.scaling()).unwrap();
    let stop = Stop { tolerance: 1e-10, max_iterations: 100 };
    c.bench_function("gauss-seidel to 1e-10, 480 elements, 3 bands", |b| {
        b.iter(|| {
            let mut x = radiosity.exitance().clone();
            GaussSeidel.solve(&system, radiosity.exitance(), &mut x, &stop, &mut Quiet).unwrap();
            black_box(x)
        });
    });
}

criterion_group!(benches, assembly, solution);
criterion_main!(benches);
