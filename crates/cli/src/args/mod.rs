//! What the command line understands.

mod compare;
mod crosscheck;
mod exchange;
mod judge;
mod paths;
mod reference;
mod resume;
mod shoot;
mod spectrum;
mod trace;
mod viewfactors;
mod waves;

use std::ffi::OsString;
use std::path::PathBuf;
use std::time::Duration;

use clap::builder::PossibleValuesParser;
use clap::{Arg, Args, CommandFactory, FromArgMatches, Parser, Subcommand, ValueEnum};
use clap_complete::Shell;
use fredholm_study::{
    Bytes, ConvergeOptions, FalseColour, GatherPoints, PointGrid, ProblemOptions, Receiver, ResultFolder,
    SolveOptions, StopOptions, discretisation, solver_names,
};
use serde::Serialize;

use crate::commands::{VIEW_EXAMPLES, ViewArgs};
use crate::duration;
use crate::start::recorded;
pub(crate) use compare::CompareArgs;
pub(crate) use crosscheck::CrosscheckArgs;
pub(crate) use exchange::{ConvertArgs, ExportArgs};
pub(crate) use judge::JudgeArgs;
pub(crate) use reference::ReferenceArgs;
pub(crate) use resume::ResumeArgs;
pub(crate) use shoot::ShootArgs;
pub(crate) use spectrum::SpectrumArgs;
pub(crate) use trace::TraceArgs;
pub(crate) use viewfactors::{ViewFactorsArgs, plane, point};
pub(crate) use waves::WavesArgs;

const EXAMPLES: &str = "\
Examples:
  fredholm solve scenes/cornell_box.toml
  fredholm check scenes/cornell_box.toml
  fredholm info out/cornell_box

Exit codes:
  0    done
  2    bad input or usage
  3    not converged, or out of time; the results so far are written all the same
  4    resources refused, such as memory
  5    a file could not be read or written, those that the scene names included
  6    two solutions disagree, or a tracer with the reference
  130  interrupted";

const SOLVE_EXAMPLES: &str = "\
Examples:
  fredholm solve scenes/cornell_box.toml
  fredholm solve room.toml -o results --solver lu --memory 8GiB
  fredholm solve room.toml --storage f32 --threads 4 --log json 2> log.jsonl
  fredholm solve room.toml --discretisation galerkin-1
  fredholm solve room.toml --accuracy 1%
  fredholm solve room.toml --accuracy 1% --goal desk,board
  fredholm solve room.toml --accuracy 1% --final-gather --point 1,2,0.8,0,0,1
  fredholm solve house.obj --accuracy 5%
  fredholm solve city.obj --accuracy 5% --way rays --time-limit 10min
  fredholm solve room.glb --also ply,glb
  fredholm solve room.toml --accuracy 1% --false-colour

A mesh file stands for a scene: .obj, .stl, .ply, .gltf, .glb, .msh (Gmsh 4.1), .rad (Radiance), .xml
(Mitsuba 3) or .vs3 (View3D). Reflectances and lamps are those of the file (of an OBJ those of its .mtl
file: Kd and Ke); where nothing emits, light comes evenly from all sides. What was taken is told.

An accuracy is reached by hierarchical radiosity, by the matrix of the scene's elements, or in
furnished scenes by rays, whichever is predicted to cost about the least; the summary says which.
With the former, mesh.png shows the elements and links.png what the element in the middle of the
picture receives its light from.

Ctrl-C during the assembly ends the run with nothing written; during the solution by an
iterative solver the current iterate is written as a result marked \"partial\", with a small
picture. A second Ctrl-C ends the run at once.";

const CHECK_EXAMPLES: &str = "\
Examples:
  fredholm check scenes/cornell_box.toml
  fredholm check house.obj -o out
  fredholm check scenes/waves/cube.toml
  fredholm check room.toml --memory 8GiB
  fredholm check scenes/leblond_furnished.toml --accuracy 2%

A mesh file (.obj, .stl, .ply, .gltf, .glb, .msh, .rad, .xml, .vs3) stands for a scene: see
`fredholm solve --help`.";

