//! The exit codes, and how errors are shown.
//!
//! | code | meaning |
//! |---|---|
//! | 0 | done |
//! | 2 | bad input or usage |
//! | 3 | not converged, or out of time; the results so far are written all the same |
//! | 4 | resources refused |
//! | 5 | a file could not be read or written |
//! | 6 | two solutions disagree, or a tracer with the reference |
//! | 130 | interrupted |

use std::process::ExitCode;

use fredholm_study::{Ended, Error, ErrorKind, Verdict};
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

impl From<ErrorKind> for Ending {
    fn from(kind: ErrorKind) -> Self {
        match kind {
            ErrorKind::Input => Self::Input,
            ErrorKind::NotConverged => Self::NotConverged,
            ErrorKind::Resources => Self::Resources,
            ErrorKind::Files => Self::Files,
            ErrorKind::Interrupted => Self::Interrupted,
        }
    }
}

impl From<Ended> for Ending {
    fn from(ended: Ended) -> Self {
        match ended {
            Ended::Done => Self::Done,
            Ended::NotConverged => Self::NotConverged,
            Ended::Interrupted => Self::Interrupted,
        }
    }
}

impl From<Verdict> for Ending {
    fn from(verdict: Verdict) -> Self {
        match verdict {
            Verdict::Agree => Self::Done,
            Verdict::Disagree => Self::Disagrees,
            Verdict::Undecided => Self::NotConverged,
        }
    }
}

/// Shows an error on standard error.
pub(crate) fn present(error: &Error, log: LogFormat) {
    match log {
        LogFormat::Plain => tell(format_args!("error: {error}")),
        LogFormat::Json => {
            let code = Ending::from(error.kind()).code();
            json::line(json!({ "event": "error", "code": code, "message": error.to_string() }));
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn codes_are_those_promised() {
        let endings = [Ending::Done, Ending::Input, Ending::NotConverged, Ending::Resources, Ending::Files];
        assert_eq!(endings.map(Ending::code), [0, 2, 3, 4, 5]);
        assert_eq!([Ending::Disagrees, Ending::Interrupted].map(Ending::code), [6, 130]);
    }
}
