//! One solver on one system.

use fredholm_linop::{MultiVector, Report, SecondKind, StopReason};
use fredholm_report::{ComparisonHistory, ComparisonRun};

use crate::failure::Failure;
use crate::interrupt::nothing_saved;
use crate::registry::Entry;
use crate::solution::reason;
use crate::watcher::Watcher;

/// A system, what all its solvers have in common, and the answer.
pub(super) struct Bench<'a> {
    pub(super) system: &'a SecondKind<'a, f64>,
    pub(super) b: &'a MultiVector<f64>,
    /// Bytes that a solver may take.
    pub(super) memory: u128,
    pub(super) watcher: Watcher<'a>,
}

/// What a solver came to, and its x where it has one.
pub(super) struct Outcome {
    pub(super) run: ComparisonRun,
    pub(super) x: Option<MultiVector<f64>>,
}

impl Bench<'_> {
    /// Solves from x = 0.
    pub(super) fn run(&self, text: &str, entry: &Entry) -> Result<Outcome, Failure> {
        let (dim, lanes) = (self.b.dim(), self.b.lanes());
        let bytes = u128::from(entry.solver.bytes(dim, lanes));
        if bytes > self.memory {
            let reason = format!("it takes {bytes} bytes of memory and {} are left", self.memory);
            return Ok(refused(text, reason));
        }
        let mut x = MultiVector::zeros(dim, lanes);
        let (stop, mut watcher) = (self.watcher.stop(), self.watcher);
        let solved = entry.solver.solve(self.system, self.b, &mut x, &stop, &mut watcher);
        if watcher.go_on().is_break() {
            return Err(nothing_saved());
        }
        Ok(match solved {
            Ok(report) => Outcome { run: record(text, &report), x: Some(x) },
            Err(error) => refused(text, error.to_string()),
        })
    }
}

fn refused(text: &str, reason: String) -> Outcome {
    let run = ComparisonRun {
        solver: text.to_owned(),
        outcome: "refused".to_owned(),
        reason: Some(reason),
        residual: f64::NAN,
        error: f64::NAN,
        ..ComparisonRun::default()
    };
    Outcome { run, x: None }
}

fn record(text: &str, report: &Report) -> ComparisonRun {
    let history = || report.history.iter();
    let last = history().next_back();
    ComparisonRun {
        solver: text.to_owned(),
        outcome: reason(report.reason).to_owned(),
        reason: None,
        iterations: last.map_or(0, |record| record.iteration as u64),
        applications: report.work.operator_applications,
        rows: report.work.row_visits,
        columns: report.work.column_visits,
        entries: report.work.entries_touched,
        seconds: report.seconds,
        residual: last.map_or(f64::NAN, |record| worst(&record.residuals)),
        error: f64::NAN,
        history: ComparisonHistory {
            entries: history().map(|record| record.entries_touched).collect(),
            seconds: history().map(|record| record.seconds).collect(),
            residual: history().map(|record| worst(&record.residuals)).collect(),
        },
    }
}

/// Whether a run failed to converge, other than by being refused.
pub(super) fn failed(run: &ComparisonRun) -> bool {
    run.outcome != reason(StopReason::Converged) && run.outcome != "refused"
}

fn worst(residuals: &[f64]) -> f64 {
    residuals
        .iter()
        .copied()
        .fold(0.0, |worst, residual| if residual > worst || residual.is_nan() { residual } else { worst })
}

/// ‖x − y‖₂/‖y‖₂ of the worst band.
pub(super) fn distance(x: &MultiVector<f64>, y: &MultiVector<f64>) -> f64 {
    let mut difference = x.clone();
    difference.set_difference(x, y);
    let shares = difference.norms().into_iter().zip(y.norms());
    worst(
        &shares
            .map(|(difference, norm)| if norm > 0.0 { difference / norm } else { difference })
            .collect::<Vec<_>>(),
    )
}
