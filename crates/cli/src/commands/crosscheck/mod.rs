//! `fredholm crosscheck`.

mod fields;
mod record;

use std::path::{Path, PathBuf};

use clap::builder::PossibleValuesParser;
use clap::{Args, ValueEnum};
use fredholm_montecarlo::State;
use fredholm_montecarlo::light::{METHODS, estimator};
use fredholm_montecarlo::statistics::{Comparison, Correction, Crosscheck, crosscheck as compare};
use fredholm_report::{CrosscheckRecord, WorstPlace, score_map, write_crosscheck};
use fredholm_scene::Scene;

use super::solve::{report_failure, view_camera};
use crate::args::{LogArgs, ProblemArgs, StopArgs};
use crate::failure::{Ending, Failure};
use crate::interrupt::nothing_saved;
use crate::options::Options;
use crate::output;
use crate::problem::{Problem, with_results};
use crate::solution::{Solution, compute};
use crate::stages::Stages;
use crate::start::Start;
use crate::stochastic::{
    FIELD_METHODS, PathArgs, TraceStopArgs, Tracer, enclosure, expected_error, faces, failure, share,
    with_tracing,
};
use crate::summary::Lines;
use crate::waves::is_scene;

/// Method where none is asked for.
const USUAL: &str = "jacobi";
/// Error that is asked for where nothing is.
const ERROR: f64 = 0.01;
/// Error of a row of form factors where neither the command line nor the scene asks for one: small beside what is compared.
const FORM_FACTORS: f64 = 1e-5;

/// What is missing where a continuous method is compared.
const UNKNOWN: &str = "the error of the mesh is not estimated, so that it counts as a fault; give every face at least 4 elements \
    (elements_per_face), or compare with jacobi, walk-gathering or walk-shooting";

/// What follows the help of `crosscheck`.
pub(crate) const EXAMPLES: &str = "\
Examples:
  fredholm crosscheck scenes/cornell_planar.toml
  fredholm crosscheck room.toml --method path --to 0.5% -o out/checked
  fredholm crosscheck room.toml --significance 0.001 --correction benjamini-hochberg
  fredholm crosscheck scenes/waves/plate.toml --method field-particles --to 2%

The scene is solved and traced, and the irradiance of every face and band is compared by its z,
the difference over the standard error and the estimated deterministic error together. The
verdict takes the number of places into account; a scene that is right fails with a
probability of --significance at most. jacobi, walk-gathering and walk-shooting estimate what
is solved; path, light, bidirectional and photon the continuous equation, where the estimated
error of the mesh counts as well. Written are crosscheck.csv, crosscheck.svg, crosscheck.png (red:
the traced solution is the brighter), and crosscheck.json last. Exit code 6 where the two
disagree.

Of a scene of waves every number of the scattered E at every point of a receiver is compared, one
bounce or two; written are crosscheck.csv, crosscheck.svg and crosscheck.json.";

/// Options of `crosscheck`.
#[derive(Clone, Debug, Args)]
pub(crate) struct CrosscheckArgs {
    /// Stochastic method [default: jacobi, of waves surface-sampling]
    #[arg(long, value_name = "NAME", value_parser = PossibleValuesParser::new(METHODS.into_iter().chain(FIELD_METHODS)))]
    method: Option<String>,
    /// Probability of a false alarm that is allowed
    #[arg(long, value_name = "P", default_value_t = 0.01, value_parser = share)]
    pub(crate) significance: f64,
    /// How many tests are taken into account
    #[arg(long, value_enum, value_name = "NAME", default_value_t = CorrectionName::Holm)]
    pub(crate) correction: CorrectionName,
    /// Folder for the results [default: out/<name of the scene file>]
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
    let (problem, options) = load(&args.problem, args.log, folder, stages)?;
    let solution = compute(&problem, &options, stages)?;
    let (state, patchwise) = traced(args, &problem, stages)?;
    if !patchwise && solution.mesh_error.is_none() {
        stages.console.warn(UNKNOWN);
    }
    let error = expected_error(&problem, &solution, !patchwise);
    let values = deterministic(&problem, &solution);
    let found = compared(args, (&values, &error), &state)?;
    let record = record::record(args, &problem, (&values, &state), &found, stages);
    let rows = record::rows(&problem, (&values, &error), &state, &found);
    let map = map(&problem, &found)?;
    let bands = problem.scene.bands();
    write_crosscheck(folder, &problem.mesh, bands, (&rows, &map), &record).map_err(report_failure)?;
    if !args.log.quiet {
        summarise(folder, "face", &record)?;
    }
    Ok(if found.agrees() { Ending::Done } else { Ending::Disagrees })
}

fn compared(
    args: &CrosscheckArgs,
    (values, error): (&[f64], &[f64]),
    state: &State,
) -> Result<Crosscheck, Failure> {
    let comparison = Comparison {
        deterministic: values,
        deterministic_error: error,
        stochastic: state.groups.mean(),
        standard_error: &state.groups.standard_errors(),
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

fn traced(args: &CrosscheckArgs, problem: &Problem, stages: &mut Stages) -> Result<(State, bool), Failure> {
    let scene = enclosure(&problem.scene, &problem.mesh)?;
    let name = args.method_or(USUAL);
    let none = || Failure::new(Ending::Input, format!("there is no method {name}"));
    let method = estimator(name, &scene, args.paths.switches()).ok_or_else(none)?;
    let stop = args.stop.or_to(ERROR);
    let tracer = Tracer::new(&scene, &*method, faces(&problem.mesh, &scene)?, &args.paths, &stop)?;
    let mut state = tracer.start();
    let watched = Stages::part(stages.console, stages.interrupt, "check");
    stages.run("tracing", || tracer.run(&mut state, &watched))?;
    if stages.interrupt.requested() { Err(nothing_saved()) } else { Ok((state, method.patchwise())) }
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
fn map(problem: &Problem, found: &Crosscheck) -> Result<fredholm_report::Picture, Failure> {
    let worse = |a: f64, b: f64| if b.abs() > a.abs() { b } else { a };
    let bands = problem.scene.bands().len();
    let scores: Vec<f64> =
        found.places.chunks(bands).map(|face| face.iter().map(|place| place.z).fold(0.0, worse)).collect();
    let camera = problem.scene.camera().map(view_camera);
    score_map(&problem.mesh, &scores, camera.as_ref()).map_err(report_failure)
}

fn summarise(folder: &Path, kind: &str, record: &CrosscheckRecord) -> Result<(), Failure> {
    let mut lines = Lines::default();
    let CrosscheckRecord { verdict, significant, places, significance, correction, .. } = record;
    lines.add(
        "verdict",
        format!("they {verdict}: {significant} of {places} places apart at {significance} ({correction})"),
    );
    lines.add(
        "scores",
        format!("mean {:.3}, mean of squares {:.3}", record.score_mean, record.score_variance),
    );
    for place in &record.worst {
        lines.add("worst", worst(kind, place));
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

/// One of the places farthest apart, in words.
fn worst(kind: &str, place: &WorstPlace) -> String {
    let ([x, y, z], relative) = (place.centroid, 100.0 * place.relative);
    let band = if kind == "face" { format!("band {}", place.band) } else { place.band.clone() };
    let (score, number, of) = (place.z, place.face, &place.surface);
    format!("z = {score:+.2}, {relative:+.2} %: {kind} {number} of {of}, at ({x:.3}, {y:.3}, {z:.3}), {band}")
}
