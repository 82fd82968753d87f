//! Multipoles of the equations of conductors against the stored matrices, their memory, solutions,
//! and threads.

#![allow(clippy::unwrap_used, reason = "a test that cannot go on has failed")]

mod common;

use common::{WAVELENGTH, circle, mie, relative_error, source, vertical, wave};
use fredholm_compressed::{BlockDiagonal, CompressionError, MultipoleSettings, Preconditioned};
use fredholm_iterative::Gmres;
use fredholm_linop::{LinearOperator, MultiVector, Quiet, SecondKind, Solver, Stop, StopReason, Watch};
use fredholm_moments::meshing::{Grading, curved_sphere, plate, sphere};
use fredholm_moments::{Basis, Conductor, Currents, Equation, MomentsError, Order};
use fredholm_waves::{Complex64, Ground, Source};
use std::ops::ControlFlow;

/// Vectors that look like chance.
fn chance(dim: usize, count: usize) -> MultiVector<Complex64> {
    MultiVector::from_fn(dim, count, |i, rhs| Complex64::cis(((i * i + 31 * rhs) % 97) as f64))
}

fn product(matrix: &dyn LinearOperator<Complex64>, x: &MultiVector<Complex64>) -> MultiVector<Complex64> {
    let mut y = MultiVector::zeros(x.dim(), x.rhs_count());
    matrix.apply(x, &mut y);
    y
}

fn settings(tolerance: f64) -> MultipoleSettings {
    MultipoleSettings { tolerance, ..MultipoleSettings::default() }
}

/// A ball whose far boxes couple on two levels.
fn ball() -> Basis {
    Basis::new(sphere(0.7 * WAVELENGTH, WAVELENGTH / 6.0).unwrap()).unwrap()
}

#[test]
fn products_of_conductors_are_within_the_tolerance() {
    let ball = ball();
    let sheet = Basis::new(plate(2.0 * WAVELENGTH, WAVELENGTH / 8.0, Grading::default()).unwrap()).unwrap();
    let curved = curved_sphere(0.8 * WAVELENGTH, WAVELENGTH / 4.0).unwrap();
    let curved = Basis::of_order(curved, Order::First).unwrap();
    for (basis, equation, tolerances) in [
        (&sheet, Equation::Electric, &[1e-2, 1e-3, 1e-4][..]),
        (&ball, Equation::Electric, &[1e-2, 1e-3]),
        (&ball, Equation::Magnetic, &[1e-2, 1e-3]),
        (&ball, Equation::Combined { alpha: 0.3 }, &[1e-2, 1e-3]),
        (&curved, Equation::Electric, &[1e-2, 1e-3]),
        (&curved, Equation::Combined { alpha: 0.3 }, &[1e-2, 1e-3]),
    ] {
        let integrals = if basis.len() == sheet.len() { 1e-5 } else { 1e-3 };
        let conductor = Conductor::new(basis, wave(), equation, integrals).unwrap();
        let x = chance(basis.len(), 1);
        let exact = product(&conductor.operator().dense().unwrap(), &x);
        let mut before = f64::INFINITY;
        for &tolerance in tolerances {
            let matrix = conductor.multipole(settings(tolerance), &Quiet).unwrap();
            let error = relative_error(&product(&matrix, &x).vector(0), &exact.vector(0));
            let summary = matrix.summary();
            println!("{} {}: {tolerance:e} error {error:.2e}, {summary:?}", equation.name(), basis.len());
            assert!(error < tolerance && error < before, "{equation:?} {tolerance}: {error:e}");
            before = error;
        }
    }
}

#[test]
fn several_vectors_are_multiplied_as_one_and_the_memory_is_what_was_told() {
    let ball = ball();
    let conductor = Conductor::new(&ball, wave(), Equation::Electric, 1e-2).unwrap();
    let matrix = conductor.multipole(settings(1e-2), &Quiet).unwrap();
    let x = chance(ball.len(), 3);
    let y = product(&matrix, &x);
    for rhs in 0..3 {
        let one = MultiVector::from_fn(x.dim(), 1, |i, _| x.row(i)[rhs]);
        assert!(product(&matrix, &one).vector(0) == y.vector(rhs));
    }
    let summary = matrix.summary();
    assert_eq!(summary, conductor.multipole_summary(settings(1e-2)).unwrap());
    assert_eq!(matrix.held_bytes(), summary.near + summary.patterns + summary.tables);
    assert!(summary.levels > 1 && summary.fields > 0, "{summary:?}");
}

