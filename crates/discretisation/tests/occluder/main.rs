//! The scene scenes/occluder.toml by every discretisation, against particle tracing.
//!
//! On every face H B_h must be within 0.3 % of the reference; the polynomials must be within their
//! stated error; and LU must find what Gauss–Seidel finds.

// A test that cannot run should panic, in its helpers too.
#![allow(clippy::unwrap_used)]

mod faces;
mod reference;
mod scene;

use faces::compare;
use fredholm_direct::DenseLu;
use fredholm_discretisation::{Light, Lit, Site, discretisation, discretisations};
use fredholm_iterative::GaussSeidel;
use fredholm_linop::{MultiVector, Quiet, Solver, Stop, StopReason};
use fredholm_mesh::Mesh;
use fredholm_visibility::Occluders;
use scene::{Cuts, Part};

const STOP: Stop = Stop { tolerance: 1e-10, max_iterations: 500 };

/// For constants by every method but Nyström's.
const CONSTANT: Cuts = Cuts {
    floor: &[(0.12, 3), (0.5, 4)],
    ceiling: &[(0.12, 8), (0.35, 6), (0.5, 1)],
    lower: [&[(0.12, 3), (0.5, 6)], &[(0.1, 2), (1.0, 9)]],
    upper: [&[(0.12, 7), (0.5, 10)], &[(0.5, 6), (1.0, 10)]],
    lamp: &[(0.5, 1)],
    plate: &[(0.5, 5)],
};

/// Lower walls for methods that find too much light on them from constants.
const FINER_LOWER_WALLS: [&[Part]; 2] = [&[(0.12, 3), (0.5, 7)], &[(0.1, 2), (1.0, 10)]];

/// For Nyström's method with one point an element: one point is not enough for the whole lamp.
const MIDPOINTS: Cuts = Cuts { lamp: &[(0.5, 2)], lower: FINER_LOWER_WALLS, ..CONSTANT };

/// For least squares, whose residual is largest in the corners of the ceiling.
const LEAST_SQUARES: Cuts = Cuts {
    ceiling: &[(0.12, 9), (0.35, 6), (0.5, 1)],
    lower: FINER_LOWER_WALLS,
    upper: [&[(0.12, 7), (0.5, 11)], &[(0.5, 7), (1.0, 12)]],
    ..CONSTANT
};

/// Enough for constants by Galerkin.
const CONSTANT_GALERKIN: Cuts = Cuts {
    ceiling: &[(0.12, 6), (0.35, 4), (0.5, 1)],
    upper: [&[(0.12, 6), (0.5, 8)], &[(0.5, 4), (1.0, 8)]],
    plate: &[(0.5, 4)],
    ..CONSTANT
};

const LINEAR: Cuts = Cuts {
    floor: &[(0.25, 2), (0.5, 1)],
    ceiling: &[(0.1, 2), (0.35, 2), (0.5, 1)],
    lower: [&[(0.25, 2), (0.5, 2)], &[(1.0, 5)]],
    upper: [&[(0.12, 2), (0.5, 3)], &[(1.0, 4)]],
    lamp: &[(0.5, 1)],
    plate: &[(0.5, 2)],
};

const QUADRATIC: Cuts = Cuts {
    floor: &[(0.25, 2), (0.5, 1)],
    ceiling: &[(0.15, 1), (0.35, 1), (0.5, 1)],
    lower: [&[(0.25, 1), (0.5, 1)], &[(1.0, 3)]],
    upper: [&[(0.15, 1), (0.5, 1)], &[(1.0, 3)]],
    lamp: &[(0.5, 1)],
    plate: &[(0.5, 1)],
};

fn solve<'a>(light: &'a Light, name: &str) -> Lit<'a> {
    let method = discretisation(name).unwrap();
    let lit = light.solve(&*method, &GaussSeidel, &STOP, &mut Quiet).unwrap();
    assert_eq!(lit.report().reason, StopReason::Converged, "{name}");
    lit
}

/// Largest difference of the unknowns from those by LU, relative to the largest.
fn difference_from_lu(mesh: &Mesh, lit: &Lit) -> f64 {
    let b = lit.system().right_hand_side(&|site: &Site, _| scene::exitance(mesh, site.element));
    let mut x = MultiVector::zeros(b.dim(), 1);
    DenseLu.solve(&lit.system().operator().unwrap(), &b, &mut x, &STOP, &mut Quiet).unwrap();
    let size = x.as_slice().iter().fold(0.0, |m: f64, x| m.max(x.abs()));
    let differences = x.as_slice().iter().zip(lit.unknowns().as_slice()).map(|(x, y)| (x - y).abs());
    differences.fold(0.0, f64::max) / size
}

/// Prints a line of the table of docs/notes/discretisations.md.
fn check(name: &str, cuts: &Cuts) {
    let mesh = cuts.mesh();
    let occluders = Occluders::new(mesh.occluders()).unwrap();
    let light = scene::light(&mesh, &occluders);
    let lit = solve(&light, name);
    let (found, stated) = (compare(&mesh, &lit, &reference::classes()), lit.error().relative_l2[0]);
    let [error, shown, root, largest, beyond] =
        [found.polynomial, stated, found.root, found.largest, found.beyond_noise].map(|x| 100.0 * x);
    println!(
        "| {name} | {} | {} | {error:.2} % | {shown:.2} % | {root:.2} % | {largest:.2} % | {beyond:.2} % |",
        mesh.len(),
        lit.unknowns().dim()
    );
    let solvers = difference_from_lu(&mesh, &lit);
    assert!(solvers < 1e-8, "{name}: LU and Gauss–Seidel differ by {solvers:e}");
    // The classes of faces are known to 0.05 %.
    assert!(found.polynomial <= stated + 5e-4, "{name}: error {:e}, stated {stated:e}", found.polynomial);
    assert!(found.largest <= 0.003, "{name}: {largest} % off on a face");
}

#[test]
fn constants_agree_with_particle_tracing_on_every_face() {
    check("galerkin-0", &CONSTANT_GALERKIN);
}

#[test]
fn linear_functions_agree_with_particle_tracing_on_every_face() {
    check("nystrom-2", &LINEAR);
}

#[test]
fn quadratic_functions_agree_with_particle_tracing_on_every_face() {
    check("collocation-2", &QUADRATIC);
}

/// All methods whose polynomials have a degree.
fn check_all(degree: usize, cuts: &Cuts) {
    for method in discretisations() {
        let number = method.name().chars().find_map(|c| c.to_digit(10)).unwrap() as usize;
        let nystrom = usize::from(method.name().starts_with("nystrom"));
        if number - nystrom == degree {
            check(
                method.name(),
                match method.name() {
                    "nystrom-1" => &MIDPOINTS,
                    "least-squares-0" => &LEAST_SQUARES,
                    _ => cuts,
                },
            );
        }
    }
}

#[test]
#[ignore = "takes minutes"]
fn all_constants_agree_on_every_face() {
    check_all(0, &CONSTANT);
}

#[test]
#[ignore = "takes a minute"]
fn all_linear_functions_agree_on_every_face() {
    check_all(1, &LINEAR);
}

#[test]
#[ignore = "takes a minute"]
fn all_quadratic_functions_agree_on_every_face() {
    check_all(2, &QUADRATIC);
}
