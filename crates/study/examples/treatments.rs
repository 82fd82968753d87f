//! Relative L² error of the scattered far field, treatment by treatment and bounce by bounce, and
//! of what a scene gets that names no method: against Galerkin solutions, the series of Mie, and
//! the stored references.
//!
//!     cargo run --release -p fredholm-study --example treatments -- [part of a name]

#![allow(clippy::unwrap_used, reason = "an example shows the way, not what may go wrong on it")]

#[path = "../tests/known/mod.rs"]
mod known;

use std::path::Path;

use fredholm_iterative::Gmres;
use fredholm_linop::{MultiVector, Quiet, SecondKind, Solver, Stop};
use fredholm_mesh::Vec3;
use fredholm_waves::{
    Bounced, Complex64, ComplexVector, EdgeCurrents, PhysicalOptics, Scatterer, Shadow, Source, System,
};
use known::common::{WAVELENGTH, mie, reference, relative_error, wave};
use known::wave_cases::{Body, Case, cases, error};
use known::{directions, far, scene, solved};

type Vectors = MultiVector<Complex64>;

/// x of all bounces.
fn all(system: &System<'_>, b: &Vectors) -> Vectors {
    let one = Vectors::from_fn(b.dim(), 1, |_, _| Complex64::ONE);
    let a = SecondKind::new(system.coupling(), one).unwrap();
    let mut x = Vectors::zeros(b.dim(), 1);
    let stop = Stop { tolerance: 1e-5, max_iterations: 300 };
    Gmres { restart: 60 }.solve(&a, b, &mut x, &stop, &mut Quiet).unwrap();
    x
}

fn amplitudes(
    system: &System<'_>,
    body: &Scatterer,
    first: &PhysicalOptics<'_>,
    x: &Vectors,
    u: &[Vec3],
) -> Vec<ComplexVector> {
    let currents = Bounced::new(body, first, &system.currents(x, 0));
    system.radiator(&currents).far_field(u).unwrap().into_iter().map(|far| far.amplitude).collect()
}

fn added(far: &[ComplexVector], edges: &EdgeCurrents, u: &[Vec3]) -> Vec<ComplexVector> {
    far.iter().zip(u).map(|(far, u)| *far + edges.far_amplitude(*u)).collect()
}

fn row(case: &Case, body: &Scatterer, shadow: Shadow, truth: &[ComplexVector], u: &[Vec3]) {
    let source = case.source();
    let sources: [&dyn Source; 1] = [&source];
    let first = PhysicalOptics::new(body, wave(), &sources, shadow).unwrap();
    let system = System::lazy(body, wave(), shadow).unwrap();
    let b = system.right_hand_side(&[&first]);
    let mut x = b.clone();
    print!("{:<18} {:<11}", case.name, shadow.name());
    let lit = EdgeCurrents::new(body, wave(), &sources).unwrap();
    let complete = |x: &Vectors| {
        let far = amplitudes(&system, body, &first, x, u);
        let currents = Bounced::new(body, &first, &system.currents(x, 0));
        let bounced = EdgeCurrents::of_bounces(body, wave(), &sources, &currents).unwrap();
        (error(&far, truth), error(&added(&far, &lit, u), truth), error(&added(&far, &bounced, u), truth))
    };
    for _ in 1..=4 {
        if !shadow.is_equation() {
            let (none, lit, bounced) = complete(&x);
            print!(" {none:.3} {lit:.3} {bounced:.3} |");
        }
        let mut product = Vectors::zeros(x.dim(), 1);
        system.coupling().apply(&x, &mut product);
        x = Vectors::from_fn(x.dim(), 1, |i, l| b.row(i)[l] + product.row(i)[l]);
    }
    let (none, lit, bounced) = complete(&all(&system, &b));
    println!(" all {none:.3} {lit:.3} {bounced:.3}");
}

/// The stored references: name, scene file, and the column.
const STORED_REFERENCES: [(&str, &str, &str); 4] = [
    ("plate 5", "plate.toml", "plate_5lambda_normal.csv"),
    ("two plates 5", "two_plates.toml", "two_plates_normal.csv"),
    ("cube 5", "cube.toml", "cube_5lambda_normal.csv"),
    ("sphere 1", "sphere.toml", ""),
];

/// What the scene of a reference gets without its settings, and after one bounce.
fn stored(folder: &Path, (name, file, column): (&str, &str, &str)) {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../scenes/waves").join(file);
    let text = std::fs::read_to_string(path).unwrap();
    let kept = |line: &&str| {
        let key = line.split('=').next().unwrap_or("").trim();
        !["method", "shadows", "bounces", "solver", "tolerance", "edge_currents", "edge"].contains(&key)
    };
    let bare: Vec<&str> = text.lines().filter(kept).collect();
    let bare = bare.join("\n");
    let truth = if column.is_empty() { mie(WAVELENGTH) } else { reference(column) };
    let run = |settings: &str| {
        let found = solved(folder, &bare.replacen("[wave]", &format!("[wave]\n{settings}"), 1));
        let ez = |row: &fredholm_report::WaveRow| Complex64::new(row.scattered[4], row.scattered[5]);
        let fields: Vec<Complex64> = found.near().iter().map(ez).collect();
        (relative_error(&fields, &truth), format!("{}, {}", found.method(), found.solution()))
    };
    let (one, _) = run("method = \"physical-optics\"\nbounces = 1");
    let (unasked, method) = run("");
    println!("{name:<18} unasked: {unasked:.4} by {method}; one bounce {one:.3}; circle of 25 m");
}

fn main() {
    let wanted = std::env::args().nth(1).unwrap_or_default();
    let folder = tempfile::tempdir().unwrap();
    for body in STORED_REFERENCES.into_iter().filter(|(name, ..)| name.contains(&wanted)) {
        stored(folder.path(), body);
    }
    let u = directions();
    println!(
        "case, treatment; after 1, 2, 3, 4 and all bounces: without edges, with those of the incident wave, of all waves"
    );
    for case in cases().into_iter().filter(|case| case.name.contains(&wanted)) {
        let truth = case.truth(&u, 8.0, 2);
        let run = |settings: &str| {
            let found = solved(folder.path(), &scene(&case, settings));
            (error(&far(&found), &truth), format!("{}, {}", found.method(), found.solution()))
        };
        let (one, _) = run("method = \"physical-optics\"\nbounces = 1");
        let (unasked, method) = run("");
        println!("{:<18} unasked: {unasked:.3} by {method}; one bounce {one:.3}", case.name);
        let body = case.scatterer(8.0);
        let mut shadows = vec![Shadow::Geometric, Shadow::Radiated];
        if !matches!(case.body, Body::Plates(_)) {
            shadows.extend([Shadow::Exact, Shadow::ExactDual]);
        }
        for shadow in shadows {
            row(&case, &body, shadow, &truth, &u);
        }
    }
}
