//! `fredholm crosscheck`.

mod fields;
mod places;
mod record;

use std::path::{Path, PathBuf};

use clap::builder::PossibleValuesParser;
use clap::{Args, ValueEnum};
use fredholm_montecarlo::light::{Estimator, METHODS, estimator};
use fredholm_montecarlo::statistics::{Comparison, Correction, Crosscheck, Place, crosscheck as compare};
use fredholm_montecarlo::{Enclosure, State};
use fredholm_report::{
    CrosscheckPower, CrosscheckRecord, Exposure, View, WorstPlace, score_map, write_crosscheck,
};
use fredholm_scene::Scene;

use places::Places;

use super::solve::{report_failure, title, view_camera};
use crate::args::{LogArgs, PlaceArgs, ProblemArgs, SolveArgs, StopArgs, accuracy};
use crate::checkpoint;
use crate::failure::{Ending, Failure};
use crate::interrupt::nothing_saved;
use crate::options::Options;
use crate::output;
use crate::problem::{Problem, scene_failure, with_results};
use crate::record::remarks;
use crate::solution::Solution;
use crate::stages::Stages;
use crate::start::Start;
use crate::stochastic::{
    FIELD_METHODS, PathArgs, TraceStopArgs, Tracer, enclosure, expected_error, failure, share, with_tracing,
};
use crate::summary::Lines;
use crate::waves::is_scene;

/// Method where none is asked for.
const USUAL: &str = "light";
/// Error that is asked for where nothing is.
const ERROR: f64 = 0.01;
/// Error of a row of form factors where neither the command line nor the scene asks for one: small beside what is compared.
const FORM_FACTORS: f64 = 1e-5;

/// The verdict where too little was sampled.
const UNDECIDED: &str = "undecided";
/// A stated error in standard deviations of it, inverse: it holds in 95 of 100 cases.
const STATED: f64 = 0.5;
/// What is missing where a continuous method is compared.
const UNKNOWN: &str = "the solution states no error, so that all of it counts as a fault";
/// Deviations of the whole, and of a typical face, that must have been found where the two are said to agree.
const WHOLE: f64 = 0.5;
const FACE: f64 = 1.0;

/// What follows the help of `crosscheck`.
pub(crate) const EXAMPLES: &str = "\
Examples:
  fredholm crosscheck scenes/cornell_planar.toml
  fredholm crosscheck room.toml --accuracy 1% --to 0.5% -o out/checked
  fredholm crosscheck room.toml --significance 0.001 --correction benjamini-hochberg
  fredholm crosscheck scenes/waves/plate.toml --method field-particles --to 2%

The scene is solved as `fredholm solve` would, links where it has an accuracy, and traced, and the
irradiance of every face, every surface and the whole is compared in every band by its z, the
difference over the standard error and the stated error together. The verdict takes the number
of places into account; a scene that is right fails with a probability of --significance at
most. The power says which deviation would have been found nine times out of ten; where that is
no use the two are neither said to agree nor to disagree, with exit code 3. light, path,
bidirectional and photon follow light over the surfaces as they are; jacobi, walk-gathering and
walk-shooting estimate constants on the elements, as the solution on a matrix has them, and see
no error of the mesh. Written are crosscheck.csv, crosscheck.svg, crosscheck.png (red: the
traced solution is the brighter), report.html, and crosscheck.json last. Exit code 6 where the
two disagree.

Of a scene of waves every number of the scattered E at every point of a receiver is compared, one
bounce or two; written are crosscheck.csv, crosscheck.svg and crosscheck.json.";

