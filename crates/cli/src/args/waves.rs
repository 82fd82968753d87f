//! Options of `waves`.

use std::path::PathBuf;

use clap::{Args, ValueEnum};
use fredholm_study::{
    Bytes, CouplingStorage, WaveCompareOptions, WaveMethod, WaveOptions, check_wave_solver,
};

use super::{LogArgs, tolerance};

/// What follows the help.
pub(super) const EXAMPLES: &str = "\
Examples:
  fredholm waves scenes/waves/plate.toml
  fredholm waves dihedral.toml -o results --threads 2
  fredholm waves scenes/waves/facing_plates.toml --compare neumann,gmres,southwell
  fredholm waves scenes/waves/dihedral.toml --methods physical-optics:edges,iterated,efie

Written are receivers.csv, receivers.npz, currents.vtu, far.csv, plots and maps of the
receivers, report.html, and run.json last; with --compare, compare.csv, compare_history.csv,
compare.svg, report.html and compare.json instead; with --methods, methods.csv, plots and maps of
all methods over each other, report.html, and methods.json last. Ctrl-C ends the run with nothing written;
with --methods it keeps those that are done.";

/// Options of `waves`.
#[derive(Clone, Debug, Args)]
pub(crate) struct WavesArgs {
    /// Scene of waves (TOML), see docs/waves.md
    pub(crate) scene: PathBuf,
    /// Folder for the results [default: out/<name of the scene file>, with -compare at its end for
    /// --compare, -methods for --methods]
    #[arg(long, short, value_name = "DIR")]
    pub(crate) output: Option<PathBuf>,
    /// Threads; any number gives the same results [default: one a core]
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u16).range(1..=1024))]
    pub(crate) threads: Option<u16>,
    /// Memory allowed, such as 4GiB or 800MB [default: what leaves the machine usable]
    #[arg(long, value_name = "LIMIT")]
    pub(crate) memory: Option<Bytes>,
    /// Where the coupling comes from: a stored matrix, products computed anew (facets), or a
    /// compressed matrix (boundary elements) [default: what is predicted to fit and to be quicker]
    #[arg(long, value_name = "STORAGE")]
    pub(crate) storage: Option<StorageArg>,
    /// Compare solvers on the coupling instead, with their options, or all:
    /// neumann,gmres:restart=100,southwell
    #[arg(long, value_name = "LIST", value_delimiter = ',', value_parser = solver)]
    pub(crate) compare: Vec<String>,
    /// Compare methods on the scene instead, with their options, or all: physical-optics, thesis
    /// (:bounces=N), iterated, mfie, dual-surface-mfie, efie, cfie, pmchwt; physical-optics and
    /// iterated may have :edges for edge currents, and :radiated or :geometric shadows; efie, cfie
    /// and pmchwt may have :order=1 for functions of the first full order
    #[arg(long, value_name = "LIST", value_delimiter = ',', value_parser = method, conflicts_with_all = ["compare", "storage"])]
    pub(crate) methods: Vec<String>,
    /// Write no report.html
    #[arg(long)]
    pub(crate) no_report: bool,
    /// Residual that compared solvers are to reach
    #[arg(long, value_name = "T", value_parser = tolerance, default_value = format!("{:e}", WaveCompareOptions::default().tolerance), requires = "compare")]
    pub(crate) to: f64,
    /// Iterations that compared solvers are allowed
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u32).range(1..), default_value_t = WaveCompareOptions::default().max_iterations, requires = "compare")]
    pub(crate) max_iterations: u32,
    #[command(flatten)]
    pub(crate) log: LogArgs,
}

/// Where the coupling comes from.
#[derive(Clone, Copy, Debug, ValueEnum)]
pub(crate) enum StorageArg {
    /// A stored matrix
    Matrix,
    /// Products computed anew in every iteration
    Products,
    /// A compressed matrix: efie, cfie, pmchwt
    Compressed,
    /// Multilevel fast multipoles: efie and cfie of conductors
    Multipole,
}

/// A solver that can be made, or all of them.
fn solver(text: &str) -> Result<String, String> {
    if text != "all" {
        check_wave_solver(text).map_err(|error| error.to_string())?;
    }
    Ok(text.to_owned())
}

/// A method that there is, or all of them.
fn method(text: &str) -> Result<String, String> {
    if text != "all" {
        WaveMethod::parse(text)?;
    }
    Ok(text.to_owned())
}

impl WavesArgs {
    pub(crate) fn options(&self) -> WaveOptions {
        let storage = self.storage.map(|storage| match storage {
            StorageArg::Matrix => CouplingStorage::Matrix,
            StorageArg::Products => CouplingStorage::Products,
            StorageArg::Compressed => CouplingStorage::Compressed,
            StorageArg::Multipole => CouplingStorage::Multipole,
        });
        WaveOptions { memory: self.memory, no_report: self.no_report, storage }
    }

    /// The solvers to compare, where there are any.
    pub(crate) fn comparison(&self) -> Option<WaveCompareOptions> {
        let (solvers, max_iterations) = (self.compare.clone(), self.max_iterations);
        (!solvers.is_empty()).then_some(WaveCompareOptions { solvers, tolerance: self.to, max_iterations })
    }
}
