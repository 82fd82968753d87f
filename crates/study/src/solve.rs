//! The radiosity of a scene: on its elements, or to an accuracy.

use std::mem;
use std::sync::Arc;

use fredholm_linop::{MultiVector, Quiet, StopReason, Watch};
use fredholm_mesh::Mesh;
use fredholm_report::{
    CHECKPOINT, Camera, Exposure, Extras, Field, LINKS_PICTURE, Layer, LitPicture, MESH_PICTURE, ReportError,
    ResultFolder, RunRecord, RunReport, View, Where, output_files, render_false_colour, render_layers,
    render_lit, wanted_files, write_with,
};
use fredholm_scene::Scene;

use crate::checkpoint::{self, Checkpoint};
use crate::choice::{Choice, Extent};
use crate::error::{Error, ErrorKind};
use crate::hierarchical::Answer;
use crate::lamplight::Lamplight;
use crate::memory::{self, Plan};
use crate::options::{
    FalseColour, FieldFile, ProblemSettings, SceneSource, SolveOptions, SolveSettings, Way,
};
use crate::pictures::{Gathered, Source, gathering, wanted};
use crate::prediction::{BYTES_OF_AN_ELEMENT, Prediction, Size};
use crate::problem::{Problem, pictures, scene_failure, with_results};
use crate::record::{record, remarks};
use crate::solution::{Solution, compute};
use crate::stages::{Signals, Stages};
use crate::stochastic::expected_error;
use crate::{hierarchical, lit_by, rays, registry};

/// Pixels of the picture of a partial result.
const QUICK_PIXELS: f64 = 40_000.0;

/// How a study ended.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Ended {
    /// With what was asked for.
    Done,
    /// With results that miss the tolerance or the accuracy asked for.
    NotConverged,
    /// With what there was when the run was cancelled.
    Interrupted,
}

/// A solved scene.
pub struct Solved<'a> {
    pub(crate) settings: SolveSettings,
    pub(crate) problem: Problem,
    pub(crate) solution: Solution,
    pub(crate) stages: Stages<'a>,
}

/// The light of a surface, per band.
#[derive(Clone, Debug, PartialEq)]
pub struct SurfaceLight {
    /// Mean irradiance over the surface, W/m².
    pub irradiance: Vec<f64>,
    /// The stated error of it, W/m²: the root mean square of what the solution states of the faces
    /// of the surface, which is the most that the error of their mean can be where each is right.
    /// An estimate, as the stated errors are. Empty where the solution states no error.
    pub error: Vec<f64>,
}

/// Solves a scene.
///
/// # Errors
/// What is wrong with the scene or the options; [`ErrorKind::Resources`] before memory is taken
/// that the limit does not allow; [`ErrorKind::Interrupted`] for a run that was cancelled before it
/// had a result.
pub fn solve<'a>(
    source: impl Into<SceneSource>,
    asked: &SolveOptions,
    watch: &'a dyn Watch,
) -> Result<Solved<'a>, Error> {
    solve_from(&source.into(), asked, None, Stages::new(watch))
}

/// Goes on with a run to an accuracy that was stopped, with the options of the
/// [`Checkpoint`], some of which may be changed.
///
/// # Errors
/// As [`solve`], and for a scene that is another one by now.
pub fn resume<'a>(
    checkpoint: &Checkpoint,
    asked: &SolveOptions,
    watch: &'a dyn Watch,
) -> Result<Solved<'a>, Error> {
    if let Some(folder) = &asked.folder {
        folder.keep(CHECKPOINT);
    }
    solve_from(&checkpoint.scene().into(), asked, Some(checkpoint), Stages::new(watch))
}

/// Solves a scene, from a checkpoint where there is one.
pub(crate) fn solve_from<'a>(
    source: &SceneSource,
    asked: &SolveOptions,
    checkpoint: Option<&Checkpoint>,
    mut stages: Stages<'a>,
) -> Result<Solved<'a>, Error> {
    let (settings, problem, solution) = answer(source, asked, checkpoint, &mut stages)?;
    let settings = SolveSettings { recorded: asked.recorded.clone(), ..settings };
    let interrupted = solution.report.reason == StopReason::Interrupted;
    let settings = if interrupted { quick_settings(settings) } else { settings };
    Ok(Solved { settings, problem, solution, stages })
}

