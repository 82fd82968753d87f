//! Thin sheets against their series, near and far, on both sides; power; the conductor as a limit;
//! conductors and sheets together; the compressed matrix.

#![allow(clippy::unwrap_used, reason = "a test that cannot go on has failed")]

mod common;

use common::{WAVELENGTH, circle, currents_on, relative_error, source, vertical, wave};
use fredholm_compressed::{BlockDiagonal, Preconditioned, Settings};
use fredholm_iterative::Gmres;
use fredholm_linop::{MultiVector, Quiet, SecondKind, Solver, Stop, StopReason};
use fredholm_mesh::Vec3;
use fredholm_moments::meshing::{Grading, plate, sphere};
use fredholm_moments::{Basis, Condition, Conductor, Equation, Imperfect, MomentsError};
use fredholm_waves::{Complex64, ResistiveShell, Source};

const TOLERANCE: f64 = 1e-3;
const RADIUS: f64 = 0.35 * WAVELENGTH;

fn shell(per_wavelength: f64) -> Basis {
    Basis::new(sphere(RADIUS, WAVELENGTH / per_wavelength).unwrap()).unwrap()
}

fn made_of(basis: &Basis, condition: Condition) -> Imperfect<'_> {
    let conditions = vec![condition; basis.surface().triangles().len()];
    Imperfect::new(basis, wave(), conditions, TOLERANCE).unwrap()
}

/// Errors of E at 25 m, at 1.3 radii and at half a radius, and radiated and absorbed over
/// extinguished power, of a shell of this sheet impedance.
fn errors(per_wavelength: f64, z: Complex64) -> ([f64; 3], [f64; 2]) {
    let basis = shell(per_wavelength);
    let body = made_of(&basis, Condition::Sheet(z));
    let currents = currents_on(&body);
    let exact = ResistiveShell::new(RADIUS, z).unwrap();
    let error = |distance: f64| {
        let points: Vec<Vec3> = circle().iter().map(|p| p.normalize() * distance).collect();
        let series: Vec<Complex64> =
            points.iter().map(|&p| exact.scattered(&wave(), &source(), p).components()[2]).collect();
        relative_error(&vertical(&currents.fields(&points).unwrap()), &series)
    };
    let extinguished = currents.extinguished_power(&source()).unwrap();
    let power = [currents.radiated_power().unwrap(), body.absorbed_power(&currents)];
    ([25.0, 1.3 * RADIUS, 0.5 * RADIUS].map(error), power.map(|power| power / extinguished))
}

#[test]
fn shells_agree_with_the_series_on_both_sides_and_the_powers_balance() {
    for z in [Complex64::from(50.0), 377.0.into(), Complex64::new(100.0, -300.0), Complex64::new(0.0, 120.0)]
    {
        let ([coarse, _, _], _) = errors(7.0, z);
        let ([far, near, inside], [radiated, absorbed]) = errors(14.0, z);
        let order = (coarse / far).log2();
        println!("{z}: far {far:.5} (order {order:.2}), near {near:.5}, inside {inside:.5}");
        println!("    radiated {radiated:.6}, absorbed {absorbed:.6}");
        assert!(far < 0.012 && near < 0.015 && inside < 0.01 && order > 1.5, "{z}");
        assert!((radiated + absorbed - 1.0).abs() < 1e-3, "{z}: {radiated} {absorbed}");
        assert!(if z.re > 0.0 { absorbed > 0.05 } else { absorbed == 0.0 }, "{z}: {absorbed}");
        let [extinction, scattering] = ResistiveShell::new(RADIUS, z).unwrap().cross_sections(&wave());
        assert!((absorbed - (1.0 - scattering / extinction)).abs() < 0.01, "{z}: {absorbed}");
    }
}

#[test]
fn a_sheet_without_impedance_is_the_conductor_bit_for_bit() {
    let basis = shell(6.0);
    let conductor = Conductor::new(&basis, wave(), Equation::Electric, TOLERANCE).unwrap();
    let whole = conductor.operator().dense().unwrap();
    for condition in [Condition::Conductor, Condition::Sheet(Complex64::ZERO)] {
        let sheet = made_of(&basis, condition);
        assert!(sheet.operator().dense().unwrap() == whole);
        let source = source();
        let sources: [&dyn Source; 1] = [&source];
        assert!(sheet.right_hand_side(&[&sources]) == conductor.right_hand_side(&[&sources]));
    }
}

