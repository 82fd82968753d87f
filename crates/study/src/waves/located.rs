//! Errors with their place in the file.

use std::fmt::Display;
use std::fs;
use std::ops::Range;
use std::path::{Path, PathBuf};

use fredholm_waves::WaveError;
use serde::de::DeserializeOwned;
use sha2::{Digest, Sha256};

use crate::error::{Error, ErrorKind};

/// Largest scene file, bytes.
const LARGEST: u64 = 1 << 26;
/// Most characters of a line that are quoted.
const QUOTED: usize = 100;

/// A scene file as text.
#[derive(Debug)]
pub(crate) struct SceneText {
    pub(crate) path: PathBuf,
    text: String,
}

impl SceneText {
    /// Reads the file.
    pub(crate) fn read(path: &Path) -> Result<Self, Error> {
        let cannot = |what: String| {
            let text = format!("cannot read {}: {what}", path.display());
            Error::new(ErrorKind::Files, text).with_help("check the path of the scene file")
        };
        let size = fs::metadata(path).map_err(|error| cannot(error.to_string()))?.len();
        if size > LARGEST {
            return Err(cannot(format!("it has {size} bytes, more than a scene file may have ({LARGEST})")));
        }
        let bytes = fs::read(path).map_err(|error| cannot(error.to_string()))?;
        let text = String::from_utf8(bytes).map_err(|error| {
            let text = format!("{}: {error}", path.display());
            Error::new(ErrorKind::Input, text).with_help("save the file as UTF-8")
        })?;
        Ok(Self { path: path.to_owned(), text })
    }

    /// The entries.
    pub(super) fn parse<T: DeserializeOwned>(&self) -> Result<T, Error> {
        toml::from_str(&self.text).map_err(|error: toml::de::Error| {
            let span = error.span().unwrap_or(self.text.len()..self.text.len());
            self.fault(span, error.message(), "see docs/waves.md for the keys of a scene of waves")
        })
    }

    /// SHA-256 of the text, in hexadecimal.
    pub(crate) fn sha256(&self) -> String {
        format!("{:x}", Sha256::digest(&self.text))
    }

    /// The end of the file.
    pub(super) fn end(&self) -> Range<usize> {
        self.text.len()..self.text.len()
    }

    /// A failure about the piece at `span`.
    pub(super) fn fault(&self, span: Range<usize>, what: impl Display, help: impl Display) -> Error {
        let start =
            (0..=span.start.min(self.text.len())).rev().find(|&i| self.text.is_char_boundary(i)).unwrap_or(0);
        let begin = self.text[..start].rfind('\n').map_or(0, |i| i + 1);
        let line = 1 + self.text[..begin].matches('\n').count();
        let column = 1 + self.text[begin..start].chars().count();
        let quoted: String = self.text[begin..].lines().next().unwrap_or("").chars().take(QUOTED).collect();
        let path = self.path.display();
        let excerpt = if quoted.trim().is_empty() { String::new() } else { format!("\n  {line} | {quoted}") };
        let text = format!("{path}:{line}:{column}: {what}{excerpt}");
        Error::new(ErrorKind::Input, text).with_help(help.to_string())
    }

    /// What the library says about the piece at `span`: the part after a semicolon is the help.
    pub(super) fn refused(&self, span: Range<usize>, error: &WaveError) -> Error {
        let message = error.to_string();
        let (what, help) =
            message.split_once("; ").unwrap_or((&message, "correct the entry that begins here"));
        let refused = self.fault(span, what, help);
        match error {
            WaveError::Linop(_) => refused.of_kind(ErrorKind::Resources),
            _ => refused,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_fault_names_line_and_column_and_quotes() {
        let scene = SceneText { path: "a.toml".into(), text: "x = 1\ny = é2\n".to_owned() };
        let at = scene.text.find('2').unwrap();
        let shown = scene.fault(at..at + 1, "wrong", "mend").to_string();
        assert_eq!(shown, "a.toml:2:6: wrong\n  2 | y = é2\n  help: mend");
        for span in [0..0, 8..9, 900..901] {
            assert!(scene.fault(span, "w", "h").to_string().starts_with("a.toml:"));
        }
    }
}
