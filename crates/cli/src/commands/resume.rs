//! `fredholm resume`.

use std::path::PathBuf;

use clap::Args;

use super::solve::solve_from;
use crate::args::{LogArgs, PlaceArgs, ProblemArgs, SolveArgs, StopArgs};
use crate::checkpoint;
use crate::failure::{Ending, Failure};
use crate::size::Bytes;

pub(crate) const EXAMPLES: &str = "\
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

/// Goes on with a run that was stopped.
pub(crate) fn resume(args: &ResumeArgs) -> Result<Ending, Failure> {
    let checkpoint = checkpoint::read(&args.folder)?;
    let header = &checkpoint.header;
    let solve = SolveArgs {
        output: Some(args.folder.clone()),
        accuracy: Some(checkpoint.accuracy),
        goal: header.goal.clone(),
        final_gather: header.final_gather,
        discontinuity: header.discontinuity,
        no_pictures: header.no_pictures,
        no_report: header.no_report,
        places: PlaceArgs { point: header.receivers(), plane: Vec::new() },
        problem: ProblemArgs {
            scene: header.scene.clone(),
            threads: args.threads,
            discretisation: None,
            solver: Some(header.solver.clone()),
            form_factor_tolerance: None,
            storage: None,
            memory: args.memory.or(header.memory_limit_bytes.map(|bytes| Bytes(bytes.into()))),
        },
        stop: StopArgs {
            tolerance: Some(checkpoint.tolerance),
            max_iterations: Some(u32::try_from(header.max_iterations).unwrap_or(u32::MAX)),
        },
        log: args.log,
    };
    solve_from(&solve, Some(&checkpoint))
}
