//! `fredholm reference`.

use std::path::{Path, PathBuf};

use clap::Args;
use fredholm_montecarlo::State;
use fredholm_montecarlo::light::PathTracing;
use fredholm_report::{REFERENCE_FORMAT, ReferenceRecord, ReferenceTable, write_reference};

use super::crosscheck::{deterministic, load};
use super::solve::report_failure;
use crate::args::{LogArgs, ProblemArgs};
use crate::failure::{Ending, Failure};
use crate::interrupt::nothing_saved;
use crate::output;
use crate::problem::Problem;
use crate::solution::{Solution, compute};
use crate::stages::Stages;
use crate::start::Start;
use crate::stochastic::{PathArgs, TraceStopArgs, Tracer, control, enclosure, expected_error, faces};
use crate::summary::Lines;

/// Error that is asked for where nothing is.
const ERROR: f64 = 0.002;

/// What follows the help of `reference`.
pub(crate) const EXAMPLES: &str = "\
Examples:
  fredholm reference scenes/cornell_planar.toml -o out/reference
  fredholm reference room.toml --to 0.1% -o reference --form-factor-tolerance 1e-7

The irradiance of every face by path tracing, with the deterministic solution as control
variate: what remains are the standard error and the error of the form factors, both stated.
Written are reference.csv, patches.obj, and reference.json last, which says what the columns mean.
Ctrl-C ends the run with nothing written.";

/// Options of `reference`.
#[derive(Clone, Debug, Args)]
pub(crate) struct ReferenceArgs {
    /// Folder for the bundle [default: out/<name of the scene file>]
    #[arg(long, short, value_name = "DIR")]
    pub(crate) output: Option<PathBuf>,
    #[command(flatten)]
    pub(crate) paths: PathArgs,
    #[command(flatten)]
    pub(crate) stop: TraceStopArgs,
    #[command(flatten)]
    pub(crate) problem: ProblemArgs,
    #[command(flatten)]
    pub(crate) log: LogArgs,
}

/// Solves, traces and writes the bundle.
pub(crate) fn reference(args: &ReferenceArgs) -> Result<Ending, Failure> {
    let start = Start {
        scene: &args.problem.scene,
        output: args.output.as_ref(),
        threads: args.problem.threads,
        memory: args.problem.memory,
        log: args.log,
    };
    start.run_whole("reference", |folder, stages| run(args, folder, stages))
}

fn run(args: &ReferenceArgs, folder: &Path, stages: &mut Stages) -> Result<Ending, Failure> {
    let (problem, options) = load(&args.problem, args.log, folder, stages)?;
    let solution = compute(&problem, &options, stages)?;
    let state = traced(args, &problem, &solution, stages)?;
    let table = table(&problem, &solution, &state);
    let record = record(&problem, &table, &state, stages);
    write_reference(folder, &problem.mesh, &table, &record).map_err(report_failure)?;
    if !args.log.quiet {
        let mut lines = Lines::default();
        lines.add("values", format!("{} faces, {} bands", problem.mesh.faces().len(), record.bands.len()));
        lines.add("stated error", format!("{:.3} % (RMS over faces)", 100.0 * record.relative_error));
        lines.add("time", crate::summary::times(&record.timings));
        output::print(&lines.under(&format!("{} → {}", record.scene, folder.display())))?;
    }
    Ok(Ending::Done)
}

fn traced(
    args: &ReferenceArgs,
    problem: &Problem,
    solution: &Solution,
    stages: &mut Stages,
) -> Result<State, Failure> {
    let scene = enclosure(&problem.scene, &problem.mesh)?;
    let known = control(&scene, solution, false)?;
    let method = PathTracing::continuous(args.paths.switches()).with_control(known);
    let TraceStopArgs { samples, seconds, to } = args.stop;
    let nothing = samples.is_none() && seconds.is_none() && to.is_none();
    let stop = TraceStopArgs { to: if nothing { Some(ERROR) } else { to }, ..args.stop };
    let tracer = Tracer::new(&scene, &method, faces(&problem.mesh, &scene)?, &args.paths, &stop)?;
    let mut state = tracer.start();
    let watched = Stages::part(stages.console, stages.interrupt, "reference");
    stages.run("tracing", || tracer.run(&mut state, &watched))?;
    if stages.interrupt.requested() { Err(nothing_saved()) } else { Ok(state) }
}

fn table(problem: &Problem, solution: &Solution, state: &State) -> ReferenceTable {
    let factors = expected_error(problem, solution, false);
    let (mesh, scene) = (&problem.mesh, &problem.scene);
    let error = state.groups.standard_errors().iter().zip(&factors).map(|(s, f)| s.hypot(*f)).collect();
    let material = |face: usize| &scene.materials()[mesh.surfaces()[mesh.faces()[face].surface].material];
    let all = || 0..mesh.faces().len();
    ReferenceTable {
        irradiance: state.groups.mean().to_vec(),
        error,
        deterministic: deterministic(problem, solution),
        reflectance: all().flat_map(|face| material(face).reflectance.clone()).collect(),
        exitance: all().flat_map(|face| material(face).exitance.clone()).collect(),
    }
}

fn record(problem: &Problem, table: &ReferenceTable, state: &State, stages: &Stages) -> ReferenceRecord {
    let conventions = [
        "lengths in m; irradiance E, radiosity B and exitance M in W/m²; an emitter has the radiance M/π",
        "faces are Lambertian, and lit on the side from which their corners run counter-clockwise",
        "E is the mean over the whole face; what is buried under an object counts as 0",
        "E_error is one standard deviation of all known errors: standard error and form factors",
    ];
    let shares = table.irradiance.iter().zip(&table.error).filter(|(e, _)| **e > 0.0);
    let (sum, count) = shares.fold((0.0, 0.0), |(sum, n), (e, s)| (sum + (s / e).powi(2), n + 1.0));
    ReferenceRecord {
        format: REFERENCE_FORMAT.to_owned(),
        version: env!("CARGO_PKG_VERSION").to_owned(),
        scene: problem.scene.path().display().to_string(),
        scene_sha256: problem.scene.sha256().to_owned(),
        conventions: conventions.map(str::to_owned).to_vec(),
        method: "path tracing, the deterministic solution as control variate".to_owned(),
        bands: problem.scene.bands().to_vec(),
        relative_error: if count > 0.0 { f64::sqrt(sum / count) } else { 0.0 },
        form_factor_tolerance: problem.options.form_factor_tolerance,
        seed: state.seed,
        batches: state.batches(),
        timings: stages.timings().to_vec(),
    }
}