#[test]
fn a_sphere_has_the_field_of_the_series_and_the_same_bits_with_any_number_of_threads() {
    let radius = 0.7 * WAVELENGTH;
    let ball = ball();
    let conductor = Conductor::new(&ball, wave(), Equation::default(), 1e-2).unwrap();
    let source = source();
    let sources: [&dyn Source; 1] = [&source];
    let b = conductor.right_hand_side(&[&sources]);
    let solve = || {
        let matrix = conductor.multipole(settings(1e-3), &Quiet).unwrap();
        let inverse = BlockDiagonal::new(&matrix).unwrap();
        let system = Preconditioned::new(&matrix, &inverse);
        let right = system.right_hand_side(&b);
        let ones = MultiVector::from_fn(b.dim(), 1, |_, _| Complex64::ONE);
        let a = SecondKind::new(&system, ones).unwrap();
        let mut x = MultiVector::zeros(b.dim(), 1);
        // Products are those of one operator to double precision: GMRES comes down to any residual.
        let stop = Stop { tolerance: 1e-10, max_iterations: 100 };
        let report = Gmres { restart: 100 }.solve(&a, &right, &mut x, &stop, &mut Quiet).unwrap();
        assert_eq!(report.reason, StopReason::Converged);
        x.vector(0)
    };
    let [one, two, four] = [1, 2, 4].map(|threads| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
        pool.install(solve)
    });
    assert!(one == two && one == four);
    let field = vertical(&Currents::new(&ball, wave(), &one, None).fields(&circle()).unwrap());
    let error = relative_error(&field, &mie(radius));
    println!("{} unknowns: error {error:.4}", ball.len());
    assert!(error < 0.01, "{error}");
}

/// A watch that wants nothing.
struct Unwanted;

impl Watch for Unwanted {
    fn go_on(&self) -> ControlFlow<()> {
        ControlFlow::Break(())
    }
}

#[test]
fn what_does_not_fit_is_refused() {
    let ball = ball();
    let conductor = Conductor::new(&ball, wave(), Equation::Electric, 1e-2).unwrap();
    let refused = |settings: MultipoleSettings| match conductor.multipole(settings, &Unwanted).map(|_| ()) {
        Err(MomentsError::Compression(error)) => error,
        other => panic!("{other:?}"),
    };
    let usual = settings(1e-2);
    assert_eq!(refused(usual), CompressionError::Interrupted);
    let CompressionError::Memory { needed, limit } = refused(MultipoleSettings { limit: 1 << 16, ..usual })
    else {
        panic!("65 kB are not enough");
    };
    assert!(needed > limit && limit == 1 << 16);
    assert!(matches!(refused(settings(1e-7)), CompressionError::Setting { .. }));
    assert!(matches!(refused(MultipoleSettings { leaf: 0.1, ..usual }), CompressionError::Setting { .. }));
    let small = Basis::new(sphere(0.1 * WAVELENGTH, WAVELENGTH / 20.0).unwrap()).unwrap();
    let conductor = Conductor::new(&small, wave(), Equation::Electric, 1e-2).unwrap();
    let refused = conductor.multipole_summary(usual);
    assert!(matches!(refused, Err(MomentsError::Compression(CompressionError::Small { .. }))), "{refused:?}");
    let sheet = Basis::new(plate(2.0 * WAVELENGTH, WAVELENGTH / 5.0, Grading::default()).unwrap()).unwrap();
    let above = sheet.above(Ground::new(-10.0).unwrap()).unwrap();
    let conductor = Conductor::new(&above, wave(), Equation::Electric, 1e-2).unwrap();
    let refused = conductor.multipole_summary(usual);
    let error = refused.unwrap_err();
    assert!(error == MomentsError::Grounded && error.help().is_some());
}
