//! `fredholm compare`.

use std::fmt::Write;
use std::path::Path;

use fredholm_report::{COMPARISON_FILES, ComparisonCase, ComparisonRecord, ComparisonRun};
use fredholm_study::{Bytes, Error, Watch};

use crate::args::CompareArgs;
use crate::ending::Ending;
use crate::output::{self, visible};
use crate::start::Start;

/// Runs solvers on the same system and writes how they did.
pub(crate) fn compare(args: &CompareArgs) -> Result<Ending, Error> {
    let start = Start {
        scene: &args.scene,
        output: args.output.as_ref(),
        verb: "compare",
        threads: args.threads,
        memory: args.memory,
        log: args.log,
    };
    start.run(|folder, terminal| {
        let (record, ended) = fredholm_study::compare(&args.scene, &args.options(), folder, terminal)?;
        record.warnings.iter().for_each(|warning| terminal.warn(warning));
        if !args.log.quiet {
            print(folder.path(), &record)?;
        }
        Ok(ended.into())
    })
}

/// Prints a table for each case.
fn print(folder: &Path, record: &ComparisonRecord) -> Result<(), Error> {
    let mut text = format!("{} → {}\n", record.scene, folder.join(COMPARISON_FILES[2]).display());
    // Writing to a string cannot fail.
    let _ = writeln!(text, "  {} unknowns, {} stored entries", record.unknowns, record.entries);
    if let Some(peak) = record.peak_memory_bytes {
        let _ = writeln!(text, "  most memory held: {}", Bytes(peak.into()));
    }
    for case in &record.cases {
        table(case, record.entries, &mut text);
    }
    output::print(&visible(&text))
}

fn table(case: &ComparisonCase, entries: u64, text: &mut String) {
    let _ = writeln!(
        text,
        "\n  reflectance up to {:.4}; errors against {} (residual {:.1e})",
        case.reflectance, case.reference, case.reference_residual
    );
    let width = case.runs.iter().map(|run| run.solver.chars().count()).fold(8, usize::max);
    let _ = writeln!(
        text,
        "  {:width$}  {:>10}  {:>9}  {:>9}  {:>9}  {:>9}  outcome",
        "solver", "iterations", "readings", "seconds", "residual", "error"
    );
    for run in &case.runs {
        let _ = writeln!(text, "  {:width$}  {}", run.solver, row(run, entries));
    }
}

/// Readings are entries read over entries stored.
fn row(run: &ComparisonRun, entries: u64) -> String {
    if run.reason.is_some() {
        return format!("{:>54}  refused", "");
    }
    let readings = run.entries as f64 / entries.max(1) as f64;
    format!(
        "{:>10}  {readings:>9.1}  {:>9.3}  {:>9.1e}  {:>9.1e}  {}",
        run.iterations, run.seconds, run.residual, run.error, run.outcome
    )
}
