//! What can be wrong with a scene, where, and how to mend it.

use std::fmt;
use std::io;
use std::path::{Path, PathBuf};

/// Kinds of [`SceneError`].
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[non_exhaustive]
pub enum ErrorKind {
    /// A file cannot be opened or read.
    Io,
    /// A file is not what its name says: not UTF-8, or of an unknown format.
    Format,
    /// A file breaks the grammar of its format.
    Syntax,
    /// A key that scene files do not have.
    UnknownKey,
    /// A key that must be there is missing.
    MissingKey,
    /// A value of the wrong type or length.
    Type,
    /// A value outside its range.
    Value,
    /// A name that is unknown, or given twice.
    Name,
    /// A shape that cannot be meshed.
    Geometry,
    /// More elements than can be handled.
    TooLarge,
    /// There is nothing to compute.
    Empty,
    /// Lit sides point away from everything.
    Inverted,
}

/// Where in a file something is wrong.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[non_exhaustive]
pub enum Place {
    /// In a text file.
    Line {
        /// Line, from 1.
        line: usize,
        /// Column in characters, from 1.
        column: usize,
    },
    /// In a file that is not text.
    Byte(usize),
}

impl fmt::Display for Place {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Line { line, column } => write!(f, "{line}:{column}"),
            Self::Byte(offset) => write!(f, " byte {offset}"),
        }
    }
}

/// The offending piece of a line.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(crate) struct Excerpt {
    /// The line, or the part of a long line around the piece.
    pub line: String,
    /// Characters of `line` before the piece.
    pub before: usize,
    /// Characters of the piece, at least 1.
    pub width: usize,
}

/// Most characters of a sentence: names and values in a file can be of any length.
const LONGEST_SENTENCE: usize = 2000;

#[derive(Debug)]
struct Detail {
    kind: ErrorKind,
    file: PathBuf,
    place: Option<Place>,
    what: String,
    help: String,
    excerpt: Option<Excerpt>,
    source: Option<io::Error>,
}

/// A scene that cannot be used: the file, the place, the offending text and what to do.
///
/// ```
/// use fredholm_scene::{ErrorKind, Scene};
///
/// let error = Scene::from_str("titel = \"room\"", "room.toml").unwrap_err();
/// assert_eq!(error.kind(), ErrorKind::UnknownKey);
/// assert!(error.to_string().starts_with("room.toml:1:1: unknown key `titel`"));
/// ```
#[derive(Debug)]
pub struct SceneError(Box<Detail>);

impl SceneError {
    pub(crate) fn new(kind: ErrorKind, file: &Path, what: impl AsRef<str>, help: impl AsRef<str>) -> Self {
        let (what, help) = (presentable(what.as_ref()), presentable(help.as_ref()));
        Self(Box::new(Detail {
            kind,
            file: file.to_owned(),
            place: None,
            what,
            help,
            excerpt: None,
            source: None,
        }))
    }

    pub(crate) fn at(mut self, place: Place) -> Self {
        self.0.place = Some(place);
        self
    }

    pub(crate) fn quoting(mut self, excerpt: Excerpt) -> Self {
        self.0.excerpt = Some(excerpt);
        self
    }

    pub(crate) fn caused_by(mut self, source: io::Error) -> Self {
        self.0.source = Some(source);
        self
    }

    /// What kind of error it is.
    #[must_use]
    pub fn kind(&self) -> ErrorKind {
        self.0.kind
    }

    /// Whether a file could not be read, rather than being wrong.
    #[must_use]
    pub fn is_io(&self) -> bool {
        self.0.kind == ErrorKind::Io
    }

    /// The file that is wrong or that names what is wrong.
    #[must_use]
    pub fn file(&self) -> &Path {
        &self.0.file
    }

    /// Where in the file, where that is known.
    #[must_use]
    pub fn place(&self) -> Option<Place> {
        self.0.place
    }

    /// What is wrong, without the place.
    #[must_use]
    pub fn what(&self) -> &str {
        &self.0.what
    }

    /// What to do about it.
    #[must_use]
    pub fn help(&self) -> &str {
        &self.0.help
    }
}

impl fmt::Display for SceneError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Detail { file, place, what, help, excerpt, .. } = &*self.0;
        write!(f, "{}:", file.display())?;
        if let Some(place) = place {
            write!(f, "{place}:")?;
        }
        write!(f, " {what}")?;
        if let (Some(Place::Line { line, .. }), Some(excerpt)) = (place, excerpt) {
            let number = line.to_string();
            let margin = " ".repeat(number.len());
            let indent = " ".repeat(excerpt.before);
            write!(f, "\n  {number} | {}", excerpt.line)?;
            write!(f, "\n  {margin} | {indent}{}", "^".repeat(excerpt.width))?;
        }
        write!(f, "\n  help: {help}")
    }
}

impl std::error::Error for SceneError {
    fn source(&self) -> Option<&(dyn std::error::Error + 'static)> {
        self.0.source.as_ref().map(|e| e as _)
    }
}

/// A sentence that can be shown: what it quotes may be of any length and hold any character.
fn presentable(sentence: &str) -> String {
    let visible = |c: char| if c.is_control() { char::REPLACEMENT_CHARACTER } else { c };
    let mut shown: String = sentence.chars().take(LONGEST_SENTENCE).map(visible).collect();
    if shown.len() < sentence.len() && sentence.chars().nth(LONGEST_SENTENCE).is_some() {
        shown.push_str(" …");
    }
    shown
}
