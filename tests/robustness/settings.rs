//! What is said by environment variables.

use std::path::PathBuf;

/// Number of the first case.
pub fn first() -> u64 {
    number("FREDHOLM_FIRST").unwrap_or(1)
}

/// A whole number, where the variable is set.
pub fn number(variable: &str) -> Option<u64> {
    let text = std::env::var(variable).ok()?;
    Some(text.parse().unwrap_or_else(|_| panic!("{variable} is {text}, not a whole number")))
}

/// Folder for the files of what is found.
pub fn keep() -> Option<PathBuf> {
    std::env::var_os("FREDHOLM_KEEP").map(PathBuf::from)
}
