//! Rays per second of one core in path tracing, and of the ray caster alone.
//!
//! `cargo run --release -p fredholm-montecarlo --example ray_rate -- scenes/cornell_planar.toml`

use fredholm_mesh::{Patch, Vec3};
use fredholm_montecarlo::density::{Cosine, DirectionDensity};
use fredholm_montecarlo::light::{Batch, METHODS, Switches, estimator};
use fredholm_montecarlo::points::{Key, PointSet, Samples};
use fredholm_montecarlo::{Enclosure, Surfaces};
use fredholm_scene::Scene;
use fredholm_visibility::Occluders;
use std::error::Error;
use std::hint::black_box;
use std::sync::Arc;

mod common;
use common::Clock;

const RAYS: u32 = 1 << 20;

fn main() -> Result<(), Box<dyn Error>> {
    let path = std::env::args().nth(1).unwrap_or_else(|| "scenes/cornell_planar.toml".to_owned());
    let scene = Scene::load(&path)?;
    let mesh = scene.mesh()?;
    let patches: Vec<Patch> = mesh.patches().copied().collect();
    let bands = scene.bands().len();
    let pieces = Arc::new(Occluders::new(mesh.occluders())?);
    let surfaces = Surfaces::blocked_by(pieces, patches.clone());
    let enclosure = Enclosure::of(surfaces, bands, scene.reflectance(&mesh), scene.exitance(&mesh))?;
    for (name, set) in [("elements", &patches[..]), ("occluders", mesh.occluders())] {
        let occluders = Occluders::new(set)?;
        println!(
            "{path}: ray caster, {} {name}: {:.2} million/s",
            set.len(),
            cast(&enclosure, &occluders) / 1e6
        );
    }
    for name in METHODS {
        let estimator = estimator(name, &enclosure, Switches::default()).ok_or("no such method")?;
        let samples = if estimator.gathers() { 8 } else { 1 << 17 };
        let batch = Batch { seed: 1, number: 0, samples, points: PointSet::Sobol };
        let mut out = vec![0.0; enclosure.len() * bands];
        let started = Clock::start();
        let work = estimator.batch(&enclosure, &batch, &mut out);
        let rate = work.rays as f64 / started.seconds();
        println!("{path}: {name:15} {:.2} million rays and segments/s", rate / 1e6);
    }
    Ok(())
}

/// Cosine-distributed rays from even points of the patches, per second.
fn cast(enclosure: &Enclosure, occluders: &Occluders) -> f64 {
    let mut samples = Samples::new(PointSet::Independent, Key { seed: 1, batch: 0, stream: 0 }, RAYS);
    let ray = |sample| -> (Vec3, Vec3) {
        let mut draw = samples.draw(sample);
        let at = enclosure.point(sample as usize % enclosure.len(), draw.pair());
        (at.point, enclosure.world(at, Cosine.sample(draw.pair())))
    };
    let rays: Vec<(Vec3, Vec3)> = (0..RAYS).map(ray).collect();
    let started = Clock::start();
    for &(origin, direction) in &rays {
        black_box(occluders.closest(origin, direction, f64::INFINITY));
    }
    f64::from(RAYS) / started.seconds()
}
