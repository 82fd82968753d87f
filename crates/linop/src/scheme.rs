//! Iterative schemes, one step at a time, and the one loop that makes a [`Solver`] of each.
//!
//! A [`Scheme`] says how x_k becomes x_(k+1); history, residuals, stopping, counting and
//! interruption are the same for all. Because a scheme can be stepped, two of them can be run side
//! by side, as hybrid procedures do.
//!
//! A scheme that updates A x by a recurrence drifts away from it by rounding. Where such a product
//! meets the tolerance, it is computed anew before it counts, and the scheme goes on from it if it
//! was too good.

use crate::{
    LinearOperator, Monitor, MultiVector, Observer, Report, Scalar, SecondKind, SolveError, Solver, Stop,
    StopReason, Work,
};
use std::ops::ControlFlow;

/// An iterative scheme for A x = b. [`solve_by_steps`] makes a [`Solver`] of it, as a boxed one is.
pub trait Scheme<T: Scalar>: Send + Sync {
    /// The name it is chosen by: lower case, words joined by hyphens.
    fn name(&self) -> &'static str;

    /// What it does, in one line.
    fn description(&self) -> &'static str;

    /// Bytes it needs besides the operator, b and x.
    fn bytes(&self, dim: usize, rhs_count: usize) -> u64;

    /// Prepares the iteration. What it takes is counted in `context`.
    ///
    /// # Errors
    /// The scheme does not suit A, or it was interrupted.
    fn begin<'a>(
        &self,
        a: &'a SecondKind<'a, T>,
        b: &'a MultiVector<T>,
        context: &mut Context<'_>,
    ) -> Result<Box<dyn Iteration<T> + 'a>, Halt>;
}

/// A scheme under way.
pub trait Iteration<T: Scalar> {
    /// Starts, or starts again, from x: [`product`](Self::product) becomes A x.
    ///
    /// # Errors
    /// It was interrupted.
    fn restart(&mut self, x: &mut MultiVector<T>, context: &mut Context<'_>) -> Result<(), Halt>;

    /// One iteration from the x that it left last.
    ///
    /// # Errors
    /// It was interrupted, x being what was reached by then; or it found that the scheme does not
    /// suit A.
    fn advance(&mut self, x: &mut MultiVector<T>, context: &mut Context<'_>) -> Result<(), Halt>;

    /// A x of the x that was left last.
    fn product(&self) -> &MultiVector<T>;

    /// Whether the product is updated by a recurrence, so that rounding piles up in it.
    fn drifts(&self) -> bool {
        false
    }
}

/// Why an iteration ended before its time.
#[derive(Clone, Debug, PartialEq)]
pub enum Halt {
    /// The observer asked for it.
    Interrupted,
    /// The scheme does not suit the system.
    Refused(SolveError),
}

impl From<SolveError> for Halt {
    fn from(error: SolveError) -> Self {
        Self::Refused(error)
    }
}

/// What surrounds a step: where its work is counted, and whom to ask whether to go on.
pub struct Context<'a> {
    /// Work so far.
    pub work: &'a mut Work,
    poll: &'a mut dyn FnMut() -> ControlFlow<()>,
}

impl<'a> Context<'a> {
    /// `poll` breaks where the solution is no longer wanted.
    pub fn new(work: &'a mut Work, poll: &'a mut dyn FnMut() -> ControlFlow<()>) -> Self {
        Self { work, poll }
    }

    /// Asks whether to go on.
    ///
    /// # Errors
    /// [`Halt::Interrupted`] where not.
    pub fn poll(&mut self) -> Result<(), Halt> {
        if (self.poll)().is_break() { Err(Halt::Interrupted) } else { Ok(()) }
    }

    /// y = A x, counted.
    ///
    /// # Errors
    /// [`Halt::Interrupted`] if it is no longer wanted; y is then as it was.
    pub fn apply<T: Scalar>(
        &mut self,
        a: &SecondKind<'_, T>,
        x: &MultiVector<T>,
        y: &mut MultiVector<T>,
    ) -> Result<(), Halt> {
        self.poll()?;
        a.apply(x, y);
        self.work.operator_applications += 1;
        self.work.entries_touched += a.entries();
        Ok(())
    }

