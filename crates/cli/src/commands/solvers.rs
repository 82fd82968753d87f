//! `fredholm solvers`.

use std::fmt::Write;

use crate::failure::{Ending, Failure};
use crate::output;
use crate::registry::{self, Entry};

/// Lists the solvers, with what they need and their options.
pub(crate) fn solvers() -> Result<Ending, Failure> {
    output::print(&registry::all().map(|entry| described(&entry)).collect::<String>())?;
    Ok(Ending::Done)
}

fn described(Entry { solver, requirements, options, .. }: &Entry) -> String {
    let mut text = format!("{:<20}{}\n", solver.name(), solver.description());
    if *requirements != "none" {
        // Writing to a string cannot fail.
        let _ = writeln!(text, "{:<20}  needs {requirements}", "");
    }
    for (option, meaning) in *options {
        let _ = writeln!(text, "{:<20}  {option}: {meaning}", "");
    }
    text
}
