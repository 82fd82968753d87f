//! Scenes traced by random paths.

mod fields;
mod files;
mod picture;
mod saved;

use fredholm_linop::Watch;
use fredholm_montecarlo::light::{Estimator, METHODS, PathTracing, estimator};
use fredholm_montecarlo::{Enclosure, Groups, State};
use fredholm_report::{ResultFolder, RunRecord};
use serde::Serialize;

use self::files::Estimates;
use self::saved::Origin;
use crate::error::{Error, ErrorKind};
use crate::options::{ProblemOptions, SceneSource, SolveSettings};
use crate::solution::{Solution, compute};
use crate::solve::Ended;
use crate::stages::Stages;
use crate::stochastic::{
    FIELD_METHODS, Ground, PathOptions, TraceStop, Tracer, control, controlled, controlling, enclosure,
    faces, with_tracing,
};
use crate::threads;

/// Error that is asked for where nothing is.
const USUAL_ERROR: f64 = 0.01;

/// What is asked of [`trace`].
#[derive(Clone, Debug)]
#[allow(clippy::struct_excessive_bools, reason = "each is a switch of its own")]
pub struct TraceOptions {
    /// Method, one of [`LIGHT_METHODS`] for scenes of light, of [`FIELD_METHODS`] for those of
    /// waves.
    pub method: String,
    /// Whether the scene is solved first and only sampled for what the discretisation missed (path,
    /// walk-gathering).
    pub control: bool,
    /// Samples of every pixel of the picture, traced by itself (path, bidirectional). None: the
    /// picture is one of the elements.
    pub spp: Option<u32>,
    /// Whether no picture is drawn.
    pub no_pictures: bool,
    /// Whether report.html is left out.
    pub no_report: bool,
    /// Whether the run in the folder is gone on with.
    pub go_on: bool,
    /// How paths are made.
    pub paths: PathOptions,
    /// When tracing ends; without anything at a standard error of 1 %, of waves after 65536
    /// samples.
    pub stop: TraceStop,
    /// What decides the size and the effort.
    pub problem: ProblemOptions,
}

impl Default for TraceOptions {
    /// Path tracing.
    fn default() -> Self {
        Self {
            method: "path".to_owned(),
            control: false,
            spp: None,
            no_pictures: false,
            no_report: false,
            go_on: false,
            paths: PathOptions::default(),
            stop: TraceStop::default(),
            problem: ProblemOptions::default(),
        }
    }
}

/// Names of the methods that trace light.
pub const LIGHT_METHODS: &[&str] = &METHODS;

/// A traced scene, whose results are written.
#[derive(Clone, Debug)]
pub struct Traced {
    /// The record of the run.
    pub record: RunRecord,
    /// Seconds of tracing, those of earlier runs included.
    pub seconds: f64,
    /// Points and frequencies of fields; 0 for light.
    pub fields: usize,
}

/// Traces a scene of light, or of waves where the method is one of [`FIELD_METHODS`], and writes
/// the results into a folder.
///
/// # Errors
/// What is wrong with the scene or the options; [`ErrorKind::Resources`] before memory is taken
/// that the limit does not allow; [`ErrorKind::Interrupted`] for a run that was cancelled before it
/// had two batches.
pub fn trace(
    source: impl Into<SceneSource>,
    asked: &TraceOptions,
    folder: &ResultFolder,
    watch: &dyn Watch,
) -> Result<(Traced, Ended), Error> {
    let (source, mut stages) = (source.into(), Stages::new(watch));
    let waves = FIELD_METHODS.contains(&asked.method.as_str());
    let run = if waves { fields::run } else { run };
    run(&source, asked, folder, &mut stages)
}

