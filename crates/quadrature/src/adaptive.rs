//! Adaptive bisection on an interval: split until ∫ₐᵇ ≈ Q[a, b] and Q[a, m] + Q[m, b] agree.
//!
//! P. J. Davis, P. Rabinowitz, *Methods of Numerical Integration*, 2nd ed., Academic Press 1984,
//! section 6.2. The difference of the two values is the error estimate of the coarser one; the
//! finer one is returned, so that the estimate errs on the safe side where halving gains more than
//! a factor of two. Where it gains less, as on x^(−1/2),
//! [`adaptive_interval`](crate::adaptive_interval) estimates the rest of the series too.

use crate::IntervalRule;

/// An integral with its estimated absolute error.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Estimate {
    /// The value.
    pub value: f64,
    /// Estimated absolute error of the value.
    pub error: f64,
}

impl Estimate {
    /// The finer of two values, with their difference, the error of the coarser, as its error.
    #[must_use]
    pub fn from_pair(coarse: f64, fine: f64) -> Self {
        Self { value: fine, error: (fine - coarse).abs() }
    }
}

impl std::ops::Add for Estimate {
    type Output = Self;
    fn add(self, other: Self) -> Self {
        Self { value: self.value + other.value, error: self.error + other.error }
    }
}

/// Relative difference that counts as rounding: smaller ones are not bisected.
const ROUNDING: f64 = 4.0 * f64::EPSILON;

/// ∫ₐᵇ f by `rule`, bisected until each half meets its share of `tolerance` (absolute), or comes to
/// rounding, or `depth` bisections are spent. What could not be met shows in the error of the
/// result. Where f is not a number, or infinite at points of a part and of its halves, that part is
/// not bisected further, and the error is NaN.
///
/// ```
/// let rule = fredholm_quadrature::gauss_legendre(8);
/// let log = fredholm_quadrature::integrate_adaptive(&rule, 0.0, 1.0, 1e-12, 60, &f64::ln);
/// assert!((log.value + 1.0).abs() < 1e-12);
/// ```
pub fn integrate_adaptive(
    rule: &IntervalRule,
    a: f64,
    b: f64,
    tolerance: f64,
    depth: u32,
    f: &impl Fn(f64) -> f64,
) -> Estimate {
    bisect(rule, (a, b), rule.integrate(a, b, f), tolerance, depth, f)
}

fn bisect(
    rule: &IntervalRule,
    (a, b): (f64, f64),
    whole: f64,
    tolerance: f64,
    depth: u32,
    f: &impl Fn(f64) -> f64,
) -> Estimate {
    let middle = 0.5 * (a + b);
    let (left, right) = (rule.integrate(a, middle, f), rule.integrate(middle, b, f));
    let error = (left + right - whole).abs();
    let rounding = ROUNDING * (left.abs() + right.abs());
    // No bisection mends an error that is not a number; an infinite one may come from a pole that
    // the halves miss.
    if error <= tolerance.max(rounding) || error.is_nan() || depth == 0 {
        return Estimate { value: left + right, error };
    }
    let half = 0.5 * tolerance;
    bisect(rule, (a, middle), left, half, depth - 1, f) + bisect(rule, (middle, b), right, half, depth - 1, f)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::exactness::interval_degree_of;
    use crate::{gauss_legendre, newton_cotes_closed};
    use std::cell::Cell;

    fn meets(f: impl Fn(f64) -> f64, exact: f64) {
        for tolerance in [1e-4, 1e-8, 1e-12] {
            let got = integrate_adaptive(&gauss_legendre(10), 0.0, 1.0, tolerance, 60, &f);
            assert!((got.value - exact).abs() <= tolerance, "{} against {exact} at {tolerance}", got.value);
            assert!((got.value - exact).abs() <= got.error + 1e-15);
        }
    }

    #[test]
    fn a_tolerance_below_rounding_ends() {
        for f in [f64::exp as fn(f64) -> f64, f64::sqrt, |x| (30.0 * x).sin()] {
            let calls = Cell::new(0);
            let counted = |x: f64| {
                calls.set(calls.get() + 1);
                f(x)
            };
            let got = integrate_adaptive(&gauss_legendre(10), 0.0, 1.0, 0.0, 60, &counted);
            assert!(got.error < 1e-14 && calls.get() < 1_000_000, "{got:?} by {} calls", calls.get());
        }
    }

    #[test]
    fn meets_its_tolerance_on_singular_and_peaked_integrands() {
        meets(f64::ln, -1.0);
        meets(f64::sqrt, 2.0 / 3.0);
        meets(|x| (x - 1.0 / 3.0).abs(), 5.0 / 18.0);
        meets(|x| 1e-3 / (1e-6 + (x - 0.4) * (x - 0.4)), 600f64.atan() + 400f64.atan());
    }

    #[test]
    fn says_so_when_it_runs_out_of_depth() {
        let got = integrate_adaptive(&gauss_legendre(2), 0.0, 1.0, 1e-15, 2, &|x: f64| x.ln());
        assert!(got.error > 1e-4);
    }

    #[test]
    fn one_bisection_has_the_degree_of_the_rule() {
        for n in 1..=10 {
            let rule = gauss_legendre(n);
            let by = |f: &dyn Fn(f64) -> f64| integrate_adaptive(&rule, 0.0, 1.0, 0.0, 0, &f).value;
            interval_degree_of(&format!("n = {n}"), rule.degree, by);
        }
    }

    /// The result at a depth of 60, which must not take more than a thousand values.
    fn counted(rule: &IntervalRule, f: impl Fn(f64) -> f64) -> Estimate {
        let count = Cell::new(0);
        let watched = |x: f64| {
            count.set(count.get() + 1);
            assert!(count.get() < 1000, "no end");
            f(x)
        };
        integrate_adaptive(rule, 0.0, 1.0, 1e-6, 60, &watched)
    }

    #[test]
    fn a_value_that_is_no_number_ends_the_work_and_stays_visible() {
        let rule = gauss_legendre(3);
        assert!(counted(&rule, |_| f64::NAN).error.is_nan());
        assert!(counted(&rule, |x| (x - 0.3).sqrt()).error.is_nan());
        assert!(counted(&rule, |x| if x > 0.6 { f64::INFINITY } else { x }).error.is_nan());
        assert!(counted(&newton_cotes_closed(3).unwrap(), |x| 1.0 / x).error.is_nan());
    }

    #[test]
    fn a_single_infinite_value_is_bisected_away() {
        let got = counted(&gauss_legendre(3), |x| if (x - 0.5).abs() < 1e-12 { f64::INFINITY } else { x });
        assert!((got.value - 0.5).abs() < 1e-15 && got.error < 1e-15, "{got:?}");
    }
}
