//! One factorisation after the other, each for all the right-hand sides that share a matrix.

use fredholm_linop::{
    LinearOperator, Monitor, MultiVector, Observer, Report, Scalar, SecondKind, SolveError, Stop, StopReason,
    Work,
};
use std::ops::ControlFlow;

/// A solution in the making: what solves the right-hand sides of one matrix works on this.
pub(crate) struct Run<'r, 'a, T> {
    pub a: &'r SecondKind<'r, T>,
    pub b: &'r MultiVector<T>,
    pub x: &'r mut MultiVector<T>,
    pub product: MultiVector<T>,
    pub work: Work,
    monitor: Monitor<'a, T>,
}

/// Why a run ended early: a reason of the monitor, or an error.
pub(crate) enum Ended {
    Stopped(StopReason),
    Failed(SolveError),
}

impl<E: Into<SolveError>> From<E> for Ended {
    fn from(error: E) -> Self {
        Self::Failed(error.into())
    }
}

impl<T: Scalar> Run<'_, '_, T> {
    /// Computes A x and records it as an iteration.
    pub fn record(&mut self) -> Result<(), Ended> {
        self.a.apply(self.x, &mut self.product);
        self.work.operator_applications += 1;
        self.work.entries_touched += self.a.entries();
        match self.monitor.record(self.x, &self.product, &self.work) {
            ControlFlow::Continue(()) => Ok(()),
            ControlFlow::Break(reason) => Err(Ended::Stopped(reason)),
        }
    }
}

/// Solves the right-hand sides of one matrix after those of the other, by `solve`. The matrix of
/// all right-hand sides of a group is that of its first.
pub(crate) fn in_groups<T: Scalar>(
    a: &SecondKind<'_, T>,
    b: &MultiVector<T>,
    x: &mut MultiVector<T>,
    stop: &Stop,
    observer: &mut dyn Observer<T>,
    mut solve: impl FnMut(&mut Run<'_, '_, T>, &[usize]) -> Result<(), Ended>,
) -> Result<Report, SolveError> {
    let stop = Stop { max_iterations: usize::MAX, ..*stop };
    let monitor = Monitor::start(a, b, x, &stop, observer)?;
    let product = MultiVector::zeros(x.dim(), x.rhs_count());
    let groups = rhs_by_matrix(a, monitor.norms());
    let mut run = Run { a, b, x, product, work: Work::default(), monitor };
    let mut flow = run.record();
    for group in groups {
        flow = flow.and_then(|()| solve(&mut run, &group)).and_then(|()| run.record());
    }
    match flow {
        Ok(()) => Ok(run.monitor.finish(StopReason::IterationLimit, run.work)),
        Err(Ended::Stopped(reason)) => Ok(run.monitor.finish(reason, run.work)),
        Err(Ended::Failed(error)) => Err(error),
    }
}

/// The right-hand sides that have something to solve, grouped by their matrix.
fn rhs_by_matrix<T: Scalar>(a: &SecondKind<'_, T>, norms: &[f64]) -> Vec<Vec<usize>> {
    let mut groups: Vec<Vec<usize>> = Vec::new();
    for rhs in (0..norms.len()).filter(|&rhs| norms[rhs] > 0.0) {
        match groups.iter_mut().find(|group| a.same_matrix(group[0], rhs)) {
            Some(group) => group.push(rhs),
            None => groups.push(vec![rhs]),
        }
    }
    groups
}

/// Right-hand sides of a vector, one after the other.
pub(crate) fn columns<T: Scalar>(v: &MultiVector<T>, group: &[usize]) -> Vec<T> {
    group.iter().flat_map(|&rhs| v.vector(rhs)).collect()
}
