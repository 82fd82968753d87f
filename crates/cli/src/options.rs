//! The options in force: those of the command line, else those of the scene, else the program's.

use fredholm_coupling::Receiver;
use fredholm_scene::{SolveDefaults, Storage};
use serde::{Serialize, Serializer};

use std::path::Path;

use crate::args::{LogArgs, LogFormat, Precision, ProblemArgs, StopArgs};
use crate::memory::Limit;
use crate::size::Bytes;
use crate::{memory, registry, threads};

const TOLERANCE: f64 = 1e-10;
const MAX_ITERATIONS: u64 = 1000;
const FORM_FACTOR_TOLERANCE: f64 = 1e-3;
/// The discretisation where none is asked for: constants on the elements, from form factors.
pub(crate) const RADIOSITY: &str = "galerkin-0";

/// What decides the size and the effort of a problem.
#[derive(Clone, Debug, Serialize)]
pub(crate) struct ProblemOptions {
    pub(crate) discretisation: String,
    pub(crate) solver: String,
    pub(crate) form_factor_tolerance: f64,
    pub(crate) storage: Precision,
    pub(crate) threads: usize,
    /// `None`: most of what the system has.
    pub(crate) memory_limit_bytes: Option<u64>,
}

/// All options of a solution.
#[derive(Clone, Debug, Serialize)]
#[allow(clippy::struct_excessive_bools, reason = "each is a switch of the command line")]
pub(crate) struct Options {
    #[serde(flatten)]
    pub(crate) problem: ProblemOptions,
    /// Where elements are chosen by hierarchical radiosity.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub(crate) accuracy: Option<f64>,
    /// Surfaces whose mean irradiance is to have the accuracy.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub(crate) goal: Vec<String>,
    /// Why an accuracy was reached in the way it was.
    #[serde(skip)]
    pub(crate) choice: Option<String>,
    /// Points whose irradiance is gathered.
    #[serde(serialize_with = "places", skip_serializing_if = "Vec::is_empty")]
    pub(crate) points: Vec<Receiver>,
    /// Whether the light of every pixel is gathered for a picture.
    #[serde(skip_serializing_if = "std::ops::Not::not")]
    pub(crate) final_gather: bool,
    /// Whether elements are cut along the borders of shadows.
    #[serde(skip_serializing_if = "std::ops::Not::not")]
    pub(crate) discontinuity: bool,
    /// Whether nothing is drawn.
    #[serde(skip_serializing_if = "std::ops::Not::not")]
    pub(crate) no_pictures: bool,
    /// Whether the page is left out.
    #[serde(skip_serializing_if = "std::ops::Not::not")]
    pub(crate) no_report: bool,
    pub(crate) tolerance: f64,
    pub(crate) max_iterations: u64,
    pub(crate) output: String,
    pub(crate) log: LogFormat,
    pub(crate) quiet: bool,
}

impl ProblemOptions {
    pub(crate) fn new(args: &ProblemArgs, scene: &SolveDefaults) -> Self {
        let discretisation = args.discretisation.as_ref().or(scene.discretisation.as_ref());
        let solver = args.solver.as_ref().or(scene.solver.as_ref());
        let form_factor_tolerance = args.form_factor_tolerance.or(scene.form_factor_tolerance);
        let storage = args.storage.or(scene.storage.map(precision));
        Self {
            discretisation: discretisation.map_or_else(|| RADIOSITY.to_owned(), Clone::clone),
            solver: solver.map_or_else(|| registry::DEFAULT.to_owned(), Clone::clone),
            form_factor_tolerance: form_factor_tolerance.unwrap_or(FORM_FACTOR_TOLERANCE),
            storage: storage.unwrap_or(Precision::F64),
            threads: threads::count(args.threads),
            memory_limit_bytes: args.memory.map(|Bytes(limit)| u64::try_from(limit).unwrap_or(u64::MAX)),
        }
    }

    pub(crate) fn memory_limit(&self) -> Limit {
        memory::limit(self.memory_limit_bytes.map(|bytes| Bytes(bytes.into())))
    }
}

impl Options {
    pub(crate) fn new(
        problem: ProblemOptions,
        stop: StopArgs,
        scene: &SolveDefaults,
        output: &Path,
        LogArgs { log, quiet }: LogArgs,
    ) -> Self {
        let iterations = stop.max_iterations.map(u64::from).or(scene.max_iterations);
        Self {
            problem,
            accuracy: None,
            goal: Vec::new(),
            choice: None,
            points: Vec::new(),
            final_gather: false,
            discontinuity: false,
            no_pictures: false,
            no_report: false,
            tolerance: stop.tolerance.or(scene.tolerance).unwrap_or(TOLERANCE),
            max_iterations: iterations.unwrap_or(MAX_ITERATIONS),
            output: output.display().to_string(),
            log,
            quiet,
        }
    }
}

/// Points as lists of numbers: place and normal.
fn places<S: Serializer>(points: &[Receiver], serializer: S) -> Result<S::Ok, S::Error> {
    serializer.collect_seq(points.iter().map(|r| [r.point.to_array(), r.normal.to_array()].concat()))
}

fn precision(storage: Storage) -> Precision {
    match storage {
        Storage::F64 => Precision::F64,
        Storage::F32 => Precision::F32,
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::args::{Cli, Command};
    use clap::Parser;

    fn options(line: &str, scene: &SolveDefaults) -> Options {
        let Command::Solve(args) = Cli::try_parse_from(line.split(' ')).unwrap().command else {
            panic!("{line} is no solve")
        };
        let problem = ProblemOptions::new(&args.problem, scene);
        let folder = crate::folder::of(args.output.as_ref(), &args.problem.scene);
        Options::new(problem, args.stop, scene, &folder, args.log)
    }

    #[test]
    fn the_command_line_goes_before_the_scene_and_that_before_the_program() {
        let scene = SolveDefaults {
            discretisation: Some("nystrom-2".into()),
            solver: Some("lu".into()),
            tolerance: Some(1e-5),
            max_iterations: Some(7),
            form_factor_tolerance: Some(1e-6),
            storage: Some(Storage::F32),
            accuracy: None,
        };
        let own = options("fredholm solve a/b.toml", &SolveDefaults::default());
        assert_eq!(
            (own.problem.solver.as_str(), own.tolerance, own.max_iterations),
            ("gauss-seidel", 1e-10, 1000)
        );
        assert_eq!((own.problem.form_factor_tolerance, own.output.as_str()), (1e-3, "out/b"));
        assert_eq!(own.problem.discretisation, "galerkin-0");
        let theirs = options("fredholm solve a/b.toml", &scene);
        assert_eq!(
            (theirs.problem.solver.as_str(), theirs.tolerance, theirs.max_iterations),
            ("lu", 1e-5, 7)
        );
        assert_eq!((theirs.problem.form_factor_tolerance, theirs.problem.storage), (1e-6, Precision::F32));
        assert_eq!(theirs.problem.discretisation, "nystrom-2");
        let given = "fredholm solve a.toml --discretisation galerkin-q1 --solver southwell --storage f64 --max-iterations 9 --threads 3 --memory 2kB";
        let given = options(given, &scene);
        assert_eq!(given.problem.discretisation, "galerkin-1");
        assert_eq!((given.problem.solver.as_str(), given.problem.storage), ("southwell", Precision::F64));
        assert_eq!(
            (given.max_iterations, given.problem.threads, given.problem.memory_limit_bytes),
            (9, 3, Some(2000))
        );
    }
}