    /// y = A x as [`apply`](Self::apply), which x = 0 has for nothing.
    ///
    /// # Errors
    /// [`Halt::Interrupted`] if it is no longer wanted; y is then as it was.
    pub fn start<T: Scalar>(
        &mut self,
        a: &SecondKind<'_, T>,
        x: &MultiVector<T>,
        y: &mut MultiVector<T>,
    ) -> Result<(), Halt> {
        if x.is_zero() {
            y.fill(T::zero());
            return Ok(());
        }
        self.apply(a, x, y)
    }
}

impl<T: Scalar, S: Scheme<T> + ?Sized> Scheme<T> for Box<S> {
    fn name(&self) -> &'static str {
        (**self).name()
    }

    fn description(&self) -> &'static str {
        (**self).description()
    }

    fn bytes(&self, dim: usize, rhs_count: usize) -> u64 {
        (**self).bytes(dim, rhs_count)
    }

    fn begin<'a>(
        &self,
        a: &'a SecondKind<'a, T>,
        b: &'a MultiVector<T>,
        context: &mut Context<'_>,
    ) -> Result<Box<dyn Iteration<T> + 'a>, Halt> {
        (**self).begin(a, b, context)
    }
}

impl<T: Scalar> Solver<T> for Box<dyn Scheme<T>> {
    fn name(&self) -> &'static str {
        Scheme::name(self)
    }

    fn description(&self) -> &'static str {
        Scheme::description(self)
    }

    fn bytes(&self, dim: usize, rhs_count: usize) -> u64 {
        Scheme::bytes(self, dim, rhs_count)
    }

    fn solve(
        &self,
        a: &SecondKind<'_, T>,
        b: &MultiVector<T>,
        x: &mut MultiVector<T>,
        stop: &Stop,
        observer: &mut dyn Observer<T>,
    ) -> Result<Report, SolveError> {
        solve_by_steps(&**self, a, b, x, stop, observer)
    }
}

/// Steps a scheme until it is time to stop: what [`Solver::solve`] promises.
///
/// # Errors
/// Those of [`Solver::solve`].
pub fn solve_by_steps<T: Scalar>(
    scheme: &dyn Scheme<T>,
    a: &SecondKind<'_, T>,
    b: &MultiVector<T>,
    x: &mut MultiVector<T>,
    stop: &Stop,
    observer: &mut dyn Observer<T>,
) -> Result<Report, SolveError> {
    let mut monitor = Monitor::start(a, b, x, stop, observer)?;
    let mut work = Work::default();
    match iterate(scheme, a, b, x, &mut monitor, &mut work) {
        Ok(reason) => Ok(monitor.finish(reason, work)),
        Err(Halt::Interrupted) => Ok(monitor.finish(StopReason::Interrupted, work)),
        Err(Halt::Refused(error)) => Err(error),
    }
}

fn iterate<T: Scalar>(
    scheme: &dyn Scheme<T>,
    a: &SecondKind<'_, T>,
    b: &MultiVector<T>,
    x: &mut MultiVector<T>,
    monitor: &mut Monitor<'_, T>,
    work: &mut Work,
) -> Result<StopReason, Halt> {
    let mut iteration = scheme.begin(a, b, &mut Context::new(work, &mut || monitor.poll()))?;
    iteration.restart(x, &mut Context::new(work, &mut || monitor.poll()))?;
    loop {
        if let ControlFlow::Break(reason) = monitor.record(x, iteration.product(), work) {
            return Ok(reason);
        }
        iteration.advance(x, &mut Context::new(work, &mut || monitor.poll()))?;
        if iteration.drifts() && monitor.converged(iteration.product()) {
            iteration.restart(x, &mut Context::new(work, &mut || monitor.poll()))?;
        }
    }
}