const CONVERGE_EXAMPLES: &str = "\
Examples:
  fredholm converge room.toml --levels 4
  fredholm converge room.toml --levels 3 --discretisation galerkin-1 -o study
  fredholm converge room.toml --levels 5 --form-factor-tolerance 1e-6 --memory 8GiB

Level 0 is the mesh of the scene; each level cuts every element into 2 × 2. The faces of the
scene stay what they are, and what is compared are means of the irradiance over them. An
order takes three levels. Written are converge.csv, converge.svg, report.html, and
converge.json last. Ctrl-C ends the run with nothing written.";

const INFO_EXAMPLES: &str = "\
Examples:
  fredholm info out/cornell_box
  fredholm info out/cornell_box/image.png
  fredholm info F.npz
  fredholm info F.csv";

const SCHEMA_EXAMPLES: &str = "\
Examples:
  fredholm schema > scene.schema.json
  fredholm schema --waves > waves.schema.json";

const COMPLETIONS_EXAMPLES: &str = "\
Examples:
  fredholm completions bash > ~/.local/share/bash-completion/completions/fredholm
  fredholm completions zsh > ~/.zfunc/_fredholm";

const DISCRETISATIONS_EXAMPLES: &str = "\
Example:
  fredholm discretisations";

const SOLVERS_EXAMPLES: &str = "\
Example:
  fredholm solvers";

/// Fredholm solves x = b + K x on the surfaces of a scene: diffuse light, deterministically.
#[derive(Debug, Parser)]
#[command(name = "fredholm", version, after_help = EXAMPLES)]
pub(crate) struct Cli {
    #[command(subcommand)]
    pub(crate) command: Command,
}

impl Cli {
    /// Reads a command line. Negative numbers are values, so that an option that takes none says
    /// itself what it takes.
    pub(crate) fn read<T: Into<OsString> + Clone>(
        line: impl IntoIterator<Item = T>,
    ) -> Result<Self, clap::Error> {
        let negative =
            |arg: Arg| if arg.get_action().takes_values() { arg.allow_negative_numbers(true) } else { arg };
        let command = Self::command().mut_subcommands(|verb| verb.mut_args(negative));
        Self::from_arg_matches(&command.try_get_matches_from(line)?)
    }
}

/// The verbs.
#[derive(Debug, Subcommand)]
pub(crate) enum Command {
    /// Solve a scene and write the results
    #[command(after_help = SOLVE_EXAMPLES)]
    Solve(SolveArgs),
    /// Go on with a run to an accuracy that was stopped
    #[command(after_help = resume::EXAMPLES)]
    Resume(ResumeArgs),
    /// Validate a scene, tell what its mesh is, and predict memory and time; solves nothing
    #[command(after_help = CHECK_EXAMPLES)]
    Check(CheckArgs),
    /// Solve a scene on finer and finer meshes; state the order and what error remains
    #[command(after_help = CONVERGE_EXAMPLES)]
    Converge(ConvergeArgs),
    /// Run solvers on the same system; tell iterations, work, time and errors
    #[command(after_help = compare::EXAMPLES)]
    Compare(CompareArgs),
    /// Progressive radiosity without the matrix: pictures at once, and from scenes whose matrix
    /// would not fit
    #[command(after_help = shoot::EXAMPLES)]
    Shoot(ShootArgs),
    /// Analyse the matrix of a scene: eigenvalues, radii, conditions, properties
    #[command(after_help = spectrum::EXAMPLES)]
    Spectrum(SpectrumArgs),
    /// Compute the view-factor matrix of a scene or a mesh file
    #[command(name = "viewfactors", after_help = viewfactors::EXAMPLES)]
    ViewFactors(ViewFactorsArgs),
    /// Compute the fields of a scene of waves: conductors and other bodies in a time-harmonic field
    #[command(after_help = waves::EXAMPLES)]
    Waves(WavesArgs),
    /// Trace a scene by random paths, with standard errors
    #[command(after_help = trace::EXAMPLES)]
    Trace(TraceArgs),
    /// Solve and trace a scene, and decide by statistics whether the two agree
    #[command(after_help = crosscheck::EXAMPLES)]
    Crosscheck(CrosscheckArgs),
    /// Write reference values with stated errors, to check other tracers with
    #[command(after_help = reference::EXAMPLES)]
    Reference(ReferenceArgs),
    /// Judge what another tracer has found by reference values
    #[command(after_help = judge::EXAMPLES)]
    Judge(JudgeArgs),
    /// Write a scene for another program: Mitsuba, pbrt, Radiance, Gmsh, or as a mesh
    #[command(after_help = exchange::EXPORT_EXAMPLES)]
    Export(ExportArgs),
    /// Write a mesh in another format
    #[command(after_help = exchange::CONVERT_EXAMPLES)]
    Convert(ConvertArgs),
    /// Open the page of a result, report.html, or print where it is
    #[command(after_help = VIEW_EXAMPLES)]
    View(ViewArgs),
    /// Tell what made a result
    #[command(after_help = INFO_EXAMPLES)]
    Info(InfoArgs),
    /// Print the JSON Schema of scene files
    #[command(after_help = SCHEMA_EXAMPLES)]
    Schema(SchemaArgs),
    /// Print the completions of a shell
    #[command(after_help = COMPLETIONS_EXAMPLES)]
    Completions(CompletionsArgs),
    /// List the solvers
    #[command(after_help = SOLVERS_EXAMPLES)]
    Solvers,
    /// List the discretisations
    #[command(after_help = DISCRETISATIONS_EXAMPLES)]
    Discretisations,
}

