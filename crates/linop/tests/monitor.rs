//! The residual, the history and every reason to stop, with iterates chosen by hand.

#![allow(clippy::unwrap_used)]

use fredholm_linop::{
    Dense, LinearOperator, LinopError, Monitor, MultiVector, Observer, Progress, Quiet, Report, SecondKind,
    SolveError, Stop, StopReason, Work,
};
use std::ops::ControlFlow;

/// K of 2 × 2, so that A = [1 −½; −¼ 1] in right-hand side 0 and [1 −1; −½ 1] in right-hand side 1.
fn coupling() -> Dense<f64> {
    Dense::new(2, vec![0.0, 0.5, 0.25, 0.0]).unwrap()
}

fn system(coupling: &Dense<f64>) -> SecondKind<'_, f64> {
    SecondKind::new(coupling, MultiVector::from_vec(2, 2, vec![1.0, 2.0, 1.0, 2.0]).unwrap()).unwrap()
}

/// Records iterate after iterate until told to stop.
fn follow(b: &[f64], stop: Stop, iterates: &[[f64; 4]], observer: &mut dyn Observer<f64>) -> Report {
    let coupling = coupling();
    let a = system(&coupling);
    let b = MultiVector::from_vec(2, 2, b.to_vec()).unwrap();
    let mut x = MultiVector::zeros(2, 2);
    let mut monitor = Monitor::start(&a, &b, &mut x, &stop, observer).unwrap();
    for iterate in iterates {
        let x = MultiVector::from_vec(2, 2, iterate.to_vec()).unwrap();
        let mut product = MultiVector::zeros(2, 2);
        a.apply(&x, &mut product);
        if let ControlFlow::Break(reason) = monitor.record(&x, &product, &Work::default()) {
            return monitor.finish(reason, Work::default());
        }
    }
    panic!("no reason to stop was found");
}

const STOP: Stop = Stop { tolerance: 1e-12, max_iterations: 2 };

#[test]
fn the_residual_is_relative_and_per_right_hand_side() {
    // x = 0 in right-hand side 0; in right-hand side 1, b = (6, 8) and x = (2, 2) give A x = (0, 1)
    // and b − A x = (6, 7).
    let iterates = [[0.0; 4], [0.0, 2.0, 0.0, 2.0], [0.0; 4]];
    let report = follow(&[3.0, 6.0, 4.0, 8.0], STOP, &iterates, &mut Quiet);
    assert_eq!(report.reason, StopReason::IterationLimit);
    assert_eq!(report.history.iter().map(|record| record.iteration).collect::<Vec<_>>(), [0, 1, 2]);
    assert_eq!(report.history[0].residuals, [1.0, 1.0]);
    let [first, second] = [report.history[1].residuals[0], report.history[1].residuals[1]];
    assert!((first - 1.0).abs() < 1e-15 && (second - 85f64.sqrt() / 10.0).abs() < 1e-15);
    assert!(report.history.windows(2).all(|pair| pair[0].seconds <= pair[1].seconds));
    assert!(report.seconds >= report.history[2].seconds);
}

#[test]
fn all_right_hand_sides_must_converge() {
    // A (4, 4) = (2, 3) in right-hand side 0, A (3, 2) = (1, ½) in right-hand side 1.
    let b = [2.0, 1.0, 3.0, 0.5];
    let report = follow(&b, STOP, &[[4.0, 0.0, 4.0, 0.0], [4.0, 3.0, 4.0, 2.0]], &mut Quiet);
    assert_eq!((report.reason, report.history.len()), (StopReason::Converged, 2));
    assert_eq!(report.history[1].residuals, [0.0, 0.0]);
}

#[test]
fn growth_and_numbers_that_are_not_finite_are_divergence() {
    let b = [1.0, 1.0, 1.0, 1.0];
    for bad in [3e6, f64::NAN, f64::INFINITY] {
        for rhs in 0..2 {
            let mut iterate = [0.0; 4];
            iterate[rhs] = bad;
            let report = follow(&b, STOP, &[[0.0; 4], iterate], &mut Quiet);
            assert_eq!((report.reason, report.history.len()), (StopReason::Diverged, 2), "{bad}");
        }
    }
    let report = follow(&b, STOP, &[[0.0; 4], [1e5; 4], [1e5; 4]], &mut Quiet);
    assert_eq!(report.reason, StopReason::IterationLimit);
}

#[test]
fn the_observer_sees_every_record_and_can_stop() {
    let mut seen = Vec::new();
    let mut observer = |progress: &Progress<'_, f64>| {
        seen.push((progress.record.iteration, progress.x.as_slice().to_vec()));
        if seen.len() == 2 { ControlFlow::Break(()) } else { ControlFlow::Continue(()) }
    };
    let report = follow(&[1.0; 4], STOP, &[[0.0; 4], [0.5; 4], [0.0; 4]], &mut observer);
    assert_eq!(report.reason, StopReason::Interrupted);
    assert_eq!(seen, [(0, vec![0.0; 4]), (1, vec![0.5; 4])]);
}

#[test]
fn a_right_hand_side_of_zeros_starts_solved() {
    let coupling = coupling();
    let a = system(&coupling);
    let b = MultiVector::from_vec(2, 2, vec![0.0, 1.0, 0.0, 1.0]).unwrap();
    let mut x = MultiVector::from_vec(2, 2, vec![5.0; 4]).unwrap();
    let mut quiet = Quiet;
    let monitor = Monitor::start(&a, &b, &mut x, &STOP, &mut quiet).unwrap();
    assert_eq!(monitor.norms(), [0.0, 2f64.sqrt()]);
    assert_eq!(x.as_slice(), [0.0, 5.0, 0.0, 5.0]);

    let report = follow(&[0.0; 4], STOP, &[[0.0; 4]], &mut Quiet);
    assert_eq!((report.reason, &*report.history[0].residuals), (StopReason::Converged, &[0.0, 0.0][..]));
}

#[test]
fn systems_that_make_no_sense_are_refused() {
    let coupling = coupling();
    let a = system(&coupling);
    let start = |b: &MultiVector<f64>, mut x: MultiVector<f64>, tolerance| {
        Monitor::start(&a, b, &mut x, &Stop { tolerance, max_iterations: 1 }, &mut Quiet).err()
    };
    let good = MultiVector::from_vec(2, 2, vec![1.0; 4]).unwrap();
    assert_eq!(start(&good, good.clone(), 0.0), None);
    let shape = |vector, found, found_rhs| {
        Some(SolveError::Shape { vector, found, found_rhs, expected: 2, expected_rhs: 2 })
    };
    assert_eq!(start(&MultiVector::zeros(3, 2), good.clone(), 0.0), shape("right-hand side", 3, 2));
    assert_eq!(start(&good, MultiVector::zeros(2, 1), 0.0), shape("starting guess", 2, 1));
    let bad = MultiVector::from_vec(2, 2, vec![1.0, 1.0, f64::NAN, 1.0]).unwrap();
    let not_finite = |what| Some(LinopError::NotFinite { what, unknown: 1, rhs: 0 }.into());
    assert_eq!(start(&bad, good.clone(), 0.0), not_finite("right-hand side"));
    assert_eq!(start(&good, bad, 0.0), not_finite("starting guess"));
    assert_eq!(start(&good, good.clone(), -1.0), Some(SolveError::Tolerance { value: -1.0 }));
    assert!(matches!(start(&good, good.clone(), f64::NAN), Some(SolveError::Tolerance { .. })));
}
