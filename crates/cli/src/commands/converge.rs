//! `fredholm converge`.

use fredholm_study::{Error, Watch};

use crate::args::ConvergeArgs;
use crate::ending::Ending;
use crate::output;
use crate::start::Start;

/// Solves a scene on finer and finer meshes and writes what that tells.
pub(crate) fn converge(args: &ConvergeArgs) -> Result<Ending, Error> {
    let start = Start::of(&args.problem, args.output.as_ref(), "converge", args.log);
    start.run(|folder, terminal| {
        let scene = &args.problem.scene;
        let (record, ended) = fredholm_study::converge(scene, &args.options(), folder, terminal)?;
        record.warnings.iter().for_each(|warning| terminal.warn(warning));
        output::summarise(&record, folder.path(), args.log)?;
        Ok(ended.into())
    })
}
