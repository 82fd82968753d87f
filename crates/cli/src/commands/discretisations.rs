//! `fredholm discretisations`.

use crate::failure::{Ending, Failure};
use crate::output;

/// Lists the discretisations.
pub(crate) fn discretisations() -> Result<Ending, Failure> {
    let all = fredholm_discretisation::discretisations();
    let lines: Vec<String> = all.iter().map(|one| format!("{:<24}{}", one.name(), one.summary())).collect();
    output::print(&(lines.join("\n") + "\n"))?;
    Ok(Ending::Done)
}
