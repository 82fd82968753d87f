//! `fredholm reference`.

use fredholm_study::Error;

use crate::args::ReferenceArgs;
use crate::ending::Ending;
use crate::output;
use crate::start::Start;

/// Solves, traces and writes the bundle.
pub(crate) fn reference(args: &ReferenceArgs) -> Result<Ending, Error> {
    let start = Start::of(&args.problem, args.output.as_ref(), "reference", args.log);
    start.run(|folder, terminal| {
        let record = fredholm_study::reference(&args.problem.scene, &args.options(), folder, terminal)?;
        output::summarise(&record, folder.path(), args.log)?;
        Ok(Ending::Done)
    })
}
