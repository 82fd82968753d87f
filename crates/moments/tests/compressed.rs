//! Compressed matrices of the equations against the stored ones, their memory, solutions, and
//! threads.

#![allow(clippy::unwrap_used, reason = "a test that cannot go on has failed")]

mod common;

use common::{WAVELENGTH, circle, mie, relative_error, solved, source, vertical, wave};
use fredholm_compressed::{BlockDiagonal, CompressionError, Factors, Preconditioned, Settings};
use fredholm_iterative::Gmres;
use fredholm_linop::{LinearOperator, MultiVector, Quiet, SecondKind, Solver, Stop, StopReason};
use fredholm_moments::meshing::{Grading, plate, sphere};
use fredholm_moments::{
    Basis, Composite, Conductor, Currents, Equation, Filling, MomentsError, Operator, Regions,
};
use fredholm_waves::{Complex64, Source};

/// ‖(Z − Z̃) x‖/‖Z x‖ of a vector that looks like chance.
fn product_error(operator: &Operator<'_>, tolerance: f64) -> (f64, f64) {
    let x = MultiVector::from_fn(operator.dim(), 1, |i, _| Complex64::cis((i * i % 97) as f64));
    let product = |matrix: &dyn LinearOperator<Complex64>| {
        let mut y = MultiVector::zeros(x.dim(), 1);
        matrix.apply(&x, &mut y);
        y.vector(0)
    };
    let compressed =
        operator.compressed(Settings { tolerance, leaf: 24, ..Settings::default() }, &Quiet).unwrap();
    let summary = compressed.summary();
    assert!(summary.low_rank > 0, "{summary:?}");
    let ratio = summary.bytes as f64 / summary.predicted as f64;
    assert!((0.7..1.4).contains(&ratio), "{summary:?}");
    (relative_error(&product(&compressed), &product(&operator.dense().unwrap())), summary.share)
}

#[test]
fn products_of_conductors_are_within_the_tolerance() {
    let ball = Basis::new(sphere(0.5 * WAVELENGTH, WAVELENGTH / 8.0).unwrap()).unwrap();
    let sheet = Basis::new(plate(1.5 * WAVELENGTH, WAVELENGTH / 10.0, Grading::default()).unwrap()).unwrap();
    let conductor =
        |basis, equation| Conductor::new(basis, wave(), equation, 1e-3).unwrap().operator().clone();
    // On this ball nothing is of low rank at a finer tolerance.
    let operators = [
        (conductor(&sheet, Equation::Electric), "electric", &[1e-2, 1e-3, 1e-4][..]),
        (conductor(&ball, Equation::default()), "combined", &[1e-2, 1e-3]),
        (conductor(&ball, Equation::Magnetic), "magnetic", &[1e-2, 1e-3]),
    ];
    for (operator, name, tolerances) in &operators {
        for &tolerance in *tolerances {
            let (error, share) = product_error(operator, tolerance);
            println!("{name} {}: {tolerance:e} error {error:.2e}, share {share:.2}", operator.dim());
            assert!(error < tolerance, "{name} {tolerance}: {error:e}");
        }
    }
}

#[test]
fn sampled_rows_tell_their_share_of_the_matrix() {
    let ball = Basis::new(sphere(0.5 * WAVELENGTH, WAVELENGTH / 8.0).unwrap()).unwrap();
    let share =
        |equation, samples| Conductor::new(&ball, wave(), equation, 1e-3).unwrap().operator().sample(samples);
    let [few, more] = [3, 6].map(|samples| share(Equation::Electric, samples));
    assert!(few > 0.0 && few < 0.5 && (more / few - 2.0).abs() < 0.2, "{few} {more}");
    // Half of the symmetric matrix is integrated, and the tiles on its diagonal.
    let whole = share(Equation::default(), 6);
    assert!(whole < more && whole > 0.5 * more, "{whole} {more}");
}