impl Solved<'_> {
    /// The same without its watch, for a caller that keeps the result longer than that.
    #[must_use]
    pub fn unwatched(self) -> Solved<'static> {
        let Self { settings, problem, solution, stages } = self;
        Solved { settings, problem, solution, stages: stages.unwatched() }
    }

    /// The scene.
    #[must_use]
    pub fn scene(&self) -> &Scene {
        &self.problem.scene
    }

    /// The elements that the solution came to, with their faces and surfaces.
    #[must_use]
    pub fn mesh(&self) -> &Mesh {
        &self.problem.mesh
    }

    /// Mean irradiance of the elements, elements × bands, W/m².
    #[must_use]
    pub fn irradiance(&self) -> &MultiVector<f64> {
        &self.solution.means.irradiance
    }

    /// Mean radiosity of the elements, elements × bands, W/m².
    #[must_use]
    pub fn radiosity(&self) -> &MultiVector<f64> {
        &self.solution.means.radiosity
    }

    /// Mean irradiance and mean radiosity of the faces, each faces × bands, W/m², as `faces.csv`
    /// has them.
    ///
    /// # Errors
    /// Never for the field of a solution, which fits its mesh.
    pub fn face_means(&self) -> Result<[MultiVector<f64>; 2], Error> {
        let field = self.field()?;
        let faces = self.problem.mesh.faces().len();
        let [irradiance, radiosity] = field.face_means();
        let vector = |values| MultiVector::from_vec(faces, field.bands().len(), values);
        let input = |error| Error::new(ErrorKind::Input, error);
        Ok([vector(irradiance).map_err(input)?, vector(radiosity).map_err(input)?])
    }

    /// The stated error of the mean irradiance of every face, faces × bands, W/m²: an estimate.
    /// None where the solution states no error.
    #[must_use]
    pub fn face_errors(&self) -> Option<Vec<f64>> {
        self.solution.mesh_error.as_ref()?;
        Some(expected_error(&self.problem, &self.solution, true))
    }

    /// A picture of so many pixels in width as the camera of the scene sees it, or as one does that
    /// sees all of it: a PNG file.
    ///
    /// # Errors
    /// [`ErrorKind::Input`] for a camera that makes no picture.
    pub fn picture(&self, width: u32) -> Result<Vec<u8>, Error> {
        let field = self.field()?.with_exposed(&self.solution.exposed).map_err(report_failure)?;
        let exitance = self.problem.scene.exitance(&self.problem.mesh);
        let field = field.with_exitance(&exitance).map_err(report_failure)?;
        let view = view_of(self.problem.scene.camera(), &field);
        let height = f64::from(width) * f64::from(view.camera.height) / f64::from(view.camera.width);
        let camera = Camera { width, height: (height.round() as u32).max(1), ..view.camera };
        let view = View { camera, ..view };
        // Nobody cancels it: there is all of it.
        let light =
            Lamplight::new(&self.problem, (self.solution.direct.as_ref(), Some(Where::Uneven)), &Quiet)?;
        let drawn = picture((&field, &view, false), &light)?;
        let Some((LitPicture { picture, .. }, _)) = drawn else { return Err(Error::cancelled()) };
        let mut png = Vec::new();
        picture.write_png(&mut png).map_err(|error| Error::new(ErrorKind::Files, error))?;
        Ok(png)
    }

    fn field(&self) -> Result<Field<'_>, Error> {
        let (bands, means) = (self.problem.scene.bands(), &self.solution.means);
        let (irradiance, radiosity) = (means.irradiance.as_slice(), means.radiosity.as_slice());
        Field::new(&self.problem.mesh, bands, irradiance, radiosity).map_err(report_failure)
    }

    /// The light of a surface by its name; none where the scene has no such surface.
    #[must_use]
    pub fn surface(&self, name: &str) -> Option<SurfaceLight> {
        let (mesh, bands) = (&self.problem.mesh, self.problem.scene.bands().len());
        let surface = mesh.surfaces().iter().position(|surface| surface.name == name)?;
        let own: Vec<usize> =
            (0..mesh.faces().len()).filter(|&face| mesh.faces()[face].surface == surface).collect();
        let area: f64 = own.iter().map(|&face| mesh.faces()[face].area).sum();
        let power = |leaf: usize, band: usize| mesh.patch(leaf).area() * self.irradiance().row(leaf)[band];
        let received = |band: usize| -> f64 {
            own.iter().flat_map(|&face| mesh.leaves_of_face(face)).map(|leaf| power(leaf, band)).sum()
        };
        let irradiance = (0..bands).map(|band| received(band) / area).collect();
        let known = self.solution.mesh_error.as_ref();
        let errors = known.map(|_| expected_error(&self.problem, &self.solution, true));
        let square = |errors: &[f64], band: usize| -> f64 {
            own.iter().map(|&face| mesh.faces()[face].area * errors[face * bands + band].powi(2)).sum()
        };
        let stated =
            |errors: Vec<f64>| (0..bands).map(|band| (square(&errors, band) / area).sqrt()).collect();
        Some(SurfaceLight { irradiance, error: errors.map_or_else(Vec::new, stated) })
    }

    /// Stated relative error of the irradiance of the faces (L², an estimate), or of the mean
    /// irradiance of the goal where there is one, in the worst band; none where it is not known.
    #[must_use]
    pub fn relative_error(&self) -> Option<f64> {
        let known = self.solution.mesh_error.as_ref().map(|error| error.relative_l2.iter().copied());
        let stated = self.solution.hierarchy.as_ref().and_then(|hierarchy| hierarchy.stated);
        known.and_then(|errors| errors.reduce(f64::max)).or(stated)
    }

    /// How the solution ended.
    #[must_use]
    pub fn ended(&self) -> Ended {
        match self.solution.report.reason {
            _ if self.stages.is_cancelled() => Ended::Interrupted,
            StopReason::Converged if self.solution.is_accurate() => Ended::Done,
            StopReason::Interrupted => Ended::Interrupted,
            _ => Ended::NotConverged,
        }
    }

    /// What the user should know of the solution; warnings about the scene were told before.
    pub fn remarks(&self) -> impl Iterator<Item = String> {
        remarks(&self.settings, &self.solution)
    }

    /// What is worth knowing of the run so far, as `run.json` has it.
    #[must_use]
    pub fn record(&self) -> RunRecord {
        record(&self.problem, &self.settings, &self.solution, &self.stages)
    }

    /// Writes all results into a folder and returns the
    /// record with the time of writing. The checkpoint there of a run that is complete is removed.
    ///
    /// # Errors
    /// [`ErrorKind::Files`] with the file that could not be written; the folder then has no
    /// `run.json`.
    pub fn write(&mut self, folder: &ResultFolder) -> Result<RunRecord, Error> {
        self.settings.output = folder.path().display().to_string();
        let mut record = self.record();
        let Self { settings, problem, solution, stages } = self;
        let signals = stages.signals();
        stages.run("results", || write(problem, settings, solution, &mut record, (folder, &signals)))?;
        if !record.partial {
            checkpoint::remove(folder)?;
        }
        Ok(RunRecord { timings: stages.timings().to_vec(), ..record })
    }
}

