//! The accuracies that are computed to: powers of ten.
//!
//! Errors lie below what is asked for by factors that scatter from pair to pair. Asking for twice
//! the accuracy could then give a slightly larger error. A step of ten in the tolerance is larger
//! than the scatter of the largest error in a scene.

/// Finest tolerance: what is asked for below it is lost in rounding, and looking for it makes
/// results worse.
const FINEST_TOLERANCE: f64 = 1e-14;

/// Relative distance below a power of ten that counts as rounding.
const ROUNDING: f64 = 1e-12;

/// The largest power of ten that is at most `tolerance`, but not below [`FINEST_TOLERANCE`].
pub(super) fn rung(tolerance: f64) -> f64 {
    10f64.powi((tolerance.max(FINEST_TOLERANCE) * (1.0 + ROUNDING)).log10().floor() as i32)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn powers_of_ten_stay_and_others_are_rounded_down() {
        for power in -13..=2 {
            let exact: f64 = format!("1e{power}").parse().unwrap_or_default();
            assert!((rung(exact) / exact - 1.0).abs() < 1e-15, "{exact}");
            assert!((rung(9.99 * exact) / exact - 1.0).abs() < 1e-15, "{exact}");
            assert!((rung(0.999 * exact) / exact - 0.1).abs() < 1e-15, "{exact}");
        }
        for tolerance in [1e-14, 9e-15, 1e-300, 0.0] {
            assert!((rung(tolerance) / FINEST_TOLERANCE - 1.0).abs() < 1e-15, "{tolerance:e}");
        }
    }
}
