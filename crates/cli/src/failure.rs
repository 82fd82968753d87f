//! Failures and the exit codes they end with.
//!
//! | code | meaning |
//! |---|---|
//! | 0 | done |
//! | 2 | bad input or usage |
//! | 3 | not converged; the results are written all the same |
//! | 4 | resources refused |
//! | 5 | a file could not be read or written |
//! | 6 | two solutions disagree |
//! | 130 | interrupted |

use std::error::Error;
use std::fmt::{self, Write};
use std::process::ExitCode;

use serde_json::json;

use crate::args::LogFormat;
use crate::console::json;
use crate::output::tell;

/// What kind of end a run comes to; the number is the exit code.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Ending {
    Done = 0,
    Input = 2,
    NotConverged = 3,
    Resources = 4,
    Files = 5,
    Disagrees = 6,
    Interrupted = 130,
}

impl Ending {
    pub(crate) fn code(self) -> u8 {
        self as u8
    }
}

impl From<Ending> for ExitCode {
    fn from(ending: Ending) -> Self {
        Self::from(ending.code())
    }
}

/// An error that ends the run.
#[derive(Debug)]
pub(crate) struct Failure {
    pub(crate) ending: Ending,
    error: Box<dyn Error + Send + Sync>,
}

impl Failure {
    pub(crate) fn new(ending: Ending, error: impl Into<Box<dyn Error + Send + Sync>>) -> Self {
        Self { ending, error: error.into() }
    }

    /// The same failure with where it happened in front.
    pub(crate) fn within(self, place: &str) -> Self {
        Self::new(self.ending, format!("{place}: {self}"))
    }

    /// Shows the failure on standard error.
    pub(crate) fn present(&self, log: LogFormat) {
        match log {
            LogFormat::Plain => tell(format_args!("error: {self}")),
            LogFormat::Json => {
                let code = self.ending.code();
                json::line(json!({ "event": "error", "code": code, "message": self.to_string() }));
            }
        }
    }
}

impl fmt::Display for Failure {
    /// The message and its causes, one a line; a cause that the message already quotes is left out.
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let mut text = self.error.to_string();
        let mut cause = self.error.source();
        while let Some(error) = cause {
            let line = error.to_string();
            if !text.contains(&line) {
                write!(text, "\n  because: {line}")?;
            }
            cause = error.source();
        }
        f.write_str(&text)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::io;

    #[derive(Debug)]
    struct Outer(&'static str, io::Error);

    impl fmt::Display for Outer {
        fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
            f.write_str(self.0)
        }
    }

    impl Error for Outer {
        fn source(&self) -> Option<&(dyn Error + 'static)> {
            Some(&self.1)
        }
    }

    #[test]
    fn causes_follow_once() {
        let shown =
            |text| Failure::new(Ending::Files, Outer(text, io::Error::other("disc full"))).to_string();
        assert_eq!(shown("cannot write x"), "cannot write x\n  because: disc full");
        assert_eq!(shown("cannot write x: disc full"), "cannot write x: disc full");
    }

    #[test]
    fn codes_are_those_promised() {
        let endings = [Ending::Done, Ending::Input, Ending::NotConverged, Ending::Resources, Ending::Files];
        assert_eq!(endings.map(Ending::code), [0, 2, 3, 4, 5]);
        assert_eq!([Ending::Disagrees, Ending::Interrupted].map(Ending::code), [6, 130]);
    }
}