/// Reads and solves the scene.
fn answer(
    source: &SceneSource,
    asked: &SolveOptions,
    checkpoint: Option<&Checkpoint>,
    stages: &mut Stages,
) -> Result<(SolveSettings, Problem, Solution), Error> {
    let scene = source.load(asked.problem.memory, stages)?;
    // Without points there is nothing to be said of them.
    if let bytes @ 1.. = asked.points.bytes(scene.bands().len()) {
        let points = Plan::default().hold("points", bytes);
        points.admit(memory::limit(asked.problem.memory), "ask for fewer points")?;
    }
    refuse_unknown_band(asked, &scene)?;
    match accuracy_of(asked, &scene)? {
        Some(accuracy) => to_accuracy(asked, &scene, (accuracy, checkpoint), stages),
        None if asked.way.is_some() => Err(way_alone()),
        None if !asked.goal.is_empty() => Err(hierarchical::goal_alone()),
        None => dense(asked, &scene, stages),
    }
}

/// Refuses a picture of a band that the scene does not have.
fn refuse_unknown_band(asked: &SolveOptions, scene: &Scene) -> Result<(), Error> {
    let Some(FalseColour { band: Some(band) }) = &asked.false_colour else { return Ok(()) };
    if scene.bands().contains(band) {
        return Ok(());
    }
    let text = format!("{}: there is no band {band} to draw in false colour", scene.path().display());
    let help = format!("name one of {}, or none for all bands together", scene.bands().join(", "));
    Err(Error::new(ErrorKind::Input, text).with_help(help))
}

