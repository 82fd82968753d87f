//! Romberg's method: trapezoids with 1, 2, 4, … panels, extrapolated to h = 0 over the even powers
//! of h.
//!
//! W. Romberg, Det Kongelige Norske Videnskabers Selskab Forhandlinger 28 (1955) 30; the even
//! powers are the Euler–Maclaurin formula's (DLMF 3.5.9, <https://dlmf.nist.gov/3.5>). Level k uses
//! 2ᵏ + 1 points and has degree 2k + 1.

use crate::{Estimate, richardson::extend};

/// Levels before which agreement is not believed: few equally spaced points agree by accident on a
/// periodic integrand.
const FIRST_TRUSTED: u32 = 4;

/// Most halvings that are made, a billion points: no integrand that needs more should be given to
/// this method.
const MOST_LEVELS: u32 = 30;

/// ∫ₐᵇ f, refined until two levels agree to `tolerance` (absolute) or `levels` halvings (at most
/// 30) are spent. What could not be met shows in the error; a value that is not finite ends the
/// work with an error of NaN. For smooth integrands up to both ends; elsewhere the adaptive rules
/// need fewer points.
///
/// ```
/// let got = fredholm_quadrature::romberg(0.0, 1.0, 1e-12, 20, f64::exp);
/// assert!((got.value - (std::f64::consts::E - 1.0)).abs() < 1e-12);
/// ```
pub fn romberg(a: f64, b: f64, tolerance: f64, levels: u32, mut f: impl FnMut(f64) -> f64) -> Estimate {
    let mut trapezoid = 0.5 * (b - a) * (f(a) + f(b));
    let mut row = vec![trapezoid];
    let levels = levels.min(MOST_LEVELS);
    let exponents: Vec<f64> = (1..=levels).map(|j| 2.0 * f64::from(j)).collect();
    let mut estimate = Estimate { value: trapezoid, error: f64::INFINITY };
    for level in 1..=levels {
        trapezoid = 0.5 * (trapezoid + midpoints(a, b, level, &mut f));
        extend(&mut row, trapezoid, 2.0, &exponents);
        let value = row.last().copied().unwrap_or(trapezoid);
        estimate = Estimate { value, error: (value - estimate.value).abs() };
        let met = level >= FIRST_TRUSTED && estimate.error <= tolerance;
        // The trapezoids keep what is not finite for ever.
        if met || estimate.error.is_nan() {
            break;
        }
    }
    estimate
}

/// The midpoint sum over the 2^(level − 1) panels of the level before.
fn midpoints(a: f64, b: f64, level: u32, f: &mut impl FnMut(f64) -> f64) -> f64 {
    let panels = 1_u64 << (level - 1);
    let width = (b - a) / panels as f64;
    width * (0..panels).map(|i| f(a + width * (i as f64 + 0.5))).sum::<f64>()
}

#[cfg(test)]
mod tests {
    use super::romberg;
    use crate::exactness::{ROUNDING_ALLOWED, interval_degree_of};

    type Curve = fn(f64) -> f64;

    /// The error at degree 2k + 2 falls like 2^(−k²): beyond level 9 it is below rounding.
    #[test]
    fn every_level_has_its_degree_and_no_more() {
        for level in 0..=9 {
            let by = |f: &dyn Fn(f64) -> f64| romberg(0.0, 1.0, 0.0, level, f).value;
            interval_degree_of(&format!("level {level}"), 2 * level as usize + 1, by);
        }
    }

    #[test]
    fn levels_beyond_keep_their_degree() {
        for level in 10..=14 {
            for power in 0..=2 * level as i32 + 1 {
                let got = romberg(0.0, 1.0, 0.0, level, |x| x.powi(power)).value;
                assert!(
                    (got - 1.0 / f64::from(power + 1)).abs() <= ROUNDING_ALLOWED,
                    "level {level}, x^{power}"
                );
            }
        }
    }

    #[test]
    fn meets_its_tolerance_on_smooth_integrands() {
        let cases: [(Curve, f64); 3] = [
            (|x| 4.0 / (1.0 + x * x), std::f64::consts::PI),
            (f64::sin, 1.0 - 1f64.cos()),
            (|x| 1.0 / (0.01 + x), 101f64.ln()),
        ];
        for (f, exact) in cases {
            for tolerance in [1e-4, 1e-8, 1e-12] {
                let got = romberg(0.0, 1.0, tolerance, 20, f);
                assert!((got.value - exact).abs() <= tolerance, "{} against {exact}", got.value);
            }
        }
    }

    #[test]
    fn says_so_when_it_runs_out_of_levels() {
        assert!(romberg(0.0, 1.0, 1e-12, 6, f64::sqrt).error > 1e-5);
    }

    /// The error at 30 levels, which must not take more than a thousand values.
    fn error_of(f: Curve) -> f64 {
        let mut count = 0;
        let watched = |x: f64| {
            count += 1;
            assert!(count < 1000, "no end");
            f(x)
        };
        romberg(0.0, 1.0, 1e-12, 30, watched).error
    }

    #[test]
    fn a_value_that_is_not_finite_ends_the_work_and_stays_visible() {
        assert!(error_of(|_| f64::NAN).is_nan());
        assert!(error_of(|x| (x - 0.3).sqrt()).is_nan());
        assert!(error_of(|x| 1.0 / x).is_nan());
        assert!(error_of(|x| 1.0 / (x - 0.375)).is_nan());
    }
}
