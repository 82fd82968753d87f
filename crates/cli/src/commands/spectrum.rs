//! `fredholm spectrum`.

use fredholm_study::Error;

use crate::args::SpectrumArgs;
use crate::ending::Ending;
use crate::output;
use crate::start::Start;

/// Analyses the matrix of a scene.
pub(crate) fn spectrum(args: &SpectrumArgs) -> Result<Ending, Error> {
    let start = Start {
        scene: &args.scene,
        output: args.output.as_ref(),
        verb: "spectrum",
        threads: args.threads,
        memory: args.memory,
        log: args.log,
    };
    start.run(|folder, terminal| {
        let (record, ended) = fredholm_study::spectrum(&args.scene, &args.options(), folder, terminal)?;
        output::summarise(&record, folder.path(), args.log)?;
        Ok(ended.into())
    })
}