/// The accuracy asked for, if any, by the options or by the scene.
pub(crate) fn accuracy_of(asked: &SolveOptions, scene: &Scene) -> Result<Option<f64>, Error> {
    match asked.accuracy.or(scene.solve().accuracy) {
        Some(accuracy) if !(accuracy > 0.0 && accuracy < 1.0) => {
            let error = Error::new(ErrorKind::Input, format!("the accuracy {accuracy} cannot be reached"));
            Err(error.with_help("ask for one above 0 and below 1, such as 0.01"))
        }
        accuracy => Ok(accuracy),
    }
}

/// Whether rays may take the place of links: who names a way, a goal or a solver has links in
/// mind.
fn is_free(asked: &SolveOptions, scene: &Scene) -> bool {
    let solver = asked.problem.solver.is_some() || scene.solve().solver.is_some();
    asked.way.is_none() && asked.goal.is_empty() && !solver
}

/// On the elements of the scene.
fn dense(
    asked: &SolveOptions,
    scene: &Arc<Scene>,
    stages: &mut Stages,
) -> Result<(SolveSettings, Problem, Solution), Error> {
    let options = ProblemSettings::new(&asked.problem, scene.solve());
    let more = |plan, scene: &Scene, elements| {
        let bands = scene.bands().len();
        let wanted = asked.discontinuity || asked.points.bytes(bands) > 0;
        let gathering = if wanted { gathering(elements, bands) + asked.points.bytes(bands) } else { 0 };
        let more = (usize::from(asked.false_colour.is_some()), asked.final_gather);
        let pictures = pictures(scene, 1, (asked.no_pictures, more));
        with_results(plan, scene, elements, (pictures, gathering))
    };
    let problem = Problem::refined(Arc::clone(scene), options, (1, &more), stages)?;
    let options = SolveSettings::new(problem.options.clone(), asked.stop, scene.solve());
    let points = asked.points.receivers();
    let SolveOptions { final_gather, discontinuity, no_pictures, no_report, .. } = *asked;
    let (also, false_colour) = (asked.also.clone(), asked.false_colour.clone());
    let options = SolveSettings {
        points,
        final_gather,
        false_colour,
        discontinuity,
        no_pictures,
        no_report,
        also,
        ..options
    };
    let solution = compute(&problem, &options, stages)?;
    Ok((options, problem, solution))
}

/// To an accuracy, the way that costs less.
fn to_accuracy(
    asked: &SolveOptions,
    scene: &Arc<Scene>,
    (accuracy, checkpoint): (f64, Option<&Checkpoint>),
    stages: &mut Stages,
) -> Result<(SolveSettings, Problem, Solution), Error> {
    hierarchical::refuse_dense(&ProblemSettings::new(&asked.problem, scene.solve()))?;
    let mut choice = None;
    if checkpoint.is_none() {
        let predicted = predicted(asked, scene, accuracy)?;
        choice = Some(predicted);
        if predicted.is_rays() {
            return on_rays(asked, scene, (accuracy, predicted), stages);
        }
        if predicted.is_matrix() {
            match on_matrix(asked, scene, (accuracy, predicted), stages)? {
                Ok(solved) => return Ok(solved),
                Err(stated) => choice = Some(Choice::TooCoarse { stated }),
            }
        }
    }
    let options = hierarchical::options(asked, scene, accuracy)?;
    let choice = choice.map(|choice| choice.to_string());
    let options = SolveSettings { choice: choice.or_else(|| checkpoint?.header.choice.clone()), ..options };
    let saved = (accuracy, checkpoint, asked.folder.as_ref());
    match hierarchical::compute(scene, &options, saved, stages)? {
        Answer::Solved(solved) => {
            let (problem, solution) = *solved;
            Ok((options, problem, solution))
        }
        Answer::Begun { .. } => Err(hierarchical::interrupted()),
    }
}

