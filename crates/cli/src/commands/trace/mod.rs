//! `fredholm trace`.

mod fields;
mod files;
mod picture;
mod saved;

use std::path::{Path, PathBuf};

use clap::Args;
use clap::builder::PossibleValuesParser;
use fredholm_montecarlo::light::{Estimator, METHODS, PathTracing, estimator};
use fredholm_montecarlo::{Enclosure, State};
use serde::Serialize;

use self::files::Estimates;
use self::saved::Origin;
use crate::args::{LogArgs, ProblemArgs};
use crate::failure::{Ending, Failure};
use crate::options::{Options, ProblemOptions};
use crate::problem::Problem;
use crate::solution::compute;
use crate::stages::Stages;
use crate::start::Start;
use crate::stochastic::{
    FIELD_METHODS, Ground, PathArgs, TraceStopArgs, Tracer, control, enclosure, faces, with_tracing,
};
use crate::summary::Lines;
use crate::{output, threads};

/// Error that is asked for where nothing is.
const ERROR: f64 = 0.01;

/// What follows the help of `trace`.
pub(crate) const EXAMPLES: &str = "\
Examples:
  fredholm trace scenes/cornell_planar.toml --method path --to 1% -o out/traced
  fredholm trace room.toml --method jacobi --seconds 30
  fredholm trace room.toml --method path --control --samples 256
  fredholm trace room.toml --method bidirectional --to 5% --spp 256
  fredholm trace scenes/waves/plate.toml --method surface-sampling --to 1%
  fredholm trace room.toml --method light --to 0.5% -o out/traced --continue

All methods estimate the irradiance of the elements, with standard errors between batches.
Methods that gather (path, bidirectional, photon, walk-gathering) start at every element, the
others (light, walk-shooting, jacobi) at the lamps. walk-gathering, walk-shooting and jacobi
estimate what `solve` solves, constants on elements; the others the continuous equation. Written
are faces.csv with standard errors, image.png, trace.json, which --continue reads, and run.json
last. Ctrl-C keeps what is there by then. Without --samples, --seconds and --to it is --to 1%.
With --spp image.png is traced pixel by pixel, and pixels.npz has the standard error of each.

surface-sampling, field-particles and amplitude-particles sample the scattered field of a scene of
waves, one bounce or two, with shadow = \"geometric\"; written are receivers.csv, trace.json and
run.json. Without --samples, --seconds and --to they draw 65536 samples.";

/// Options of `trace`.
#[derive(Clone, Debug, Args)]
pub(crate) struct TraceArgs {
    /// Method
    #[arg(long, value_name = "NAME", default_value = "path", value_parser = PossibleValuesParser::new(METHODS.into_iter().chain(FIELD_METHODS)))]
    pub(crate) method: String,
    /// Folder for the results [default: out/<name of the scene file>]
    #[arg(long, short, value_name = "DIR")]
    pub(crate) output: Option<PathBuf>,
    /// Solve the scene first and sample only what the discretisation missed (path, walk-gathering)
    #[arg(long)]
    pub(crate) control: bool,
    /// Trace every pixel of the picture by itself, with at least so many samples (path, bidirectional)
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u32).range(1..=1 << 20))]
    pub(crate) spp: Option<u32>,
    /// Draw no picture
    #[arg(long, conflicts_with = "spp")]
    pub(crate) no_pictures: bool,
    /// Go on with the run in the folder
    #[arg(long = "continue")]
    pub(crate) go_on: bool,
    #[command(flatten)]
    pub(crate) paths: PathArgs,
    #[command(flatten)]
    pub(crate) stop: TraceStopArgs,
    #[command(flatten)]
    pub(crate) problem: ProblemArgs,
    #[command(flatten)]
    pub(crate) log: LogArgs,
}

/// The options in force.
#[derive(Debug, Serialize)]
struct InForce<'a> {
    method: &'a str,
    control: bool,
    spp: Option<u32>,
    #[serde(flatten)]
    paths: PathArgs,
    #[serde(flatten)]
    stop: TraceStopArgs,
    threads: usize,
}

/// Traces a scene and writes the results.
pub(crate) fn trace(args: &TraceArgs) -> Result<Ending, Failure> {
    let start = Start {
        scene: &args.problem.scene,
        output: args.output.as_ref(),
        threads: args.problem.threads,
        memory: args.problem.memory,
        log: args.log,
    };
    let waves = FIELD_METHODS.contains(&args.method.as_str());
    let run = if waves { fields::run } else { run };
    start.run(|folder, stages| run(args, folder, stages))
}

