//! Standard output: summaries and what a verb was asked for, nothing else.

use std::io::{self, ErrorKind, Write};

use crate::failure::{Ending, Failure};

/// Writes `text` to standard output. A reader that has gone away (`fredholm schema | head`) is no failure.
pub(crate) fn print(text: &str) -> Result<(), Failure> {
    let mut out = io::stdout().lock();
    match out.write_all(text.as_bytes()).and_then(|()| out.flush()) {
        Err(error) if error.kind() != ErrorKind::BrokenPipe => {
            Err(Failure::new(Ending::Files, format!("cannot write to standard output: {error}")))
        }
        _ => Ok(()),
    }
}
