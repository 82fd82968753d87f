//! `fredholm waves`.

use std::fmt::Write;
use std::path::Path;

use fredholm_report::{ComparisonRun, WaveComparison};
use fredholm_study::{Ended, Error, SolvedWaves, Watch, WaveCompareOptions};

use crate::args::WavesArgs;
use crate::ending::Ending;
use crate::output::{self, visible};
use crate::start::Start;
use crate::summary::Lines;
use crate::terminal::Terminal;

/// Computes a scene of waves and writes the results.
pub(crate) fn waves(args: &WavesArgs) -> Result<Ending, Error> {
    let start = Start {
        scene: &args.scene,
        output: args.output.as_ref(),
        threads: args.threads,
        memory: args.memory,
        log: args.log,
    };
    start.run(|folder, terminal| match args.comparison() {
        Some(comparison) => compare(args, &comparison, folder, terminal),
        None => run(args, folder, terminal),
    })
}

fn run(args: &WavesArgs, folder: &Path, terminal: &Terminal) -> Result<Ending, Error> {
    let mut solved = fredholm_study::waves(&args.scene, &args.options(), terminal)?;
    solved.write(folder)?;
    if solved.ended() != Ended::Done {
        terminal.warn("the residual asked for was not reached; the results are those of the last iteration");
    }
    if !args.log.quiet {
        summarise(args, folder, &solved)?;
    }
    Ok(solved.ended().into())
}

fn compare(
    args: &WavesArgs,
    comparison: &WaveCompareOptions,
    folder: &Path,
    terminal: &Terminal,
) -> Result<Ending, Error> {
    let (scene, options) = (&args.scene, args.options());
    let (record, ended) = fredholm_study::compare_waves(scene, &options, comparison, folder, terminal)?;
    if !args.log.quiet {
        tabulate(folder, &record)?;
    }
    Ok(ended.into())
}

/// Prints a table for each frequency.
fn tabulate(folder: &Path, record: &WaveComparison) -> Result<(), Error> {
    let mut text = format!("{} → {}\n", record.scene, folder.join("compare.svg").display());
    for case in &record.cases {
        // Writing to a string cannot fail.
        let _ = writeln!(
            text,
            "\n  {} MHz, {} unknowns, spectral radius {:.3}; errors against {}",
            case.frequency / 1e6,
            case.unknowns,
            case.spectral_radius,
            case.reference
        );
        let width = case.runs.iter().map(|run| run.solver.chars().count()).fold(8, usize::max);
        let _ = writeln!(text, "  {:width$}  iterations   residual      error  outcome", "solver");
        for run in &case.runs {
            let _ = writeln!(text, "  {:width$}  {}", run.solver, row(run));
        }
    }
    output::print(&visible(&text))
}

fn row(run: &ComparisonRun) -> String {
    match &run.reason {
        Some(reason) => format!("{:>32}  refused: {reason}", ""),
        None => {
            format!("{:>10}  {:>9.1e}  {:>9.1e}  {}", run.iterations, run.residual, run.error, run.outcome)
        }
    }
}

fn summarise(args: &WavesArgs, folder: &Path, solved: &SolvedWaves) -> Result<(), Error> {
    let mut lines = Lines::default();
    let edges = if solved.edge_currents() { ", edge currents" } else { "" };
    lines.add("method", format!("{}, shadows {}{edges}", solved.method(), solved.shadow()));
    if let Some(reason) = solved.reason() {
        lines.add("chosen", reason);
    }
    for found in solved.frequencies() {
        let residual = found.residuals.last();
        let ending = residual.map_or(String::new(), |residual| {
            format!(", residual {residual:.1e} after {} iterations", found.residuals.len() - 1)
        });
        let text = format!("{} facets{ending}", found.facets);
        lines.add(&format!("{} MHz", found.frequency / 1e6), text);
    }
    for error in solved.stated_errors() {
        let name = solved.receiver(error.receiver).unwrap_or_default();
        let text = format!("below {:.2e} at {name}, {} MHz", error.relative, error.frequency / 1e6);
        lines.add("stated error", text);
    }
    for (what, errors) in [("mesh error", solved.mesh_errors()), ("form error", solved.form_errors())] {
        for error in errors {
            let name = solved.receiver(error.receiver).unwrap_or_default();
            let text = format!("about {:.2e} at {name}, {} MHz", error.relative, error.frequency / 1e6);
            lines.add(what, text);
        }
    }
    output::print(&lines.under(&format!("{} → {}", args.scene.display(), folder.display())))
}
