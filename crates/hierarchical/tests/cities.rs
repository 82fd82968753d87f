//! Links of generated cities: row sums that hold, and a system that every solver of products
//! solves.
//!
//! `cargo test --release -p fredholm-hierarchical --test cities -- --ignored --test-threads=1
//! --nocapture` takes cities of 13,000 and 40,000 faces within 4 GiB.

#![allow(clippy::unwrap_used, reason = "a test that cannot run should panic, in its helpers too")]

mod common;

use std::time::Instant;

use common::{Bench, options};
use fredholm_generate::City;
use fredholm_hierarchical::{Solution, Stated};
use fredholm_iterative::solvers;
use fredholm_linop::{MultiVector, Quiet, SecondKind, Stop, StopReason};
use fredholm_scene::Scene;

/// Solvers that ask for products alone. `cg-psi` is not among them: its matrix has areas over
/// reflectances on the diagonal, here from m² to cm², and without a preconditioner its steps grow
/// with the root of their quotient. Scaled by that diagonal it is `cg-theta`.
const PRODUCTS: [&str; 9] =
    ["neumann", "jacobi", "cg-theta", "pcg-jacobi", "chebyshev", "minres", "gmres", "bicgstab", "anderson"];

/// Largest row sum, and how many solvers of products end at the residual that the accuracy asks
/// for.
fn solved(solution: &Solution, accuracy: f64) -> (f64, usize) {
    let operator = solution.operator();
    let a = SecondKind::new(&operator, solution.system.scaling()).unwrap();
    let rhs = solution.system.exitance();
    let stop = Stop { tolerance: options(accuracy).residual, max_iterations: 2000 };
    let mut converged = 0;
    for solver in solvers::<f64>().iter().filter(|solver| PRODUCTS.contains(&solver.name())) {
        let mut x = MultiVector::zeros(rhs.dim(), rhs.rhs_count());
        let start = Instant::now();
        let report = solver.solve(&a, rhs, &mut x, &stop, &mut Quiet).unwrap();
        let (steps, seconds) = (report.history.len(), start.elapsed().as_secs_f64());
        println!("{:>12} {:?} after {steps} steps, {seconds:.1} s", solver.name(), report.reason);
        converged += usize::from(report.reason == StopReason::Converged);
    }
    (solution.closure.iter().copied().fold(0.0, f64::max), converged)
}

/// Solves the links of a city within 4 GiB.
fn city(faces: usize, jitter: f64, accuracy: f64) {
    let folder = tempfile::tempdir().unwrap();
    let scene = City { faces, jitter, seed: 1 }.files().write(folder.path()).unwrap();
    let bench = Bench::new(Scene::load(scene).unwrap());
    let solution = bench.resume(accuracy, None, &Quiet);
    let (links, stated) = (solution.links.len(), solution.error.as_ref().map(Stated::worst));
    println!("{faces} faces, {jitter} m: {links} links, stated {stated:?}, limited {}", solution.limited);
    let (row, converged) = solved(&solution, accuracy);
    println!("largest row sum {row}");
    assert!(row <= 1.05, "{row}");
    assert_eq!(converged, PRODUCTS.len());
    assert!(solution.bytes() <= options(accuracy).bytes);
}

#[test]
fn row_sums_of_a_small_city_hold_and_every_solver_of_products_converges() {
    for jitter in [0.0, 0.003] {
        city(600, jitter, 0.2);
    }
}

#[test]
#[ignore = "takes minutes"]
fn row_sums_of_a_city_of_13_000_faces_hold() {
    city(13_000, 0.0, 0.05);
}

#[test]
#[ignore = "takes minutes"]
fn row_sums_of_a_city_of_13_000_faces_that_are_moved_hold() {
    city(13_000, 0.003, 0.05);
}

#[test]
#[ignore = "takes a quarter of an hour"]
fn row_sums_of_a_city_of_40_000_faces_hold() {
    city(40_000, 0.0, 0.05);
}