impl Command {
    /// How this command shows errors.
    pub(crate) fn log(&self) -> LogFormat {
        match self {
            Self::Solve(args) => args.log.log,
            Self::Resume(args) => args.log.log,
            Self::Check(args) => args.log.log,
            Self::Converge(args) => args.log.log,
            Self::Compare(args) => args.log.log,
            Self::Shoot(args) => args.log.log,
            Self::Spectrum(args) => args.log.log,
            Self::ViewFactors(args) => args.log.log,
            Self::Waves(args) => args.log.log,
            Self::Trace(args) => args.log.log,
            Self::Crosscheck(args) => args.log.log,
            Self::Reference(args) => args.log.log,
            Self::Judge(args) => args.log.log,
            Self::Export(args) => args.log.log,
            Self::Convert(args) => args.log.log,
            _ => LogFormat::Plain,
        }
    }
}

/// How to show what is going on, and how long it may go on.
#[derive(Clone, Copy, Debug, Args)]
pub(crate) struct LogArgs {
    /// Form of progress and errors on standard error
    #[arg(long, value_enum, default_value_t, value_name = "FORM")]
    pub(crate) log: LogFormat,
    /// Show neither progress nor warnings nor summary, errors only
    #[arg(long, short)]
    pub(crate) quiet: bool,
    /// End the run after this time, such as 30s, 10min or 2h: what there is then is kept as after
    /// Ctrl-C, and the exit code is 3
    #[arg(long, value_name = "TIME", value_parser = duration::parse)]
    pub(crate) time_limit: Option<Duration>,
}

/// Form of what goes to standard error.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, ValueEnum)]
#[serde(rename_all = "lowercase")]
pub(crate) enum LogFormat {
    /// Bars on a terminal, lines elsewhere
    #[default]
    Plain,
    /// A JSON object a line
    Json,
}

/// A way to an accuracy.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub(crate) enum Way {
    /// Hierarchical radiosity: elements are chosen where they are needed, and linked
    Links,
    /// Rays from the elements of the scene, whose parts they tell apart
    Rays,
}

impl From<Way> for fredholm_study::Way {
    fn from(way: Way) -> Self {
        match way {
            Way::Links => Self::Links,
            Way::Rays => Self::Rays,
        }
    }
}

/// A further file with the field.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub(crate) enum FieldFile {
    /// Colours at the corners, and the values of the elements
    Ply,
    /// Colours and radiosity at the corners
    Glb,
    /// Linear colours of the picture
    Exr,
}

impl From<FieldFile> for fredholm_study::FieldFile {
    fn from(file: FieldFile) -> Self {
        match file {
            FieldFile::Ply => Self::Ply,
            FieldFile::Glb => Self::Glb,
            FieldFile::Exr => Self::Exr,
        }
    }
}

