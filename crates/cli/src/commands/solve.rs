//! `fredholm solve`.

use fredholm_study::{Error, ResultFolder, Solved, Watch};

use crate::args::{LogArgs, SolveArgs};
use crate::ending::Ending;
use crate::output;
use crate::start::Start;
use crate::terminal::Terminal;

/// Solves a scene and writes the results.
pub(crate) fn solve(args: &SolveArgs) -> Result<Ending, Error> {
    let start = Start::of(&args.problem, args.output.as_ref(), "", args.log);
    start.run(|folder, terminal| {
        let asked = args.options(folder.clone());
        let solved = fredholm_study::solve(&args.problem.scene, &asked, terminal)?;
        finish(solved, folder, args.log, terminal)
    })
}

/// Writes the results and says what came of the run.
pub(super) fn finish(
    mut solved: Solved,
    folder: &ResultFolder,
    log: LogArgs,
    terminal: &Terminal,
) -> Result<Ending, Error> {
    // The summary, other than the file, can tell the time of writing.
    let record = solved.write(folder)?;
    solved.remarks().for_each(|remark| terminal.warn(&remark));
    if terminal.interrupt.requested() && !record.partial {
        terminal.warn("interrupted when the solution was there: the solution is complete all the same");
    }
    output::summarise(&record, folder.path(), log)?;
    Ok(solved.ended().into())
}