/// Options of `crosscheck`.
#[derive(Clone, Debug, Args)]
pub(crate) struct CrosscheckArgs {
    /// Stochastic method [default: light, of waves surface-sampling]
    #[arg(long, value_name = "NAME", value_parser = PossibleValuesParser::new(METHODS.into_iter().chain(FIELD_METHODS)))]
    method: Option<String>,
    /// Error of the irradiance that `solve` is asked for, whose answer is checked [default: the scene's, else its elements]
    #[arg(long, value_name = "E", value_parser = accuracy)]
    pub(crate) accuracy: Option<f64>,
    /// Probability of a false alarm that is allowed
    #[arg(long, value_name = "P", default_value_t = 0.01, value_parser = share)]
    pub(crate) significance: f64,
    /// How many tests are taken into account
    #[arg(long, value_enum, value_name = "NAME", default_value_t = CorrectionName::Holm)]
    pub(crate) correction: CorrectionName,
    /// Folder for the results [default: out/<name of the scene file>]
    #[arg(long, short, value_name = "DIR")]
    pub(crate) output: Option<PathBuf>,
    /// Write no report.html
    #[arg(long)]
    pub(crate) no_report: bool,
    #[command(flatten)]
    pub(crate) paths: PathArgs,
    #[command(flatten)]
    pub(crate) stop: TraceStopArgs,
    #[command(flatten)]
    pub(crate) problem: ProblemArgs,
    #[command(flatten)]
    pub(crate) log: LogArgs,
}

/// Corrections, as the command line names them.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub(crate) enum CorrectionName {
    /// The chance of any false alarm
    Holm,
    /// The expected share of false alarms
    BenjaminiHochberg,
}

impl CorrectionName {
    fn correction(self) -> Correction {
        match self {
            Self::Holm => Correction::Holm,
            Self::BenjaminiHochberg => Correction::BenjaminiHochberg,
        }
    }
}

/// Solves and traces a scene, and says whether the two agree.
pub(crate) fn crosscheck(args: &CrosscheckArgs) -> Result<Ending, Failure> {
    let start = Start {
        scene: &args.problem.scene,
        output: args.output.as_ref(),
        threads: args.problem.threads,
        memory: args.problem.memory,
        log: args.log,
    };
    let fields = match &args.method {
        Some(name) => FIELD_METHODS.contains(&name.as_str()),
        None => is_scene(&args.problem.scene),
    };
    let run = if fields { fields::run } else { run };
    start.run_whole("check", |folder, stages| run(args, folder, stages))
}

impl CrosscheckArgs {
    /// The method asked for, or else the usual one.
    fn method_or<'a>(&'a self, usual: &'a str) -> &'a str {
        self.method.as_deref().unwrap_or(usual)
    }
}

fn run(args: &CrosscheckArgs, folder: &Path, stages: &mut Stages) -> Result<Ending, Failure> {
    let (problem, solution) = answer(args, folder, stages)?;
    let places = Places::new(&problem);
    let Traced { scene, state, patchwise } = traced(args, &problem, &places, stages)?;
    if !patchwise && solution.mesh_error.is_none() {
        stages.console.warn(UNKNOWN);
    }
    let faces = deterministic(&problem, &solution);
    let error = errors(&places, (&problem, &solution), &faces, patchwise);
    let values = places.means(&faces);
    let method = named(args, &scene)?;
    let single = places.single(&scene, &state, &*method);
    let found = compared(args, (&values, &error, &single), &state)?;
    let power = Power::new(&places, &values, &found);
    let record = record::record(args, (&problem, &places), (&values, &state), (&found, &power), stages);
    let rows = record::rows(&problem, (&values, &error), &state, &found.places[..places.of_faces()]);
    let map = map(&problem, &found.places[..places.of_faces()])?;
    let bands = problem.scene.bands();
    let title = title(&problem.scene);
    let view =
        problem.scene.camera().map(|camera| View { camera: view_camera(camera), exposure: Exposure::Auto });
    let report = (!args.no_report).then_some((title.as_str(), view.as_ref()));
    write_crosscheck(folder, &problem.mesh, bands, (&rows, &map), &record, report).map_err(report_failure)?;
    if !args.log.quiet {
        summarise(folder, &record)?;
    }
    Ok(match (found.agrees(), power.suffices()) {
        (false, _) => Ending::Disagrees,
        (true, true) => Ending::Done,
        (true, false) => Ending::NotConverged,
    })
}

