//! `fredholm solve`.

use std::path::{Path, PathBuf};
use std::sync::Arc;

use fredholm_linop::StopReason;
use fredholm_report::{
    Camera, Exposure, Extras, Field, IMAGE, Layer, ReportError, RunRecord, RunReport, View, write_with,
};
use fredholm_scene::Scene;

use crate::args::{ProblemArgs, SolveArgs};
use crate::checkpoint::{self, Checkpoint};
use crate::choice::{Choice, Extent};
use crate::failure::{Ending, Failure};
use crate::memory::{self, Plan};
use crate::options::{Options, ProblemOptions};
use crate::pictures::{Gathered, Source, gathering, pictures};
use crate::prediction::{MESH, Prediction, Size};
use crate::problem::{Problem, scene_failure, with_results};
use crate::record::{record, remarks};
use crate::solution::{Solution, compute};
use crate::stages::Stages;
use crate::start::Start;
use crate::summary::{Lines, quality};
use crate::{hierarchical, output, registry};

/// Pixels of the picture of a partial result.
const QUICK_PIXELS: f64 = 40_000.0;

/// Solves a scene and writes the results.
pub(crate) fn solve(args: &SolveArgs) -> Result<Ending, Failure> {
    solve_from(args, None)
}

/// Solves a scene, from a checkpoint where there is one, and writes the results.
pub(super) fn solve_from(args: &SolveArgs, checkpoint: Option<&Checkpoint>) -> Result<Ending, Failure> {
    let ProblemArgs { scene, threads, memory, .. } = &args.problem;
    let output = args.output.as_ref();
    let start = Start { scene, output, threads: *threads, memory: *memory, log: args.log };
    start.run(|folder, stages| run(args, checkpoint, folder, stages))
}

fn run(
    args: &SolveArgs,
    checkpoint: Option<&Checkpoint>,
    folder: &Path,
    stages: &mut Stages,
) -> Result<Ending, Failure> {
    let (options, problem, solution) = answer(args, checkpoint, folder, stages)?;
    let record = record(&problem, &options, &solution, stages);
    stages.run("results", || write(&problem, &options, &solution, &record, folder))?;
    if !record.partial {
        checkpoint::remove(folder)?;
    }
    // The summary, other than the file, can tell the time of writing.
    let record = RunRecord { timings: stages.timings().to_vec(), ..record };
    remarks(&options, &solution).for_each(|remark| stages.console.warn(&remark));
    conclude(args, folder, &record, stages)?;
    Ok(ending(&solution, stages))
}

/// Reads and solves the scene.
pub(super) fn answer(
    args: &SolveArgs,
    checkpoint: Option<&Checkpoint>,
    folder: &Path,
    stages: &mut Stages,
) -> Result<(Options, Problem, Solution), Failure> {
    let scene = stages.run("scene", || Scene::load(&args.problem.scene).map_err(scene_failure))?;
    let scene = Arc::new(scene);
    // Without points there is nothing to be said of them.
    if let bytes @ 1.. = args.places.bytes(scene.bands().len()) {
        let points = Plan::default().hold("points", bytes);
        points.admit(memory::limit(args.problem.memory), "ask for fewer points")?;
    }
    match args.accuracy.or(scene.solve().accuracy) {
        Some(accuracy) => to_accuracy(args, &scene, (accuracy, checkpoint), folder, stages),
        None if !args.goal.is_empty() => Err(hierarchical::goal_alone()),
        None => dense(args, &scene, folder, stages),
    }
}

/// On the elements of the scene.
fn dense(
    args: &SolveArgs,
    scene: &Arc<Scene>,
    folder: &Path,
    stages: &mut Stages,
) -> Result<(Options, Problem, Solution), Failure> {
    let options = ProblemOptions::new(&args.problem, scene.solve());
    let more = |plan, scene: &Scene, elements| {
        let bands = scene.bands().len();
        let wanted = args.final_gather || args.discontinuity || args.places.bytes(bands) > 0;
        let gathering = if wanted { gathering(elements, bands) + args.places.bytes(bands) } else { 0 };
        with_results(plan, scene, elements, (1 + usize::from(args.final_gather), gathering))
    };
    let problem = Problem::refined(Arc::clone(scene), options, (1, &more), stages)?;
    let options = Options::new(problem.options.clone(), args.stop, scene.solve(), folder, args.log);
    let points = args.places.receivers();
    let SolveArgs { final_gather, discontinuity, no_pictures, no_report, .. } = *args;
    let options = Options { points, final_gather, discontinuity, no_pictures, no_report, ..options };
    let solution = compute(&problem, &options, stages)?;
    Ok((options, problem, solution))
}

