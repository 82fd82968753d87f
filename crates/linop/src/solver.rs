//! What every solver of A x = b takes and gives.

use crate::{MultiVector, Scalar, SecondKind, SolveError};
use std::ops::ControlFlow;

/// A method that solves A x = b, all right-hand sides together.
pub trait Solver<T: Scalar>: Send + Sync {
    /// The name it is chosen by: lower case, words joined by hyphens.
    fn name(&self) -> &'static str;

    /// What it does, in one line.
    fn description(&self) -> &'static str;

    /// Bytes it needs besides the operator, b and x.
    fn bytes(&self, dim: usize, rhs_count: usize) -> u64;

    /// Bytes of addresses that every thread sets aside besides, and of which it touches no more
    /// than [`bytes`](Self::bytes) counts. They matter only where the address space is limited.
    fn addresses(&self) -> u64 {
        0
    }

    /// Solves A x = b from the starting guess `x`, which becomes the solution. The residual of
    /// every iteration goes to `observer`, and into the report.
    ///
    /// However it stops, x is the best that was reached by then, and the report says why.
    ///
    /// # Errors
    /// The method does not suit A, b or x do not fit it or are not finite, or no memory. x is then
    /// of no use.
    fn solve(
        &self,
        a: &SecondKind<'_, T>,
        b: &MultiVector<T>,
        x: &mut MultiVector<T>,
        stop: &Stop,
        observer: &mut dyn Observer<T>,
    ) -> Result<Report, SolveError>;
}

/// When to stop.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Stop {
    /// Residual that every right-hand side must reach.
    pub tolerance: f64,
    /// Most iterations. Direct solvers do not iterate, and do not look at it.
    pub max_iterations: usize,
}

/// Why a solver stopped.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum StopReason {
    /// Every right-hand side met the tolerance.
    Converged,
    /// The iterations ran out, or a direct solver ended above the tolerance.
    IterationLimit,
    /// The observer asked for it; x is what was reached by then.
    Interrupted,
    /// A residual is not finite, or grew to a million times the best; x is of no use.
    Diverged,
}

/// One entry of the residual history.
#[derive(Clone, Debug, PartialEq)]
pub struct Record {
    /// Iterations done; 0 is the starting guess.
    pub iteration: usize,
    /// Seconds since the start.
    pub seconds: f64,
    /// Stored entries read so far, for all right-hand sides together.
    pub entries_touched: u64,
    /// ‖b − A x‖₂/‖b‖₂ per right-hand side.
    pub residuals: Vec<f64>,
}

/// Work done. For all right-hand sides together: an entry that serves several right-hand sides
/// counts once.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Work {
    /// Applications y = A x.
    pub operator_applications: u64,
    /// Rows visited.
    pub row_visits: u64,
    /// Columns visited.
    pub column_visits: u64,
    /// Stored entries read.
    pub entries_touched: u64,
}

/// What a solver did.
#[derive(Clone, Debug, PartialEq)]
pub struct Report {
    /// Why it stopped.
    pub reason: StopReason,
    /// Residuals, from the starting guess on.
    pub history: Vec<Record>,
    /// Work done.
    pub work: Work,
    /// Seconds in all.
    pub seconds: f64,
}

/// Where a solver is.
#[derive(Debug)]
pub struct Progress<'a, T> {
    /// The newest entry of the history.
    pub record: &'a Record,
    /// The iterate it belongs to.
    pub x: &'a MultiVector<T>,
}

/// Follows a solver and may stop it. A closure of the progress is an observer.
pub trait Observer<T> {
    /// Called with every entry of the history.
    fn observe(&mut self, progress: &Progress<'_, T>) -> ControlFlow<()>;

    /// Called often between the entries; asks only whether to go on.
    fn poll(&mut self) -> ControlFlow<()> {
        ControlFlow::Continue(())
    }
}

impl<T, F: FnMut(&Progress<'_, T>) -> ControlFlow<()>> Observer<T> for F {
    fn observe(&mut self, progress: &Progress<'_, T>) -> ControlFlow<()> {
        self(progress)
    }
}

/// The observer that only watches.
#[derive(Clone, Copy, Debug, Default)]
pub struct Quiet;

impl<T> Observer<T> for Quiet {
    fn observe(&mut self, _: &Progress<'_, T>) -> ControlFlow<()> {
        ControlFlow::Continue(())
    }
}
