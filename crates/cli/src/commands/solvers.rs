//! `fredholm solvers`.

use std::fmt::Write;

use fredholm_study::{Error, SolverEntry};

use crate::ending::Ending;
use crate::output;

/// Lists the solvers, with what they need and their options.
pub(crate) fn solvers() -> Result<Ending, Error> {
    output::print(&fredholm_study::solvers().map(|entry| described(&entry)).collect::<String>())?;
    Ok(Ending::Done)
}

fn described(SolverEntry { solver, requirements, options, .. }: &SolverEntry) -> String {
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
