//! What the tests of every rule share: all monomials of its degree to 1e-14, and at least one of the next
//! degree wrong.
//!
//! The bound is relative to the measure times the largest value of the monomial, which is what rounding is
//! relative to.

use crate::{IntervalRule, PlanePoint};

/// Rounding allowed.
const EXACT: f64 = 1e-14;

/// Asserts the degree of a rule on [0, 1]. Beyond it a Chebyshev polynomial is tried: on a monomial the error
/// of a good rule falls like 4^(−degree) and soon drowns in rounding.
pub fn interval_degree(rule: &IntervalRule) {
    let error = |power: usize| {
        let got = rule.integrate(0.0, 1.0, |x| x.powi(power as i32));
        (got - 1.0 / (power + 1) as f64).abs()
    };
    for power in 0..=rule.degree {
        assert!(error(power) <= EXACT, "{} points, x^{power}: {:e}", rule.points.len(), error(power));
    }
    let beyond = (rule.integrate(0.0, 1.0, |x| chebyshev(rule.degree + 1, x))
        - chebyshev_integral(rule.degree + 1))
    .abs();
    assert!(
        beyond > 1e-6,
        "{} points: degree {} is off by only {beyond:e}",
        rule.points.len(),
        rule.degree + 1
    );
}

/// T_m on [0, 1].
pub fn chebyshev(m: usize, x: f64) -> f64 {
    (m as f64 * (2.0 * x - 1.0).acos()).cos()
}

/// ∫₀¹ T_m = 1/(1 − m²) for even m, 0 for odd.
pub fn chebyshev_integral(m: usize) -> f64 {
    if m % 2 == 1 { 0.0 } else { 1.0 / (1.0 - (m * m) as f64) }
}

/// Σ w u^a v^b.
pub fn moment(points: &[PlanePoint], a: usize, b: usize) -> f64 {
    points.iter().map(|p| p.weight * p.u.powi(a as i32) * p.v.powi(b as i32)).sum()
}

/// ∫ u^a v^b over the unit triangle, a! b! / (a + b + 2)!.
pub fn triangle_moment(a: usize, b: usize) -> f64 {
    let inverse_binomial: f64 = (1..=b).map(|k| k as f64 / (a + k) as f64).product();
    inverse_binomial / ((a + b + 1) * (a + b + 2)) as f64
}

/// Asserts the total degree of a rule on the unit triangle.
pub fn triangle_degree(points: &[PlanePoint], degree: usize) {
    let worst = |total: usize| {
        let error = |a: usize| (moment(points, a, total - a) - triangle_moment(a, total - a)).abs();
        (0..=total).map(|a| error(a) / (0.5 * peak(a, total - a))).fold(0.0, f64::max)
    };
    for total in 0..=degree {
        assert!(worst(total) <= EXACT, "{} points, degree {total}: {:e}", points.len(), worst(total));
    }
    let beyond = worst(degree + 1);
    assert!(beyond > 10.0 * EXACT, "{} points, degree {}: only {beyond:e}", points.len(), degree + 1);
}

/// The largest value of u^a v^b on the unit triangle, at u = a/(a + b).
pub fn peak(a: usize, b: usize) -> f64 {
    let share = |k: usize| (k as f64 / ((a + b).max(1)) as f64).powi(k as i32);
    share(a) * share(b)
}
