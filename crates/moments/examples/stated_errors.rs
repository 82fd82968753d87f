//! Indicators of the error beside the true one, as CSV: what `fredholm_waves::Indicator` is calibrated on.
//!
//!     cargo run --release -p fredholm-moments --example stated_errors > tests/data/wave/stated_errors.csv

#![allow(clippy::unwrap_used, reason = "an example shows the way, not what may go wrong on it")]

#[path = "../tests/common/mod.rs"]
mod common;
mod wave_cases;

use common::wave;
use fredholm_iterative::Gmres;
use fredholm_linop::{MultiVector, Quiet, SecondKind, Solver, Stop};
use fredholm_mesh::Vec3;
use fredholm_waves::{
    Bounced, Complex64, ComplexVector, EdgeCurrents, Indicator, PhysicalOptics, Scatterer, Shadow, Source,
    System, field_inside,
};
use wave_cases::{Body, Case, calibration, directions, error, small_sheets};

type Vectors = MultiVector<Complex64>;

fn all(system: &System<'_>, b: &Vectors) -> Vectors {
    let one = Vectors::from_fn(b.dim(), 1, |_, _| Complex64::ONE);
    let a = SecondKind::new(system.coupling(), one).unwrap();
    let mut x = Vectors::zeros(b.dim(), 1);
    let stop = Stop { tolerance: 1e-4, max_iterations: 300 };
    Gmres { restart: 60 }.solve(&a, b, &mut x, &stop, &mut Quiet).unwrap();
    x
}

fn norm(a: &[ComplexVector]) -> f64 {
    a.iter().map(|a| a.norm_squared()).sum::<f64>().sqrt()
}

/// The name, the treatment, the indicator and the true error.
fn row(case: &Case, shadow: Shadow, indicator: Indicator, true_error: f64) {
    let kind = format!("{indicator:?}");
    let kind = kind.split('(').next().unwrap();
    println!("{},{},{kind},{:.5},{true_error:.5}", case.name, shadow.name(), indicator.value());
}

fn run(case: &Case, body: &Scatterer, shadow: Shadow, truth: &[ComplexVector], u: &[Vec3]) {
    let source = case.source();
    let sources: [&dyn Source; 1] = [&source];
    let first = PhysicalOptics::new(body, wave(), &sources, shadow).unwrap();
    let system = System::lazy(body, wave(), shadow).unwrap();
    let currents = system.currents(&all(&system, &system.right_hand_side(&[&first])), 0);
    let currents = Bounced::new(body, &first, &currents);
    let radiator = system.radiator(&currents);
    let far: Vec<ComplexVector> =
        radiator.far_field(u).unwrap().into_iter().map(|far| far.amplitude).collect();
    if let Some(inside) = field_inside(body, &wave(), &sources, &radiator).unwrap() {
        let indicator = if shadow.is_equation() {
            Indicator::InsideEquation(inside)
        } else {
            Indicator::InsideOptics(inside)
        };
        return row(case, shadow, indicator, error(&far, truth));
    }
    let edges = EdgeCurrents::of_bounces(body, wave(), &sources, &currents).unwrap();
    let edge: Vec<ComplexVector> = u.iter().map(|&u| edges.far_amplitude(u)).collect();
    let both: Vec<ComplexVector> = far.iter().zip(&edge).map(|(far, edge)| *far + *edge).collect();
    row(case, shadow, Indicator::EdgesLeft(norm(&edge) / norm(&far)), error(&far, truth));
    row(case, shadow, Indicator::EdgesAdded(norm(&edge) / norm(&both)), error(&both, truth));
}

/// The electric field equation on even cells of several sizes, beside cells far finer and graded.
fn boundary_elements(u: &[Vec3]) {
    for bodies in small_sheets() {
        let truths = Case::truths(&bodies, u, 20.0, 2);
        for per in [4.5, 6.0, 8.0, 10.0] {
            let indicator = Indicator::BoundaryElements(bodies[0].longest_edge(per));
            for ((case, far), truth) in bodies.iter().zip(Case::truths(&bodies, u, per, 0)).zip(&truths) {
                println!(
                    "{},efie,BoundaryElements,{:.5},{:.5}",
                    case.name,
                    indicator.value(),
                    error(&far, truth)
                );
            }
        }
    }
}

fn main() {
    let u = directions();
    println!("case,treatment,indicator,value,true_error");
    for bodies in calibration() {
        let truths = Case::truths(&bodies, &u, 8.0, 1);
        let body = bodies[0].scatterer(8.0);
        for (case, truth) in bodies.iter().zip(&truths) {
            let shadows = if matches!(case.body, Body::Plates(_)) {
                vec![Shadow::Radiated]
            } else {
                vec![Shadow::Geometric, Shadow::ExactDual]
            };
            for shadow in shadows {
                run(case, &body, shadow, truth, &u);
            }
        }
    }
    boundary_elements(&u);
}