/// A sheet of much impedance before a conducting plate is as good as away, and the compressed matrix
/// solves a mixture of both as the whole one does.
#[test]
fn conductors_and_sheets_go_together() {
    let side = 1.2 * WAVELENGTH;
    let metal = plate(side, WAVELENGTH / 8.0, Grading::default()).unwrap();
    let count = metal.triangles().len();
    let moved = metal.vertices().iter().map(|v| *v - Vec3::Y * (0.25 * WAVELENGTH)).collect();
    let film = fredholm_moments::Surface::new(moved, metal.triangles().to_vec()).unwrap();
    let basis = Basis::new(metal.clone().with(&film).unwrap()).unwrap();
    let before = |z: f64| {
        let mut conditions = vec![Condition::Conductor; count];
        conditions.extend(vec![Condition::Sheet(z.into()); count]);
        Imperfect::new(&basis, wave(), conditions, TOLERANCE).unwrap()
    };
    let alone = Basis::new(metal).unwrap();
    let conductor = Conductor::new(&alone, wave(), Equation::Electric, TOLERANCE).unwrap();
    let expected = vertical(&common::currents(&conductor, &alone).fields(&circle()).unwrap());
    let faint = vertical(&currents_on(&before(1e9)).fields(&circle()).unwrap());
    assert!(relative_error(&faint, &expected) < 1e-5);

    // Salisbury's screen: a sheet of η₀ a quarter of a wavelength before the metal sends little back.
    let screen = before(377.0);
    let whole = currents_on(&screen);
    let back = |field: &[Complex64]| field[270].norm();
    let found = vertical(&whole.fields(&circle()).unwrap());
    assert!(back(&found) < 0.25 * back(&expected), "{} {}", back(&found), back(&expected));
    let balance = whole.radiated_power().unwrap() + screen.absorbed_power(&whole);
    assert!((balance / whole.extinguished_power(&source()).unwrap() - 1.0).abs() < 1e-3);

    let settings = Settings { tolerance: 1e-4, leaf: 24, ..Settings::default() };
    let matrix = screen.operator().compressed(settings, &Quiet).unwrap();
    assert!(matrix.summary().low_rank > 0);
    let inverse = BlockDiagonal::new(&matrix).unwrap();
    let system = Preconditioned::new(&matrix, &inverse);
    let source = source();
    let sources: [&dyn Source; 1] = [&source];
    let right = system.right_hand_side(&screen.right_hand_side(&[&sources]));
    let ones = MultiVector::from_fn(right.dim(), 1, |_, _| Complex64::ONE);
    let a = SecondKind::new(&system, ones).unwrap();
    let mut x = MultiVector::zeros(right.dim(), 1);
    let stop = Stop { tolerance: 1e-5, max_iterations: 300 };
    let report = Gmres { restart: 300 }.solve(&a, &right, &mut x, &stop, &mut Quiet).unwrap();
    assert_eq!(report.reason, StopReason::Converged);
    let compressed = vertical(&screen.currents(&x.vector(0)).fields(&circle()).unwrap());
    assert!(relative_error(&compressed, &found) < 1e-3, "{:e}", relative_error(&compressed, &found));
}

#[test]
fn impedances_that_are_none_are_refused() {
    let open = Basis::new(plate(0.3, 0.05, Grading::default()).unwrap()).unwrap();
    let count = open.surface().triangles().len();
    let new = |condition| Imperfect::new(&open, wave(), vec![condition; count], TOLERANCE).map(|_| ());
    for z in [Complex64::new(-1.0, 0.0), Complex64::new(f64::NAN, 0.0), Complex64::new(1.0, f64::INFINITY)] {
        assert!(matches!(new(Condition::Sheet(z)), Err(MomentsError::Parameter { .. })));
    }
    assert!(matches!(new(Condition::Body(50.0.into())), Err(MomentsError::NotClosed { .. })));
    assert!(new(Condition::Sheet(50.0.into())).is_ok());
    let few = Imperfect::new(&open, wave(), vec![Condition::Conductor], TOLERANCE).map(|_| ());
    assert!(matches!(few, Err(MomentsError::Parameter { .. })));
    let mut patchwork = vec![Condition::Sheet(1.0.into()); count];
    patchwork[1] = Condition::Body(1.0.into());
    let refused = Imperfect::new(&open, wave(), patchwork, TOLERANCE).map(|_| ());
    assert_eq!(refused, Err(MomentsError::Patchwork { first: 0, second: 1 }));
}
