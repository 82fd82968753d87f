//! Stated errors beside true ones, computed anew: a sphere quickly, a plate where it is asked for.

#![allow(clippy::unwrap_used, reason = "a test that cannot go on has failed")]

mod common;
#[path = "../examples/wave_cases/mod.rs"]
mod wave_cases;

use common::wave;
use fredholm_iterative::Gmres;
use fredholm_linop::{MultiVector, Quiet, SecondKind, Solver, Stop};
use fredholm_waves::{
    Bounced, Complex64, ComplexVector, EdgeCurrents, Indicator, PhysicalOptics, Shadow, Source, System,
    field_inside,
};
use wave_cases::{Body, Case, calibration, directions, error};

/// Stated over true error of a case after all bounces, by its treatment.
fn ratio(case: &Case, shadow: Shadow, truth: &[ComplexVector]) -> f64 {
    let (body, u) = (case.scatterer(8.0), directions());
    let source = case.source();
    let sources: [&dyn Source; 1] = [&source];
    let first = PhysicalOptics::new(&body, wave(), &sources, shadow).unwrap();
    let system = System::lazy(&body, wave(), shadow).unwrap();
    let b = system.right_hand_side(&[&first]);
    let one = MultiVector::from_fn(b.dim(), 1, |_, _| Complex64::ONE);
    let a = SecondKind::new(system.coupling(), one).unwrap();
    let mut x = MultiVector::zeros(b.dim(), 1);
    let stop = Stop { tolerance: 1e-4, max_iterations: 300 };
    Gmres { restart: 60 }.solve(&a, &b, &mut x, &stop, &mut Quiet).unwrap();
    let currents = Bounced::new(&body, &first, &system.currents(&x, 0));
    let radiator = system.radiator(&currents);
    let far = radiator.far_field(&u).unwrap().into_iter().map(|far| far.amplitude);
    let far: Vec<ComplexVector> = far.collect();
    if let Some(inside) = field_inside(&body, &wave(), &sources, &radiator).unwrap() {
        return Indicator::InsideEquation(inside).error() / error(&far, truth);
    }
    let edges = EdgeCurrents::of_bounces(&body, wave(), &sources, &currents).unwrap();
    let edge: Vec<ComplexVector> = u.iter().map(|&u| edges.far_amplitude(u)).collect();
    let both: Vec<ComplexVector> = far.iter().zip(&edge).map(|(far, edge)| *far + *edge).collect();
    let norm = |a: &[ComplexVector]| a.iter().map(|a| a.norm_squared()).sum::<f64>().sqrt();
    Indicator::EdgesAdded(norm(&edge) / norm(&both)).error() / error(&both, truth)
}

#[test]
fn the_error_of_a_sphere_holds() {
    let case = Case::new("sphere", Body::Sphere(0.6), [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]);
    let ratio = ratio(&case, Shadow::ExactDual, &case.truth(&directions(), 8.0, 1));
    assert!((1.0..10.0).contains(&ratio), "{ratio}");
}

/// All runs of the calibration, after all bounces by default treatments.
#[test]
#[ignore = "takes minutes"]
fn stated_errors_hold_in_95_of_100_runs() {
    let mut ratios = Vec::new();
    for cases in calibration() {
        let truths = Case::truths(&cases, &directions(), 8.0, 1);
        let shadow =
            if matches!(cases[0].body, Body::Plates(_)) { Shadow::Radiated } else { Shadow::ExactDual };
        ratios.extend(cases.iter().zip(&truths).map(|(case, truth)| ratio(case, shadow, truth)));
    }
    ratios.sort_by(f64::total_cmp);
    let failed = ratios.iter().filter(|&&ratio| ratio < 1.0).count();
    eprintln!(
        "{} runs, {failed} above what was stated, median {:.2}",
        ratios.len(),
        ratios[ratios.len() / 2]
    );
    assert!(ratios.len() >= 60 && 20 * failed <= ratios.len() && ratios[ratios.len() / 2] < 4.0);
}