fn run(args: &TraceArgs, folder: &Path, stages: &mut Stages) -> Result<Ending, Failure> {
    picture::admit(args)?;
    let ground = Ground::load(&args.problem, &|scene| picture::drawn(args, scene), stages)?;
    let scene = stages.run("exposure", || enclosure(&ground.scene, &ground.mesh))?;
    let stop = args.stop.or_to(ERROR);
    let origin = Origin::new(args, ground.scene.sha256(), 0);
    let (state, reason) = traced(args, folder, (&ground, &scene, &origin), &stop, stages)?;
    let estimates = Estimates::new(&ground, &state);
    let tracer = picture::Tracer::new(args, &ground, &scene, &estimates.view()?.camera)?;
    let watched = Stages::new(stages.console, stages.interrupt);
    let pixels = match tracer {
        Some(tracer) if !stages.interrupt.requested() => {
            stages.run("picture", || Ok(tracer.trace(&watched)))?
        }
        _ => None,
    };
    let record = files::record(&ground, &state, &in_force(args, stop), reason, stages);
    stages
        .run("results", || estimates.write(folder, &origin, (!args.no_pictures, pixels.as_ref()), &record))?;
    if !args.log.quiet {
        summarise(folder, !args.no_pictures, &state, &record.stop_reason)?;
    }
    Ok(if stages.interrupt.requested() { Ending::Interrupted } else { Ending::Done })
}

fn in_force(args: &TraceArgs, stop: TraceStopArgs) -> InForce<'_> {
    let threads = threads::count(args.problem.threads);
    InForce { method: &args.method, control: args.control, spp: args.spp, paths: args.paths, stop, threads }
}

/// The irradiances, and why their tracing has ended.
fn traced(
    args: &TraceArgs,
    folder: &Path,
    (ground, scene, origin): (&Ground, &Enclosure, &Origin),
    stop: &TraceStopArgs,
    stages: &mut Stages,
) -> Result<(State, String), Failure> {
    let estimator = method(args, scene, stages)?;
    let tracer = Tracer::new(scene, &*estimator, faces(&ground.mesh, scene)?, &args.paths, stop)?;
    let mut state = if args.go_on { origin.earlier(folder)? } else { tracer.start() };
    stages.begin_saving()?;
    let watched = Stages::new(stages.console, stages.interrupt);
    stages.run("tracing", || tracer.run(&mut state, &watched))?;
    worth_saving(&state)?;
    let reason = tracer.reason(&state);
    Ok((state, reason))
}

fn method(args: &TraceArgs, scene: &Enclosure, stages: &Stages) -> Result<Box<dyn Estimator>, Failure> {
    let patchwise = args.method == "walk-gathering";
    if !args.control {
        let found = estimator(&args.method, scene, args.paths.switches());
        return found
            .ok_or_else(|| Failure::new(Ending::Input, format!("there is no method {}", args.method)));
    }
    if !patchwise && args.method != "path" {
        let text = format!(
            "{} takes no control variate\n  help: --method path, or leave out --control",
            args.method
        );
        return Err(Failure::new(Ending::Input, text));
    }
    let known = control(scene, &solution(args, stages)?, patchwise)?;
    let switches = args.paths.switches();
    let tracing =
        if patchwise { PathTracing::patchwise(switches) } else { PathTracing::continuous(switches) };
    Ok(Box::new(tracing.with_control(known)))
}

fn solution(args: &TraceArgs, stages: &Stages) -> Result<crate::solution::Solution, Failure> {
    let mut stages = Stages::part(stages.console, stages.interrupt, "control");
    let problem = Problem::load(&args.problem, &with_tracing, &mut stages)?;
    let options = options(args, &problem.options, &problem);
    compute(&problem, &options, &mut stages)
}

fn options(args: &TraceArgs, options: &ProblemOptions, problem: &Problem) -> Options {
    let stop = crate::args::StopArgs { tolerance: None, max_iterations: None };
    Options::new(options.clone(), stop, problem.scene.solve(), Path::new(""), args.log)
}

fn worth_saving(state: &State) -> Result<(), Failure> {
    if state.batches() < 2 { Err(crate::interrupt::nothing_saved()) } else { Ok(()) }
}

fn summarise(folder: &Path, drawn: bool, state: &State, reason: &str) -> Result<(), Failure> {
    let mut lines = Lines::default();
    lines.add_some("picture", drawn.then(|| folder.join("image.png").display().to_string()));
    let (batches, samples) = (state.batches(), state.samples);
    lines.add(
        "samples",
        format!("{batches} batches of {samples}, {} paths, {} rays", state.paths, state.rays),
    );
    lines.add("result", reason);
    lines.add("time", format!("{:.2} s of tracing", state.seconds));
    output::print(&lines.under(&format!("{} → {}", state.method, folder.display())))
}
