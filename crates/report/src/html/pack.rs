//! Numbers as text in a page: few bytes, deflated (RFC 1950), in base64 (RFC 4648).
//!
//! - *Words*, 16-bit codes: each is stored as its difference to the one before modulo 2¹⁶, folded
//!   (0, −1, 1, −2 … become 0, 1, 2, 3 …); all upper bytes come first, then all lower bytes.
//! - *Varints*, 32-bit integers: seven bits a byte, the lowest first; the highest bit tells that
//!   more follow.
//! - *Values*, f64, by a [`Scale`]: words that are logarithms, so that a dark element
//!   is as exact as a bright one.

use std::io::{self, Write};

use base64::engine::general_purpose::STANDARD;
use base64::write::EncoderWriter;
use flate2::Compression;
use flate2::write::ZlibEncoder;
use serde::Serialize;

/// Smallest magnitude that is told from 0, over the largest.
const LEAST_MAGNITUDE: f64 = 1e-9;
/// Most codes of numbers of one sign, and of either sign.
const MOST_CODES: [u16; 2] = [0xffff, 0x7fff];
/// Relative step between codes that is fine enough: finer ones would only cost bytes.
const FINE_STEP: f64 = 1e-4;

/// How 16-bit codes stand for numbers: code 0 for 0, code c for ±low (high/low)^((c − 1)/(levels −
/// 1)); the codes of negative numbers are those of their magnitudes, negated modulo 2¹⁶.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub(super) struct Scale {
    /// Smallest magnitude.
    low: f64,
    /// Largest magnitude.
    high: f64,
    /// Codes above 0 of either sign.
    levels: u16,
    /// Whether there are numbers below 0.
    signed: bool,
    /// Largest relative error of a number of magnitude `low` at least; what is smaller becomes 0 or
    /// `low`.
    error: f64,
}

impl Scale {
    /// The scale that finite numbers need.
    pub(super) fn new(values: impl Iterator<Item = f64>) -> Self {
        let (mut least, mut high, mut signed) = (f64::INFINITY, 0.0_f64, false);
        for value in values.filter(|value| value.is_finite() && *value != 0.0) {
            (least, high) = (least.min(value.abs()), high.max(value.abs()));
            signed |= value < 0.0;
        }
        if high == 0.0 {
            (least, high) = (1.0, 1.0);
        }
        let low = least.max(high * LEAST_MAGNITUDE);
        let range = (high / low).ln();
        let wanted = (range / FINE_STEP).ceil().clamp(1.0, f64::from(MOST_CODES[usize::from(signed)] - 1));
        let levels = 1 + wanted as u16;
        let error = (0.5 * range / wanted).exp_m1();
        Self { low, high, levels, signed, error }
    }

    /// The code of a number; that of 0 for one that is not finite.
    pub(super) fn code(&self, value: f64) -> u16 {
        let size = value.abs();
        if !value.is_finite() || size < 0.5 * self.low {
            return 0;
        }
        let range = (self.high / self.low).ln();
        let share = if range > 0.0 { (size / self.low).ln() / range } else { 0.0 };
        let code = 1 + (share.clamp(0.0, 1.0) * f64::from(self.levels - 1)).round() as u16;
        if value < 0.0 { code.wrapping_neg() } else { code }
    }

    /// Largest relative error.
    pub(super) fn error(&self) -> f64 {
        self.error
    }
}

/// Deflates what is written and turns it into text.
pub(super) fn packed(
    out: &mut dyn Write,
    fill: impl FnOnce(&mut dyn Write) -> io::Result<()>,
) -> io::Result<()> {
    let mut encoder = ZlibEncoder::new(EncoderWriter::new(out, &STANDARD), Compression::default());
    fill(&mut encoder)?;
    encoder.finish()?.finish()?;
    Ok(())
}

/// Writes words; the differences begin anew at 0 after every `run` of them.
pub(super) fn words(
    out: &mut dyn Write,
    codes: &(impl Iterator<Item = u16> + Clone),
    run: usize,
) -> io::Result<()> {
    for shift in [8, 0] {
        let mut last = 0;
        let mut bytes = Vec::with_capacity(BYTES_OF_A_BLOCK);
        for (i, code) in codes.clone().enumerate() {
            last = if i % run == 0 { 0 } else { last };
            bytes.push((folded(code.wrapping_sub(last)) >> shift) as u8);
            last = code;
            if bytes.len() == BYTES_OF_A_BLOCK {
                out.write_all(&bytes)?;
                bytes.clear();
            }
        }
        out.write_all(&bytes)?;
    }
    Ok(())
}

/// Bytes that are handed over at once.
const BYTES_OF_A_BLOCK: usize = 1 << 14;

/// A difference modulo 2¹⁶, so that small ones of either sign are small numbers.
fn folded(difference: u16) -> u16 {
    let sign = 0_u16.wrapping_sub(difference >> 15);
    (difference << 1) ^ sign
}

/// Writes integers of seven bits a byte.
pub(super) fn varints(out: &mut dyn Write, values: impl Iterator<Item = u32>) -> io::Result<()> {
    let mut bytes = Vec::with_capacity(BYTES_OF_A_BLOCK + 5);
    for mut value in values {
        while value > 0x7f {
            bytes.push(value as u8 | 0x80);
            value >>= 7;
        }
        bytes.push(value as u8);
        if bytes.len() >= BYTES_OF_A_BLOCK {
            out.write_all(&bytes)?;
            bytes.clear();
        }
    }
    out.write_all(&bytes)
}

