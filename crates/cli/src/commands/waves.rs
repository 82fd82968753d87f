//! `fredholm waves`.

use std::fmt::Write;
use std::path::Path;

use fredholm_report::{ComparisonRun, WaveComparison};
use fredholm_study::{
    CheckedWaves, Ended, Error, ResultFolder, SolvedFrequency, SolvedWaves, Watch, WaveCompareOptions,
    WaveOptions, check_waves,
};
use serde_json::Value;

use crate::args::{CheckArgs, WavesArgs};
use crate::ending::Ending;
use crate::output::{self, visible};
use crate::start::Start;
use crate::summary::Lines;
use crate::terminal::Terminal;

/// Beginning of the format of a record of waves.
pub(super) const RECORD_FORMAT: &str = "fredholm-waves-run/";
/// Most frequencies that are listed one by one.
const MOST_LISTED: usize = 8;

/// Computes a scene of waves and writes the results.
pub(crate) fn waves(args: &WavesArgs) -> Result<Ending, Error> {
    let start = Start {
        scene: &args.scene,
        output: args.output.as_ref(),
        verb: if args.comparison().is_some() { "compare" } else { "" },
        threads: args.threads,
        memory: args.memory,
        log: args.log,
    };
    start.run(|folder, terminal| match args.comparison() {
        Some(comparison) => compare(args, &comparison, folder, terminal),
        None => run(args, folder, terminal),
    })
}

fn run(args: &WavesArgs, folder: &ResultFolder, terminal: &Terminal) -> Result<Ending, Error> {
    let mut solved = fredholm_study::waves(&args.scene, &args.options(), terminal)?;
    solved.write(folder)?;
    if solved.ended() != Ended::Done {
        terminal.warn("the residual asked for was not reached; the results are those of the last iteration");
    }
    if !args.log.quiet {
        summarise(args, folder.path(), &solved)?;
    }
    Ok(solved.ended().into())
}

