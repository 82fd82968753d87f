//! Errors of a study: of which kind they are, what is wrong, and how to mend it.

use std::fmt::{self, Write};

/// Kinds of [`Error`].
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum ErrorKind {
    /// A scene, or what is asked of it, is not what it has to be.
    Input,
    /// A computation came to no usable result.
    NotConverged,
    /// Memory, addresses or threads do not suffice.
    Resources,
    /// A file could not be read or written.
    Files,
    /// The run was cancelled before it had a result.
    Interrupted,
}

/// An error that ends a study. It is displayed as its message, the causes that the message does not
/// quote, and the help.
#[derive(Debug)]
pub struct Error {
    kind: ErrorKind,
    /// Where it happened.
    place: Option<String>,
    cause: Box<dyn std::error::Error + Send + Sync>,
    help: Option<String>,
}

impl Error {
    /// An error of a kind, from its message or its cause.
    pub fn new(kind: ErrorKind, cause: impl Into<Box<dyn std::error::Error + Send + Sync>>) -> Self {
        Self { kind, place: None, cause: cause.into(), help: None }
    }

    /// The end of a run that was cancelled before it had anything to save.
    #[must_use]
    pub fn cancelled() -> Self {
        let text = "interrupted; there is no partial result, nothing was written";
        Self::new(ErrorKind::Interrupted, text)
    }

    /// The same with a way to mend it.
    #[must_use]
    pub fn with_help(self, help: impl Into<String>) -> Self {
        Self { help: Some(help.into()), ..self }
    }

    /// The same with where it happened in front.
    pub(crate) fn within(self, place: &str) -> Self {
        Self { place: Some(place.to_owned()), ..self }
    }

    /// Of which kind it is.
    #[must_use]
    pub fn kind(&self) -> ErrorKind {
        self.kind
    }

    /// What was wrong: the error of the crate that found it, which knows the file and the line
    /// where there are any, or a message.
    #[must_use]
    pub fn cause(&self) -> &(dyn std::error::Error + Send + Sync + 'static) {
        &*self.cause
    }

    /// How to mend it, where this crate knows. Errors of the crates below have theirs in the
    /// message.
    #[must_use]
    pub fn help(&self) -> Option<&str> {
        self.help.as_deref()
    }
}

impl fmt::Display for Error {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let mut text = self.cause.to_string();
        let mut cause = self.cause.source();
        while let Some(error) = cause {
            let line = error.to_string();
            if !text.contains(&line) {
                write!(text, "\n  because: {line}")?;
            }
            cause = error.source();
        }
        if let Some(place) = &self.place {
            write!(f, "{place}: ")?;
        }
        f.write_str(&text)?;
        self.help.as_ref().map_or(Ok(()), |help| write!(f, "\n  help: {help}"))
    }
}

impl std::error::Error for Error {
    fn source(&self) -> Option<&(dyn std::error::Error + 'static)> {
        self.cause.source()
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

    impl std::error::Error for Outer {
        fn source(&self) -> Option<&(dyn std::error::Error + 'static)> {
            Some(&self.1)
        }
    }

    #[test]
    fn causes_follow_once_and_the_help_comes_last() {
        let error = |text| Error::new(ErrorKind::Files, Outer(text, io::Error::other("disc full")));
        assert_eq!(error("cannot write x").to_string(), "cannot write x\n  because: disc full");
        let helped = error("cannot write x: disc full").with_help("make room").within("level 1");
        assert_eq!(helped.to_string(), "level 1: cannot write x: disc full\n  help: make room");
        assert_eq!((helped.help(), helped.kind()), (Some("make room"), ErrorKind::Files));
    }
}
