//! Reference values with stated errors, to check other tracers with.

use fredholm_linop::Watch;
use fredholm_montecarlo::State;
use fredholm_montecarlo::light::PathTracing;
use fredholm_report::{REFERENCE_FORMAT, ReferenceRecord, ReferenceTable, ResultFolder, write_reference};
use fredholm_scene::{ExportFormat, Scene};

use crate::error::Error;
use crate::exchange::{outline, write};
use crate::options::{ProblemOptions, SceneSource, SolveSettings, StopOptions};
use crate::problem::{Problem, with_results};
use crate::solution::{Solution, compute};
use crate::solve::report_failure;
use crate::stages::Stages;
use crate::stochastic::{
    PathOptions, TraceStop, Tracer, control, enclosure, expected_error, face_means, faces, with_tracing,
};

/// Error that is asked for where nothing is.
const ERROR: f64 = 0.002;
/// Error of a row of form factors where neither the caller nor the scene asks for one: small beside
/// what is compared.
const FORM_FACTORS: f64 = 1e-5;

/// What is asked of [`reference()`].
#[derive(Clone, Debug, Default)]
pub struct ReferenceOptions {
    /// How paths are made.
    pub paths: PathOptions,
    /// When tracing ends; without anything at a standard error of 0.2 %.
    pub stop: TraceStop,
    /// What decides the size and the effort; form factors are computed to 1e-5 where nothing is
    /// said.
    pub problem: ProblemOptions,
}

/// Reference values, which are written.
#[derive(Clone, Debug)]
pub struct References {
    /// The record of the run.
    pub record: ReferenceRecord,
    /// Number of faces.
    pub faces: usize,
}

/// Solves a scene, traces it with the solution as control variate, and writes the irradiance of
/// every face with its stated error into a folder, with the scene for Mitsuba 3 and pbrt-v4 where
/// its bands are colours or grey.
///
/// # Errors
/// What is wrong with the scene or the options; [`Resources`](crate::ErrorKind::Resources) before
/// memory is taken that the limit does not allow; [`Interrupted`](crate::ErrorKind::Interrupted)
/// for a run that was cancelled.
pub fn reference(
    source: impl Into<SceneSource>,
    asked: &ReferenceOptions,
    folder: &ResultFolder,
    watch: &dyn Watch,
) -> Result<References, Error> {
    let mut stages = Stages::new(watch).part("reference");
    let (problem, settings) = load(&source.into(), &asked.problem, &mut stages)?;
    let solution = compute(&problem, &settings, &mut stages)?;
    let state = traced(asked, &problem, &solution, &mut stages)?;
    let table = table(&problem, &solution, &state);
    let record = record(&problem, &table, &state, &stages);
    scenes(&problem, folder)?;
    write_reference(folder, &problem.mesh, &table, &record).map_err(report_failure)?;
    Ok(References { record, faces: problem.mesh.faces().len() })
}

/// Writes the scene for Mitsuba 3 and pbrt-v4, where its bands are colours or grey.
fn scenes(problem: &Problem, folder: &ResultFolder) -> Result<(), Error> {
    let Ok(outline) = outline(&problem.scene, None) else { return Ok(()) };
    for format in [ExportFormat::Mitsuba, ExportFormat::Pbrt] {
        write(&outline, format, folder, "scene")?;
    }
    Ok(())
}

/// The problem, with form factors more exact than for a picture.
fn load(
    source: &SceneSource,
    asked: &ProblemOptions,
    stages: &mut Stages,
) -> Result<(Problem, SolveSettings), Error> {
    let more = |plan, scene: &Scene, n| with_results(with_tracing(plan, scene, n), scene, n, (1, 0));
    let mut problem = Problem::load(source, asked, &more, stages)?;
    let tolerance = asked.form_factor_tolerance.or(problem.scene.solve().form_factor_tolerance);
    problem.options.form_factor_tolerance = tolerance.unwrap_or(FORM_FACTORS);
    let (settings, scene) = (problem.options.clone(), problem.scene.solve());
    let settings = SolveSettings::new(settings, StopOptions::default(), scene);
    Ok((problem, settings))
}

fn traced(
    asked: &ReferenceOptions,
    problem: &Problem,
    solution: &Solution,
    stages: &mut Stages,
) -> Result<State, Error> {
    let scene = enclosure(&problem.scene, &problem.mesh)?;
    let known = control(&scene, solution, false)?;
    let method = PathTracing::continuous(asked.paths.switches()).with_control(known);
    let stop = asked.stop.or_to(ERROR);
    let tracer = Tracer::new(&scene, &method, faces(&problem.mesh, &scene)?, &asked.paths, &stop)?;
    let mut state = tracer.start();
    let watch = stages.watch;
    stages.run("tracing", || tracer.run(&mut state, watch))?;
    if stages.is_cancelled() { Err(Error::cancelled()) } else { Ok(state) }
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
        deterministic: face_means(problem, solution),
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