fn compare(
    args: &WavesArgs,
    comparison: &WaveCompareOptions,
    folder: &ResultFolder,
    terminal: &Terminal,
) -> Result<Ending, Error> {
    let (scene, options) = (&args.scene, args.options());
    let (record, ended) = fredholm_study::compare_waves(scene, &options, comparison, folder, terminal)?;
    if !args.log.quiet {
        tabulate(folder.path(), &record)?;
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
    lines.add("method", format!("{}{edges}, {}", solved.method(), solved.solution()));
    if let Some(reason) = solved.reason() {
        lines.add("chosen", reason);
    }
    let all = solved.frequencies();
    if all.len() > MOST_LISTED {
        lines.add("frequencies", sweep(all));
    }
    for found in all.iter().filter(|_| all.len() <= MOST_LISTED) {
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
    for balance in solved.balances() {
        let text = format!(
            "{:.4} of what the sources give is radiated, {} MHz",
            balance.ratio(),
            balance.frequency / 1e6
        );
        lines.add("power", text);
    }
    for found in solved.reciprocity().iter().take(MOST_LISTED) {
        let name = solved.receiver(found.receiver).unwrap_or_default();
        let text = format!("within {:.1e} at {name}, {} MHz", found.defect, found.frequency / 1e6);
        lines.add("reciprocity", text);
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

/// What is to be said of many frequencies together.
fn sweep(all: &[SolvedFrequency]) -> String {
    let frequencies: Vec<f64> = all.iter().map(|found| found.frequency).collect();
    let facets = all.first().map_or(0, |found| found.facets);
    let residuals = all.iter().filter_map(|found| found.residuals.last().copied());
    let worst = residuals.fold(None, |worst: Option<f64>, r| Some(worst.map_or(r, |w| w.max(r))));
    let ending = worst.map_or(String::new(), |residual| format!(", residuals up to {residual:.1e}"));
    format!("{}, {facets} facets{ending}", self::frequencies(&frequencies))
}

/// Validates a scene of waves, tells what its mesh is and predicts what its fields will take.
pub(super) fn check(args: &CheckArgs, terminal: &Terminal) -> Result<Ending, Error> {
    if args.output.is_some() {
        terminal.warn("scenes of waves are not drawn by check; -o is left aside");
    }
    let options = WaveOptions { memory: args.problem.memory, no_report: true, ..WaveOptions::default() };
    let checked = check_waves(&args.problem.scene, &options, terminal)?;
    if !args.log.quiet {
        output::print(&forecast(&checked))?;
    }
    Ok(Ending::Done)
}

fn forecast(checked: &CheckedWaves) -> String {
    let mut lines = Lines::default();
    lines.add_some("title", checked.title.clone());
    lines.add("method", format!("{}, {}", checked.method, checked.solution));
    lines.add("frequencies", frequencies(&checked.frequencies));
    lines.add("mesh", format!("{} facets on {} surfaces", checked.facets, checked.surfaces));
    checked.findings.iter().for_each(|finding| lines.add("found", finding.to_string()));
    lines.add("receivers", format!("{} points and directions", checked.places));
    lines.add("memory", format!("{}: {}", checked.plan.peak(), checked.plan));
    let coupling = |(unknowns, bytes)| format!("{unknowns} unknowns; {bytes} where its matrix is stored");
    lines.add_some("coupling", checked.coupling.map(coupling));
    lines.add("memory limit", checked.limit.to_string());
    checked.warnings.iter().for_each(|warning| lines.add("warning", warning));
    lines.under(&format!("{}: a valid scene of waves", checked.path.display()))
}

fn frequencies(all: &[f64]) -> String {
    let megahertz = |f: &f64| format!("{} MHz", f / 1e6);
    match all {
        [first, .., last] if all.len() > 4 => {
            format!("{} from {} to {}", all.len(), megahertz(first), megahertz(last))
        }
        few => few.iter().map(megahertz).collect::<Vec<_>>().join(", "),
    }
}

/// What the record of a result of waves tells.
pub(super) fn describe(path: &Path, record: &Value) -> Result<Ending, Error> {
    let text = |key: &str| record[key].as_str().map(str::to_owned);
    let list = |key: &str| record[key].as_array().cloned().unwrap_or_default();
    let mut lines = Lines::default();
    lines.add_some("made by", text("program"));
    lines.add_some("scene", text("scene"));
    lines.add_some("scene sha256", text("scene_sha256"));
    lines.add_some("title", text("title"));
    let method = [text("method"), text("shadows").map(|name| format!("{name} shadows")), text("solution")];
    lines.add("method", method.into_iter().flatten().collect::<Vec<_>>().join(", "));
    let found = list("frequencies");
    let values: Vec<f64> = found.iter().filter_map(|one| one["frequency_hz"].as_f64()).collect();
    if found.len() > MOST_LISTED {
        lines.add("frequencies", frequencies(&values));
    }
    for found in found.iter().filter(|_| found.len() <= MOST_LISTED) {
        let megahertz = found["frequency_hz"].as_f64().unwrap_or_default() / 1e6;
        let ending = match (found["residuals"].as_array().and_then(|all| all.last()), &found["converged"]) {
            (Some(residual), Value::Bool(true)) => format!(", residual {residual}"),
            (Some(residual), _) => format!(", residual {residual}, more than was asked for"),
            (None, _) => String::new(),
        };
        lines.add(&format!("{megahertz} MHz"), format!("{} facets{ending}", found["facets"]));
    }
    for power in list("power") {
        let ratio = power["ratio"].as_f64().unwrap_or_default();
        lines.add("power", format!("{ratio:.4} of what the sources give is radiated"));
    }
    for (what, key) in [("mesh error", "estimated_mesh_errors"), ("form error", "estimated_form_errors")] {
        for error in list(key) {
            let relative = error["relative"].as_f64().unwrap_or_default();
            let name = error["receiver"].as_str().unwrap_or_default();
            lines.add(what, format!("about {relative:.2e} at {name}"));
        }
    }
    list("warnings").iter().filter_map(Value::as_str).for_each(|warning| lines.add("warning", warning));
    output::print(&lines.under(&path.display().to_string()))?;
    Ok(Ending::Done)
}
