//! A place in the bytes of a file that moves forwards and never past the end: what a header
//! promises takes no memory, since every number is fetched from bytes that are there.

use std::ops::Range;

use fredholm_mesh::Vec3;

use crate::error::{ErrorKind, SceneError};
use crate::source::Source;

/// How numbers are written.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Encoding {
    /// As words with blanks or ends of lines between them.
    Text,
    Little,
    Big,
}

/// Kinds of numbers in files. All of them are exact as f64.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Scalar {
    I8,
    U8,
    I16,
    U16,
    I32,
    U32,
    F32,
    F64,
}

impl Scalar {
    /// Bytes of one.
    pub fn size(self) -> usize {
        match self {
            Self::I8 | Self::U8 => 1,
            Self::I16 | Self::U16 => 2,
            Self::I32 | Self::U32 | Self::F32 => 4,
            Self::F64 => 8,
        }
    }

    /// Whether it is a whole number.
    pub fn is_whole(self) -> bool {
        !matches!(self, Self::F32 | Self::F64)
    }

    /// The number that the first bytes of a slice stand for; 0 where there are too few.
    pub fn of_little(self, bytes: &[u8]) -> f64 {
        let mut all = [0; 8];
        let size = self.size().min(bytes.len());
        all[..size].copy_from_slice(&bytes[..size]);
        let [a, b, c, d, ..] = all;
        match self {
            Self::I8 => f64::from(i8::from_le_bytes([a])),
            Self::U8 => f64::from(a),
            Self::I16 => f64::from(i16::from_le_bytes([a, b])),
            Self::U16 => f64::from(u16::from_le_bytes([a, b])),
            Self::I32 => f64::from(i32::from_le_bytes([a, b, c, d])),
            Self::U32 => f64::from(u32::from_le_bytes([a, b, c, d])),
            Self::F32 => f64::from(f32::from_le_bytes([a, b, c, d])),
            Self::F64 => f64::from_le_bytes(all),
        }
    }
}

/// A place in the bytes of a file.
pub(super) struct Cursor<'a> {
    pub source: &'a Source,
    bytes: &'a [u8],
    pub at: usize,
    pub encoding: Encoding,
}

impl<'a> Cursor<'a> {
    pub fn new(source: &'a Source, bytes: &'a [u8], encoding: Encoding) -> Self {
        Self { source, bytes, at: 0, encoding }
    }

    /// An error about the bytes from `start` up to here.
    pub fn error(&self, start: usize, what: impl AsRef<str>, help: &str) -> SceneError {
        self.source.error(ErrorKind::Syntax, start..self.at.max(start + 1), what, help)
    }

    /// The end of the file where `what` should stand.
    pub fn ended(&self, what: &str) -> SceneError {
        let end = self.bytes.len();
        let help = "the file was cut short: copy or write it anew";
        self.source.error(ErrorKind::Syntax, end..end, format!("the file ends where {what} should be"), help)
    }

    /// The next line without its end, and where it lies. None at the end of the file.
    pub fn line(&mut self) -> Option<(String, Range<usize>)> {
        let rest = self.bytes.get(self.at..).filter(|rest| !rest.is_empty())?;
        let length = rest.iter().position(|&byte| byte == b'\n').unwrap_or(rest.len());
        let line = rest[..length].strip_suffix(b"\r").unwrap_or(&rest[..length]);
        let span = self.at..self.at + line.len();
        self.at = (self.at + length + 1).min(self.bytes.len());
        Some((String::from_utf8_lossy(line).into_owned(), span))
    }

    /// The next word of a text, and where it lies. None at the end of the file.
    pub fn word(&mut self) -> Option<(&'a str, Range<usize>)> {
        let rest = self.bytes.get(self.at..)?;
        let start = self.at + rest.iter().position(|byte| !byte.is_ascii_whitespace())?;
        let rest = &self.bytes[start..];
        let length = rest.iter().position(u8::is_ascii_whitespace).unwrap_or(rest.len());
        self.at = start + length;
        // Only the bytes of a text are asked for words.
        Some((std::str::from_utf8(&rest[..length]).unwrap_or("\u{fffd}"), start..self.at))
    }

    /// The next bytes.
    pub fn take(&mut self, count: usize, what: &str) -> Result<&'a [u8], SceneError> {
        let end = self.at.checked_add(count).filter(|&end| end <= self.bytes.len());
        let end = end.ok_or_else(|| self.ended(what))?;
        let found = &self.bytes[self.at..end];
        self.at = end;
        Ok(found)
    }

    /// The next number.
    pub fn number(&mut self, kind: Scalar, what: &str) -> Result<f64, SceneError> {
        if self.encoding == Encoding::Text {
            return self.written(kind, what);
        }
        let mut bytes = [0; 8];
        let found = self.take(kind.size(), what)?;
        let bytes = &mut bytes[..found.len()];
        bytes.copy_from_slice(found);
        if self.encoding == Encoding::Big {
            bytes.reverse();
        }
        Ok(kind.of_little(bytes))
    }

    fn written(&mut self, kind: Scalar, what: &str) -> Result<f64, SceneError> {
        let (word, span) = self.word().ok_or_else(|| self.ended(what))?;
        let number = word.parse::<f64>().ok().filter(|x| !kind.is_whole() || x.fract() == 0.0);
        number.ok_or_else(|| {
            let whole = if kind.is_whole() { "whole number" } else { "number" };
            let text = format!("`{word}` stands where {what} should be, a {whole}");
            self.error(span.start, text, "mend the word, or write the file anew")
        })
    }

    /// The next number, which must be a coordinate: finite.
    pub fn coordinate(&mut self, kind: Scalar) -> Result<f64, SceneError> {
        let start = self.at;
        let value = self.number(kind, "a coordinate")?;
        if value.is_finite() {
            return Ok(value);
        }
        let start = if self.encoding == Encoding::Text { self.at.saturating_sub(1) } else { start };
        Err(self.error(
            start,
            format!("the coordinate {value} is not a finite number"),
            "write a finite number",
        ))
    }

    /// The next three coordinates.
    pub fn point(&mut self, kind: Scalar) -> Result<Vec3, SceneError> {
        Ok(Vec3::new(self.coordinate(kind)?, self.coordinate(kind)?, self.coordinate(kind)?))
    }

    /// The next whole number, 0 or more, that takes eight bytes where it is no text.
    pub fn size(&mut self, what: &str) -> Result<u64, SceneError> {
        if self.encoding == Encoding::Text {
            return self.whole(what);
        }
        let bytes = self.take(8, what)?;
        let fold = |sum: u64, byte: &u8| (sum << 8) | u64::from(*byte);
        let big = self.encoding == Encoding::Big;
        Ok(if big { bytes.iter().fold(0, fold) } else { bytes.iter().rev().fold(0, fold) })
    }

    /// The next whole number, that takes four bytes where it is no text.
    pub fn int(&mut self, what: &str) -> Result<i32, SceneError> {
        if self.encoding == Encoding::Text {
            return self.whole(what);
        }
        Ok(self.number(Scalar::I32, what)? as i32)
    }

    fn whole<T: std::str::FromStr>(&mut self, what: &str) -> Result<T, SceneError> {
        let (word, span) = self.word().ok_or_else(|| self.ended(what))?;
        word.parse().map_err(|_| {
            let text = format!("`{word}` stands where {what} should be, a whole number");
            self.error(span.start, text, "mend the word, or write the file anew")
        })
    }
}
