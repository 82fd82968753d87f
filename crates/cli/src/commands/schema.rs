//! `fredholm schema`.

use fredholm_study::Error;

use crate::args::SchemaArgs;
use crate::ending::Ending;
use crate::output;

/// Prints the JSON Schema of scene files.
pub(crate) fn schema(args: SchemaArgs) -> Result<Ending, Error> {
    let schema = if args.waves { fredholm_scene::wave_schema() } else { fredholm_scene::schema() };
    output::print(&format!("{schema:#}\n"))?;
    Ok(Ending::Done)
}