/// To an accuracy, the way that costs less.
fn to_accuracy(
    args: &SolveArgs,
    scene: &Arc<Scene>,
    (accuracy, checkpoint): (f64, Option<&Checkpoint>),
    folder: &Path,
    stages: &mut Stages,
) -> Result<(Options, Problem, Solution), Failure> {
    hierarchical::refuse_dense(&ProblemOptions::new(&args.problem, scene.solve()))?;
    let mut choice = None;
    if checkpoint.is_none() {
        let predicted = predicted(args, scene, accuracy)?;
        choice = Some(predicted);
        if predicted.is_matrix() {
            match on_matrix(args, scene, (accuracy, predicted), folder, stages)? {
                Ok(solved) => return Ok(solved),
                Err(stated) => choice = Some(Choice::TooCoarse { stated }),
            }
        }
    }
    let options = hierarchical::options(args, scene, accuracy, folder)?;
    let options = Options { choice: choice.map(|choice| choice.to_string()), ..options };
    let (problem, solution) = hierarchical::compute(scene, &options, (accuracy, checkpoint), stages)?;
    Ok((options, problem, solution))
}

/// The way that is predicted to cost less.
fn predicted(args: &SolveArgs, scene: &Scene, accuracy: f64) -> Result<Choice, Failure> {
    if !args.goal.is_empty() {
        return Ok(Choice::Goal);
    }
    let elements = scene.predicted_elements() as f64;
    if elements >= Choice::most_elements(accuracy) {
        // Whatever the faces: as many as there are elements, they have the most links.
        return Ok(Choice::new(Extent { elements, faces: elements, fewest: 1 }, accuracy));
    }
    let options = ProblemOptions::new(&args.problem, scene.solve());
    let meshed = Plan::default().hold("the mesh", MESH.saturating_mul(scene.predicted_elements()));
    if !meshed.fits(options.memory_limit()) {
        return Ok(Choice::Memory);
    }
    let mesh = scene.mesh().map_err(scene_failure)?;
    let count = mesh.faces().len();
    let fewest = (0..count).map(|face| mesh.leaves_of_face(face).len()).min().unwrap_or(0);
    let choice = Choice::new(Extent { elements: mesh.len() as f64, faces: count as f64, fewest }, accuracy);
    let fits = fits(&options, mesh.len(), scene.bands().len());
    Ok(if choice.is_matrix() && !fits { Choice::Memory } else { choice })
}

/// Whether the matrix of some elements fits the memory.
fn fits(options: &ProblemOptions, elements: usize, bands: usize) -> bool {
    let size = Size { elements, unknowns: elements, dense: None };
    registry::find(&options.solver).is_some_and(|solver| {
        Prediction::new(size, bands, options.storage, &solver).plan().fits(options.memory_limit())
    })
}

/// A solution, or the error that it states where that is too large.
type Trial = Result<(Options, Problem, Solution), Option<f64>>;

/// On the elements of the scene, where the error that is stated then is within an accuracy.
fn on_matrix(
    args: &SolveArgs,
    scene: &Arc<Scene>,
    (accuracy, choice): (f64, Choice),
    folder: &Path,
    stages: &mut Stages,
) -> Result<Trial, Failure> {
    let (options, problem, solution) = dense(args, scene, folder, stages)?;
    let stated = solution.mesh_error.as_ref();
    let stated = stated.and_then(|error| error.relative_l2.iter().copied().reduce(f64::max));
    let partial = solution.report.reason != StopReason::Converged;
    if !partial && stated.is_none_or(|error| error > accuracy) {
        return Ok(Err(stated));
    }
    let choice = Some(choice.to_string());
    Ok(Ok((Options { accuracy: Some(accuracy), choice, ..options }, problem, solution)))
}

