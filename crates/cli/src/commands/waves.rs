//! `fredholm waves`.

use std::path::PathBuf;

use clap::Args;

use crate::args::LogArgs;
use crate::failure::{Ending, Failure};
use crate::interrupt::Interrupt;
use crate::stages::Stages;
use crate::summary::Lines;
use crate::waves::{self, Model, Outcome};
use crate::{console, folder, output, threads};

/// Examples for the help.
pub(crate) const EXAMPLES: &str = "\
Examples:
  fredholm waves scenes/waves/plate.toml
  fredholm waves dihedral.toml -o results --threads 2

Written are receivers.csv, receivers.npz, currents.vtu, far.csv, plots and maps of the
receivers, and run.json last. Ctrl-C ends the run with nothing written.";

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
    #[command(flatten)]
    pub(crate) log: LogArgs,
}

/// Computes a scene of waves and writes the results.
pub(crate) fn waves(args: &WavesArgs) -> Result<Ending, Failure> {
    let interrupt = Interrupt::install(args.log.log)?;
    folder::probe(&folder::of(args.output.as_ref(), &args.scene))?;
    let console = console::choose(args.log);
    let mut stages = Stages::new(&*console, &interrupt);
    let count = args.threads.map_or_else(threads::default_count, usize::from);
    threads::pool(count)?.install(|| run(args, &mut stages))
}

fn run(args: &WavesArgs, stages: &mut Stages) -> Result<Ending, Failure> {
    let folder = folder::of(args.output.as_ref(), &args.scene);
    let model = stages.run("scene", || Model::load(&args.scene))?;
    let outcome = waves::compute(&model, stages)?;
    stages.begin_saving()?;
    let timings = stages.timings().to_vec();
    let written = || waves::write(&folder, &model, &outcome, &timings).map_err(super::solve::report_failure);
    stages.run("results", written)?;
    if !outcome.converged() {
        stages
            .console
            .warn("the residual asked for was not reached; the results are those of the last iteration");
    }
    if !args.log.quiet {
        summarise(&folder, &model, &outcome)?;
    }
    Ok(if outcome.converged() { Ending::Done } else { Ending::NotConverged })
}

fn summarise(folder: &std::path::Path, model: &Model, outcome: &Outcome) -> Result<(), Failure> {
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
