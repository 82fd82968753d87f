//! Solvers compared on the couplings of a scene of waves: `compare.csv` (a row a solver and
//! frequency), `compare_history.csv` (a row an iteration), `compare.svg` (residuals of the last
//! frequency), `compare.json` last.
//!
//! Columns of the first: `frequency` (Hz), `spectral_radius`, `solver`, `outcome`, `iterations`,
//! `entries` (matrix entries read), `seconds`, `residual`, `error`, `reason`; of the second:
//! `frequency`, `solver`, `iteration`, `entries`, `seconds`, `residual`. What is not known is
//! empty.

use std::io::{self, Write};

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};
use serde_json::Value;

use crate::csv::quoted;
use crate::number::Number;
use crate::plot::{Axis, Figure, Line, Panel, Part, Point, Span, write_svg};
use crate::{COMPARISON_FILES, ComparisonRun, ReportError, ResultFolder, Timing, reading};

/// Name of the format of `compare.json`.
pub const WAVE_COMPARISON_FORMAT: &str = "fredholm-waves-compare-1";

const COLUMNS: &str =
    "frequency,spectral_radius,solver,outcome,iterations,entries,seconds,residual,error,reason";
const HISTORY_COLUMNS: &str = "frequency,solver,iteration,entries,seconds,residual";
const RESIDUAL_LABEL: &str = "relative residual ‖b − x + K x‖ / ‖b‖";

/// What solvers did, and what made it.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(default)]
pub struct WaveComparison {
    /// [`WAVE_COMPARISON_FORMAT`].
    pub format: String,
    /// Version of the program.
    pub version: String,
    /// Path of the scene file.
    pub scene: String,
    /// Options in force.
    pub options: Value,
    /// One a frequency.
    pub cases: Vec<WaveComparisonCase>,
    /// Times of the stages.
    pub timings: Vec<Timing>,
}

/// All solvers on one system.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(default)]
pub struct WaveComparisonCase {
    /// Frequency, Hz.
    pub frequency: f64,
    /// Complex unknowns.
    pub unknowns: u64,
    /// Estimate of ϱ(K): the series of bounces converges where it is below 1.
    #[serde(deserialize_with = "reading::number")]
    pub spectral_radius: f64,
    /// Solver that the errors are measured against.
    pub reference: String,
    /// Solvers in the order asked for.
    pub runs: Vec<ComparisonRun>,
}

/// Writes a comparison into a folder.
///
/// # Errors
/// [`ReportError::Write`] with the path.
pub fn write_wave_comparison(folder: &ResultFolder, record: &WaveComparison) -> Result<(), ReportError> {
    let [all, histories, drawn, json] = COMPARISON_FILES;
    folder.write(all, |out| table(record, out))?;
    folder.write(histories, |out| history(record, out))?;
    folder.write(drawn, |out| plot(record, out))?;
    let record = |out: &mut dyn Write| {
        serde_json::to_writer_pretty(&mut *out, record)?;
        writeln!(out)
    };
    folder.write(json, record).map(drop)
}

fn runs(record: &WaveComparison) -> impl Iterator<Item = (&WaveComparisonCase, &ComparisonRun)> {
    record.cases.iter().flat_map(|case| case.runs.iter().map(move |run| (case, run)))
}

fn table(record: &WaveComparison, out: &mut dyn Write) -> io::Result<()> {
    writeln!(out, "{COLUMNS}")?;
    for (case, run) in runs(record) {
        let (frequency, radius) = (Number(case.frequency), Number(case.spectral_radius));
        write!(out, "{frequency},{radius},{},{}", quoted(&run.solver), run.outcome)?;
        write!(out, ",{},{}", run.iterations, run.entries)?;
        for value in [run.seconds, run.residual, run.error] {
            if value.is_finite() { write!(out, ",{}", Number(value))? } else { write!(out, ",")? }
        }
        writeln!(out, ",{}", quoted(run.reason.as_deref().unwrap_or_default()))?;
    }
    Ok(())
}

fn history(record: &WaveComparison, out: &mut dyn Write) -> io::Result<()> {
    writeln!(out, "{HISTORY_COLUMNS}")?;
    for (case, run) in runs(record) {
        let known = run.history.entries.iter().zip(&run.history.seconds).zip(&run.history.residual);
        for (iteration, ((entries, &seconds), &residual)) in known.enumerate() {
            let (frequency, solver) = (Number(case.frequency), quoted(&run.solver));
            let (seconds, residual) = (Number(seconds), Number(residual));
            writeln!(out, "{frequency},{solver},{iteration},{entries},{seconds},{residual}")?;
        }
    }
    Ok(())
}