/// Writes integers as folded differences.
pub(super) fn differences(out: &mut dyn Write, values: impl Iterator<Item = u32>) -> io::Result<()> {
    let mut last = 0_u32;
    varints(
        out,
        values.map(|value| {
            let difference = value.wrapping_sub(std::mem::replace(&mut last, value));
            (difference << 1) ^ 0_u32.wrapping_sub(difference >> 31)
        }),
    )
}

#[cfg(test)]
pub(super) mod tests {
    use super::*;
    use base64::Engine;
    use std::io::Read;

    /// The bytes of a packed text.
    pub(crate) fn unpacked(text: &str) -> Vec<u8> {
        let bytes = STANDARD.decode(text).unwrap();
        let mut found = Vec::new();
        flate2::read::ZlibDecoder::new(&bytes[..]).read_to_end(&mut found).unwrap();
        found
    }

    /// The codes of words, as the page reads them.
    pub(crate) fn read_words(text: &str, run: usize) -> Vec<u16> {
        let bytes = unpacked(text);
        let (upper, lower) = bytes.split_at(bytes.len() / 2);
        let mut last = 0_u16;
        upper
            .iter()
            .zip(lower)
            .enumerate()
            .map(|(i, (&upper, &lower))| {
                let folded = u16::from_be_bytes([upper, lower]);
                let difference = (folded >> 1) ^ 0_u16.wrapping_sub(folded & 1);
                last = if i % run == 0 { difference } else { last.wrapping_add(difference) };
                last
            })
            .collect()
    }

    /// The integers of varints, as the page reads them.
    pub(crate) fn read_varints(text: &str) -> Vec<u32> {
        let (mut found, mut value, mut shift) = (Vec::new(), 0_u32, 0);
        for byte in unpacked(text) {
            value |= u32::from(byte & 0x7f) << shift;
            shift += 7;
            if byte < 0x80 {
                found.push(value);
                (value, shift) = (0, 0);
            }
        }
        found
    }

    impl Scale {
        /// The number that a code stands for.
        pub(crate) fn number(&self, code: u16) -> f64 {
            let negative = self.signed && code >= 0x8000;
            let size = if negative { code.wrapping_neg() } else { code };
            if size == 0 {
                return 0.0;
            }
            let step = (self.high / self.low).ln() / f64::from(self.levels - 1);
            let number = self.low * (f64::from(size - 1) * step).exp();
            if negative { -number } else { number }
        }
    }

    fn text(fill: impl FnOnce(&mut dyn Write) -> io::Result<()>) -> String {
        let mut out = Vec::new();
        packed(&mut out, fill).unwrap();
        String::from_utf8(out).unwrap()
    }

    #[test]
    fn words_read_back() {
        let codes: Vec<u16> = (0..40_000_u32).map(|i| (i * i + 7 * i) as u16).chain([0, 65535, 1]).collect();
        for run in [1, 100, usize::MAX] {
            let packed = text(|out| words(out, &codes.iter().copied(), run));
            assert_eq!(read_words(&packed, run), codes);
        }
    }

    #[test]
    fn integers_read_back() {
        let values = [0, 1, 127, 128, 16_383, 16_384, u32::MAX, 5, 0];
        assert_eq!(read_varints(&text(|out| varints(out, values.into_iter()))), values);
        let mut last = 0_u32;
        let found: Vec<u32> = read_varints(&text(|out| differences(out, values.into_iter())))
            .into_iter()
            .map(|folded| {
                last = last.wrapping_add((folded >> 1) ^ 0_u32.wrapping_sub(folded & 1));
                last
            })
            .collect();
        assert_eq!(found, values);
    }

    #[test]
    fn values_are_within_the_error_that_is_stated() {
        let mut x = 3.7e-4;
        let positive: Vec<f64> = std::iter::repeat_with(|| {
            x *= 1.000_37;
            x
        })
        .take(40_000)
        .collect();
        let both: Vec<f64> =
            positive.iter().enumerate().map(|(i, v)| if i % 3 == 0 { -v } else { *v }).collect();
        for values in [positive, both] {
            let scale = Scale::new(values.iter().copied());
            assert!(scale.error() < 3e-4 && scale.error() > 4e-5, "{}", scale.error());
            for value in values {
                let found = scale.number(scale.code(value));
                assert!((found / value - 1.0).abs() <= scale.error() * (1.0 + 1e-9), "{value} {found}");
            }
        }
    }

    #[test]
    fn odd_values_have_codes() {
        let none = Scale::new([0.0, -0.0, f64::NAN].into_iter());
        assert_eq!([0.0, f64::NAN, f64::INFINITY].map(|v| none.code(v)), [0; 3]);
        let same = Scale::new([2.5; 4].into_iter());
        assert_eq!((same.number(same.code(2.5)), same.error()), (2.5, 0.0));
        // What is 10⁻⁹ of the largest at most is 0, or the smallest number that is kept.
        let wide = Scale::new([1.0, 1e-12].into_iter());
        assert_eq!(wide.code(1e-12), 0);
        assert!((wide.number(wide.code(1.0)) - 1.0).abs() < 1e-14);
        let [least, most] = [f64::MIN_POSITIVE, f64::MAX].map(|v| Scale::new([v].into_iter()));
        assert_eq!((least.number(1), most.number(1)), (f64::MIN_POSITIVE, f64::MAX));
    }
}