/// What the solution says of its error at all places. Links state nothing of single faces, but a norm over all.
fn errors(
    places: &Places,
    (problem, solution): (&Problem, &Solution),
    faces: &[f64],
    patchwise: bool,
) -> Vec<f64> {
    match solution.mesh_error.as_ref().filter(|error| !patchwise && error.per_face.is_empty()) {
        Some(error) => {
            let norms = places.norms(faces);
            let stated: Vec<f64> =
                norms.iter().zip(&error.relative_l2).map(|(norm, part)| STATED * norm * part).collect();
            places.of_norms(&stated)
        }
        None => places.root_mean_squares(&expected_error(problem, solution, !patchwise)),
    }
}

/// What `solve` answers for the scene.
fn answer(args: &CrosscheckArgs, folder: &Path, stages: &mut Stages) -> Result<(Problem, Solution), Failure> {
    let solve = SolveArgs {
        output: args.output.clone(),
        accuracy: args.accuracy,
        goal: Vec::new(),
        final_gather: false,
        discontinuity: false,
        no_pictures: true,
        no_report: true,
        places: PlaceArgs::default(),
        problem: args.problem.clone(),
        stop: StopArgs { tolerance: None, max_iterations: None },
        log: args.log,
    };
    let (options, problem, solution) = super::solve::answer(&solve, None, folder, stages)?;
    checkpoint::remove(folder)?;
    remarks(&options, &solution).for_each(|remark| stages.console.warn(&remark));
    Ok((problem, solution))
}

/// The smallest deviations that would have been found nine times out of ten, over the irradiance, in the worst band.
pub(super) struct Power {
    whole: f64,
    /// Medians.
    surface: f64,
    face: f64,
}

impl Power {
    fn new(places: &Places, values: &[f64], found: &Crosscheck) -> Self {
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
        self.whole < WHOLE && self.face < FACE
    }
}

fn compared(
    args: &CrosscheckArgs,
    (values, error, single): (&[f64], &[f64], &[f64]),
    state: &State,
) -> Result<Crosscheck, Failure> {
    let comparison = Comparison {
        deterministic: values,
        deterministic_error: error,
        stochastic: state.groups.mean(),
        standard_error: &state.groups.standard_errors(),
        single,
        batches: state.batches(),
    };
    compare(&comparison, args.correction.correction(), args.significance).map_err(failure)
}

/// The problem, with form factors more exact than for a picture.
pub(super) fn load(
    args: &ProblemArgs,
    log: LogArgs,
    folder: &Path,
    stages: &mut Stages,
) -> Result<(Problem, Options), Failure> {
    let more = |plan, scene: &Scene, n| with_results(with_tracing(plan, scene, n), scene, n, (1, 0));
    let mut problem = Problem::load(args, &more, stages)?;
    let asked = args.form_factor_tolerance.or(problem.scene.solve().form_factor_tolerance);
    problem.options.form_factor_tolerance = asked.unwrap_or(FORM_FACTORS);
    let stop = StopArgs { tolerance: None, max_iterations: None };
    let options = Options::new(problem.options.clone(), stop, problem.scene.solve(), folder, log);
    Ok((problem, options))
}

/// A traced scene.
struct Traced {
    scene: Enclosure,
    state: State,
    patchwise: bool,
}

fn named(args: &CrosscheckArgs, scene: &Enclosure) -> Result<Box<dyn Estimator>, Failure> {
    let name = args.method_or(USUAL);
    let none = || Failure::new(Ending::Input, format!("there is no method {name}"));
    estimator(name, scene, args.paths.switches()).ok_or_else(none)
}

/// Traces the faces as they are; a method of constants on elements, the elements of the solution.
fn traced(
    args: &CrosscheckArgs,
    problem: &Problem,
    places: &Places,
    stages: &mut Stages,
) -> Result<Traced, Failure> {
    let faces = problem.scene.face_mesh().map_err(scene_failure)?;
    let mut scene = enclosure(&problem.scene, &faces)?;
    let mut method = named(args, &scene)?;
    let patchwise = method.patchwise();
    let mut mesh = &faces;
    if patchwise {
        mesh = &problem.mesh;
        scene = enclosure(&problem.scene, mesh)?;
        method = named(args, &scene)?;
    }
    let stop = args.stop.or_to(ERROR);
    let tracer = Tracer::new(&scene, &*method, places.groups(mesh, &scene)?, &args.paths, &stop)?;
    let mut state = tracer.start();
    let watched = Stages::part(stages.console, stages.interrupt, "check");
    stages.run("tracing", || tracer.run(&mut state, &watched))?;
    if stages.interrupt.requested() {
        return Err(nothing_saved());
    }
    Ok(Traced { scene, state, patchwise })
}