/// The way that is predicted to cost less.
pub(crate) fn predicted(asked: &SolveOptions, scene: &Scene, accuracy: f64) -> Result<Choice, Error> {
    match asked.way {
        Some(Way::Rays) if !asked.goal.is_empty() => {
            let error = Error::new(ErrorKind::Input, "rays know no goal");
            return Err(error.with_help("leave out the goal, or the way"));
        }
        Some(way) => return Ok(Choice::Asked(way)),
        None if !asked.goal.is_empty() => return Ok(Choice::Goal),
        None => {}
    }
    let options = ProblemSettings::new(&asked.problem, scene.solve());
    let meshed =
        Plan::default().hold("the mesh", BYTES_OF_AN_ELEMENT.saturating_mul(scene.predicted_elements()));
    if !meshed.fits(options.memory_limit()) {
        return Ok(Choice::Memory);
    }
    let mesh = scene.mesh().map_err(scene_failure)?;
    let settings = hierarchical::options(asked, scene, accuracy)?;
    let free = is_free(asked, scene)
        && rays::plan_on(scene, &mesh, &settings, accuracy).fits(options.memory_limit());
    let choice = Choice::new(Extent::of(&mesh, free), accuracy);
    let fits = fits(&options, mesh.len(), scene.bands().len());
    Ok(if choice.is_matrix() && !fits { Choice::Memory } else { choice })
}

/// Whether the matrix of some elements fits the memory.
fn fits(options: &ProblemSettings, elements: usize, bands: usize) -> bool {
    let size = Size { elements, unknowns: elements, dense: None };
    registry::find(&options.solver).is_some_and(|solver| {
        Prediction::new(size, bands, options.storage, &solver).plan().fits(options.memory_limit())
    })
}

/// A solution, or the error that it states where that is too large.
type Trial = Result<(SolveSettings, Problem, Solution), Option<f64>>;

/// On the elements of the scene, where the error that is stated then is within an accuracy.
fn on_matrix(
    asked: &SolveOptions,
    scene: &Arc<Scene>,
    (accuracy, choice): (f64, Choice),
    stages: &mut Stages,
) -> Result<Trial, Error> {
    let (options, problem, solution) = dense(asked, scene, stages)?;
    let stated = solution.mesh_error.as_ref();
    let stated = stated.and_then(|error| error.relative_l2.iter().copied().reduce(f64::max));
    let partial = solution.report.reason != StopReason::Converged;
    if !partial && stated.is_none_or(|error| error > accuracy) {
        return Ok(Err(stated));
    }
    let choice = Some(choice.to_string());
    Ok(Ok((SolveSettings { accuracy: Some(accuracy), choice, ..options }, problem, solution)))
}

/// By rays, on the elements of the scene.
fn on_rays(
    asked: &SolveOptions,
    scene: &Arc<Scene>,
    (accuracy, choice): (f64, Choice),
    stages: &mut Stages,
) -> Result<(SolveSettings, Problem, Solution), Error> {
    let mut options = hierarchical::options(asked, scene, accuracy)?;
    rays::NAME.clone_into(&mut options.problem.discretisation);
    rays::SOLVER.clone_into(&mut options.problem.solver);
    let options = SolveSettings { choice: Some(choice.to_string()), ..options };
    let (problem, solution) = rays::compute(scene, &options, accuracy, stages)?;
    Ok((options, problem, solution))
}

