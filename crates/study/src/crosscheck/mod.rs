//! A scene solved and traced, and the statistics that decide whether the two agree.

mod fields;
pub(crate) mod places;
pub(crate) mod record;

use fredholm_linop::Watch;
use fredholm_montecarlo::light::{Estimator, estimator};
use fredholm_montecarlo::statistics::{Comparison, Correction, Crosscheck, Place, crosscheck as compare};
use fredholm_montecarlo::{Enclosure, State};
use fredholm_report::{CrosscheckRecord, Exposure, ResultFolder, View, score_map, write_crosscheck};
use fredholm_scene::waves::is_wave_scene;

use places::Places;

use crate::checkpoint;
use crate::error::{Error, ErrorKind};
use crate::options::{ProblemOptions, SceneSource, SolveOptions};
use crate::problem::{Problem, scene_failure};
use crate::solution::Solution;
use crate::solve::{Solved, report_failure, solve_from, title, view_camera};
use crate::stages::Stages;
use crate::stochastic::{
    FIELD_METHODS, PathOptions, TraceStop, Tracer, enclosure, expected_error, face_means, failure,
};

/// Method where none is asked for.
const USUAL_METHOD: &str = "light";
/// Error that is asked for where nothing is.
const USUAL_ERROR: f64 = 0.01;

/// A stated error in standard deviations of it, inverse: it holds in 95 of 100 cases.
const STATED_ERROR_DEVIATIONS: f64 = 0.5;
/// What is missing where a continuous method is compared.
const NO_STATED_ERROR: &str = "the solution states no error, so that all of it counts as a fault";
/// Deviations of the whole, and of a typical face, that must have been found where the two are said
/// to agree.
const MOST_WHOLE_DEVIATION: f64 = 0.5;
const MOST_FACE_DEVIATION: f64 = 1.0;

/// What is asked of [`crosscheck`].
#[derive(Clone, Debug)]
pub struct CrosscheckOptions {
    /// Stochastic method, one of [`LIGHT_METHODS`](crate::LIGHT_METHODS) or [`FIELD_METHODS`].
    /// None: light, of scenes of waves surface-sampling.
    pub method: Option<String>,
    /// Relative error that the solution which is checked is asked for; see [`SolveOptions`].
    pub accuracy: Option<f64>,
    /// Probability of a false alarm that is allowed.
    pub significance: f64,
    /// How the number of tests is taken into account.
    pub correction: MultipleTests,
    /// Whether report.html is left out.
    pub no_report: bool,
    /// How paths are made.
    pub paths: PathOptions,
    /// When tracing ends; without anything at a standard error of 1 %.
    pub stop: TraceStop,
    /// What decides the size and the effort.
    pub problem: ProblemOptions,
}

impl Default for CrosscheckOptions {
    fn default() -> Self {
        Self {
            method: None,
            accuracy: None,
            significance: 0.01,
            correction: MultipleTests::default(),
            no_report: false,
            paths: PathOptions::default(),
            stop: TraceStop::default(),
            problem: ProblemOptions::default(),
        }
    }
}

/// Corrections for many tests: what is kept below the significance.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum MultipleTests {
    /// The chance of any false alarm.
    #[default]
    Holm,
    /// The expected share of false alarms.
    BenjaminiHochberg,
}

impl MultipleTests {
    pub(crate) fn correction(self) -> Correction {
        match self {
            Self::Holm => Correction::Holm,
            Self::BenjaminiHochberg => Correction::BenjaminiHochberg,
        }
    }
}

/// Whether two solutions agree.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Verdict {
    /// They do, and a deviation worth the name would have been found.
    Agree,
    /// They do not.
    Disagree,
    /// No deviation was found, but too little was sampled to say that they agree.
    Undecided,
}

impl Verdict {
    /// As the record has it.
    #[must_use]
    pub fn name(self) -> &'static str {
        match self {
            Self::Agree => "agree",
            Self::Disagree => "disagree",
            Self::Undecided => "undecided",
        }
    }
}