/// Iterations on a logarithmic axis of residuals, and seconds.
fn plot(record: &WaveComparison, out: &mut dyn Write) -> io::Result<()> {
    let Some(case) = record.cases.last() else {
        return write_svg(&Figure { title: "Nothing to compare".to_owned(), parts: Vec::new() }, out);
    };
    let over = |across: &str, points: fn(&ComparisonRun) -> Vec<Point>| {
        let solved = case.runs.iter().filter(|run| !run.history.residual.is_empty());
        let line = |(number, run): (usize, &ComparisonRun)| Line::distinct(&run.solver, points(run), number);
        let lines = solved.enumerate().map(line).collect();
        let (across, up) = (Axis::new(across, Span::WithZero), Axis::new(RESIDUAL_LABEL, Span::Decades));
        Part::Panel(Panel::new(across, up, lines))
    };
    let title = format!(
        "{}: {} unknowns, spectral radius {:.3}, {} MHz",
        record.scene,
        case.unknowns,
        case.spectral_radius,
        case.frequency / 1e6
    );
    let parts = vec![over("iterations", over_iterations), over("time, s", over_time)];
    write_svg(&Figure { title, parts }, out)
}

fn over_iterations(run: &ComparisonRun) -> Vec<Point> {
    let counted = run.history.residual.iter().copied().enumerate();
    counted.map(|(iteration, residual)| (iteration as f64, residual)).collect()
}

fn over_time(run: &ComparisonRun) -> Vec<Point> {
    run.history.seconds.iter().copied().zip(run.history.residual.iter().copied()).collect()
}

#[cfg(test)]
mod tests {
    use std::fs;

    use super::*;
    use crate::ComparisonHistory;
    use crate::csv::tests::parse;
    use crate::plot::tests::curves;

    fn sample() -> WaveComparison {
        let history = ComparisonHistory {
            entries: vec![0, 16, 32],
            seconds: vec![0.0, 0.5, 1.0],
            residual: vec![1.0, 40.0, 3e6],
        };
        let diverging = ComparisonRun {
            solver: "neumann".into(),
            outcome: "diverged".into(),
            iterations: 2,
            entries: 32,
            seconds: 1.0,
            residual: 3e6,
            error: f64::NAN,
            history,
            ..ComparisonRun::default()
        };
        let refused = ComparisonRun {
            solver: "cg-theta".into(),
            outcome: "refused".into(),
            reason: Some("not symmetric, so".into()),
            residual: f64::NAN,
            error: f64::NAN,
            ..ComparisonRun::default()
        };
        let case = WaveComparisonCase {
            frequency: 2.5e9,
            unknowns: 4,
            spectral_radius: 1.125,
            reference: "none".into(),
            runs: vec![diverging, refused],
        };
        WaveComparison {
            format: WAVE_COMPARISON_FORMAT.into(),
            version: "0".into(),
            scene: "a <b>.toml".into(),
            options: Value::Null,
            cases: vec![case],
            timings: Vec::new(),
        }
    }

    #[test]
    fn every_solver_and_every_iteration_has_a_row() {
        let (mut solvers, mut steps) = (Vec::new(), Vec::new());
        table(&sample(), &mut solvers).unwrap();
        history(&sample(), &mut steps).unwrap();
        let solvers = parse(&String::from_utf8(solvers).unwrap());
        assert_eq!(solvers[0].len(), 10);
        let expected = ["2500000000", "1.125", "neumann", "diverged", "2", "32", "1", "3000000", "", ""];
        assert_eq!(solvers[1], expected);
        assert_eq!(solvers[2][7..], ["", "", "not symmetric, so"]);
        let steps = parse(&String::from_utf8(steps).unwrap());
        assert_eq!((steps.len(), steps[3][2].as_str(), steps[3][5].as_str()), (4, "2", "3000000"));
    }

    #[test]
    fn the_plot_is_well_formed_and_the_record_complete() {
        let mut out = Vec::new();
        plot(&sample(), &mut out).unwrap();
        let text = String::from_utf8(out).unwrap();
        assert_eq!(curves(&text).len(), 2);
        let folder = tempfile::tempdir().unwrap();
        write_wave_comparison(&ResultFolder::claim(folder.path()).unwrap(), &sample()).unwrap();
        let json = fs::read(folder.path().join("compare.json")).unwrap();
        let json: Value = serde_json::from_slice(&json).unwrap();
        assert_eq!(json["cases"][0]["runs"][0]["history"]["residual"][1], 40.0);
        assert!(json["cases"][0]["runs"][0]["error"].is_null());
    }
}
