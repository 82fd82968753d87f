//! Southwell: relax the unknown with the largest residual, x_i += r_i/a_ii, and take a_ki r_i/a_ii from every r_k.
//!
//! Source: R. V. Southwell, Relaxation Methods in Engineering Science, Oxford 1940; for light in its gathering form,
//! S. J. Gortler, M. F. Cohen, P. Slusallek, Radiosity and relaxation methods, IEEE Computer Graphics and
//! Applications 14 (6), 1994. Several lanes are relaxed together: the unknown chosen has the largest |r_il|/‖b_l‖₂ of
//! all lanes l, the first one of equals.
//!
//! Requires a_ii ≠ 0. Converges for strictly diagonally dominant matrices and for Hermitian positive definite ones.
//!
//! Cost of an iteration: n relaxations, each of one column, and one application. The residual that is reported and
//! that the next n relaxations start from is computed anew, so that rounding does not pile up in it.
//!
//! ```
//! use fredholm_iterative::Southwell;
//! use fredholm_linop::{Dense, MultiVector, Quiet, SecondKind, Solver, Stop, StopReason};
//!
//! // x = b + K x with K = [0 ½; ½ 0] and b = (1, 1): x = (2, 2).
//! let coupling = Dense::new(2, vec![0.0, 0.5, 0.5, 0.0])?;
//! let a = SecondKind::new(&coupling, MultiVector::from_vec(2, 1, vec![1.0, 1.0])?)?;
//! let b = MultiVector::from_vec(2, 1, vec![1.0, 1.0])?;
//! let mut x = MultiVector::zeros(2, 1);
//! let stop = Stop { tolerance: 1e-12, max_iterations: 100 };
//! let report = Southwell.solve(&a, &b, &mut x, &stop, &mut Quiet)?;
//! assert_eq!(report.reason, StopReason::Converged);
//! assert!((x.row(0)[0] - 2.0).abs() < 1e-11);
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```

use crate::diagonal::divisors;
use fredholm_linop::{
    LinearOperator, Monitor, MultiVector, Observer, Report, Scalar, SecondKind, SolveError, Solver, Stop,
    StopReason, Work,
};
use std::ops::ControlFlow;

const NAME: &str = "southwell";

/// Relaxes the unknown with the largest residual, over and over.
#[derive(Clone, Copy, Debug, Default)]
pub struct Southwell;

impl<T: Scalar> Solver<T> for Southwell {
    fn name(&self) -> &'static str {
        NAME
    }

    fn description(&self) -> &'static str {
        "Southwell: the unknown with the largest residual first; few relaxations where the light is local"
    }

    // The residual, the product, the diagonal, and one column.
    fn bytes(&self, dim: usize, lanes: usize) -> u64 {
        let vectors = (lanes as u64).saturating_mul(3).saturating_add(1);
        vectors.saturating_mul(dim as u64).saturating_mul(size_of::<T>() as u64)
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
        let mut relaxation = Relaxation::new(a, b, &monitor)?;
        let reason = relaxation.iterate(x, &mut monitor);
        Ok(monitor.finish(reason, relaxation.work))
    }
}

/// The residual and what it takes to change it.
struct Relaxation<'a, T> {
    a: &'a SecondKind<'a, T>,
    b: &'a MultiVector<T>,
    diagonal: MultiVector<T>,
    /// 1/‖b_l‖₂ per lane, 0 where b is 0.
    weights: Vec<f64>,
    residual: MultiVector<T>,
    product: MultiVector<T>,
    column: Vec<T>,
    work: Work,
}

impl<'a, T: Scalar> Relaxation<'a, T> {
    fn new(
        a: &'a SecondKind<'a, T>,
        b: &'a MultiVector<T>,
        monitor: &Monitor<'_, T>,
    ) -> Result<Self, SolveError> {
        let zeros = MultiVector::zeros(b.dim(), b.lanes());
        Ok(Self {
            a,
            b,
            diagonal: divisors(NAME, a)?,
            weights: monitor
                .norms()
                .iter()
                .map(|&norm| if norm > 0.0 { norm.recip() } else { 0.0 })
                .collect(),
            residual: zeros.clone(),
            product: zeros,
            column: vec![T::zero(); b.dim()],
            work: Work::default(),
        })
    }

    fn iterate(&mut self, x: &mut MultiVector<T>, monitor: &mut Monitor<'_, T>) -> StopReason {
        loop {
            self.compute_residual(x);
            if let ControlFlow::Break(reason) = monitor.record(x, &self.product) {
                return reason;
            }
            if let ControlFlow::Break(reason) = self.relax_many(x, monitor) {
                return reason;
            }
        }
    }

    fn compute_residual(&mut self, x: &MultiVector<T>) {
        self.a.apply(x, &mut self.product);
        self.work.operator_applications += 1;
        self.work.entries_touched += self.a.entries();
        let terms = self.b.as_slice().iter().zip(self.product.as_slice());
        self.residual.as_mut_slice().iter_mut().zip(terms).for_each(|(r, (&b, &ax))| *r = b - ax);
    }

    /// As many relaxations as there are unknowns, or fewer if nothing is left to relax.
    fn relax_many(
        &mut self,
        x: &mut MultiVector<T>,
        monitor: &mut Monitor<'_, T>,
    ) -> ControlFlow<StopReason> {
        for _ in 0..x.dim() {
            monitor.poll()?;
            let Some(i) = self.largest() else { break };
            self.relax(i, x);
        }
        ControlFlow::Continue(())
    }

    fn relax(&mut self, i: usize, x: &mut MultiVector<T>) {
        let quotients = self.residual.row(i).iter().zip(self.diagonal.row(i));
        let step: Vec<T> = quotients.map(|(&r, &diagonal)| r / diagonal).collect();
        x.row_mut(i).iter_mut().zip(&step).for_each(|(x, &step)| *x += step);
        self.work.column_visits += 1;
        self.work.entries_touched += self.a.subtract_column(i, &step, &mut self.residual, &mut self.column);
    }

    /// The unknown with the largest weighted residual, if any is above 0.
    fn largest(&self) -> Option<usize> {
        let (mut found, mut largest) = (None, 0.0);
        for i in 0..self.residual.dim() {
            let lanes = self.residual.row(i).iter().zip(&self.weights);
            let size = lanes.map(|(r, &weight)| r.scale(weight).abs2()).fold(0.0, f64::max);
            if size > largest {
                (found, largest) = (Some(i), size);
            }
        }
        found
    }
}