/// Solves and traces a scene of light or of waves, compares the two place by place, and writes what
/// that came to into a folder.
///
/// # Errors
/// What is wrong with the scene or the options; [`ErrorKind::Resources`] before memory is taken
/// that the limit does not allow; [`ErrorKind::Interrupted`] for a run that was cancelled.
pub fn crosscheck(
    source: impl Into<SceneSource>,
    asked: &CrosscheckOptions,
    folder: &ResultFolder,
    watch: &dyn Watch,
) -> Result<(CrosscheckRecord, Verdict), Error> {
    let (source, stages) = (source.into(), Stages::new(watch).part("check"));
    let fields = match &asked.method {
        Some(name) => FIELD_METHODS.contains(&name.as_str()),
        None => is_wave_scene(source.path()),
    };
    let run = if fields { fields::run } else { run };
    run(&source, asked, folder, stages)
}

impl CrosscheckOptions {
    /// The method asked for, or else the usual one.
    fn method_or<'a>(&'a self, usual: &'a str) -> &'a str {
        self.method.as_deref().unwrap_or(usual)
    }
}

fn run(
    source: &SceneSource,
    asked: &CrosscheckOptions,
    folder: &ResultFolder,
    stages: Stages,
) -> Result<(CrosscheckRecord, Verdict), Error> {
    let Solved { problem, solution, mut stages, .. } = answer(source, asked, folder, stages)?;
    let places = Places::new(&problem);
    let Traced { scene, state, patchwise } = traced(asked, &problem, &places, &mut stages)?;
    if !patchwise && solution.mesh_error.is_none() {
        stages.watch.warn(NO_STATED_ERROR);
    }
    let faces = face_means(&problem, &solution);
    let error = errors(&places, (&problem, &solution), &faces, patchwise);
    let values = places.means(&faces);
    let method = named(asked, &scene)?;
    let single = places.single(&scene, &state, &*method);
    let found = compared(asked, (&values, &error, &single), &state)?;
    let power = Power::new(&places, &values, &found);
    let verdict = verdict(&found, &power);
    let (record, rows, map) = {
        let (of_faces, outcome) = (&found.places[..places.of_faces()], (&found, &power, verdict));
        let record = record::record(asked, (&problem, &places), (&values, &state), outcome, &stages);
        let rows = record::rows(&problem, (&values, &error), &state, of_faces);
        (record, rows, map(&problem, of_faces)?)
    };
    let bands = problem.scene.bands();
    let title = title(&problem.scene);
    let view =
        problem.scene.camera().map(|camera| View { camera: view_camera(camera), exposure: Exposure::Auto });
    let report = (!asked.no_report).then_some((title.as_str(), view.as_ref()));
    write_crosscheck(folder, &problem.mesh, bands, (&rows, &map), &record, report).map_err(report_failure)?;
    Ok((record, verdict))
}

pub(crate) fn verdict(found: &Crosscheck, power: &Power) -> Verdict {
    match (found.agrees(), power.suffices()) {
        (false, _) => Verdict::Disagree,
        (true, true) => Verdict::Agree,
        (true, false) => Verdict::Undecided,
    }
}

/// The solution that is checked.
fn answer<'a>(
    source: &SceneSource,
    asked: &CrosscheckOptions,
    folder: &ResultFolder,
    stages: Stages<'a>,
) -> Result<Solved<'a>, Error> {
    let solve = SolveOptions {
        accuracy: asked.accuracy,
        no_pictures: true,
        no_report: true,
        problem: asked.problem.clone(),
        folder: Some(folder.clone()),
        ..SolveOptions::default()
    };
    let watch = stages.watch;
    let solved = solve_from(source, &solve, None, stages)?;
    checkpoint::remove(folder)?;
    solved.remarks().for_each(|remark| watch.warn(&remark));
    Ok(solved)
}

/// What the solution says of its error at all places. Links state nothing of single faces, but a
/// norm over all.
fn errors(
    places: &Places,
    (problem, solution): (&Problem, &Solution),
    faces: &[f64],
    patchwise: bool,
) -> Vec<f64> {
    match solution.mesh_error.as_ref().filter(|error| !patchwise && error.per_face.is_empty()) {
        Some(error) => {
            let norms = places.norms(faces);
            let stated: Vec<f64> = norms
                .iter()
                .zip(&error.relative_l2)
                .map(|(norm, part)| STATED_ERROR_DEVIATIONS * norm * part)
                .collect();
            places.of_norms(&stated)
        }
        None => places.root_mean_squares(&expected_error(problem, solution, !patchwise)),
    }
}

