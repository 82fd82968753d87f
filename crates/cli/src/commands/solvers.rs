//! `fredholm solvers`.

use crate::failure::{Ending, Failure};
use crate::output;
use crate::registry::{self, Entry};

/// Lists the solvers.
pub(crate) fn solvers() -> Result<Ending, Failure> {
    let line = |Entry { solver, .. }: Entry| format!("{:<16}{}", solver.name(), solver.description());
    let lines: Vec<String> = registry::all().map(line).collect();
    output::print(&(lines.join("\n") + "\n"))?;
    Ok(Ending::Done)
}