/// Refuses a way without an accuracy.
fn way_alone() -> Error {
    Error::new(ErrorKind::Input, "a way to an accuracy needs one").with_help("add it, such as --accuracy 1%")
}

fn write(
    problem: &Problem,
    options: &SolveSettings,
    solution: &Solution,
    record: &mut RunRecord,
    (folder, signals): (&ResultFolder, &Signals),
) -> Result<(), Error> {
    let exitance = problem.scene.exitance(&problem.mesh);
    let (irradiance, radiosity) = (solution.means.irradiance.as_slice(), solution.means.radiosity.as_slice());
    let bands = problem.scene.bands();
    let field = Field::new(&problem.mesh, bands, irradiance, radiosity)
        .and_then(|field| field.with_exitance(&exitance))
        .and_then(|field| field.with_exposed(&solution.exposed))
        .map_err(report_failure)?;
    let view = view_of(problem.scene.camera(), &field);
    // Whoever has cancelled the run gets a small picture at once; one that is cancelled meanwhile
    // is left out.
    let cancelled = record.partial || signals.is_cancelled();
    let view = if cancelled { quick(view) } else { view };
    let watch = if cancelled { &Quiet } else { signals.watch };
    let source = Source::new(problem, options, solution)?;
    let (linked, gathered) = (|element| source.linked(element), source.gather(options, signals)?);
    let layer = |name| match name {
        MESH_PICTURE => Some(Layer::Elements),
        LINKS_PICTURE => Some(Layer::Links(&linked)),
        _ => None,
    };
    let gathers =
        (!cancelled).then_some(if options.final_gather { Where::Everywhere } else { Where::Uneven });
    let exact = gathers == Some(Where::Everywhere) || options.also.contains(&FieldFile::Exr);
    let lamplight = if options.no_pictures {
        None
    } else {
        Some(Lamplight::new(problem, (solution.direct.as_ref(), gathers), watch)?)
    };
    let draw = |light: &Lamplight| picture((&field, &view, exact), light);
    let drawn = lamplight.as_ref().map(draw).transpose()?.flatten();
    let (image, linear, standard_error) = match drawn {
        Some((LitPicture { picture, linear, standard_error, whole, .. }, how)) => {
            record.picture = Some(how);
            if !whole {
                let text = "interrupted: the picture is as it was then; the solution itself is whole";
                signals.watch.warn(text);
                record.warnings.push(text.to_owned());
            }
            (Some(picture), linear, standard_error)
        }
        None => (None, Vec::new(), Vec::new()),
    };
    let wanted = wanted(options, solution);
    let (names, layers): (Vec<&str>, Vec<Layer>) =
        wanted_files(&wanted).filter_map(|name| Some((name, layer(name)?))).unzip();
    let drawn = match &image {
        Some(image) => render_layers(&field, &view.camera, image, &layers).map_err(report_failure)?,
        None => Vec::new(),
    };
    let pictures: Vec<_> = names.into_iter().zip(drawn).collect();
    let title = title(&problem.scene);
    let false_colour = match (&options.false_colour, &lamplight) {
        (Some(shown), Some(light)) if !cancelled => {
            let named = |name: &String| bands.iter().position(|band| band == name);
            let what = (title.as_str(), shown.band.as_ref().and_then(named));
            render_false_colour(&field, &view.camera, &light.lit(), what).map_err(report_failure)?
        }
        _ => None,
    };
    let points = gathered.as_ref().map(|gathered| gathered.points(options)).transpose()?.flatten();
    let shadows = gathered.as_ref().filter(|_| options.discontinuity).and_then(Gathered::shadows);
    let links = match &solution.tree {
        _ if options.no_report => None,
        Some(hierarchy) => lit_by::by_links(hierarchy, &problem.mesh, &solution.means),
        None => lit_by::of_elements(&solution.senders, &problem.mesh, &solution.means),
    };
    let page = RunReport { title: &title, view: &view, steps: ("", &[]), links: links.as_ref() };
    let report = (!options.no_report).then_some(page);
    let (also, exposure) = (wanted.also, view.exposure);
    let more = Extras {
        image,
        linear,
        standard_error,
        pictures,
        false_colour,
        exposure,
        points,
        shadows,
        also,
        report,
    };
    if signals.is_cancelled() && !record.partial {
        leave_out(record, &more, signals);
    }
    write_with(folder, &field, record, &more).map(drop).map_err(report_failure)
}

