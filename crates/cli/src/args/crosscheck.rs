//! Options of `crosscheck`.

use std::path::PathBuf;

use clap::builder::PossibleValuesParser;
use clap::{Args, ValueEnum};
use fredholm_study::{CrosscheckOptions, FIELD_METHODS, LIGHT_METHODS, MultipleTests};

use super::paths::{PathArgs, TraceStopArgs, share};
use super::{LogArgs, ProblemArgs, accuracy};

/// What follows the help of `crosscheck`.
pub(super) const EXAMPLES: &str = "\
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
    #[arg(long, value_name = "NAME", value_parser = PossibleValuesParser::new(LIGHT_METHODS.iter().chain(&FIELD_METHODS)))]
    method: Option<String>,
    /// Error of the irradiance that `solve` is asked for, whose answer is checked [default: the
    /// scene's, else its elements]
    #[arg(long, value_name = "E", value_parser = accuracy)]
    pub(crate) accuracy: Option<f64>,
    /// Probability of a false alarm that is allowed
    #[arg(long, value_name = "P", default_value_t = CrosscheckOptions::default().significance, value_parser = share)]
    pub(crate) significance: f64,
    /// How many tests are taken into account
    #[arg(long, value_enum, value_name = "NAME", default_value_t = CorrectionName::Holm)]
    pub(crate) correction: CorrectionName,
    /// Folder for the results [default: out/<name of the scene file>-crosscheck]
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

impl From<CorrectionName> for MultipleTests {
    fn from(name: CorrectionName) -> Self {
        match name {
            CorrectionName::Holm => Self::Holm,
            CorrectionName::BenjaminiHochberg => Self::BenjaminiHochberg,
        }
    }
}

impl CrosscheckArgs {
    pub(crate) fn options(&self) -> CrosscheckOptions {
        CrosscheckOptions {
            method: self.method.clone(),
            accuracy: self.accuracy,
            significance: self.significance,
            correction: self.correction.into(),
            no_report: self.no_report,
            paths: self.paths.options(),
            stop: self.stop.options(),
            problem: self.problem.options(),
        }
    }
}