fn run(
    source: &SceneSource,
    asked: &TraceOptions,
    folder: &ResultFolder,
    stages: &mut Stages,
) -> Result<(Traced, Ended), Error> {
    picture::admit(asked)?;
    let drawn = |scene: &_| picture::drawn(asked, scene);
    let ground = Ground::load(source, &asked.problem, &drawn, stages)?;
    let scene = stages.run("exposure", || enclosure(&ground.scene, &ground.mesh))?;
    let stop = asked.stop.or_to(USUAL_ERROR);
    let origin = Origin::new(asked, ground.scene.sha256(), 0);
    let (state, reason) = traced((source, asked), folder, (&ground, &scene, &origin), &stop, stages)?;
    let estimates = Estimates::new(&ground, &state);
    let tracer = picture::tracer(asked, &ground, &scene, &estimates.view()?.camera)?;
    let watch = stages.watch;
    let pixels = match tracer {
        Some(tracer) if !stages.is_cancelled() => stages.run("picture", || Ok(tracer.trace(watch)))?,
        _ => None,
    };
    let record = estimates.record(&in_force(asked, stop), reason, stages)?;
    let drawn = (!asked.no_pictures, pixels.as_ref(), !asked.no_report);
    stages.run("results", || estimates.write(folder, &origin, drawn, &record))?;
    let ended = if stages.is_cancelled() { Ended::Interrupted } else { Ended::Done };
    Ok((Traced { record, seconds: state.seconds, fields: 0 }, ended))
}

/// The options in force.
#[derive(Debug, Serialize)]
struct InForce<'a> {
    method: &'a str,
    control: bool,
    spp: Option<u32>,
    #[serde(flatten)]
    paths: PathOptions,
    #[serde(flatten)]
    stop: TraceStop,
    threads: usize,
}

fn in_force(asked: &TraceOptions, stop: TraceStop) -> InForce<'_> {
    let threads = threads::count(asked.problem.threads);
    InForce {
        method: &asked.method,
        control: asked.control,
        spp: asked.spp,
        paths: asked.paths,
        stop,
        threads,
    }
}

/// The irradiances, and why their tracing has ended.
fn traced(
    (source, asked): (&SceneSource, &TraceOptions),
    folder: &ResultFolder,
    (ground, scene, origin): (&Ground, &Enclosure, &Origin),
    stop: &TraceStop,
    stages: &mut Stages,
) -> Result<(State, String), Error> {
    let groups = faces(&ground.mesh, scene)?;
    let estimator = method((source, asked), (scene, &groups), stages)?;
    let tracer = Tracer::new(scene, &*estimator, groups, &asked.paths, stop)?;
    let mut state = if asked.go_on { origin.earlier(folder)? } else { tracer.start() };
    stages.begin_saving()?;
    let watch = stages.watch;
    stages.run("tracing", || tracer.run(&mut state, watch))?;
    worth_saving(&state)?;
    let reason = tracer.reason(&state);
    Ok((state, reason))
}

fn method(
    (source, asked): (&SceneSource, &TraceOptions),
    (scene, groups): (&Enclosure, &Groups),
    stages: &Stages,
) -> Result<Box<dyn Estimator>, Error> {
    let patchwise = asked.method == "walk-gathering";
    if !asked.control {
        let found = estimator(&asked.method, scene, asked.paths.switches());
        return found
            .ok_or_else(|| Error::new(ErrorKind::Input, format!("there is no method {}", asked.method)));
    }
    if !patchwise && asked.method != "path" {
        let error = Error::new(ErrorKind::Input, format!("{} takes no control variate", asked.method));
        return Err(error.with_help("--method path, or leave out --control"));
    }
    let known = control(scene, &solution(source, asked, stages)?, patchwise)?;
    if patchwise {
        return Ok(Box::new(PathTracing::patchwise(asked.paths.switches()).with_control(known)));
    }
    Ok(Box::new(controlled(scene, known, groups, &asked.paths, stages.watch)))
}

fn solution(source: &SceneSource, asked: &TraceOptions, stages: &Stages) -> Result<Solution, Error> {
    let mut stages = stages.part("control");
    let problem = controlling(source, &asked.problem, &with_tracing, &mut stages)?;
    let settings = SolveSettings::of_control(problem.options.clone(), problem.scene.solve());
    compute(&problem, &settings, &mut stages)
}

fn worth_saving(state: &State) -> Result<(), Error> {
    if state.batches() < 2 { Err(Error::cancelled()) } else { Ok(()) }
}
