//! What each way to reduce the variance is worth: variance × CPU seconds of one batch, of the mean
//! irradiance of faces, with and without; and, of each method, CPU seconds to a standard error of 1
//! % (RMS over faces).
//!
//! `cargo run -p fredholm-montecarlo --example efficiency [-- SCENE …]`, from the repository.

use fredholm_mesh::Patch;
use fredholm_montecarlo::light::{
    Batch, Control, Estimator, METHODS, PathTracing, ResidualShooting, Switches, estimator,
};
use fredholm_montecarlo::points::PointSet;
use fredholm_montecarlo::statistics::Moments;
use fredholm_montecarlo::{Enclosure, Groups, State, Stop, Surfaces, Tracing};
use fredholm_scene::Scene;
use fredholm_visibility::Occluders;
use std::error::Error;
use std::sync::Arc;

mod common;
use common::Clock;

const BATCHES: u32 = 24;
const SCENES: [&str; 3] = ["cornell_planar", "occluder", "leblond_room"];

/// A scene and its faces.
struct Ground {
    name: String,
    scene: Enclosure,
    faces: Vec<usize>,
}

impl Ground {
    fn load(name: &str) -> Result<Self, Box<dyn Error>> {
        let scene = Scene::load(format!("scenes/{name}.toml"))?;
        let mesh = scene.mesh()?;
        let bands = scene.bands().len();
        let patches: Vec<Patch> = mesh.patches().copied().collect();
        let surfaces = Surfaces::blocked_by(Arc::new(Occluders::new(mesh.occluders())?), patches);
        let enclosure = Enclosure::of(surfaces, bands, scene.reflectance(&mesh), scene.exitance(&mesh))?;
        let faces = (0..mesh.len()).map(|leaf| mesh.face_of(leaf)).collect();
        Ok(Self { name: name.to_owned(), scene: enclosure, faces })
    }

    fn groups(&self) -> Result<Groups, Box<dyn Error>> {
        let count = self.faces.iter().max().map_or(0, |last| last + 1);
        Ok(Groups::new(&self.scene, self.faces.clone(), count)?)
    }
}

/// Mean over elements and bands of (s/x)² of a single batch, times its CPU seconds.
fn cost(ground: &Ground, estimator: &dyn Estimator, points: PointSet, mean: &[f64]) -> f64 {
    let scene = &ground.scene;
    let samples = if estimator.gathers() { 4 } else { 1 << 15 };
    let mut moments = Moments::new(mean.len());
    let mut out = vec![0.0; mean.len()];
    let clock = Clock::start();
    for number in 0..BATCHES {
        estimator.batch(scene, &Batch { seed: 7, number, samples, points }, &mut out);
        moments.push(&out);
    }
    let seconds = clock.seconds() / f64::from(BATCHES);
    let lit = moments.variances().into_iter().zip(mean).filter(|(_, mean)| **mean > 0.0);
    let (sum, count) = lit.fold((0.0, 0.0), |(sum, n), (v, mean)| (sum + v / (mean * mean), n + 1.0));
    sum / count * seconds
}

/// Irradiances to compare variances with, and to serve as control variate.
fn known(ground: &Ground) -> Result<Vec<f64>, Box<dyn Error>> {
    let jacobi = estimator("jacobi", &ground.scene, Switches::default()).ok_or("no such method")?;
    let tracing = Tracing::new(&ground.scene, &*jacobi, ground.groups()?, 99, 1 << 17)?;
    let mut state = tracing.start();
    let stop = Stop { batches: Some(64), ..Stop::default() };
    tracing.go_on(&mut state, &stop, &fredholm_linop::Quiet)?;
    Ok(state.patches.mean().to_vec())
}

fn reductions(ground: &Ground) -> Result<(), Box<dyn Error>> {
    let mean = known(ground)?;
    let all = Switches::default();
    let path = PathTracing::continuous;
    let full = cost(ground, &path(all), PointSet::Sobol, &mean);
    let ratio = |estimator: PathTracing, points| cost(ground, &estimator, points, &mean) / full;
    println!("{}: variance × time of path tracing with everything {full:.2e} s; times as much", ground.name);
    let switches = [
        ("without roulette", Switches { roulette: false, ..all }),
        ("without multiple importance", Switches { multiple_importance: false, ..all }),
        ("without next event", Switches { next_event: false, multiple_importance: false, ..all }),
    ];
    for (name, switches) in switches {
        println!("  {name:28} {:.2}", ratio(path(switches), PointSet::Sobol));
    }
    for points in [PointSet::Independent, PointSet::Jittered, PointSet::NRooks, PointSet::MultiJittered] {
        println!("  {:28} {:.2}", points.name(), ratio(path(all), points));
    }
    let shares: Vec<f64> = (0..ground.scene.len()).map(|patch| ground.scene.exposed(patch)).collect();
    let control = Control::new(&ground.scene, (mean.clone(), &shares), false)?;
    let shooting = ResidualShooting::new(&ground.scene, control, all);
    let shooting =
        shooting.shared_out(&ground.scene, &ground.groups()?, (5, PointSet::Sobol), &fredholm_linop::Quiet);
    let ratio = cost(ground, &shooting, PointSet::Sobol, &mean) / full;
    println!("  {:28} {ratio:.2}", "with a control variate");
    Ok(())
}

/// √ of the mean of (s/x)² over the faces and bands.
fn rms(state: &State) -> f64 {
    let errors = state.groups.standard_errors();
    let lit = state.groups.mean().iter().zip(&errors).filter(|(mean, _)| **mean > 0.0);
    let (sum, count) = lit.fold((0.0, 0.0), |(sum, n), (mean, s)| (sum + (s / mean).powi(2), n + 1.0));
    f64::sqrt(sum / count)
}

/// CPU seconds to 1 % over the faces, RMS and in L², from a run of at least so many batches.
fn to_one_percent(ground: &Ground) -> Result<(), Box<dyn Error>> {
    for name in METHODS {
        let method = estimator(name, &ground.scene, Switches::default()).ok_or("no such method")?;
        let samples = if method.gathers() { 4 } else { 1 << 16 };
        let tracing = Tracing::new(&ground.scene, &*method, ground.groups()?, 3, samples)?;
        let mut state = tracing.start();
        let stop = Stop { batches: Some(BATCHES.into()), ..Stop::default() };
        let clock = Clock::start();
        tracing.go_on(&mut state, &stop, &fredholm_linop::Quiet)?;
        // Errors fall with the root of the work.
        let seconds = clock.seconds();
        let [rms, l2] = [rms(&state), state.relative_error()].map(|error| seconds * (error / 0.01).powi(2));
        println!("{}: {name:15} {rms:6.1} CPU s to 1 % RMS, {l2:6.1} to 1 % in L2", ground.name);
    }
    Ok(())
}

fn main() -> Result<(), Box<dyn Error>> {
    let asked: Vec<String> = std::env::args().skip(1).collect();
    let all = || SCENES.map(str::to_owned).to_vec();
    let names = if asked.is_empty() { all() } else { asked };
    // One thread, so that its clock is the work's.
    let pool = rayon::ThreadPoolBuilder::new().num_threads(1).build()?;
    pool.install(|| -> Result<(), String> {
        for name in &names {
            let ground = Ground::load(name).map_err(|error| error.to_string())?;
            reductions(&ground).map_err(|error| error.to_string())?;
            to_one_percent(&ground).map_err(|error| error.to_string())?;
        }
        Ok(())
    })?;
    Ok(())
}