#[test]
fn a_compressed_sphere_has_the_field_of_the_series_and_the_same_bits_with_any_number_of_threads() {
    let radius = 0.5 * WAVELENGTH;
    let basis = Basis::new(sphere(radius, WAVELENGTH / 8.0).unwrap()).unwrap();
    let conductor = Conductor::new(&basis, wave(), Equation::default(), 1e-3).unwrap();
    let source = source();
    let sources: [&dyn Source; 1] = [&source];
    let b = conductor.right_hand_side(&[&sources]);
    let solve = || {
        let settings = Settings { tolerance: 1e-3, leaf: 24, ..Settings::default() };
        let matrix = conductor.operator().compressed(settings, &Quiet).unwrap();
        let inverse = BlockDiagonal::new(&matrix).unwrap();
        let system = Preconditioned::new(&matrix, &inverse);
        let right = system.right_hand_side(&b);
        let ones = MultiVector::from_fn(b.dim(), 1, |_, _| Complex64::ONE);
        let a = SecondKind::new(&system, ones).unwrap();
        let mut x = MultiVector::zeros(b.dim(), 1);
        let stop = Stop { tolerance: 1e-4, max_iterations: 60 };
        let report = Gmres { restart: 60 }.solve(&a, &right, &mut x, &stop, &mut Quiet).unwrap();
        assert_eq!(report.reason, StopReason::Converged);
        x.vector(0)
    };
    let [one, two, four] = [1, 2, 4].map(|threads| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
        pool.install(solve)
    });
    assert!(one == two && one == four);
    let field =
        |x: &[Complex64]| vertical(&Currents::new(&basis, wave(), x, None).fields(&circle()).unwrap());
    let whole = solved(&conductor.operator().coupling().unwrap(), &b).vector(0);
    let (difference, error) =
        (relative_error(&field(&one), &field(&whole)), relative_error(&field(&one), &mie(radius)));
    assert!(difference < 1e-3 && error < 0.02, "{difference:e} {error}");
}

#[test]
fn what_is_predicted_not_to_fit_is_refused() {
    let basis = Basis::new(sphere(0.5 * WAVELENGTH, WAVELENGTH / 6.0).unwrap()).unwrap();
    let conductor = Conductor::new(&basis, wave(), Equation::default(), 1e-3).unwrap();
    let refused = conductor.operator().compressed(Settings { limit: 1 << 16, ..Settings::default() }, &Quiet);
    let Err(MomentsError::Compression(CompressionError::Memory { needed, limit })) = refused.map(|_| ())
    else {
        panic!("65 kB are not enough");
    };
    assert!(needed > limit && limit == 1 << 16);
}

/// The currents by the factors of the compressed matrix and a few iterations, and by LU.
fn by_factors(operator: &Operator<'_>, b: &MultiVector<Complex64>) -> [Vec<Complex64>; 2] {
    let settings = Settings { tolerance: 1e-4, leaf: 24, ..Settings::default() };
    let matrix = operator.compressed(settings, &Quiet).unwrap();
    let factors = Factors::new(&matrix, 1e-2, u64::MAX, &Quiet).unwrap();
    assert!(factors.bytes() as f64 <= 1.2 * matrix.summary().bytes as f64, "{:?}", matrix.summary());
    let system = Preconditioned::new(&matrix, &factors);
    let ones = MultiVector::from_fn(b.dim(), 1, |_, _| Complex64::ONE);
    let a = SecondKind::new(&system, ones).unwrap();
    let mut x = MultiVector::zeros(b.dim(), 1);
    // Without factors hundreds of iterations are needed; solved in single precision they would end
    // before 1e-10.
    let stop = Stop { tolerance: 1e-10, max_iterations: 20 };
    let right = system.right_hand_side(b);
    let report = Gmres { restart: 20 }.solve(&a, &right, &mut x, &stop, &mut Quiet).unwrap();
    assert_eq!(report.reason, StopReason::Converged);
    [x.vector(0), solved(&operator.coupling().unwrap(), b).vector(0)]
}

#[test]
fn factors_solve_equations_that_iterate_slowly() {
    let source = source();
    let sources: [&dyn Source; 1] = [&source];
    let sheet = Basis::new(plate(1.5 * WAVELENGTH, WAVELENGTH / 12.0, Grading::default()).unwrap()).unwrap();
    let conductor = Conductor::new(&sheet, wave(), Equation::Electric, 1e-3).unwrap();
    let field = |x: &[Complex64]| Currents::new(&sheet, wave(), x, None).fields(&circle()).unwrap();
    let [found, exact] = by_factors(conductor.operator(), &conductor.right_hand_side(&[&sources]))
        .map(|x| vertical(&field(&x)));
    assert!(relative_error(&found, &exact) < 1e-4, "{:e}", relative_error(&found, &exact));

    let surface = sphere(0.25 * WAVELENGTH, WAVELENGTH / 16.0).unwrap();
    let regions = Regions::new(&surface, &vec![Filling::Dielectric(0); surface.triangles().len()]).unwrap();
    let basis = Basis::between(regions).unwrap();
    let body = Composite::new(&basis, wave(), &[Complex64::new(4.0, -0.1)], 1e-3).unwrap();
    let [found, exact] = by_factors(body.operator(), &body.right_hand_side(&[&sources]))
        .map(|x| vertical(&body.currents(&x).fields(&circle()).unwrap()));
    assert!(relative_error(&found, &exact) < 1e-4, "{:e}", relative_error(&found, &exact));
}
