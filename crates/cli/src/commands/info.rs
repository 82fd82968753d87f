//! `fredholm info`.

use fredholm_study::Error;

use crate::args::InfoArgs;
use crate::ending::Ending;
use crate::output;

/// Tells what made a result.
pub(crate) fn info(args: &InfoArgs) -> Result<Ending, Error> {
    output::report(&fredholm_study::info(&args.path)?)?;
    Ok(Ending::Done)
}
