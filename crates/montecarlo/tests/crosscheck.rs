//! The comparison of a deterministic with a stochastic solution: twenty scenes that are right, and
//! planted faults.

// A test that cannot run should panic, in its helpers too.
#![allow(clippy::unwrap_used)]

mod common;

use common::{mesh, run, single};
use fredholm_coupling::assemble;
use fredholm_coupling::form_factor::PairIntegrator;
use fredholm_linop::Quiet;
use fredholm_mesh::{Lines, Mesh, Patch, Shape, Vec3};
use fredholm_montecarlo::density::{Cosine, DirectionDensity, UniformHemisphere};
use fredholm_montecarlo::light::{Estimator, PathTracing, StochasticJacobi, Switches};
use fredholm_montecarlo::philox::philox;
use fredholm_montecarlo::statistics::{Comparison, Correction, Crosscheck, crosscheck};
use fredholm_montecarlo::{Enclosure, State};
use fredholm_visibility::Occluders;

const SIGNIFICANCE: f64 = 0.01;
const TOLERANCE: f64 = 1e-7;

/// Patches of one band with their form factors F_ij.
struct Problem {
    patches: Vec<Patch>,
    rho: Vec<f64>,
    exitance: Vec<f64>,
    factors: Vec<Vec<f64>>,
}

impl Problem {
    fn new(patches: Vec<Patch>, rho: Vec<f64>, exitance: Vec<f64>) -> Self {
        let occluders = Occluders::new(&patches).unwrap();
        let pairs = PairIntegrator::new(patches.iter(), &occluders, TOLERANCE);
        let matrix = assemble::<f64>(&pairs, &Quiet).unwrap().matrix;
        let row = |i: usize| (0..patches.len()).map(|j| matrix.get(i, j) / patches[i].area()).collect();
        let factors = (0..patches.len()).map(row).collect();
        Self { patches, rho, exitance, factors }
    }

    /// E after so many reflections: E ← F (M + ρ E).
    fn irradiance(&self, reflections: usize) -> Vec<f64> {
        let mut e = vec![0.0; self.patches.len()];
        for _ in 0..=reflections {
            let b: Vec<f64> = (0..e.len()).map(|j| self.exitance[j] + self.rho[j] * e[j]).collect();
            e = self.factors.iter().map(|row| row.iter().zip(&b).map(|(f, b)| f * b).sum()).collect();
        }
        e
    }

    fn enclosure(&self) -> Enclosure {
        Enclosure::new(self.patches.clone(), 1, self.rho.clone(), self.exitance.clone()).unwrap()
    }
}

/// Reflections after which nothing is left: 0.9^400 < 1e-18.
const MOST_REFLECTIONS: usize = 400;

fn traced(scene: &Enclosure, estimator: &dyn Estimator, seed: u64, samples: u32) -> State {
    run(scene, estimator, single(scene), (seed, samples, 32))
}

fn verdict(irradiance: &[f64], state: &State) -> Crosscheck {
    let error: Vec<f64> = irradiance.iter().map(|e| TOLERANCE * e).collect();
    let comparison = Comparison {
        deterministic: irradiance,
        deterministic_error: &error,
        stochastic: state.groups.mean(),
        standard_error: &state.groups.standard_errors(),
        single: &vec![0.0; irradiance.len()],
        batches: state.batches(),
    };
    crosscheck(&comparison, Correction::Holm, SIGNIFICANCE).unwrap()
}

/// Even numbers in [0, 1) of a scene.
fn random(scene: u32, which: u32) -> f64 {
    f64::from(philox([scene, which, 0, 0], [2026, 0])[0]) / 2_f64.powi(32)
}

/// A room with something in it, all of it drawn by lot.
fn room(number: u32) -> Problem {
    let r = |which| random(number, which);
    let size = Vec3::new(1.0 + r(0), 1.0 + r(1), 0.8 + r(2));
    let cut = 1 + number as usize % 2;
    let centre = size * Vec3::new(0.4 + 0.2 * r(3), 0.4 + 0.2 * r(4), 0.4 + 0.2 * r(5));
    let half = 0.1 + 0.1 * r(6);
    let object = match number % 4 {
        0 => Shape::Box { min: centre - Vec3::splat(half), max: centre + Vec3::splat(half), inward: false },
        1 => Shape::Sphere { centre, radius: half, inward: false, segments: 5 },
        2 => Shape::Cylinder {
            base: centre,
            axis: Vec3::new(0.0, 0.2, 0.1),
            radius: half,
            caps: true,
            inward: false,
            segments: 6,
        },
        _ => Shape::Disc { centre, normal: Vec3::new(0.2, 0.1, -1.0), radius: half, segments: 5 },
    };
    let walls = Shape::Box { min: Vec3::ZERO, max: size, inward: true };
    let mesh = mesh(&[(walls, Lines::Counts { u: cut, v: cut }), (object, Lines::Whole)]);
    materials(&mesh, |leaf, surface| {
        let lamp = if surface == 1 { 5.0 * r(7) } else { f64::from(u8::from(leaf < cut * cut)) };
        (0.9 * r(8 + surface as u32), lamp)
    })
}

