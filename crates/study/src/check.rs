//! What a scene and its mesh are, and what its solution will take; nothing is solved.

use std::sync::Arc;

use fredholm_linop::Watch;
use fredholm_report::{Back, Camera, Field, ResultFolder, Side, sides_map};
use fredholm_scene::{Report, Scene};

use crate::error::{Error, ErrorKind};
use crate::hierarchical;
use crate::memory::{Limit, Plan, limit};
use crate::options::{ProblemOptions, ProblemSettings, SceneSource, SolveOptions};
use crate::prediction::pictured;
use crate::problem::{Problem, pictures, pixels, scene_failure, with_results};
use crate::rays;
use crate::rounds;
use crate::sample;
use crate::solve::{accuracy_of, predicted, report_failure, view_camera};
use crate::stages::Stages;

/// A valid scene, its mesh, and what its solution will take.
pub struct Checked {
    /// The scene.
    pub scene: Arc<Scene>,
    /// What its mesh is.
    pub report: Report,
    /// What a solution on the elements of the scene will take, or why its matrix does not fit.
    pub forecast: Result<Forecast, Error>,
    /// What a solution to an accuracy will take, where one is asked for.
    pub to_accuracy: Option<ToAccuracy>,
}

/// What a solution to an accuracy will take.
#[derive(Clone, Debug)]
pub struct ToAccuracy {
    /// The accuracy.
    pub accuracy: f64,
    /// How it is reached, and why.
    pub way: String,
    /// Whether that is the matrix of the scene's elements, whose forecast holds then.
    pub by_matrix: bool,
    /// Memory by use, of links as many as are to be expected.
    pub plan: Option<Plan>,
    /// Seconds that everything takes one thread, from its first rounds; none where these are too
    /// long to be tried, and by the matrix.
    pub seconds: Option<f64>,
    /// Threads.
    pub threads: usize,
}

impl Checked {
    /// Seconds that the solution takes one thread, where they are known.
    #[must_use]
    pub fn seconds(&self) -> Option<f64> {
        match &self.to_accuracy {
            Some(found) if !found.by_matrix => found.seconds,
            _ => self.forecast.as_ref().ok()?.seconds,
        }
    }
}

/// What a solution will take.
#[derive(Clone, Debug)]
pub struct Forecast {
    /// Elements.
    pub elements: usize,
    /// Faces.
    pub faces: usize,
    /// Surfaces.
    pub surfaces: usize,
    /// Flat pieces that block the view.
    pub occluders: usize,
    /// Unknowns in each band.
    pub unknowns: usize,
    /// The discretisation in force.
    pub discretisation: String,
    /// The solver in force.
    pub solver: String,
    /// Threads.
    pub threads: usize,
    /// Memory by use.
    pub plan: Plan,
    /// Memory allowed.
    pub limit: Limit,
    /// Seconds that everything takes one thread, from samples of its parts; none for other
    /// discretisations.
    pub seconds: Option<f64>,
    /// Warnings about the scene.
    pub warnings: Vec<String>,
}

/// Validates a scene, tells what its mesh is, draws it by its sides where `picture` names a file,
/// and predicts what its solution will take, to `accuracy` or that of the scene where there is one.
///
/// # Errors
/// What is wrong with the scene; [`ErrorKind::Files`] for a picture that cannot be written. A
/// matrix that does not fit the memory is no error, but what was asked.
pub fn check(
    source: impl Into<SceneSource>,
    asked: (&ProblemOptions, Option<f64>),
    picture: Option<(&ResultFolder, &str)>,
    watch: &dyn Watch,
) -> Result<Checked, Error> {
    check_scene(&source.into(), asked, picture, watch)
}

/// [`check`], compiled once and not for each kind of source.
fn check_scene(
    source: &SceneSource,
    (asked, accuracy): (&ProblemOptions, Option<f64>),
    picture: Option<(&ResultFolder, &str)>,
    watch: &dyn Watch,
) -> Result<Checked, Error> {
    let mut stages = Stages::new(watch);
    let scene = source.load(asked.memory, &mut stages)?;
    let report = stages.run("report", || Ok(scene.report()))?;
    if let Some((folder, name)) = picture {
        let plan = Plan::default().stage("the picture", pictured(pixels(&scene), 1));
        stages.admit(
            &plan,
            limit(asked.memory),
            "ask for a smaller picture (width, height of the camera)",
        )?;
        stages.run("picture", || draw(&scene, &report, (folder, name)))?;
    }
    let to_accuracy = to_accuracy(asked, accuracy, &scene, &mut stages)?;
    let settings = ProblemSettings::new(asked, scene.solve());
    let more =
        |plan, scene: &Scene, n| with_results(plan, scene, n, (pictures(scene, 1, (false, (0, false))), 0));
    let forecast = match Problem::refined(Arc::clone(&scene), settings, (1, &more), &mut stages) {
        Err(error) if error.kind() == ErrorKind::Resources => Err(error),
        loaded => {
            let sampled = to_accuracy.as_ref().is_none_or(|found| found.by_matrix);
            Ok(forecast(loaded?, sampled, &mut stages)?)
        }
    };
    Ok(Checked { scene, report, forecast, to_accuracy })
}

