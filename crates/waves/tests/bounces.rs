//! Several bounces against closed forms, exact series and stored results of an independent code.

#![allow(clippy::unwrap_used, reason = "a test that cannot go on has failed")]

mod common;

use common::{WAVELENGTH, circle, reference, relative_error, source, wave};
use fredholm_iterative::Neumann;
use fredholm_linop::{MultiVector, Quiet, Report, SecondKind, SolveError, Solver, Stop, StopReason};
use fredholm_mesh::Vec3;
use fredholm_waves::source::PlaneWave;
use fredholm_waves::surface::{cube, dihedral, facing_plates, parallel_plates, sphere, trihedral};
use fredholm_waves::{
    Bounced, Bounces, Complex64, Discretisation, EdgeCurrents, Field, PhysicalOptics, Scatterer, Shadow,
    Source, System, cross_section, spectral_radius,
};
use std::f64::consts::{FRAC_PI_2, PI};

type Vectors = MultiVector<Complex64>;

fn solve(
    solver: &dyn Solver<Complex64>,
    system: &System<'_>,
    b: &Vectors,
    tolerance: f64,
) -> (Vectors, Report) {
    attempt(solver, system, b, tolerance).unwrap()
}

fn attempt(
    solver: &dyn Solver<Complex64>,
    system: &System<'_>,
    b: &Vectors,
    tolerance: f64,
) -> Result<(Vectors, Report), SolveError> {
    let one = MultiVector::from_fn(b.dim(), b.rhs_count(), |_, _| Complex64::ONE);
    let a = SecondKind::new(system.coupling(), one).unwrap();
    let mut x = MultiVector::zeros(b.dim(), b.rhs_count());
    let stop = Stop { tolerance, max_iterations: 400 };
    let report = solver.solve(&a, b, &mut x, &stop, &mut Quiet)?;
    Ok((x, report))
}

fn direct() -> Box<dyn Solver<Complex64>> {
    fredholm_direct::solvers().remove(0)
}

/// σ straight back over the closed form, dB.
fn corner(scatterer: &Scatterer, from: Vec3, bounces: usize, closed: f64) -> f64 {
    let source = PlaneWave::new(-from, Vec3::Z, 1.0.into()).unwrap();
    let sources: [&dyn Source; 1] = [&source];
    let first = PhysicalOptics::new(scatterer, wave(), &sources, Shadow::Geometric).unwrap();
    let system = System::lazy(scatterer, wave(), Shadow::Geometric).unwrap();
    let b = system.right_hand_side(&[&first]);
    let x = Bounces::sum(system.coupling(), &b, bounces, &Quiet).unwrap().x;
    let currents = system.currents(&x, 0);
    let far = system.radiator(&currents).far_field(&[from]).unwrap();
    10.0 * (cross_section(far[0].amplitude.dot(source.polarisation()), 1.0.into()) / closed).log10()
}

/// 8πa²b²/λ², which holds for large bodies: two bounces are 2.3 dB below it at 3λ.
#[test]
fn a_dihedral_approaches_its_closed_form() {
    let error = |side: f64| {
        let a = side * WAVELENGTH;
        let pair = dihedral(a, a, FRAC_PI_2, WAVELENGTH / 6.0).unwrap();
        corner(&pair, Vec3::X, 2, 8.0 * PI * (a * a / WAVELENGTH).powi(2))
    };
    let [small, large] = [3.0, 6.0].map(error);
    assert!((small + 2.3).abs() < 0.15 && (large + 1.34).abs() < 0.1, "{small} {large}");
}

/// 4πa⁴/(3λ²).
#[test]
fn a_trihedral_is_close_to_its_closed_form() {
    let a = 6.0 * WAVELENGTH;
    let corner = corner(
        &trihedral(a, WAVELENGTH / 4.0).unwrap(),
        Vec3::ONE.normalize(),
        3,
        4.0 * PI / 3.0 * (a * a / WAVELENGTH).powi(2),
    );
    assert!(corner.abs() < 0.5, "{corner}");
}

fn scattered(fields: &[Field]) -> Vec<Complex64> {
    fields.iter().map(|field| field.e.components()[2]).collect()
}

/// The magnetic field equation on spheres of radius λ: second order in the edge, below 0.5 % with
/// 1,280 facets.
#[test]
fn the_exact_treatment_meets_the_series_of_mie() {
    let source = source();
    let sources: [&dyn Source; 1] = [&source];
    let expected = reference("sphere_1lambda.csv", "mie");
    let error = |edge: f64, facets: usize| {
        let ball = sphere(WAVELENGTH, edge * WAVELENGTH).unwrap();
        assert_eq!(ball.facets().len(), facets);
        let first = PhysicalOptics::new(&ball, wave(), &sources, Shadow::Exact).unwrap();
        let system = System::stored(&ball, wave(), Shadow::Exact, Discretisation::Nystrom).unwrap();
        let x = solve(&*direct(), &system, &system.right_hand_side(&[&first]), 1e-10).0;
        let currents = system.currents(&x, 0);
        relative_error(&scattered(&system.radiator(&currents).fields(&circle()).unwrap()), &expected)
    };
    let (coarse, fine) = (error(0.36, 320), error(0.18, 1280));
    let order = (coarse / fine).log2();
    assert!(fine < 0.003 && order > 1.9, "{coarse} {fine}: order {order}");
}

