//! What a scene and its mesh are, and what its solution will take; nothing is solved.

use std::sync::Arc;

use fredholm_linop::Watch;
use fredholm_report::{Back, Camera, Field, ResultFolder, Side, render_sides};
use fredholm_scene::{Report, Scene};

use crate::error::{Error, ErrorKind};
use crate::memory::{Limit, Plan, limit};
use crate::options::{ProblemOptions, ProblemSettings, SceneSource};
use crate::prediction::pictured;
use crate::problem::{Problem, pixels, scene_failure, with_results};
use crate::sample;
use crate::solve::{report_failure, view_camera};
use crate::stages::Stages;

/// A valid scene, its mesh, and what its solution will take.
pub struct Checked {
    /// The scene.
    pub scene: Arc<Scene>,
    /// What its mesh is.
    pub report: Report,
    /// What a solution on the elements of the scene will take, or why its matrix does not fit.
    pub forecast: Result<Forecast, Error>,
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
/// and predicts what its solution will take.
///
/// # Errors
/// What is wrong with the scene; [`ErrorKind::Files`] for a picture that cannot be written. A
/// matrix that does not fit the memory is no error, but what was asked.
pub fn check(
    source: impl Into<SceneSource>,
    asked: &ProblemOptions,
    picture: Option<(&ResultFolder, &str)>,
    watch: &dyn Watch,
) -> Result<Checked, Error> {
    let mut stages = Stages::new(watch);
    let scene = source.into().load(asked.memory, &mut stages)?;
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
    let settings = ProblemSettings::new(asked, scene.solve());
    let more = |plan, scene: &Scene, n| with_results(plan, scene, n, (1, 0));
    let forecast = match Problem::refined(Arc::clone(&scene), settings, (1, &more), &mut stages) {
        Err(error) if error.kind() == ErrorKind::Resources => Err(error),
        loaded => Ok(forecast(loaded?, &mut stages)?),
    };
    Ok(Checked { scene, report, forecast })
}

fn forecast(problem: Problem, stages: &mut Stages) -> Result<Forecast, Error> {
    // The sample is one of pairs of elements.
    let seconds = if problem.is_radiosity() {
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
    let picture = render_sides(&sides, &found.open, &camera).map_err(report_failure)?;
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
