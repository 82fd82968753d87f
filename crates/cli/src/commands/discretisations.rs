//! `fredholm discretisations`.

use fredholm_study::Error;

use crate::ending::Ending;
use crate::output;

/// Lists the discretisations.
pub(crate) fn discretisations() -> Result<Ending, Error> {
    let all = fredholm_study::discretisations();
    let lines: Vec<String> = all.iter().map(|one| format!("{:<24}{}", one.name(), one.summary())).collect();
    output::print(&(lines.join("\n") + "\n"))?;
    Ok(Ending::Done)
}
