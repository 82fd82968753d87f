//! `compare.csv`: a row a solver and case; `compare_history.csv`: a row an iteration.
//!
//! Columns of the first: `reflectance`, `solver`, `outcome`, `iterations`, `applications`, `rows`,
//! `columns`, `entries`, `seconds`, `residual`, `error`, `reason`; of the second: `reflectance`,
//! `solver`, `iteration`, `entries`, `seconds`, `residual`. What is not known is empty.

use std::io::{self, Write};

use super::record::{ComparisonRecord, ComparisonRun};
use crate::csv::quoted;
use crate::number::Number;

const COLUMNS: &str =
    "reflectance,solver,outcome,iterations,applications,rows,columns,entries,seconds,residual,error,reason";
const HISTORY_COLUMNS: &str = "reflectance,solver,iteration,entries,seconds,residual";

/// Writes the table of solvers.
///
/// # Errors
/// What `out` reports.
pub fn write_comparison_csv(record: &ComparisonRecord, out: &mut dyn Write) -> io::Result<()> {
    writeln!(out, "{COLUMNS}")?;
    for (reflectance, run) in runs(record) {
        write!(out, "{},{},{}", Number(reflectance), quoted(&run.solver), run.outcome)?;
        for count in [run.iterations, run.applications, run.rows, run.columns, run.entries] {
            write!(out, ",{count}")?;
        }
        for value in [run.seconds, run.residual, run.error] {
            if value.is_finite() { write!(out, ",{}", Number(value))? } else { write!(out, ",")? }
        }
        writeln!(out, ",{}", quoted(run.reason.as_deref().unwrap_or_default()))?;
    }
    Ok(())
}

/// Writes the residuals on the way.
///
/// # Errors
/// What `out` reports.
pub fn write_comparison_history(record: &ComparisonRecord, out: &mut dyn Write) -> io::Result<()> {
    writeln!(out, "{HISTORY_COLUMNS}")?;
    for (reflectance, run) in runs(record) {
        let history = &run.history;
        let known = history.entries.iter().zip(&history.seconds).zip(&history.residual);
        for (iteration, ((entries, &seconds), &residual)) in known.enumerate() {
            let (solver, reflectance) = (quoted(&run.solver), Number(reflectance));
            writeln!(
                out,
                "{reflectance},{solver},{iteration},{entries},{},{}",
                Number(seconds),
                Number(residual)
            )?;
        }
    }
    Ok(())
}

fn runs(record: &ComparisonRecord) -> impl Iterator<Item = (f64, &ComparisonRun)> {
    record.cases.iter().flat_map(|case| case.runs.iter().map(move |run| (case.reflectance, run)))
}

#[cfg(test)]
mod tests {
    use super::super::record::tests::sample;
    use super::*;
    use crate::csv::tests::parse;

    #[test]
    fn every_solver_and_case_has_a_row() {
        let mut out = Vec::new();
        write_comparison_csv(&sample(), &mut out).unwrap();
        let rows = parse(&String::from_utf8(out).unwrap());
        assert_eq!((rows.len(), rows[0].len()), (5, 12));
        assert_eq!(rows[1][..4], ["0.5", "sor:omega=1.2", "converged", "2"]);
        assert_eq!(rows[1][7..], ["20", "0.5", "1e-9", "2e-9", ""]);
        assert_eq!(rows[4][9..], ["", "", "not symmetric, \"so\""]);
    }

    #[test]
    fn every_iteration_has_a_row() {
        let mut out = Vec::new();
        write_comparison_history(&sample(), &mut out).unwrap();
        let rows = parse(&String::from_utf8(out).unwrap());
        assert_eq!(rows.len(), 1 + 2 * 3);
        assert_eq!(rows[6], ["0.9", "sor:omega=1.2", "2", "20", "0.5", "1e-9"]);
    }
}
