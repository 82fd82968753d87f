//! `fredholm judge`.

use fredholm_study::Error;

use crate::args::JudgeArgs;
use crate::ending::Ending;
use crate::output;
use crate::start::Start;

/// Judges what a tracer has found by a bundle.
pub(crate) fn judge(args: &JudgeArgs) -> Result<Ending, Error> {
    let output = args.output.as_ref();
    let start =
        Start { scene: &args.bundle, output, verb: "judge", threads: None, memory: None, log: args.log };
    start.run(|folder, terminal| {
        let (record, verdict) =
            fredholm_study::judge(&args.bundle, &args.files, &args.options(), folder, terminal)?;
        output::summarise(&record, folder.path(), args.log)?;
        Ok(verdict.into())
    })
}
