//! Options of `resume`.

use std::path::PathBuf;

use clap::Args;
use fredholm_study::Bytes;

use super::LogArgs;

/// What follows the help.
pub(super) const EXAMPLES: &str = "\
Example:
  fredholm resume out/room

A run to an accuracy (solve --accuracy) saves its state after every round. What is resumed goes on
from there, in the folder that the run was started in, and ends with the results of the whole run.";

/// Options of `resume`.
#[derive(Clone, Debug, Args)]
pub(crate) struct ResumeArgs {
    /// Folder for the results of the run that was stopped
    pub(crate) folder: PathBuf,
    /// Threads; any number gives the same results [default: one a core]
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u16).range(1..=1024))]
    pub(crate) threads: Option<u16>,
    /// Memory allowed, such as 4GiB or 800MB [default: as the run was begun with]
    #[arg(long, value_name = "LIMIT")]
    pub(crate) memory: Option<Bytes>,
    #[command(flatten)]
    pub(crate) log: LogArgs,
}
