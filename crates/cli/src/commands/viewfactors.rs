//! `fredholm viewfactors`.

use fredholm_study::{Error, MatrixFiles, Watch, summary};

use crate::args::ViewFactorsArgs;
use crate::ending::Ending;
use crate::output;
use crate::start;
use crate::terminal::Terminal;

/// Computes the matrix and writes it.
pub(crate) fn view_factors(args: &ViewFactorsArgs) -> Result<Ending, Error> {
    let terminal = Terminal::new(args.log)?;
    let form = args.format.map(Into::into);
    let files = MatrixFiles::new(&args.input, args.output.as_deref(), form)?;
    start::run(&terminal, args.threads, args.memory, || {
        let (record, ended) = fredholm_study::view_factors(&args.options(), &files, &terminal)?;
        record.warnings.iter().for_each(|warning| terminal.warn(warning));
        if !args.log.quiet {
            output::report(&summary(&record, &files.files.matrix))?;
        }
        Ok(ended.into())
    })
}
