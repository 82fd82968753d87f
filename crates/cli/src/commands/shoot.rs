//! `fredholm shoot`: progressive radiosity without the matrix.

use fredholm_study::{Error, Watch};

use crate::args::ShootArgs;
use crate::ending::Ending;
use crate::output;
use crate::start::Start;

/// Shoots until the share asked for is distributed, and writes the field so far.
pub(crate) fn shoot(args: &ShootArgs) -> Result<Ending, Error> {
    let start = Start {
        scene: &args.scene,
        output: args.output.as_ref(),
        verb: "shoot",
        threads: args.threads,
        memory: args.memory,
        log: args.log,
    };
    start.run(|folder, terminal| {
        let (record, ended) = fredholm_study::shoot(&args.scene, &args.options(), folder, terminal)?;
        record.warnings.iter().for_each(|warning| terminal.warn(warning));
        output::summarise(&record, folder.path(), args.log)?;
        Ok(ended.into())
    })
}
