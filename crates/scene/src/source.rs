//! A file, and how to point at a piece of it: by line in a text, by byte elsewhere.

use std::fs::File;
use std::io::{self, Read};
use std::ops::Range;
use std::path::{Path, PathBuf};

use crate::error::{ErrorKind, Excerpt, Place, SceneError};

/// Largest file that is read, bytes.
const LARGEST_FILE: u64 = 1 << 30;
/// Most characters of a line that are quoted.
const MOST_QUOTED_CHARACTERS: usize = 100;
/// Characters kept before the offending piece of a long line.
const QUOTED_CHARACTERS_BEFORE: usize = 30;

/// A file, for messages about it.
#[derive(Debug)]
pub(crate) struct Source {
    pub path: PathBuf,
    /// Its text; empty where it is none.
    pub text: String,
    /// Whether it is no text, so that places in it are told by their bytes.
    pub binary: bool,
}

/// What editors put before the text of UTF-8 files to mark them as such.
const BYTE_ORDER_MARK: char = '\u{feff}';

impl Source {
    /// Reads the text of a scene file.
    pub fn load(path: &Path) -> Result<Self, SceneError> {
        let bytes = read(path).map_err(|error| {
            let what = format!("cannot read the scene: {error}");
            let help = "correct the name of the scene file, or its permissions";
            SceneError::new(ErrorKind::Io, path, what, help).caused_by(error)
        })?;
        Self::decode(path, bytes)
    }

    /// Takes bytes for UTF-8, with or without a byte-order mark.
    pub fn decode(path: &Path, bytes: Vec<u8>) -> Result<Self, SceneError> {
        match String::from_utf8(bytes) {
            Ok(text) => Ok(Self::of(path, text)),
            Err(error) => Err(not_text(path, error.as_bytes(), error.utf8_error().valid_up_to())),
        }
    }

    /// Takes bytes for UTF-8 or else for Latin-1, in which old programs write names and comments of
    /// mesh files. What holds a zero byte is no text.
    pub fn decode_mesh(path: &Path, bytes: Vec<u8>) -> Result<Self, SceneError> {
        if let Some(offset) = bytes.iter().position(|&byte| byte == 0) {
            return Err(not_text(path, &bytes, offset));
        }
        let latin = |bytes: &[u8]| bytes.iter().map(|&byte| char::from(byte)).collect();
        let text = String::from_utf8(bytes).unwrap_or_else(|error| latin(error.as_bytes()));
        Ok(Self::of(path, text))
    }

    /// A file that is no text.
    pub fn binary(path: &Path) -> Self {
        Self { path: path.to_owned(), text: String::new(), binary: true }
    }

    /// A text.
    pub fn of(path: &Path, mut text: String) -> Self {
        if text.starts_with(BYTE_ORDER_MARK) {
            text.drain(..BYTE_ORDER_MARK.len_utf8());
        }
        Self { path: path.to_owned(), text, binary: false }
    }

    /// An error about the piece at `span`, bytes.
    pub fn error(
        &self,
        kind: ErrorKind,
        span: Range<usize>,
        what: impl AsRef<str>,
        help: impl AsRef<str>,
    ) -> SceneError {
        if self.binary {
            return SceneError::new(kind, &self.path, what, help).at(Place::Byte(span.start));
        }
        let (place, excerpt) = self.locate(span);
        let error = SceneError::new(kind, &self.path, what, help).at(place);
        if excerpt.line.trim().is_empty() { error } else { error.quoting(excerpt) }
    }

    /// Where the piece at `span` begins.
    pub fn place(&self, span: Range<usize>) -> Place {
        if self.binary { Place::Byte(span.start) } else { self.locate(span).0 }
    }

    /// The piece at `span`, as it is written.
    pub fn piece(&self, span: Range<usize>) -> &str {
        self.text.get(span).unwrap_or_default()
    }

