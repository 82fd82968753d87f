//! One array of an NPZ archive in the NPY format, version 1.0: magic, length and text of a header,
//! then the numbers, little-endian, row by row. NumPy Enhancement Proposal 1,
//! <https://numpy.org/neps/nep-0001-npy-format.html>.
//!
//! Written by hand, since rows are streamed and names need the type `<U`, which the library of the
//! other tables does not have.

use std::io::{self, Write};

const MAGIC: &[u8] = b"\x93NUMPY";
/// What header and magic together are a multiple of, bytes.
const ALIGNMENT: usize = 64;
/// Numbers converted at a time.
const CHUNK: usize = 8192;

/// A type of number.
pub(super) trait Number: Copy {
    /// Type in the header.
    const TYPE: &'static str;
    /// Bytes of a number.
    const SIZE: usize;
    /// Appends its bytes.
    fn put(self, out: &mut Vec<u8>);
    /// The number of [`SIZE`](Self::SIZE) bytes.
    fn take(bytes: &[u8]) -> Self;
}

macro_rules! number {
    ($number:ty, $code:literal) => {
        impl Number for $number {
            const TYPE: &'static str = $code;
            const SIZE: usize = size_of::<$number>();

            fn put(self, out: &mut Vec<u8>) {
                out.extend(self.to_le_bytes());
            }

            fn take(bytes: &[u8]) -> Self {
                let mut array = [0; size_of::<$number>()];
                array.copy_from_slice(bytes);
                <$number>::from_le_bytes(array)
            }
        }
    };
}

number!(f64, "<f8");
number!(f32, "<f4");
number!(i32, "<i4");
number!(i64, "<i8");

/// Writes an array.
pub(super) fn write<T: Number>(out: &mut dyn Write, shape: &[usize], values: &[T]) -> io::Result<()> {
    out.write_all(&header(T::TYPE, shape))?;
    let mut bytes = Vec::with_capacity(CHUNK * T::SIZE);
    for chunk in values.chunks(CHUNK) {
        bytes.clear();
        for value in chunk {
            value.put(&mut bytes);
        }
        out.write_all(&bytes)?;
    }
    Ok(())
}

/// Writes texts as UCS-4, padded with zeros to the longest.
pub(crate) fn write_texts(out: &mut dyn Write, texts: &[String]) -> io::Result<()> {
    let width = texts.iter().map(|text| text.chars().count()).max().unwrap_or(0).max(1);
    out.write_all(&header(&format!("<U{width}"), &[texts.len()]))?;
    for text in texts {
        let padded = text.chars().map(u32::from).chain(std::iter::repeat(0)).take(width);
        let bytes: Vec<u8> = padded.flat_map(u32::to_le_bytes).collect();
        out.write_all(&bytes)?;
    }
    Ok(())
}

/// Writes a single ASCII text.
pub(super) fn write_word(out: &mut dyn Write, word: &str) -> io::Result<()> {
    out.write_all(&header(&format!("|S{}", word.len()), &[]))?;
    out.write_all(word.as_bytes())
}

fn header(code: &str, shape: &[usize]) -> Vec<u8> {
    let sides: Vec<String> = shape.iter().map(|side| format!("{side},")).collect();
    let mut text = format!("{{'descr': '{code}', 'fortran_order': False, 'shape': ({}), }}", sides.join(" "));
    let bare = MAGIC.len() + 4 + text.len() + 1;
    text.extend(std::iter::repeat_n(' ', bare.next_multiple_of(ALIGNMENT) - bare));
    text.push('\n');
    let length = u16::try_from(text.len()).unwrap_or(u16::MAX);
    [MAGIC, &[1, 0], &length.to_le_bytes(), text.as_bytes()].concat()
}

/// An array as it stands in the file.
#[derive(Debug)]
pub(super) struct Array<'a> {
    code: &'a str,
    pub shape: Vec<usize>,
    data: &'a [u8],
}

impl<'a> Array<'a> {
    /// Takes an array apart.
    pub fn parse(bytes: &'a [u8]) -> Result<Self, String> {
        let (text, data) = split(bytes).ok_or("it does not begin with an NPY header")?;
        let code = between(text, "'descr': '", "'").ok_or("the header has no plain type")?;
        let sides = between(text, "'shape': (", ")").ok_or("the header has no shape")?;
        let shape: Result<Vec<usize>, _> =
            sides.split(',').map(str::trim).filter(|side| !side.is_empty()).map(str::parse).collect();
        let shape = shape.map_err(|_| format!("the shape ({sides}) is not one of whole numbers"))?;
        if between(text, "'fortran_order': ", ",") != Some("False") && shape.len() > 1 {
            return Err("the array is stored by columns; store it by rows".to_owned());
        }
        Ok(Self { code, shape, data })
    }

