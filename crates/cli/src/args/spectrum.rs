//! Options of `spectrum`.

use std::path::PathBuf;

use clap::Args;
use fredholm_study::{Bytes, SpectrumOptions};

use super::{LogArgs, tolerance};

/// What follows the help.
pub(super) const EXAMPLES: &str = "\
Examples:
  fredholm spectrum scenes/leblond_room.toml
  fredholm spectrum room.toml --dense 0 --steps 100 -o analysis

Written are spectrum.csv, spectrum.svg, report.html, and spectrum.json last. Ctrl-C ends the run
with nothing written.";

/// Options of `spectrum`.
#[derive(Clone, Debug, Args)]
pub(crate) struct SpectrumArgs {
    /// Scene file (TOML)
    pub(crate) scene: PathBuf,
    /// Folder for the results [default: out/<name of the scene file>-spectrum]
    #[arg(long, short, value_name = "DIR")]
    pub(crate) output: Option<PathBuf>,
    /// Most unknowns for dense methods; beyond, there are estimates by the Lanczos process
    #[arg(long, value_name = "N", default_value_t = SpectrumOptions::default().dense)]
    pub(crate) dense: usize,
    /// Steps of the Lanczos process
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u32).range(2..=10_000), default_value_t = SpectrumOptions::default().steps)]
    pub(crate) steps: u32,
    /// Write no report.html
    #[arg(long)]
    pub(crate) no_report: bool,
    /// Threads; any number gives the same results [default: one a core]
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u16).range(1..=1024))]
    pub(crate) threads: Option<u16>,
    /// Error asked for in a row of form factors, rounded down to a power of ten, 1e-14 at least
    /// [default: the scene's, else 1e-3]
    #[arg(long, value_name = "T", value_parser = tolerance)]
    pub(crate) form_factor_tolerance: Option<f64>,
    /// Memory allowed, such as 4GiB or 800MB [default: what leaves the machine usable]
    #[arg(long, value_name = "LIMIT")]
    pub(crate) memory: Option<Bytes>,
    #[command(flatten)]
    pub(crate) log: LogArgs,
}

impl SpectrumArgs {
    pub(crate) fn options(&self) -> SpectrumOptions {
        SpectrumOptions {
            dense: self.dense,
            steps: self.steps,
            no_report: self.no_report,
            threads: self.threads,
            form_factor_tolerance: self.form_factor_tolerance,
            memory: self.memory,
        }
    }
}
