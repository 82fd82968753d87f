//! `fredholm schema`.

use crate::failure::{Ending, Failure};
use crate::output;

/// Prints the JSON Schema of scene files.
pub(crate) fn schema() -> Result<Ending, Failure> {
    output::print(&format!("{:#}\n", fredholm_scene::schema()))?;
    Ok(Ending::Done)
}
