//! Options of `trace`.

use std::path::PathBuf;

use clap::Args;
use clap::builder::PossibleValuesParser;
use fredholm_study::{FIELD_METHODS, LIGHT_METHODS, TraceOptions};

use super::paths::{PathArgs, TraceStopArgs};
use super::{LogArgs, ProblemArgs};

/// What follows the help of `trace`.
pub(super) const EXAMPLES: &str = "\
Examples:
  fredholm trace scenes/cornell_planar.toml --method path --to 1% -o out/traced
  fredholm trace room.toml --method jacobi --seconds 30
  fredholm trace room.toml --method path --control --samples 256
  fredholm trace room.toml --method bidirectional --to 5% --spp 256
  fredholm trace scenes/waves/plate.toml --method surface-sampling --to 1%
  fredholm trace room.toml --method light --to 0.5% -o out/traced --continue

All methods estimate the irradiance of the elements, with standard errors between batches.
Methods that gather (path, bidirectional, photon, walk-gathering) start at every element, the
others (light, walk-shooting, jacobi) at the lamps. walk-gathering, walk-shooting and jacobi
estimate what `solve` solves, constants on elements; the others the continuous equation. Written
are faces.csv with standard errors, image.png, report.html, trace.json, which --continue reads, and
run.json last. Ctrl-C keeps what is there by then. Without --samples, --seconds and --to it is --to 1%.
With --spp image.png is traced pixel by pixel, and pixels.npz has the standard error of each.

surface-sampling, field-particles and amplitude-particles sample the scattered field of a scene of
waves, one bounce or two, with shadows = \"geometric\"; directions of field-particles are by the
solid angles of the facets, or uniform, by the cosine, or by the density of von Mises and Fisher
about the direction to the scatterer, as the end of the name says. Written are receivers.csv,
trace.json and run.json. Without --samples, --seconds and --to they draw 65536 samples.";

/// Options of `trace`.
#[derive(Clone, Debug, Args)]
#[allow(clippy::struct_excessive_bools, reason = "each is a switch of the command line")]
pub(crate) struct TraceArgs {
    /// Method
    #[arg(long, value_name = "NAME", default_value = "path", value_parser = PossibleValuesParser::new(LIGHT_METHODS.iter().chain(&FIELD_METHODS)))]
    pub(crate) method: String,
    /// Folder for the results [default: out/<name of the scene file>-trace]
    #[arg(long, short, value_name = "DIR")]
    pub(crate) output: Option<PathBuf>,
    /// Solve the scene first and sample only what the discretisation missed (path, walk-gathering)
    #[arg(long)]
    pub(crate) control: bool,
    /// Trace every pixel of the picture by itself, with at least so many samples (path,
    /// bidirectional)
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u32).range(1..=1 << 20))]
    pub(crate) spp: Option<u32>,
    /// Draw no picture
    #[arg(long, conflicts_with = "spp")]
    pub(crate) no_pictures: bool,
    /// Write no report.html
    #[arg(long)]
    pub(crate) no_report: bool,
    /// Go on with the run in the folder
    #[arg(long = "continue")]
    pub(crate) go_on: bool,
    #[command(flatten)]
    pub(crate) paths: PathArgs,
    #[command(flatten)]
    pub(crate) stop: TraceStopArgs,
    #[command(flatten)]
    pub(crate) problem: ProblemArgs,
    #[command(flatten)]
    pub(crate) log: LogArgs,
}

impl TraceArgs {
    pub(crate) fn options(&self) -> TraceOptions {
        TraceOptions {
            method: self.method.clone(),
            control: self.control,
            spp: self.spp,
            no_pictures: self.no_pictures,
            no_report: self.no_report,
            go_on: self.go_on,
            paths: self.paths.options(),
            stop: self.stop.options(),
            problem: self.problem.options(),
        }
    }
}