    fn locate(&self, span: Range<usize>) -> (Place, Excerpt) {
        let start = floor_char(&self.text, span.start);
        let begin = self.text[..start].rfind('\n').map_or(0, |i| i + 1);
        let end = self.text[start..].find('\n').map_or(self.text.len(), |i| start + i);
        let before = self.text[begin..start].chars().count();
        let stop = floor_char(&self.text, span.end).clamp(start, end);
        let width = self.text[start..stop].trim_end().chars().count();
        let line = 1 + self.text[..begin].matches('\n').count();
        let place = Place::Line { line, column: before + 1 };
        (place, excerpt(&self.text[begin..end], before, width))
    }
}

/// Reads a whole file of at most [`LARGEST_FILE`] bytes.
pub(crate) fn read(path: &Path) -> io::Result<Vec<u8>> {
    let mut bytes = Vec::new();
    File::open(path)?.take(LARGEST_FILE + 1).read_to_end(&mut bytes)?;
    if bytes.len() as u64 > LARGEST_FILE {
        return Err(io::Error::other("the file is longer than 1 GiB"));
    }
    Ok(bytes)
}

fn floor_char(text: &str, index: usize) -> usize {
    let index = index.min(text.len());
    (0..=index).rev().find(|&i| text.is_char_boundary(i)).unwrap_or(0)
}

fn excerpt(line: &str, before: usize, width: usize) -> Excerpt {
    let skipped = if before + width > MOST_QUOTED_CHARACTERS {
        before.saturating_sub(QUOTED_CHARACTERS_BEFORE)
    } else {
        0
    };
    let shown = line.trim_end().chars().skip(skipped).take(MOST_QUOTED_CHARACTERS);
    let line: String = shown.map(|c| if c.is_control() { ' ' } else { c }).collect();
    let line = line.trim_end().to_owned();
    let before = before - skipped;
    let room = line.chars().count().saturating_sub(before);
    Excerpt { line, before, width: width.clamp(1, room.max(1)) }
}

fn not_text(path: &Path, bytes: &[u8], offset: usize) -> SceneError {
    let line = bytes[..offset].split(|&b| b == b'\n').count();
    let what = format!("byte 0x{:02x} on line {line} is not UTF-8 text", bytes[offset]);
    let help = "save the file as UTF-8 text; if it is no text file, give the right one";
    SceneError::new(ErrorKind::Format, path, what, help).at(Place::Byte(offset))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn source(text: &str) -> Source {
        Source::of(Path::new("a.toml"), text.to_owned())
    }

    #[test]
    fn a_piece_is_marked_in_its_line() {
        let error = source("x = 1\ny = 22\n").error(ErrorKind::Value, 10..12, "wrong", "mend");
        assert_eq!(error.place(), Some(Place::Line { line: 2, column: 5 }));
        assert_eq!(error.to_string(), "a.toml:2:5: wrong\n  2 | y = 22\n    |     ^^\n  help: mend");
    }

    #[test]
    fn marks_and_latin_letters_are_read() {
        let path = Path::new("a.obj");
        let read = |bytes: &[u8]| Source::decode_mesh(path, bytes.to_vec()).map(|source| source.text);
        assert_eq!(read(b"\xef\xbb\xbfv 0 0 0").unwrap(), "v 0 0 0");
        assert_eq!(read(b"# caf\xe9").unwrap(), "# café");
        assert_eq!(read("# café".as_bytes()).unwrap(), "# café");
        assert_eq!(Source::decode(path, b"\xef\xbb\xbfx = 1".to_vec()).unwrap().text, "x = 1");
        assert!(read(b"v 0\0").unwrap_err().to_string().contains("0x00 on line 1"));
        assert!(Source::decode(path, b"\xe9".to_vec()).is_err());
    }

    #[test]
    fn a_long_line_is_cut_around_the_piece() {
        let text = format!("{}BAD{}", "a".repeat(5000), "b".repeat(5000));
        let message = source(&text).error(ErrorKind::Value, 5000..5003, "wrong", "mend").to_string();
        assert!(message.contains("aBADb") && message.len() < 400, "{message}");
    }

    #[test]
    fn spans_beyond_the_text_or_inside_a_character_do_no_harm() {
        for span in [0..0, 1..2, 2..900, 900..901, 3..3] {
            let message = source("é\n").error(ErrorKind::Value, span, "wrong", "mend").to_string();
            assert!(message.starts_with("a.toml:"), "{message}");
        }
    }
}
