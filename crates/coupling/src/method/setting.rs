//! The one number (or two) that a method can be told, and its range.

use super::MethodError;
use std::fmt;

/// Setting of a form-factor method.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Setting {
    /// The method has nothing to set.
    Fixed,
    /// Points a direction.
    Order(usize),
    /// Error to reach, relative to A_i A_j / (π d²) or the smaller area where that is less.
    Tolerance(f64),
    /// Number and seed of random samples.
    Samples {
        /// Number of samples.
        count: u64,
        /// Seed: another one gives an independent result.
        seed: u64,
    },
    /// Pixels along the edge of the top face.
    Resolution(usize),
}

impl fmt::Display for Setting {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Fixed => write!(f, "no setting"),
            Self::Order(order) => write!(f, "order {order}"),
            Self::Tolerance(tolerance) => write!(f, "tolerance {tolerance:e}"),
            Self::Samples { count, seed } => write!(f, "{count} samples with seed {seed}"),
            Self::Resolution(pixels) => write!(f, "resolution {pixels}"),
        }
    }
}

/// Finest tolerance: below it rounding is larger.
const FINEST_TOLERANCE: f64 = 1e-15;

impl Setting {
    pub(super) fn fixed(self, method: &'static str) -> Result<(), MethodError> {
        if self == Self::Fixed { Ok(()) } else { Err(self.refused(method, "no setting".to_owned())) }
    }

    pub(super) fn order(self, method: &'static str, most: usize) -> Result<usize, MethodError> {
        match self {
            Self::Order(order) if (1..=most).contains(&order) => Ok(order),
            _ => Err(self.refused(method, format!("an order from 1 to {most}"))),
        }
    }

    pub(super) fn tolerance(self, method: &'static str) -> Result<f64, MethodError> {
        match self {
            Self::Tolerance(tolerance) if (FINEST_TOLERANCE..=1.0).contains(&tolerance) => Ok(tolerance),
            _ => Err(self.refused(method, format!("a tolerance from {FINEST_TOLERANCE:e} to 1"))),
        }
    }

    pub(super) fn samples(self, method: &'static str) -> Result<(u64, u64), MethodError> {
        match self {
            Self::Samples { count, seed } if count >= 2 => Ok((count, seed)),
            _ => Err(self.refused(method, "2 samples or more, and a seed".to_owned())),
        }
    }

    pub(super) fn resolution(self, method: &'static str, most: usize) -> Result<usize, MethodError> {
        match self {
            Self::Resolution(pixels) if pixels % 2 == 0 && (2..=most).contains(&pixels) => Ok(pixels),
            _ => Err(self.refused(method, format!("an even resolution from 2 to {most}"))),
        }
    }

    fn refused(self, method: &'static str, wanted: String) -> MethodError {
        MethodError::Setting { method, wanted, got: self }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn out_of_range_and_of_another_kind_are_refused() {
        assert!(Setting::Order(0).order("m", 8).is_err() && Setting::Order(9).order("m", 8).is_err());
        assert!(Setting::Tolerance(f64::NAN).tolerance("m").is_err());
        assert!(Setting::Fixed.tolerance("m").is_err() && Setting::Order(2).fixed("m").is_err());
        assert!(Setting::Resolution(7).resolution("m", 64).is_err());
        let error = Setting::Samples { count: 1, seed: 5 }.samples("m").unwrap_err();
        assert_eq!(
            error.to_string(),
            "the method m takes 2 samples or more, and a seed, not 1 samples with seed 5"
        );
    }
}
