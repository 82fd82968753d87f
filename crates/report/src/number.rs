//! Decimal text that reads back to the same f64: the shortest digits that do, with an exponent
//! where it saves zeros; zero has no sign.

use std::fmt;

/// A number as it stands in the files.
pub(crate) struct Number(pub(crate) f64);

impl fmt::Display for Number {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self(x) = *self;
        // A zero's sign means nothing to a reader.
        let x = if x == 0.0 { 0.0 } else { x };
        if x == 0.0 || (1e-5..1e16).contains(&x.abs()) { write!(f, "{x}") } else { write!(f, "{x:e}") }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_read_back_to_the_same_bits() {
        let mut x = 1.234_567_890_123_456_7e-300_f64;
        while x < 1e300 {
            for value in [x, -x, 1.0 / x] {
                let back: f64 = Number(value).to_string().parse().unwrap();
                assert_eq!(back.to_bits(), value.to_bits());
            }
            x *= 1.733e3;
        }
        assert_eq!(Number(0.25).to_string(), "0.25");
        assert_eq!(Number(-0.0).to_string(), "0");
        assert_eq!(Number(3e-9).to_string(), "3e-9");
    }
}
