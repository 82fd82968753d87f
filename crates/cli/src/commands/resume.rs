//! `fredholm resume`.

use fredholm_study::{Checkpoint, Error, ProblemOptions, SolveOptions};

use super::solve::finish;
use crate::args::ResumeArgs;
use crate::ending::Ending;
use crate::start::{Start, recorded};

/// Goes on with a run that was stopped.
pub(crate) fn resume(args: &ResumeArgs) -> Result<Ending, Error> {
    let checkpoint = Checkpoint::read(&args.folder)?;
    let saved = checkpoint.options();
    let memory = args.memory.or(saved.problem.memory);
    let asked = SolveOptions {
        problem: ProblemOptions { threads: args.threads, memory, ..saved.problem },
        recorded: recorded(args.log),
        ..saved
    };
    let start = Start {
        scene: checkpoint.scene(),
        output: Some(&args.folder),
        verb: "",
        threads: args.threads,
        memory,
        log: args.log,
    };
    start.run(|folder, terminal| {
        let asked = SolveOptions { folder: Some(folder.clone()), ..asked };
        let solved = fredholm_study::resume(&checkpoint, &asked, terminal)?;
        finish(solved, folder, args.log, terminal)
    })
}