fn materials(mesh: &Mesh, material: impl Fn(usize, usize) -> (f64, f64)) -> Problem {
    let patches: Vec<Patch> = mesh.patches().copied().collect();
    let (rho, exitance) = (0..mesh.len()).map(|leaf| material(leaf, mesh.surface_of(leaf))).unzip();
    Problem::new(patches, rho, exitance)
}

#[test]
fn twenty_scenes_that_are_right_pass() {
    let mut scores = Vec::new();
    for number in 0..20 {
        let problem = room(number);
        let scene = problem.enclosure();
        let found = verdict(
            &problem.irradiance(MOST_REFLECTIONS),
            &traced(&scene, &StochasticJacobi, number.into(), 2048),
        );
        let worst = found.worst(1)[0];
        println!(
            "{number:2}: {:3} patches, mean z² {:.2}, worst z {:+.2}",
            problem.patches.len(),
            found.suite.variance,
            worst.z
        );
        assert!(found.agrees(), "scene {number}: {worst:?}");
        scores.push(found.suite.variance);
    }
    // A comparison that cannot fail would have small scores.
    let mean = scores.iter().sum::<f64>() / 20.0;
    assert!((mean - 1.0).abs() < 0.25, "{mean}");
}

/// A room of six walls, the last of which emits.
fn plain() -> Problem {
    let walls = Shape::Box { min: Vec3::ZERO, max: Vec3::new(1.0, 1.2, 0.9), inward: true };
    materials(&mesh(&[(walls, Lines::Whole)]), |leaf, _| (0.5, f64::from(u8::from(leaf == 5))))
}

/// A room of four patches a wall, with a plate between.
fn furnished() -> Problem {
    let walls = Shape::Box { min: Vec3::ZERO, max: Vec3::new(1.0, 1.2, 0.9), inward: true };
    let object = Shape::Box { min: Vec3::splat(0.3), max: Vec3::splat(0.6), inward: false };
    let mesh = mesh(&[(walls, Lines::Counts { u: 2, v: 2 }), (object, Lines::Whole)]);
    materials(&mesh, |leaf, _| (0.5, f64::from(u8::from((20..24).contains(&leaf)))))
}

#[test]
fn a_form_factor_two_percent_wrong_is_found_and_located() {
    let right = plain();
    let state = traced(&right.enclosure(), &StochasticJacobi, 1, 1 << 14);
    assert!(verdict(&right.irradiance(MOST_REFLECTIONS), &state).agrees());
    let mut wrong = plain();
    // Between the lamp and the wall opposite; both directions, as one stored exchange has them.
    wrong.factors[5][4] *= 1.02;
    wrong.factors[4][5] *= 1.02;
    let found = verdict(&wrong.irradiance(MOST_REFLECTIONS), &state);
    println!("{:?}", found.worst(2));
    assert!(!found.agrees() && found.worst(1)[0].index == 4 && found.worst(1)[0].z < 0.0);
}

#[test]
fn a_flipped_normal_is_found() {
    let right = furnished();
    let state = traced(&right.enclosure(), &StochasticJacobi, 2, 1 << 12);
    assert!(verdict(&right.irradiance(MOST_REFLECTIONS), &state).agrees());
    let mut patches = right.patches.clone();
    patches[25] = patches[25].flipped();
    let wrong = Problem::new(patches, right.rho.clone(), right.exitance.clone());
    let found = verdict(&wrong.irradiance(MOST_REFLECTIONS), &state);
    println!("{:?}", found.worst(2));
    assert!(!found.agrees() && found.worst(1)[0].index == 25);
}

#[test]
fn a_missing_bounce_is_found_on_either_side() {
    let right = furnished();
    let scene = right.enclosure();
    let state = traced(&scene, &StochasticJacobi, 3, 1 << 12);
    // The fourth reflection and those after it are lost.
    assert!(!verdict(&right.irradiance(3), &state).agrees());
    let short = PathTracing::patchwise(Switches { bounces: Some(3), ..Switches::default() });
    let whole = PathTracing::patchwise(Switches::default());
    assert!(verdict(&right.irradiance(MOST_REFLECTIONS), &traced(&scene, &whole, 4, 128)).agrees());
    let found = verdict(&right.irradiance(MOST_REFLECTIONS), &traced(&scene, &short, 4, 128));
    assert!(!found.agrees() && found.suite.mean < -1.0, "{:?}", found.suite);
    // As many reflections on both sides agree.
    assert!(verdict(&right.irradiance(3), &traced(&scene, &short, 4, 128)).agrees());
}

/// Draws from one density and states another.
struct Misstated;

impl DirectionDensity for Misstated {
    fn sample(&self, numbers: [f64; 2]) -> Vec3 {
        UniformHemisphere.sample(numbers)
    }

    fn pdf(&self, direction: Vec3) -> f64 {
        Cosine.pdf(direction)
    }
}

#[test]
fn a_wrong_density_is_found_and_another_right_one_is_not() {
    let right = furnished();
    let (scene, irradiance) = (right.enclosure(), right.irradiance(MOST_REFLECTIONS));
    let with = |density: Box<dyn DirectionDensity>| {
        let tracing = PathTracing::patchwise(Switches::default()).with_directions(density);
        verdict(&irradiance, &traced(&scene, &tracing, 5, 128))
    };
    assert!(with(Box::new(UniformHemisphere)).agrees());
    assert!(!with(Box::new(Misstated)).agrees());
}
