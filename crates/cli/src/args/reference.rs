//! Options of `reference`.

use std::path::PathBuf;

use clap::Args;
use fredholm_study::ReferenceOptions;

use super::paths::{PathArgs, TraceStopArgs};
use super::{LogArgs, ProblemArgs};

/// What follows the help of `reference`.
pub(super) const EXAMPLES: &str = "\
Examples:
  fredholm reference scenes/cornell_planar.toml -o out/reference
  fredholm reference room.toml --to 0.1% -o reference --form-factor-tolerance 1e-7

The irradiance of every face by path tracing, with the deterministic solution as control
variate: what remains are the standard error and the error of the form factors, both stated.
Written are reference.csv, patches.obj, the scene for Mitsuba 3 (scene.xml) and pbrt-v4 (scene.pbrt)
where its bands are colours or grey, and reference.json last, which says what the columns mean.
Ctrl-C ends the run with nothing written.";

/// Options of `reference`.
#[derive(Clone, Debug, Args)]
pub(crate) struct ReferenceArgs {
    /// Folder for the bundle [default: out/<name of the scene file>-reference]
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

impl ReferenceArgs {
    pub(crate) fn options(&self) -> ReferenceOptions {
        let (paths, stop) = (self.paths.options(), self.stop.options());
        ReferenceOptions { paths, stop, problem: self.problem.options() }
    }
}
