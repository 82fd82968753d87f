//! `fredholm waves`.

use std::fmt::Write;
use std::path::{Path, PathBuf};

use clap::Args;
use fredholm_linop::Stop;
use fredholm_report::{ComparisonRun, WaveComparison, write_wave_comparison};

use crate::args::{LogArgs, tolerance};
use crate::failure::{Ending, Failure};
use crate::output;
use crate::output::visible;
use crate::size::Bytes;
use crate::stages::Stages;
use crate::start::Start;
use crate::summary::Lines;
use crate::trial::failed;
use crate::waves::{self, Model, Outcome};

/// Examples for the help.
pub(crate) const EXAMPLES: &str = "\
Examples:
  fredholm waves scenes/waves/plate.toml
  fredholm waves dihedral.toml -o results --threads 2
  fredholm waves scenes/waves/facing_plates.toml --compare neumann,gmres,southwell

Written are receivers.csv, receivers.npz, currents.vtu, far.csv, plots and maps of the
receivers, report.html, and run.json last; with --compare, compare.csv, compare_history.csv,
compare.svg and compare.json instead. Ctrl-C ends the run with nothing written.";

/// Options of `waves`.
#[derive(Clone, Debug, Args)]
pub(crate) struct WavesArgs {
    /// Scene of waves (TOML), see docs/waves.md
    scene: PathBuf,
    /// Folder for the results [default: out/<name of the scene file>]
    #[arg(long, short, value_name = "DIR")]
    output: Option<PathBuf>,
    /// Threads; any number gives the same results [default: one a core]
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u16).range(1..=1024))]
    threads: Option<u16>,
    /// Memory allowed, such as 4GiB or 800MB [default: what leaves the machine usable]
    #[arg(long, value_name = "LIMIT")]
    memory: Option<Bytes>,
    /// Compare solvers on the coupling instead, with their options, or all: neumann,gmres:restart=100,southwell
    #[arg(long, value_name = "LIST", value_delimiter = ',', value_parser = solver)]
    compare: Vec<String>,
    /// Write no report.html
    #[arg(long)]
    no_report: bool,
    /// Residual that compared solvers are to reach
    #[arg(long, value_name = "T", value_parser = tolerance, default_value = "1e-6", requires = "compare")]
    to: f64,
    /// Iterations that compared solvers are allowed
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u32).range(1..), default_value_t = 1000, requires = "compare")]
    max_iterations: u32,
    #[command(flatten)]
    pub(crate) log: LogArgs,
}

/// A solver that can be made, or all of them.
fn solver(text: &str) -> Result<String, String> {
    if text != "all" {
        waves::build(text).map_err(|error| error.to_string())?;
    }
    Ok(text.to_owned())
}

impl WavesArgs {
    /// The solvers to compare, `all` written out, each once.
    fn solvers(&self) -> Vec<String> {
        let mut solvers: Vec<String> = Vec::new();
        for text in &self.compare {
            let named = if text == "all" { waves::names() } else { vec![text.as_str()] };
            for name in named {
                if solvers.iter().all(|known| known != name) {
                    solvers.push(name.to_owned());
                }
            }
        }
        solvers
    }
}

/// Computes a scene of waves and writes the results.
pub(crate) fn waves(args: &WavesArgs) -> Result<Ending, Failure> {
    let start = Start {
        scene: &args.scene,
        output: args.output.as_ref(),
        threads: args.threads,
        memory: args.memory,
        log: args.log,
    };
    start.run(|folder, stages| run(args, folder, stages))
}

fn run(args: &WavesArgs, folder: &Path, stages: &mut Stages) -> Result<Ending, Failure> {
    let model = stages.run("scene", || Model::load(&args.scene, args.memory))?;
    stages.console.admit(&model.plan, model.limit);
    if !args.compare.is_empty() {
        return compare(args, folder, &model, stages);
    }
    let outcome = waves::compute(&model, stages)?;
    stages.begin_saving()?;
    let timings = stages.timings().to_vec();
    let written = || {
        waves::write(folder, &model, &outcome, &timings, !args.no_report)
            .map_err(super::solve::report_failure)
    };
    stages.run("results", written)?;
    if !outcome.converged() {
        stages
            .console
            .warn("the residual asked for was not reached; the results are those of the last iteration");
    }
    if !args.log.quiet {
        summarise(folder, &model, &outcome)?;
    }
    Ok(if outcome.converged() { Ending::Done } else { Ending::NotConverged })
}

fn compare(args: &WavesArgs, folder: &Path, model: &Model, stages: &mut Stages) -> Result<Ending, Failure> {
    let stop = Stop { tolerance: args.to, max_iterations: args.max_iterations as usize };
    let record = waves::compare(model, &args.solvers(), &stop, stages)?;
    stages.begin_saving()?;
    write_wave_comparison(folder, &record).map_err(super::solve::report_failure)?;
    if !args.log.quiet {
        tabulate(folder, &record)?;
    }
    let any = record.cases.iter().any(|case| case.runs.iter().any(failed));
    Ok(if any { Ending::NotConverged } else { Ending::Done })
}

/// Prints a table for each frequency.
fn tabulate(folder: &Path, record: &WaveComparison) -> Result<(), Failure> {
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

fn summarise(folder: &Path, model: &Model, outcome: &Outcome) -> Result<(), Failure> {
    let mut lines = Lines::default();
    lines.add("method", format!("{}, shadows {}", model.method.name(), model.shadow.name()));
    for solved in &outcome.solved {
        let residual = solved.residuals.last();
        let ending = residual.map_or(String::new(), |residual| {
            format!(", residual {residual:.1e} after {} iterations", solved.residuals.len() - 1)
        });
        let text = format!("{} facets{ending}", solved.facets);
        lines.add(&format!("{} MHz", solved.frequency / 1e6), text);
    }
    for (what, errors) in [("mesh error", &outcome.mesh_errors), ("form error", &outcome.form_errors)] {
        for error in errors {
            let name = &model.receivers[error.receiver].name;
            let text = format!("about {:.2e} at {name}, {} MHz", error.relative, error.frequency / 1e6);
            lines.add(what, text);
        }
    }
    output::print(&lines.under(&format!("{} → {}", model.path().display(), folder.display())))
}
