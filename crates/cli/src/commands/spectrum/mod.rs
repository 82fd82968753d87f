//! `fredholm spectrum`.

mod analysis;
mod summary;

use std::path::{Path, PathBuf};

use clap::Args;
use fredholm_direct::{spectrum_bytes, thread_addresses};
use fredholm_linop::{SecondKind, Stop, Storage};
use fredholm_report::{SPECTRUM_FORMAT, SpectrumRecord, write_spectrum};
use fredholm_scene::Scene;

use super::solve::report_failure;
use crate::args::{LogArgs, Precision, ProblemArgs, tolerance};

use crate::failure::{Ending, Failure};
use crate::memory::Plan;
use crate::options::RADIOSITY;
use crate::prediction::of_threads;
use crate::problem::Problem;
use crate::registry;
use crate::size::Bytes;
use crate::solution::{form_factors, system};
use crate::stages::Stages;
use crate::start::Start;
use crate::watcher::Watcher;

/// Options of `spectrum`.
#[derive(Clone, Debug, Args)]
pub(crate) struct SpectrumArgs {
    /// Scene file (TOML)
    pub(crate) scene: PathBuf,
    /// Folder for the results [default: out/<name of the scene file>]
    #[arg(long, short, value_name = "DIR")]
    pub(crate) output: Option<PathBuf>,
    /// Most unknowns for dense methods; beyond, there are estimates by the Lanczos process
    #[arg(long, value_name = "N", default_value_t = 2000)]
    pub(crate) dense: usize,
    /// Steps of the Lanczos process
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u32).range(2..=10_000), default_value_t = 60)]
    pub(crate) steps: u32,
    /// Threads; any number gives the same results [default: one a core]
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u16).range(1..=1024))]
    pub(crate) threads: Option<u16>,
    /// Error asked for in a row of form factors, rounded down to a power of ten, 1e-14 at least [default: the scene's, else 1e-3]
    #[arg(long, value_name = "T", value_parser = tolerance)]
    pub(crate) form_factor_tolerance: Option<f64>,
    /// Memory allowed, such as 4GiB or 800MB [default: what leaves the machine usable]
    #[arg(long, value_name = "LIMIT")]
    pub(crate) memory: Option<Bytes>,
    #[command(flatten)]
    pub(crate) log: LogArgs,
}

/// Analyses the matrix of a scene.
pub(crate) fn spectrum(args: &SpectrumArgs) -> Result<Ending, Failure> {
    let start = Start {
        scene: &args.scene,
        output: args.output.as_ref(),
        threads: args.threads,
        memory: args.memory,
        log: args.log,
    };
    start.run(|folder, stages| run(args, folder, stages))
}

fn problem(args: &SpectrumArgs) -> ProblemArgs {
    ProblemArgs {
        scene: args.scene.clone(),
        threads: args.threads,
        discretisation: None,
        solver: Some(registry::DEFAULT.to_owned()),
        form_factor_tolerance: args.form_factor_tolerance,
        storage: None,
        memory: args.memory,
    }
}

fn run(args: &SpectrumArgs, folder: &Path, stages: &mut Stages) -> Result<Ending, Failure> {
    let dense = |plan: Plan, _: &Scene, n: usize| {
        if n > args.dense {
            return plan;
        }
        plan.hold("dense methods", spectrum_bytes(n).into()).aside(of_threads(thread_addresses()))
    };
    let problem = Problem::load(&problem(args), &dense, stages)?;
    if !problem.is_radiosity() {
        let text = format!(
            "spectrum works on the matrix of form factors, which is {RADIOSITY}; the scene asks for {}",
            problem.options.discretisation
        );
        return Err(Failure::new(Ending::Input, text));
    }
    let record = match problem.options.storage {
        Precision::F64 => analysed::<f64>(args, &problem, stages),
        Precision::F32 => analysed::<f32>(args, &problem, stages),
    }?;
    stages.interrupt.begin_saving()?;
    write_spectrum(folder, &record).map_err(report_failure)?;
    if !args.log.quiet {
        summary::print(folder, &record)?;
    }
    Ok(if stages.interrupt.requested() { Ending::Interrupted } else { Ending::Done })
}

fn analysed<S: Storage>(
    args: &SpectrumArgs,
    problem: &Problem,
    stages: &mut Stages,
) -> Result<SpectrumRecord, Failure> {
    let watcher = Watcher::to(stages, Stop { tolerance: 0.0, max_iterations: 0 });
    let assembled = stages.run("assembly", || form_factors::<S>(problem, watcher))?;
    let radiosity = stages.run("exposure", || system(problem, &assembled.matrix))?;
    let system = SecondKind::new(&assembled.matrix, radiosity.scaling())
        .map_err(|error| Failure::new(Ending::Input, error))?;
    let dense = problem.unknowns <= args.dense;
    let bands = if dense {
        analysis::exact(&system, problem.scene.bands(), stages)?
    } else {
        analysis::estimated(&system, problem.scene.bands(), args.steps as usize, watcher, stages)?
    };
    let scene = &problem.scene;
    Ok(SpectrumRecord {
        format: SPECTRUM_FORMAT.to_owned(),
        version: env!("CARGO_PKG_VERSION").to_owned(),
        scene: scene.path().display().to_string(),
        scene_sha256: scene.sha256().to_owned(),
        unknowns: problem.unknowns as u64,
        method: if dense { "dense" } else { "lanczos" }.to_owned(),
        bands,
        timings: stages.timings().to_vec(),
    })
}
