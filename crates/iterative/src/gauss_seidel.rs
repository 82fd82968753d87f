//! Gauss–Seidel: x_i = (b_i − Σ_{j≠i} a_ij x_j)/a_ii for i = 0 … n−1, with the x_j already relaxed.
//!
//! Source: Y. Saad, Iterative Methods for Sparse Linear Systems, 2nd ed., SIAM 2003, § 4.1,
//! DOI 10.1137/1.9780898718003. For light it gathers, for one patch after the other, what the others send.
//!
//! Requires a_ii ≠ 0. Converges for strictly or irreducibly diagonally dominant matrices, which light has with ρ < 1,
//! and for Hermitian positive definite ones.
//!
//! Cost of an iteration: one sweep, which reads every stored entry once for all lanes and gives the residual for
//! nothing. A starting guess other than 0 costs one sweep more.
//!
//! ```
//! use fredholm_iterative::GaussSeidel;
//! use fredholm_linop::{Dense, MultiVector, Quiet, SecondKind, Solver, Stop, StopReason};
//!
//! // x = b + K x with K = [0 ½; ½ 0] and b = (1, 1): x = (2, 2).
//! let coupling = Dense::new(2, vec![0.0, 0.5, 0.5, 0.0])?;
//! let a = SecondKind::new(&coupling, MultiVector::from_vec(2, 1, vec![1.0, 1.0])?)?;
//! let b = MultiVector::from_vec(2, 1, vec![1.0, 1.0])?;
//! let mut x = MultiVector::zeros(2, 1);
//! let stop = Stop { tolerance: 1e-12, max_iterations: 100 };
//! let report = GaussSeidel.solve(&a, &b, &mut x, &stop, &mut Quiet)?;
//! assert_eq!(report.reason, StopReason::Converged);
//! assert!((x.row(0)[0] - 2.0).abs() < 1e-11);
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```

use crate::diagonal::divisors;
use fredholm_linop::{
    LinearOperator, Monitor, MultiVector, Observer, Report, Scalar, SecondKind, SolveError, Solver, Stop,
    StopReason, Sweep, Visit, Work,
};
use std::ops::ControlFlow;

const NAME: &str = "gauss-seidel";

/// Relaxes every unknown in order, over and over.
#[derive(Clone, Copy, Debug, Default)]
pub struct GaussSeidel;

impl<T: Scalar> Solver<T> for GaussSeidel {
    fn name(&self) -> &'static str {
        NAME
    }

    fn description(&self) -> &'static str {
        "Gauss–Seidel: every unknown in order from the newest values of the others; robust for light"
    }

    // The sums above the diagonal and the product A x.
    fn bytes(&self, dim: usize, lanes: usize) -> u64 {
        (2 * size_of::<T>() as u64).saturating_mul(dim as u64).saturating_mul(lanes as u64)
    }

    fn solve(
        &self,
        a: &SecondKind<'_, T>,
        b: &MultiVector<T>,
        x: &mut MultiVector<T>,
        stop: &Stop,
        observer: &mut dyn Observer<T>,
    ) -> Result<Report, SolveError> {
        let mut monitor = Monitor::start(a, b, x, stop, observer)?;
        divisors(NAME, a)?;
        let mut work = Work::default();
        let reason = iterate(a, b, x, &mut monitor, &mut work);
        Ok(monitor.finish(reason, work))
    }
}

fn iterate<T: Scalar>(
    a: &SecondKind<'_, T>,
    b: &MultiVector<T>,
    x: &mut MultiVector<T>,
    monitor: &mut Monitor<'_, T>,
    work: &mut Work,
) -> StopReason {
    let mut sweep = Sweep::new(x.dim(), x.lanes());
    if x.as_slice().iter().any(|&value| value != T::zero()) {
        count_sweep(a, work);
        // Nothing changes: this gives the product of the starting guess.
        if let ControlFlow::Break(reason) = visit_all(a, x, &mut sweep, monitor, |_| ()) {
            return reason;
        }
    }
    loop {
        if let ControlFlow::Break(reason) = monitor.record(x, sweep.product()) {
            return reason;
        }
        count_sweep(a, work);
        if let ControlFlow::Break(reason) = visit_all(a, x, &mut sweep, monitor, |visit| relax(b, visit)) {
            return reason;
        }
    }
}

/// x_i = (b_i − Σ_{j≠i} a_ij x_j)/a_ii in all lanes.
fn relax<T: Scalar>(b: &MultiVector<T>, visit: Visit<'_, T>) {
    let Visit { index, off_diagonal, diagonal, x } = visit;
    let known = b.row(index).iter().zip(off_diagonal).zip(diagonal);
    for (x, ((&b, &sum), &diagonal)) in x.iter_mut().zip(known) {
        *x = (b - sum) / diagonal;
    }
}

/// One sweep, which the observer can break off.
fn visit_all<T: Scalar>(
    a: &SecondKind<'_, T>,
    x: &mut MultiVector<T>,
    sweep: &mut Sweep<T>,
    monitor: &mut Monitor<'_, T>,
    relax: impl Fn(Visit<'_, T>),
) -> ControlFlow<StopReason> {
    let mut verdict = ControlFlow::Continue(());
    let _ = a.sweep(x, sweep, &mut |visit| {
        verdict = monitor.poll();
        if verdict.is_break() {
            return ControlFlow::Break(());
        }
        relax(visit);
        ControlFlow::Continue(())
    });
    verdict
}

fn count_sweep<T: Scalar>(a: &SecondKind<'_, T>, work: &mut Work) {
    work.row_visits += a.dim() as u64;
    work.entries_touched += a.entries();
}