/// Number format of the stored matrix.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub(crate) enum Precision {
    /// 8 bytes an entry
    F64,
    /// 4 bytes an entry; arithmetic stays f64
    F32,
}

impl From<Precision> for fredholm_study::Precision {
    fn from(precision: Precision) -> Self {
        match precision {
            Precision::F64 => Self::F64,
            Precision::F32 => Self::F32,
        }
    }
}

/// What decides the size and the effort of a problem; where given it goes before the scene's
/// `[solve]` table.
#[derive(Clone, Debug, Args)]
pub(crate) struct ProblemArgs {
    /// Scene file (.toml), or mesh file that stands for a scene (.obj, .stl, .ply, .gltf, .glb,
    /// .msh, .rad, .xml, .vs3)
    pub(crate) scene: PathBuf,
    /// Threads; any number gives the same results [default: one a core]
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u16).range(1..=1024))]
    pub(crate) threads: Option<u16>,
    /// Discretisation, as `fredholm discretisations` lists them [default: the scene's, else
    /// galerkin-0]
    #[arg(long, value_name = "NAME", value_parser = discretisation_name)]
    pub(crate) discretisation: Option<String>,
    /// Solver [default: the scene's, else gauss-seidel]
    #[arg(long, value_name = "NAME", value_parser = PossibleValuesParser::new(solver_names()))]
    pub(crate) solver: Option<String>,
    /// Error asked for in a row of form factors, rounded down to a power of ten, 1e-14 at least
    /// [default: the scene's, else 1e-3]
    #[arg(long, value_name = "T", value_parser = tolerance)]
    pub(crate) form_factor_tolerance: Option<f64>,
    /// Number format of the stored matrix [default: the scene's, else f64]
    #[arg(long, value_enum, value_name = "FORMAT")]
    pub(crate) storage: Option<Precision>,
    /// Memory allowed, such as 4GiB or 800MB [default: what leaves the machine usable]
    #[arg(long, value_name = "LIMIT")]
    pub(crate) memory: Option<Bytes>,
}

impl ProblemArgs {
    pub(crate) fn options(&self) -> ProblemOptions {
        ProblemOptions {
            threads: self.threads,
            discretisation: self.discretisation.clone(),
            solver: self.solver.clone(),
            form_factor_tolerance: self.form_factor_tolerance,
            storage: self.storage.map(Into::into),
            memory: self.memory,
        }
    }
}

/// Options of `solve`.
#[derive(Clone, Debug, Args)]
#[allow(clippy::struct_excessive_bools, reason = "each is a switch of the command line")]
pub(crate) struct SolveArgs {
    /// Folder for the results [default: out/<name of the scene file>]
    #[arg(long, short, value_name = "DIR")]
    pub(crate) output: Option<PathBuf>,
    /// Error of the irradiance of the faces to reach, such as 1% or 0.01; the elements are then
    /// chosen by hierarchical radiosity [default: the scene's, else its elements]
    #[arg(long, value_name = "E", value_parser = accuracy)]
    pub(crate) accuracy: Option<f64>,
    /// How to reach the accuracy [default: the way that is predicted to cost about the least]
    #[arg(long, value_enum, value_name = "WAY")]
    pub(crate) way: Option<Way>,
    /// Surfaces, by their names, whose mean irradiance is to have the accuracy; all else is only as
    /// exact as that needs, and the elements are chosen by hierarchical radiosity
    #[arg(long, value_name = "SURFACE", value_delimiter = ',')]
    pub(crate) goal: Vec<String>,
    /// Gather the light of image.png that lamps do not send themselves along 512 directions from
    /// some ten thousand places, instead of interpolating it between elements; pixels.npz has its
    /// colours with their standard errors
    #[arg(long)]
    pub(crate) final_gather: bool,
    /// Also draw false_colour.png, the irradiance (W/m²) of what the camera sees in false colour,
    /// with lines of equal irradiance and numbers at points of the surfaces, which false_colour.csv
    /// lists; in a band as in --false-colour=g, else in all bands together
    #[arg(long, value_name = "BAND", num_args = 0..=1, require_equals = true)]
    #[allow(clippy::option_option, reason = "the inner one is missing where no band is named")]
    pub(crate) false_colour: Option<Option<String>>,
    /// Draw no picture
    #[arg(long, conflicts_with_all = ["final_gather", "false_colour"])]
    pub(crate) no_pictures: bool,
    /// Write no report.html
    #[arg(long)]
    pub(crate) no_report: bool,
    /// Also write the elements with their light as colours and numbers, field.ply and field.glb, or
    /// the linear colours of the picture, image.exr
    #[arg(long, value_enum, value_name = "FORMAT", value_delimiter = ',')]
    pub(crate) also: Vec<FieldFile>,
    /// Also write shadows.vtu, for which the elements are cut along the borders of the shadows that
    /// lamps cast and gather their irradiance at the corners
    #[arg(long)]
    pub(crate) discontinuity: bool,
    #[command(flatten)]
    pub(crate) places: PlaceArgs,
    #[command(flatten)]
    pub(crate) problem: ProblemArgs,
    #[command(flatten)]
    pub(crate) stop: StopArgs,
    #[command(flatten)]
    pub(crate) log: LogArgs,
}