/// The smallest deviations that would have been found nine times out of ten, over the irradiance,
/// in the worst band.
pub(crate) struct Power {
    whole: f64,
    /// Medians.
    surface: f64,
    face: f64,
}

impl Power {
    pub(crate) fn new(places: &Places, values: &[f64], found: &Crosscheck) -> Self {
        let of = |kind: fn(places::Place) -> bool| -> Vec<f64> {
            let own = found.places.iter().filter(|place| kind(places.at(place.index).0));
            // What is dark on both sides has nothing to deviate from.
            let lit = own.filter(|place| values[place.index] > 0.0);
            let mut sizes: Vec<f64> = lit.map(|place| place.found / values[place.index]).collect();
            sizes.sort_by(f64::total_cmp);
            sizes
        };
        let median = |sizes: &[f64]| sizes.get(sizes.len() / 2).copied().unwrap_or(f64::INFINITY);
        Self {
            whole: of(|place| place == places::Place::Whole).last().copied().unwrap_or(f64::INFINITY),
            surface: median(&of(|place| matches!(place, places::Place::Surface(_)))),
            face: median(&of(|place| matches!(place, places::Place::Face(_)))),
        }
    }

    /// Whether agreement says something.
    fn suffices(&self) -> bool {
        self.whole < MOST_WHOLE_DEVIATION && self.face < MOST_FACE_DEVIATION
    }
}

fn compared(
    asked: &CrosscheckOptions,
    (values, error, single): (&[f64], &[f64], &[f64]),
    state: &State,
) -> Result<Crosscheck, Error> {
    let comparison = Comparison {
        deterministic: values,
        deterministic_error: error,
        stochastic: state.groups.mean(),
        standard_error: &state.groups.standard_errors(),
        single,
        batches: state.batches(),
    };
    compare(&comparison, asked.correction.correction(), asked.significance).map_err(failure)
}

/// A traced scene.
struct Traced {
    scene: Enclosure,
    state: State,
    patchwise: bool,
}

fn named(asked: &CrosscheckOptions, scene: &Enclosure) -> Result<Box<dyn Estimator>, Error> {
    let name = asked.method_or(USUAL_METHOD);
    let none = || Error::new(ErrorKind::Input, format!("there is no method {name}"));
    estimator(name, scene, asked.paths.switches()).ok_or_else(none)
}

/// Traces the faces as they are; a method of constants on elements, the elements of the solution.
fn traced(
    asked: &CrosscheckOptions,
    problem: &Problem,
    places: &Places,
    stages: &mut Stages,
) -> Result<Traced, Error> {
    let faces = problem.scene.face_mesh().map_err(scene_failure)?;
    let mut scene = enclosure(&problem.scene, &faces)?;
    let mut method = named(asked, &scene)?;
    let patchwise = method.patchwise();
    let mut mesh = &faces;
    if patchwise {
        mesh = &problem.mesh;
        scene = enclosure(&problem.scene, mesh)?;
        method = named(asked, &scene)?;
    }
    let stop = asked.stop.or_to(USUAL_ERROR);
    let tracer = Tracer::new(&scene, &*method, places.groups(mesh, &scene)?, &asked.paths, &stop)?;
    let mut state = tracer.start();
    let watch = stages.watch;
    stages.run("tracing", || tracer.run(&mut state, watch))?;
    if stages.is_cancelled() {
        return Err(Error::cancelled());
    }
    Ok(Traced { scene, state, patchwise })
}

/// The worst band of every face.
fn map(problem: &Problem, faces: &[Place]) -> Result<fredholm_report::Picture, Error> {
    let worse = |a: f64, b: f64| if b.abs() > a.abs() { b } else { a };
    let bands = problem.scene.bands().len();
    let scores: Vec<f64> =
        faces.chunks(bands).map(|face| face.iter().map(|place| place.z).fold(0.0, worse)).collect();
    let camera = problem.scene.camera().map(view_camera);
    let title = "Solution and paths: red where the paths are brighter";
    score_map(&problem.mesh, &scores, camera.as_ref(), title).map_err(report_failure)
}
