//! Multipoles of the equations of conductors against the stored matrices, their memory, solutions,
//! and threads.

#![allow(clippy::unwrap_used, reason = "a test that cannot go on has failed")]

mod common;

use common::{WAVELENGTH, relative_error, wave};
use fredholm_compressed::MultipoleSettings;
use fredholm_linop::{LinearOperator, MultiVector, Quiet};
use fredholm_moments::meshing::{Grading, plate, sphere};
use fredholm_moments::{Basis, Conductor, Equation};
use fredholm_waves::Complex64;

/// A vector that looks like chance.
fn chance(dim: usize, count: usize) -> MultiVector<Complex64> {
    MultiVector::from_fn(dim, count, |i, rhs| Complex64::cis(((i * i + 31 * rhs) % 97) as f64))
}

fn product(matrix: &dyn LinearOperator<Complex64>, x: &MultiVector<Complex64>) -> MultiVector<Complex64> {
    let mut y = MultiVector::zeros(x.dim(), x.rhs_count());
    matrix.apply(x, &mut y);
    y
}

#[test]
fn products_of_conductors_are_within_the_tolerance() {
    let ball = Basis::new(sphere(0.6 * WAVELENGTH, WAVELENGTH / 8.0).unwrap()).unwrap();
    let sheet = Basis::new(plate(2.0 * WAVELENGTH, WAVELENGTH / 8.0, Grading::default()).unwrap()).unwrap();
    for (basis, equation) in [
        (&sheet, Equation::Electric),
        (&ball, Equation::Electric),
        (&ball, Equation::Magnetic),
        (&ball, Equation::default()),
    ] {
        let conductor = Conductor::new(basis, wave(), equation, 1e-4).unwrap();
        let x = chance(basis.len(), 1);
        let exact = product(&conductor.operator().dense().unwrap(), &x);
        for tolerance in [1e-2, 1e-3, 1e-4] {
            let settings = MultipoleSettings { tolerance, ..MultipoleSettings::default() };
            let matrix = conductor.multipole(settings, &Quiet).unwrap();
            let error = relative_error(&product(&matrix, &x).vector(0), &exact.vector(0));
            println!(
                "{} {}: {tolerance:e} error {error:.2e} {:?}",
                equation.name(),
                basis.len(),
                matrix.summary()
            );
        }
    }
}