/// What a solution to the accuracy asked for will take.
fn to_accuracy(
    asked: &ProblemOptions,
    accuracy: Option<f64>,
    scene: &Arc<Scene>,
    stages: &mut Stages,
) -> Result<Option<ToAccuracy>, Error> {
    let asked = SolveOptions { accuracy, problem: asked.clone(), ..SolveOptions::default() };
    let Some(accuracy) = accuracy_of(&asked, scene)? else { return Ok(None) };
    hierarchical::refuse_dense(&ProblemSettings::new(&asked.problem, scene.solve()))?;
    let choice = predicted(&asked, scene, accuracy)?;
    let (way, by_matrix) = (choice.to_string(), choice.is_matrix());
    let threads = rayon::current_num_threads();
    if by_matrix {
        return Ok(Some(ToAccuracy { accuracy, way, by_matrix, plan: None, seconds: None, threads }));
    }
    let settings = hierarchical::options(&asked, scene, accuracy)?;
    let run = (accuracy, choice.is_rays());
    let watch = stages.watch;
    let expected = stages.run("sample", || Ok(rounds::expected(scene, &settings, run, watch)))?;
    stages.check()?;
    let plan = if choice.is_rays() {
        rays::expected_plan(scene, &settings, accuracy)?
    } else {
        hierarchical::expected_plan(scene, &settings, accuracy, expected.sizes)
    };
    let plan = Some(plan);
    Ok(Some(ToAccuracy { accuracy, way, by_matrix, plan, seconds: expected.seconds, threads }))
}

fn forecast(problem: Problem, sampled: bool, stages: &mut Stages) -> Result<Forecast, Error> {
    // The sample is one of pairs of elements.
    let seconds = if sampled && problem.is_radiosity() {
        Some(stages.run("sample", || Ok(sample::seconds(&problem)))?)
    } else {
        None
    };
    let Problem { options, mesh, unknowns, plan, warnings, .. } = problem;
    Ok(Forecast {
        elements: mesh.len(),
        faces: mesh.faces().len(),
        surfaces: mesh.surfaces().len(),
        occluders: mesh.occluders().len(),
        unknowns,
        limit: options.memory_limit(),
        discretisation: options.discretisation,
        solver: options.solver,
        threads: options.threads,
        plan,
        seconds,
        warnings,
    })
}

/// Draws the mesh by its sides.
fn draw(scene: &Scene, found: &Report, (folder, name): (&ResultFolder, &str)) -> Result<(), Error> {
    let camera = match scene.camera() {
        Some(camera) => view_camera(camera),
        None => framing(scene)?,
    };
    let side = |shown: &fredholm_scene::Shown| {
        let back = match (shown.wall, shown.two_sided) {
            (true, _) => Back::Hidden,
            (false, true) => Back::Lit,
            (false, false) => Back::Dark,
        };
        Side { patch: shown.patch, back, marked: shown.meets }
    };
    let sides: Vec<Side> = found.shown.iter().map(side).collect();
    let picture = sides_map(
        &sides,
        (&found.open, "open sides"),
        &camera,
        (scene.title().unwrap_or("The mesh"), "pieces that lie on others or cross them"),
    );
    let picture = picture.map_err(report_failure)?;
    folder.write(name, |out| picture.write_png(out)).map(drop).map_err(report_failure)
}

/// A camera that sees the whole scene.
pub(crate) fn framing(scene: &Scene) -> Result<Camera, Error> {
    let mesh = scene.face_mesh().map_err(scene_failure)?;
    let (bands, zero) = (["grey".to_owned()], vec![0.0; mesh.len()]);
    let lamps = scene.exitance(&mesh);
    let emits: Vec<f64> = lamps.chunks_exact(scene.bands().len()).map(|lamp| lamp.iter().sum()).collect();
    let field = Field::new(&mesh, &bands, &zero, &zero).and_then(|field| field.with_exitance(&emits));
    Ok(Camera::framing(&field.map_err(report_failure)?))
}
