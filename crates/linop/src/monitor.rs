//! The one definition of the residual, ‖b − A x‖₂/‖b‖₂ per right-hand side, and of when to stop.
//!
//! A right-hand side with b = 0 has the solution 0: its x is set to 0 at the start, and its
//! residual is ‖A x‖₂, which stays 0.

use crate::multivector::norms;
use crate::{
    LinearOperator, LinopError, MultiVector, Observer, Progress, Record, Report, Scalar, SecondKind,
    SolveError, Stop, StopReason, Work,
};
use std::ops::ControlFlow;
use std::time::Instant;

/// Growth over the best residual that is taken for divergence.
const DIVERGED_GROWTH: f64 = 1e6;

/// Follows one solution: keeps the history, calls the observer, decides when to stop.
pub struct Monitor<'a, T> {
    b: &'a MultiVector<T>,
    norms: Vec<f64>,
    stop: Stop,
    observer: &'a mut dyn Observer<T>,
    history: Vec<Record>,
    best: f64,
    start: Instant,
}

impl<'a, T: Scalar> Monitor<'a, T> {
    /// Checks the system and starts the clock. Right-hand sides of `x` whose b is 0 are set to 0.
    ///
    /// # Errors
    /// A vector does not fit `a` or is not finite, or the tolerance is no bound.
    pub fn start(
        a: &SecondKind<'_, T>,
        b: &'a MultiVector<T>,
        x: &mut MultiVector<T>,
        stop: &Stop,
        observer: &'a mut dyn Observer<T>,
    ) -> Result<Self, SolveError> {
        let start = Instant::now();
        if stop.tolerance.is_nan() || stop.tolerance < 0.0 {
            return Err(SolveError::Tolerance { value: stop.tolerance });
        }
        check(a, b, "right-hand side")?;
        check(a, x, "starting guess")?;
        let norms = b.norms();
        clear_right_hand_sides_of_zero(&norms, x);
        Ok(Self { b, norms, stop: *stop, observer, history: Vec::new(), best: f64::INFINITY, start })
    }

    /// Records the next iteration, of which `product` is A x and before which `work` was done.
    /// Breaks when it is time to stop.
    pub fn record(
        &mut self,
        x: &MultiVector<T>,
        product: &MultiVector<T>,
        work: &Work,
    ) -> ControlFlow<StopReason> {
        let residuals = self.residuals(product);
        let (iteration, seconds) = (self.history.len(), self.seconds());
        let record = Record { iteration, seconds, entries_touched: work.entries_touched, residuals };
        let wish = self.observer.observe(&Progress { record: &record, x });
        let verdict = self.verdict(&record, wish);
        self.history.push(record);
        verdict.map_or(ControlFlow::Continue(()), ControlFlow::Break)
    }

    /// Whether every right-hand side would meet the tolerance with this A x.
    #[must_use]
    pub fn converged(&self, product: &MultiVector<T>) -> bool {
        self.residuals(product).iter().all(|&residual| residual <= self.stop.tolerance)
    }

    /// Asks the observer, between iterations, whether to go on.
    pub fn poll(&mut self) -> ControlFlow<()> {
        self.observer.poll()
    }

    /// ‖b‖₂ per right-hand side.
    #[must_use]
    pub fn norms(&self) -> &[f64] {
        &self.norms
    }

    /// The report, at the end.
    #[must_use]
    pub fn finish(self, reason: StopReason, work: Work) -> Report {
        let seconds = self.seconds();
        Report { reason, history: self.history, work, seconds }
    }

    fn seconds(&self) -> f64 {
        self.start.elapsed().as_secs_f64()
    }

    fn residuals(&self, product: &MultiVector<T>) -> Vec<f64> {
        let pairs = self.b.as_slice().iter().zip(product.as_slice());
        let residuals = norms(self.norms.len(), pairs.map(|(&b, &ax)| b - ax));
        let scale = |(residual, &norm)| if norm > 0.0 { residual / norm } else { residual };
        residuals.into_iter().zip(&self.norms).map(scale).collect()
    }

    fn verdict(&mut self, record: &Record, wish: ControlFlow<()>) -> Option<StopReason> {
        if !record.residuals.iter().all(|residual| residual.is_finite()) {
            return Some(StopReason::Diverged);
        }
        let worst = record.residuals.iter().copied().fold(0.0, f64::max);
        self.best = self.best.min(worst);
        if worst <= self.stop.tolerance {
            Some(StopReason::Converged)
        } else if worst > DIVERGED_GROWTH * self.best {
            Some(StopReason::Diverged)
        } else if wish.is_break() {
            Some(StopReason::Interrupted)
        } else {
            (record.iteration >= self.stop.max_iterations).then_some(StopReason::IterationLimit)
        }
    }
}

fn check<T: Scalar>(
    a: &SecondKind<'_, T>,
    v: &MultiVector<T>,
    vector: &'static str,
) -> Result<(), SolveError> {
    let (expected, expected_rhs) = (a.dim(), a.factor().rhs_count());
    let (found, found_rhs) = (v.dim(), v.rhs_count());
    if (found, found_rhs) != (expected, expected_rhs) {
        return Err(SolveError::Shape { vector, found, found_rhs, expected, expected_rhs });
    }
    match v.not_finite() {
        Some((unknown, rhs)) => Err(LinopError::NotFinite { what: vector, unknown, rhs }.into()),
        None => Ok(()),
    }
}

fn clear_right_hand_sides_of_zero<T: Scalar>(norms: &[f64], x: &mut MultiVector<T>) {
    for i in 0..x.dim() {
        x.row_mut(i)
            .iter_mut()
            .zip(norms)
            .filter(|(_, norm)| **norm == 0.0)
            .for_each(|(x, _)| *x = T::zero());
    }
}
