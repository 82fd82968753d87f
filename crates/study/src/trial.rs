//! What a solver came to in a comparison, as the record of it.

use fredholm_linop::{Report, StopReason};
use fredholm_report::{ComparisonHistory, ComparisonRun};

use crate::solution::reason;

/// Outcome of a solver that does not suit the system or the memory.
const REFUSED_OUTCOME: &str = "refused";

/// A solver that was refused, and why.
pub(crate) fn refused(solver: &str, reason: String) -> ComparisonRun {
    ComparisonRun {
        solver: solver.to_owned(),
        outcome: REFUSED_OUTCOME.to_owned(),
        reason: Some(reason),
        residual: f64::NAN,
        error: f64::NAN,
        ..ComparisonRun::default()
    }
}

/// A solver that ran; its error is not known yet.
pub(crate) fn ran(solver: &str, report: &Report) -> ComparisonRun {
    let history = || report.history.iter();
    let last = history().next_back();
    ComparisonRun {
        solver: solver.to_owned(),
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
pub(crate) fn failed(run: &ComparisonRun) -> bool {
    run.outcome != reason(StopReason::Converged) && run.outcome != REFUSED_OUTCOME
}

/// The largest, or one that is no number.
pub(crate) fn worst(residuals: &[f64]) -> f64 {
    residuals
        .iter()
        .copied()
        .fold(0.0, |worst, residual| if residual > worst || residual.is_nan() { residual } else { worst })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_refusal_is_no_failure() {
        let run = |outcome: &str| ComparisonRun { outcome: outcome.into(), ..ComparisonRun::default() };
        assert!(!failed(&run(REFUSED_OUTCOME)) && !failed(&run("converged")));
        assert!(failed(&run("diverged")) && failed(&run("not converged")));
    }
}