/// Two plates at a right angle: one bounce has 0.79 of error, the converged currents less than a
/// quarter of it. What remains is mostly the current at the edges, which no form of physical optics
/// has.
#[test]
fn two_plates_converge_to_less_than_half_the_error_of_one_bounce() {
    let plates = facing_plates(5.0 * WAVELENGTH, 2.0, WAVELENGTH / 6.0).unwrap();
    let source = source();
    let sources: [&dyn Source; 1] = [&source];
    let expected = reference("two_plates_normal.csv", "mom");
    for shadow in [Shadow::Geometric, Shadow::Radiated, Shadow::Thesis] {
        let first = PhysicalOptics::new(&plates, wave(), &sources, shadow).unwrap();
        let system = System::lazy(&plates, wave(), shadow).unwrap();
        let b = system.right_hand_side(&[&first]);
        let error = |x: &Vectors| {
            let currents = Bounced::new(&plates, &first, &system.currents(x, 0));
            relative_error(&scattered(&system.radiator(&currents).fields(&circle()).unwrap()), &expected)
        };
        let (x, report) = solve(&Neumann, &system, &b, 1e-6);
        assert_eq!(report.reason, StopReason::Converged);
        let (one, all) = (error(&b), error(&x));
        assert!((one - 0.79).abs() < 0.01 && all < 0.19, "{shadow:?}: {one} {all}");
        if shadow != Shadow::Thesis {
            let currents = Bounced::new(&plates, &first, &system.currents(&x, 0));
            let fields = system.radiator(&currents).fields(&circle()).unwrap();
            let lit = EdgeCurrents::new(&plates, wave(), &sources).unwrap();
            let bounced = EdgeCurrents::of_bounces(&plates, wave(), &sources, &currents).unwrap();
            let [lit, bounced] = [lit, bounced].map(|edges| {
                let pairs = fields.iter().zip(edges.fields(&circle()));
                let both: Vec<Field> = pairs.map(|(&field, edge)| field + edge).collect();
                relative_error(&scattered(&both), &expected)
            });
            eprintln!("{shadow:?}: {all:.4}, edges {lit:.4} {bounced:.4}");
            assert!(lit < 0.08 && bounced < 0.06, "{shadow:?}: {lit} {bounced}");
        }
    }
}

/// Every registered solver that suits a coupling without symmetry and converges finds the same
/// currents of a dihedral.
#[test]
fn all_solvers_agree() {
    let pair = dihedral(1.5 * WAVELENGTH, 1.5 * WAVELENGTH, FRAC_PI_2, WAVELENGTH / 6.0).unwrap();
    let source = PlaneWave::new(Vec3::new(-1.0, 0.3, 0.2), Vec3::Z, 1.0.into()).unwrap();
    let sources: [&dyn Source; 1] = [&source];
    let first = PhysicalOptics::new(&pair, wave(), &sources, Shadow::Geometric).unwrap();
    let system = System::stored(&pair, wave(), Shadow::Geometric, Discretisation::Nystrom).unwrap();
    let b = system.right_hand_side(&[&first]);
    let expected = solve(&*direct(), &system, &b, 1e-12).0;
    let scale = expected.norms()[0];
    let solvers: Vec<Box<dyn Solver<Complex64>>> = fredholm_iterative::solvers();
    let mut converged = 0;
    for solver in &solvers {
        let (x, report) = match attempt(&**solver, &system, &b, 1e-10) {
            Err(SolveError::Unsuitable { .. }) => continue,
            solved => solved.unwrap(),
        };
        if report.reason == StopReason::Converged {
            let error = Vectors::from_fn(x.dim(), 1, |i, _| x.row(i)[0] - expected.row(i)[0]).norms()[0];
            assert!(error < 1e-8 * scale, "{}: {error}", solver.name());
            converged += 1;
        }
    }
    assert!(converged >= 10, "{converged}");
}

/// Spectral radii of an independent code at λ/6; beyond 1 the series of bounces diverges, which is
/// reported.
#[test]
fn spectral_radii_and_a_series_that_diverges() {
    let edge = WAVELENGTH / 6.0;
    let side = 3.0 * WAVELENGTH;
    let pair = dihedral(side, side, FRAC_PI_2, edge).unwrap();
    let closed = [cube(1.5 * WAVELENGTH, edge).unwrap(), cube(2.1 * WAVELENGTH, edge).unwrap()];
    let facing = parallel_plates(side, WAVELENGTH, edge).unwrap();
    let cases = [
        (&pair, Shadow::Geometric, 0.404),
        (&facing, Shadow::Geometric, 0.972),
        (&closed[0], Shadow::Exact, 1.003),
        (&closed[1], Shadow::Exact, 1.12),
    ];
    for (scatterer, shadow, expected) in cases {
        let system = System::stored(scatterer, wave(), shadow, Discretisation::Nystrom).unwrap();
        let radius = spectral_radius(system.coupling(), 120, &Quiet).unwrap();
        assert!((radius / expected - 1.0).abs() < 0.05, "{shadow:?}: {radius} for {expected}");
        if expected > 1.1 {
            let source = source();
            let sources: [&dyn Source; 1] = [&source];
            let first = PhysicalOptics::new(scatterer, wave(), &sources, shadow).unwrap();
            let report = solve(&Neumann, &system, &system.right_hand_side(&[&first]), 1e-6).1;
            assert_eq!(report.reason, StopReason::Diverged);
        }
    }
}