impl SolveArgs {
    /// What is asked for; checkpoints are kept in the folder for the results.
    pub(crate) fn options(&self, folder: ResultFolder) -> SolveOptions {
        SolveOptions {
            accuracy: self.accuracy,
            way: self.way.map(Into::into),
            goal: self.goal.clone(),
            final_gather: self.final_gather,
            false_colour: self.false_colour.clone().map(|band| FalseColour { band }),
            discontinuity: self.discontinuity,
            no_pictures: self.no_pictures,
            no_report: self.no_report,
            also: self.also.iter().map(|&file| file.into()).collect(),
            points: GatherPoints { points: self.places.point.clone(), grids: self.places.plane.clone() },
            problem: self.problem.options(),
            stop: self.stop.options(),
            folder: Some(folder),
            recorded: recorded(self.log),
        }
    }
}

/// Where the irradiance is gathered for points.csv.
#[derive(Clone, Debug, Default, Args)]
pub(crate) struct PlaceArgs {
    /// Point with a normal that receives light, for points.csv: x,y,z,nx,ny,nz (may be given
    /// several times)
    #[arg(long, value_name = "POINT", value_parser = point, allow_hyphen_values = true)]
    pub(crate) point: Vec<Receiver>,
    /// Such points in a parallelogram: ox,oy,oz,ux,uy,uz,vx,vy,vz,NU,NV, normal u × v (may be given
    /// several times)
    #[arg(long, value_name = "PLANE", value_parser = plane, allow_hyphen_values = true)]
    pub(crate) plane: Vec<PointGrid>,
}

/// When a solution ends.
#[derive(Clone, Copy, Debug, Args)]
pub(crate) struct StopArgs {
    /// Relative residual ‖b − A x‖₂/‖b‖₂ to reach in every band [default: the scene's, else 1e-10]
    #[arg(long, value_name = "T", value_parser = tolerance)]
    pub(crate) tolerance: Option<f64>,
    /// Iterations allowed [default: the scene's, else 1000]
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u32).range(1..))]
    pub(crate) max_iterations: Option<u32>,
}

impl StopArgs {
    fn options(self) -> StopOptions {
        StopOptions { tolerance: self.tolerance, max_iterations: self.max_iterations }
    }
}

/// Options of `converge`.
#[derive(Clone, Debug, Args)]
pub(crate) struct ConvergeArgs {
    /// Folder for the results [default: out/<name of the scene file>-converge]
    #[arg(long, short, value_name = "DIR")]
    pub(crate) output: Option<PathBuf>,
    /// Number of meshes: that of the scene, and finer ones
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u8).range(2..=12))]
    pub(crate) levels: u8,
    /// Write no report.html
    #[arg(long)]
    pub(crate) no_report: bool,
    #[command(flatten)]
    pub(crate) problem: ProblemArgs,
    #[command(flatten)]
    pub(crate) stop: StopArgs,
    #[command(flatten)]
    pub(crate) log: LogArgs,
}