/// Irradiances of faces and bands, W/m².
pub(super) fn deterministic(problem: &Problem, solution: &Solution) -> Vec<f64> {
    let (mesh, bands) = (&problem.mesh, problem.scene.bands().len());
    let mean = |face: usize, band: usize| {
        let weighed = |leaf: usize| mesh.patch(leaf).area() * solution.means.irradiance.row(leaf)[band];
        mesh.leaves_of_face(face).map(weighed).sum::<f64>() / mesh.faces()[face].area
    };
    (0..mesh.faces().len()).flat_map(|face| (0..bands).map(move |band| mean(face, band))).collect()
}

/// The worst band of every face.
fn map(problem: &Problem, faces: &[Place]) -> Result<fredholm_report::Picture, Failure> {
    let worse = |a: f64, b: f64| if b.abs() > a.abs() { b } else { a };
    let bands = problem.scene.bands().len();
    let scores: Vec<f64> =
        faces.chunks(bands).map(|face| face.iter().map(|place| place.z).fold(0.0, worse)).collect();
    let camera = problem.scene.camera().map(view_camera);
    score_map(&problem.mesh, &scores, camera.as_ref()).map_err(report_failure)
}

fn summarise(folder: &Path, record: &CrosscheckRecord) -> Result<(), Failure> {
    let mut lines = Lines::default();
    let CrosscheckRecord { verdict, significant, places, significance, correction, .. } = record;
    let verdict = match verdict.as_str() {
        UNDECIDED => "undecided: too little was sampled to say that they agree".to_owned(),
        verdict => format!("they {verdict}"),
    };
    lines.add(
        "verdict",
        format!("{verdict}: {significant} of {places} places apart at {significance} ({correction})"),
    );
    lines.add_some("power", record.power.as_ref().map(power));
    lines.add(
        "scores",
        format!("mean {:.3}, mean of squares {:.3}", record.score_mean, record.score_variance),
    );
    for place in &record.worst {
        lines.add("worst", worst(place));
    }
    lines.add(
        "traced",
        format!(
            "{}, {} batches, standard error {:.2} %",
            record.method,
            record.batches,
            100.0 * record.relative_error
        ),
    );
    lines.add("time", crate::summary::times(&record.timings));
    output::print(&lines.under(&format!("{} → {}", record.scene, folder.display())))
}

/// What would have been found.
fn power(power: &CrosscheckPower) -> String {
    let percent =
        |part: Option<f64>| part.map_or_else(|| "any".to_owned(), |x| format!("{:.2} %", 100.0 * x));
    format!(
        "a deviation of the whole by {} would have been found nine times out of ten, of a typical surface by {}, of a typical face by {}",
        percent(power.whole),
        percent(power.surface),
        percent(power.face)
    )
}

/// One of the places farthest apart, in words.
fn worst(place: &WorstPlace) -> String {
    let ([x, y, z], relative) = (place.centroid, 100.0 * place.relative);
    let (score, number, of) = (place.z, place.face, &place.surface);
    let head = format!("z = {score:+.2}, {relative:+.2} %");
    let at = format!("at ({x:.3}, {y:.3}, {z:.3})");
    match place.kind.as_str() {
        "whole" => format!("{head}: the whole, band {}", place.band),
        "surface" => format!("{head}: surface {of}, band {}", place.band),
        "face" => format!("{head}: face {number} of {of}, {at}, band {}", place.band),
        kind => format!("{head}: {kind} {number} of {of}, {at}, {}", place.band),
    }
}
