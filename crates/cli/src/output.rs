//! Standard output: summaries and what a verb was asked for, nothing else. Standard error:
//! everything else.

use std::fmt::Display;
use std::io::{self, Write};
use std::path::Path;

use fredholm_study::{Error, ErrorKind, Summarise, summary};

use crate::args::LogArgs;

/// Says what a run came to, whose files are in a folder, unless nothing is to be said.
pub(crate) fn summarise(record: &impl Summarise, folder: &Path, log: LogArgs) -> Result<(), Error> {
    if log.quiet { Ok(()) } else { report(&summary(record, folder)) }
}

/// Prints what a scene or a result tells, whose names can hold any characters.
pub(crate) fn report(text: &str) -> Result<(), Error> {
    print(&visible(text))
}

/// Writes `text` to standard output. A reader that has gone away (`fredholm schema | head`) is no
/// failure.
pub(crate) fn print(text: &str) -> Result<(), Error> {
    let mut out = io::stdout().lock();
    match out.write_all(text.as_bytes()).and_then(|()| out.flush()) {
        Err(error) if error.kind() != io::ErrorKind::BrokenPipe => {
            Err(Error::new(ErrorKind::Files, format!("cannot write to standard output: {error}")))
        }
        _ => Ok(()),
    }
}

/// Text without characters that could command a terminal: names in files can hold any.
fn visible(text: &str) -> String {
    let shown = |c: char| if c.is_control() && c != '\n' { char::REPLACEMENT_CHARACTER } else { c };
    text.chars().map(shown).collect()
}

/// Writes a line to standard error. Where that fails, nobody listens, and there is nobody to tell.
pub(crate) fn tell(line: impl Display) {
    let line = visible(&format!("{line}\n"));
    let _ = io::stderr().lock().write_all(line.as_bytes());
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn nothing_commands_the_terminal() {
        assert_eq!(visible("é 100 %\n\u{1b}[31m\u{9b}2J\r"), "é 100 %\n\u{fffd}[31m\u{fffd}2J\u{fffd}");
    }
}