impl ConvergeArgs {
    pub(crate) fn options(&self) -> ConvergeOptions {
        let (problem, stop) = (self.problem.options(), self.stop.options());
        let (levels, no_report) = (self.levels, self.no_report);
        ConvergeOptions { levels, no_report, problem, stop, recorded: recorded(self.log) }
    }
}

/// Options of `check`.
#[derive(Clone, Debug, Args)]
pub(crate) struct CheckArgs {
    /// Folder for check.png: fronts blue, backs orange, what lies on or crosses something violet,
    /// open sides yellow
    #[arg(long, short, value_name = "DIR")]
    pub(crate) output: Option<PathBuf>,
    /// Accuracy that the solution is to have, such as 2% or 0.02 [default: that of the scene, else
    /// its elements]
    #[arg(long, value_name = "E", value_parser = accuracy)]
    pub(crate) accuracy: Option<f64>,
    #[command(flatten)]
    pub(crate) problem: ProblemArgs,
    #[command(flatten)]
    pub(crate) log: LogArgs,
}

/// Options of `info`.
#[derive(Clone, Debug, Args)]
pub(crate) struct InfoArgs {
    /// Result folder, a file in one, or a file of view factors
    pub(crate) path: PathBuf,
}

/// Options of `schema`.
#[derive(Clone, Copy, Debug, Args)]
pub(crate) struct SchemaArgs {
    /// The schema of scenes of waves instead of scenes of light
    #[arg(long)]
    pub(crate) waves: bool,
}

/// Options of `completions`.
#[derive(Clone, Debug, Args)]
pub(crate) struct CompletionsArgs {
    /// Shell
    pub(crate) shell: Shell,
}

/// The name by which a discretisation is listed.
fn discretisation_name(text: &str) -> Result<String, String> {
    discretisation(text).map(|found| found.name().to_owned()).map_err(|error| error.to_string())
}

pub(crate) fn tolerance(text: &str) -> Result<f64, String> {
    match text.parse::<f64>() {
        Ok(value) if value > 0.0 && value < 1.0 => Ok(value),
        _ => Err("must be a number above 0 and below 1, such as 1e-6".to_owned()),
    }
}

/// A relative error, as a number or in per cent.
pub(crate) fn accuracy(text: &str) -> Result<f64, String> {
    let wrong = || "must be above 0 and below 100%, such as 1% or 0.01".to_owned();
    let (number, unit) = text.strip_suffix('%').map_or((text, 1.0), |number| (number, 0.01));
    let value = number.trim().parse::<f64>().map_err(|_| wrong())? * unit;
    if value > 0.0 && value < 1.0 { Ok(value) } else { Err(wrong()) }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_definition_is_sound() {
        Cli::command().debug_assert();
    }

    #[test]
    fn negative_numbers_are_answered_by_the_option() {
        for (line, wanted) in [
            ("fredholm viewfactors a.obj --tolerance -1", "above 0 and below 1"),
            ("fredholm converge a.toml --levels -1", "2..=12"),
            ("fredholm solve a.toml --threads -3", "1..=1024"),
        ] {
            let message = Cli::read(line.split(' ')).unwrap_err().to_string();
            assert!(message.contains(wanted), "{message}");
        }
        assert!(Cli::read(["fredholm", "info", "-x"]).is_err());
    }

    #[test]
    fn an_accuracy_is_a_number_or_in_per_cent() {
        assert_eq!((accuracy("1%"), accuracy("0.02"), accuracy("50 %")), (Ok(0.01), Ok(0.02), Ok(0.5)));
        for text in ["0", "0%", "1", "100%", "-1%", "nan%", "inf", "%", "x", ""] {
            assert!(accuracy(text).is_err(), "{text}");
        }
    }

    #[test]
    fn tolerances_lie_between_zero_and_one() {
        assert_eq!(tolerance("1e-6"), Ok(1e-6));
        for text in ["0", "1", "-1e-3", "nan", "inf", "x", ""] {
            assert!(tolerance(text).is_err(), "{text}");
        }
    }
}
