//! `fredholm compare`.

use fredholm_study::{Error, Watch};

use crate::args::CompareArgs;
use crate::ending::Ending;
use crate::output;
use crate::start::Start;

/// Runs solvers on the same system and writes how they did.
pub(crate) fn compare(args: &CompareArgs) -> Result<Ending, Error> {
    let start = Start {
        scene: &args.scene,
        output: args.output.as_ref(),
        verb: "compare",
        threads: args.threads,
        memory: args.memory,
        log: args.log,
    };
    start.run(|folder, terminal| {
        let (record, ended) = fredholm_study::compare(&args.scene, &args.options(), folder, terminal)?;
        record.warnings.iter().for_each(|warning| terminal.warn(warning));
        output::summarise(&record, folder.path(), args.log)?;
        Ok(ended.into())
    })
}
