//! `fredholm schema`.

use fredholm_study::Error;

use crate::ending::Ending;
use crate::output;

/// Prints the JSON Schema of scene files.
pub(crate) fn schema() -> Result<Ending, Error> {
    output::print(&format!("{:#}\n", fredholm_scene::schema()))?;
    Ok(Ending::Done)
}