    /// The numbers.
    pub fn numbers<T: Number>(&self) -> Result<Vec<T>, String> {
        if self.code != T::TYPE {
            return Err(format!("its type is {}, not {}", self.code, T::TYPE));
        }
        self.check(T::SIZE)?;
        Ok(self.data.chunks_exact(T::SIZE).map(T::take).collect())
    }

    /// The texts.
    pub fn texts(&self) -> Result<Vec<String>, String> {
        let width = self.code.strip_prefix("<U").and_then(|width| width.parse::<usize>().ok());
        let size = width.and_then(|width| width.checked_mul(4)).filter(|&size| size > 0);
        let size = size.ok_or_else(|| format!("its type is {}, not one of texts", self.code))?;
        self.check(size)?;
        self.data.chunks_exact(size).map(text).collect()
    }

    /// Whether there are as many bytes as the shape says.
    fn check(&self, size: usize) -> Result<(), String> {
        let needed = self.shape.iter().try_fold(size, |bytes, &side| bytes.checked_mul(side));
        match needed {
            Some(needed) if needed == self.data.len() => Ok(()),
            _ => Err(format!("the shape {:?} does not fit its {} bytes", self.shape, self.data.len())),
        }
    }
}

fn text(bytes: &[u8]) -> Result<String, String> {
    let code = |bytes: &[u8]| i32::take(bytes).cast_unsigned();
    let codes = bytes.chunks_exact(4).map(code).take_while(|&code| code != 0);
    codes.map(|code| char::from_u32(code).ok_or_else(|| format!("{code:#x} is no character"))).collect()
}

/// The text of the header, and what follows it.
fn split(bytes: &[u8]) -> Option<(&str, &[u8])> {
    let rest = bytes.strip_prefix(MAGIC)?;
    let (version, rest) = rest.split_at_checked(2)?;
    let wide = match version[0] {
        1 => false,
        2 | 3 => true,
        _ => return None,
    };
    let (length, rest) = rest.split_at_checked(if wide { 4 } else { 2 })?;
    let length = length.iter().rev().fold(0, |sum, &byte| (sum << 8) | usize::from(byte));
    let (text, data) = rest.split_at_checked(length)?;
    Some((std::str::from_utf8(text).ok()?, data))
}

fn between<'a>(text: &'a str, before: &str, behind: &str) -> Option<&'a str> {
    let (_, rest) = text.split_once(before)?;
    rest.split_once(behind).map(|(found, _)| found)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_header_is_that_of_the_format() {
        let mut out = Vec::new();
        write(&mut out, &[2, 1], &[1.0, 2.0]).unwrap();
        // Magic, version 1.0, 118 = 0x76 bytes of header: 128 in all.
        assert_eq!(&out[..10], b"\x93NUMPY\x01\x00\x76\x00");
        assert!(out[10..].starts_with(b"{'descr': '<f8', 'fortran_order': False, 'shape': (2, 1,), }  "));
        assert_eq!((out[127], out.len()), (b'\n', 128 + 16));
    }

    #[test]
    fn arrays_read_back() {
        let mut out = Vec::new();
        write(&mut out, &[3], &[1_i64, -2, i64::MAX]).unwrap();
        let array = Array::parse(&out).unwrap();
        assert_eq!((array.shape.clone(), array.numbers::<i64>().unwrap()), (vec![3], vec![1, -2, i64::MAX]));
        assert!(array.numbers::<f64>().unwrap_err().contains("<i8"));
        let texts = ["a", "Ωß𝄞", ""].map(String::from);
        let mut out = Vec::new();
        write_texts(&mut out, &texts).unwrap();
        assert_eq!(Array::parse(&out).unwrap().texts().unwrap(), texts);
    }

    #[test]
    fn every_truncation_is_noticed() {
        let mut out = Vec::new();
        write(&mut out, &[2, 2], &[1.0, 2.0, 3.0, 4.0]).unwrap();
        for length in 0..out.len() {
            let read = Array::parse(&out[..length]).and_then(|array| array.numbers::<f64>());
            assert!(read.is_err(), "{length}");
        }
    }

    #[test]
    fn shapes_that_lie_take_no_memory() {
        for shape in ["99999999999999999999,", "4294967296, 4294967296, 4294967296,", "-1,", "1e9,", "3,"] {
            let text = format!("{{'descr': '<f8', 'fortran_order': False, 'shape': ({shape}), }}\n");
            let length = u16::try_from(text.len()).unwrap().to_le_bytes();
            let bytes = [MAGIC, &[1, 0], &length, text.as_bytes(), &[0; 16]].concat();
            assert!(Array::parse(&bytes).and_then(|array| array.numbers::<f64>()).is_err(), "{shape}");
        }
    }
}
