//! Relative L² error of the scattered far field, treatment by treatment and bounce by bounce.
//!
//!     cargo run --release -p fredholm-moments --example treatments -- [part of a name]

#![allow(clippy::unwrap_used, reason = "an example shows the way, not what may go wrong on it")]

#[path = "../tests/common/mod.rs"]
mod common;
mod wave_cases;

use common::wave;
use fredholm_iterative::Gmres;
use fredholm_linop::{MultiVector, Quiet, SecondKind, Solver, Stop};
use fredholm_mesh::Vec3;
use fredholm_waves::{
    Bounced, Complex64, ComplexVector, EdgeCurrents, PhysicalOptics, Scatterer, Shadow, Source, System,
};
use wave_cases::{Body, Case, cases, directions, error};

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

fn main() {
    let wanted = std::env::args().nth(1).unwrap_or_default();
    let u = directions();
    println!(
        "case, treatment; after 1, 2, 3, 4 and all bounces: without edges, with those of the incident wave, of all waves"
    );
    for case in cases().into_iter().filter(|case| case.name.contains(&wanted)) {
        let truth = case.truth(&u, 8.0, 1);
        if matches!(case.body, Body::Plates(_)) {
            // What small scenes get unasked.
            println!(
                "{}, efie on even cells of λ/6: {:.3}",
                case.name,
                error(&case.truth(&u, 6.0, 0), &truth)
            );
        }
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
