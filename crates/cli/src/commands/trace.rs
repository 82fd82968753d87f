//! `fredholm trace`.

use fredholm_study::Error;

use crate::args::TraceArgs;
use crate::ending::Ending;
use crate::output;
use crate::start::Start;

/// Traces a scene and writes the results.
pub(crate) fn trace(args: &TraceArgs) -> Result<Ending, Error> {
    let start = Start::of(&args.problem, args.output.as_ref(), "trace", args.log);
    start.run(|folder, terminal| {
        let scene = &args.problem.scene;
        let (traced, ended) = fredholm_study::trace(scene, &args.options(), folder, terminal)?;
        output::summarise(&traced.record, folder.path(), args.log)?;
        Ok(ended.into())
    })
}