fn write(
    problem: &Problem,
    options: &Options,
    solution: &Solution,
    record: &RunRecord,
    folder: &Path,
) -> Result<Vec<PathBuf>, Failure> {
    let exitance = problem.scene.exitance(&problem.mesh);
    let (irradiance, radiosity) = (solution.means.irradiance.as_slice(), solution.means.radiosity.as_slice());
    let field = Field::new(&problem.mesh, &record.bands, irradiance, radiosity)
        .and_then(|field| field.with_exitance(&exitance))
        .and_then(|field| field.with_exposed(&solution.exposed))
        .map_err(report_failure)?;
    let view = view_of(problem.scene.camera(), &field);
    let view = if record.partial { quick(view) } else { view };
    let source = Source::new(problem, options, solution)?;
    let (links, gathered) = (|element| source.linked(element), source.gather(options)?);
    let layer = |name| match (name, &gathered) {
        ("mesh.png", _) => Layer::Elements,
        ("links.png", _) => Layer::Links(&links),
        (_, Some(gathered)) => Layer::Gathered(gathered),
        _ => Layer::Field,
    };
    let pictures = pictures(options, solution).map(|name| (name, layer(name))).collect();
    let points = gathered.as_ref().map(|gathered| gathered.points(options)).transpose()?.flatten();
    let shadows = gathered.as_ref().filter(|_| options.discontinuity).map(Gathered::shadows);
    let title = title(&problem.scene);
    let report = (!options.no_report).then_some(RunReport { title: &title, view: &view, steps: ("", &[]) });
    let view = (!options.no_pictures).then_some(&view);
    let extras = Extras { pictures, points, shadows, report };
    write_with(folder, &field, record, view, &extras).map_err(report_failure)
}

/// The title of the scene, or the name of its file.
pub(super) fn title(scene: &Scene) -> String {
    let name = || scene.path().file_stem().map(|stem| stem.to_string_lossy().into_owned());
    scene.title().map(str::to_owned).or_else(name).unwrap_or_default()
}

/// The scene's camera, or one that sees all of it.
pub(super) fn view_of(camera: Option<&fredholm_scene::Camera>, field: &Field) -> View {
    let Some(camera) = camera else { return View::framing(field) };
    let exposure = camera.exposure.map_or(Exposure::Auto, Exposure::Fixed);
    View { camera: view_camera(camera), exposure }
}

pub(super) fn view_camera(camera: &fredholm_scene::Camera) -> Camera {
    Camera {
        eye: camera.eye,
        target: camera.target,
        up: camera.up,
        vertical_fov_degrees: camera.vertical_fov_degrees,
        width: camera.width,
        height: camera.height,
    }
}

/// The view in few pixels: whoever has pressed Ctrl-C does not wait for a large picture.
fn quick(view: View) -> View {
    let Camera { width, height, .. } = view.camera;
    let scale = (QUICK_PIXELS / (f64::from(width) * f64::from(height))).sqrt().min(1.0);
    let scaled = |side: u32| ((f64::from(side) * scale) as u32).max(1);
    View { camera: Camera { width: scaled(width), height: scaled(height), ..view.camera }, ..view }
}

pub(super) fn report_failure(error: ReportError) -> Failure {
    let ending = match error {
        ReportError::Write { .. } => Ending::Files,
        ReportError::NotFinite { .. } => Ending::NotConverged,
        _ => Ending::Input,
    };
    Failure::new(ending, error)
}

/// Says what came of it.
fn conclude(args: &SolveArgs, folder: &Path, record: &RunRecord, stages: &Stages) -> Result<(), Failure> {
    if stages.interrupt.requested() && !record.partial {
        stages.console.warn("interrupted when the solution was there: the results are complete all the same");
    }
    if args.log.quiet { Ok(()) } else { summarise(folder, record) }
}

fn summarise(folder: &Path, record: &RunRecord) -> Result<(), Failure> {
    let mut lines = Lines::default();
    let picture = record.files.iter().any(|name| name == IMAGE);
    lines.add_some("picture", picture.then(|| folder.join(IMAGE).display().to_string()));
    quality(record, &mut lines);
    output::print(&lines.under(&format!("{} → {}", record.scene, folder.display())))
}

fn ending(solution: &Solution, stages: &Stages) -> Ending {
    match solution.report.reason {
        _ if stages.interrupt.requested() => Ending::Interrupted,
        StopReason::Converged if solution.is_accurate() => Ending::Done,
        StopReason::Interrupted => Ending::Interrupted,
        _ => Ending::NotConverged,
    }
}