/// The picture of a solution, with its linear colours where these are wanted, and how it was made:
/// the light of lamps at every pixel where the solution tells that part of the irradiance apart,
/// else what its elements have. There is none where the watch did not want it any more.
fn picture(
    (field, view, linear): (&Field, &View, bool),
    lamplight: &Lamplight,
) -> Result<Option<(LitPicture, String)>, Error> {
    let drawn = render_lit(field, &view.camera, view.exposure, &lamplight.lit(), linear);
    Ok(drawn.map_err(report_failure)?.map(|drawn| {
        let (light, exposure) = (lamplight.words(drawn.places), drawn.exposure);
        (drawn, format!("{light}; {TONE}; exposure {exposure:.4e} m²/W"))
    }))
}

/// How colours become what a screen shows.
const TONE: &str =
    "tone mapping of luminance by L (1 + L/w²)/(1 + L) with white at w = 4 (Reinhard et al. 2002), sRGB";

/// Takes what a cancelled run has not finished from the list of its files, and says so.
fn leave_out(record: &mut RunRecord, more: &Extras<'_>, signals: &Signals) {
    let missing = |name: &str| output_files().any(|file| file.name() == name && !file.is_ready(more));
    let (left_out, written) = mem::take(&mut record.files).into_iter().partition(|name| missing(name));
    record.files = written;
    let left_out: Vec<String> = left_out;
    if !left_out.is_empty() {
        let text = format!("interrupted: {} left out; the solution itself is whole", left_out.join(" and "));
        signals.watch.warn(&text);
        record.warnings.push(text);
    }
}

/// The title of the scene, or the name of its file.
pub(crate) fn title(scene: &Scene) -> String {
    let name = || scene.path().file_stem().map(|stem| stem.to_string_lossy().into_owned());
    scene.title().map(str::to_owned).or_else(name).unwrap_or_default()
}

/// The scene's camera, or one that sees all of it.
pub(crate) fn view_of(camera: Option<&fredholm_scene::Camera>, field: &Field) -> View {
    let Some(camera) = camera else { return View::framing(field) };
    let exposure = camera.exposure.map_or(Exposure::Auto, Exposure::Fixed);
    View { camera: view_camera(camera), exposure }
}

pub(crate) fn view_camera(camera: &fredholm_scene::Camera) -> Camera {
    Camera {
        eye: camera.eye,
        target: camera.target,
        up: camera.up,
        vertical_fov_degrees: camera.vertical_fov_degrees,
        width: camera.width,
        height: camera.height,
    }
}

/// The settings without what takes long to write: whoever has pressed Ctrl-C waits for no final
/// gather. `resume` goes on with the settings as they were.
fn quick_settings(settings: SolveSettings) -> SolveSettings {
    SolveSettings { final_gather: false, false_colour: None, discontinuity: false, ..settings }
}

/// The view in few pixels: whoever has pressed Ctrl-C does not wait for a large picture.
fn quick(view: View) -> View {
    let Camera { width, height, .. } = view.camera;
    let scale = (QUICK_PIXELS / (f64::from(width) * f64::from(height))).sqrt().min(1.0);
    let scaled = |side: u32| ((f64::from(side) * scale) as u32).max(1);
    View { camera: Camera { width: scaled(width), height: scaled(height), ..view.camera }, ..view }
}

pub(crate) fn report_failure(error: ReportError) -> Error {
    let ending = match error {
        ReportError::Write { .. } | ReportError::Read { .. } => ErrorKind::Files,
        ReportError::NotFinite { .. } => ErrorKind::NotConverged,
        _ => ErrorKind::Input,
    };
    Error::new(ending, error)
}
