//! One solver on one system.

use fredholm_linop::{MultiVector, SecondKind};
use fredholm_report::ComparisonRun;

use crate::error::Error;
use crate::memory::Limit;
use crate::prediction::of_threads;
use crate::registry::SolverEntry;
use crate::trial;
use crate::watcher::Watcher;

/// A system, what all its solvers have in common, and the answer.
pub(super) struct Bench<'a> {
    pub(super) system: &'a SecondKind<'a, f64>,
    pub(super) b: &'a MultiVector<f64>,
    /// Bytes that a solver may take.
    pub(super) memory: u128,
    /// Where addresses are limited, those that threads set aside count as well.
    pub(super) limit: Limit,
    pub(super) watcher: Watcher<'a>,
}

/// What a solver came to, and its x where it has one.
pub(super) struct Outcome {
    pub(super) run: ComparisonRun,
    pub(super) x: Option<MultiVector<f64>>,
}

impl Bench<'_> {
    /// Solves from x = 0.
    pub(super) fn run(&self, text: &str, entry: &SolverEntry) -> Result<Outcome, Error> {
        let (dim, rhs_count) = (self.b.dim(), self.b.rhs_count());
        let bytes = u128::from(entry.solver.bytes(dim, rhs_count))
            + self.limit.counted(of_threads(entry.solver.addresses()));
        if bytes > self.memory {
            let reason = format!("it takes {bytes} bytes of memory and {} are left", self.memory);
            return Ok(Outcome { run: trial::refused(text, reason), x: None });
        }
        let mut x = MultiVector::zeros(dim, rhs_count);
        let (stop, mut watcher) = (self.watcher.stop(), self.watcher);
        let solved = entry.solver.solve(self.system, self.b, &mut x, &stop, &mut watcher);
        if watcher.go_on().is_break() {
            return Err(Error::cancelled());
        }
        Ok(match solved {
            Ok(report) => Outcome { run: trial::ran(text, &report), x: Some(x) },
            Err(error) => Outcome { run: trial::refused(text, error.to_string()), x: None },
        })
    }
}

/// ‖x − y‖₂/‖y‖₂ of the worst band.
pub(super) fn distance(x: &MultiVector<f64>, y: &MultiVector<f64>) -> f64 {
    let mut difference = x.clone();
    difference.set_difference(x, y);
    let shares = difference.norms().into_iter().zip(y.norms());
    trial::worst(
        &shares
            .map(|(difference, norm)| if norm > 0.0 { difference / norm } else { difference })
            .collect::<Vec<_>>(),
    )
}
