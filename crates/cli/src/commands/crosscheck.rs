//! `fredholm crosscheck`.

use fredholm_study::Error;

use crate::args::CrosscheckArgs;
use crate::ending::Ending;
use crate::output;
use crate::start::Start;

/// Solves and traces a scene, and says whether the two agree.
pub(crate) fn crosscheck(args: &CrosscheckArgs) -> Result<Ending, Error> {
    let start = Start::of(&args.problem, args.output.as_ref(), "crosscheck", args.log);
    start.run(|folder, terminal| {
        let scene = &args.problem.scene;
        let (record, verdict) = fredholm_study::crosscheck(scene, &args.options(), folder, terminal)?;
        output::summarise(&record, folder.path(), args.log)?;
        Ok(verdict.into())
    })
}
