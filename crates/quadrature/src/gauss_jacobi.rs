//! Gauss–Jacobi rules for the weight (1 − s)^α on [0, 1]: ∫₀¹ (1 − s)^α f(s) ds ≈ Σ wᵢ f(sᵢ), n
//! points, degree 2n − 1.
//!
//! Points are the roots of Pₙ^(α,0) (DLMF 18.9.1 for the recurrence, 18.9.17 for the derivative,
//! <https://dlmf.nist.gov/18.9>); with β = 0 the weights on [−1, 1] are 2^(α+1) / ((1 − xᵢ²) Pₙ′(xᵢ)²). The
//! weight 1 − s is what collapsing a square to a triangle leaves behind.

use crate::IntervalRule;
use std::f64::consts::PI;

/// Newton steps with the known roots divided out, then without.
const NEWTON_STEPS: [usize; 2] = [12, 2];

/// The rule with `n` points for the weight (1 − s)^α. The weights sum to 1/(α + 1); α = 0 is
/// Gauss–Legendre.
///
/// ```
/// let rule = fredholm_quadrature::gauss_jacobi(2, 1);
/// let third = rule.integrate(0.0, 1.0, |s| s.powi(3));
/// assert!((third - (1.0 / 4.0 - 1.0 / 5.0)).abs() < 1e-15);
/// ```
#[must_use]
pub fn gauss_jacobi(n: usize, alpha: u32) -> IntervalRule {
    let mut roots = roots(n, f64::from(alpha));
    roots.sort_by(f64::total_cmp);
    let weight = |x: f64| {
        let slope = jacobi(n, f64::from(alpha), x).1;
        1.0 / ((1.0 - x * x) * slope * slope)
    };
    let weights = roots.iter().map(|&x| weight(x)).collect();
    let points = roots.iter().map(|&x| 0.5 * (1.0 + x)).collect();
    IntervalRule { points, weights, degree: (2 * n).saturating_sub(1) }
}

/// All roots of Pₙ^(α,0), largest first.
fn roots(n: usize, alpha: f64) -> Vec<f64> {
    let mut roots: Vec<f64> = Vec::with_capacity(n);
    for i in 0..n {
        let start = (PI * (i as f64 + 0.5 * alpha + 0.75) / (n as f64 + 0.5 * (alpha + 1.0))).cos();
        let near = newton(n, alpha, start, &roots, NEWTON_STEPS[0]);
        roots.push(newton(n, alpha, near, &[], NEWTON_STEPS[1]));
    }
    roots
}

/// Newton's iteration on Pₙ(x) / Π (x − known), which cannot fall back on a known root.
fn newton(n: usize, alpha: f64, start: f64, known: &[f64], steps: usize) -> f64 {
    let mut x = start;
    for _ in 0..steps {
        let (value, slope) = jacobi(n, alpha, x);
        let pull: f64 = known.iter().map(|root| 1.0 / (x - root)).sum();
        x -= value / (slope - value * pull);
    }
    x
}

/// Pₙ^(α,0)(x) and its derivative.
fn jacobi(n: usize, alpha: f64, x: f64) -> (f64, f64) {
    let (mut previous, mut current) = (0.0, 1.0);
    for k in 1..=n {
        (previous, current) = (current, next_jacobi(k as f64, alpha, x, current, previous));
    }
    let (n, double) = (n as f64, 2.0 * n as f64 + alpha);
    let slope = n * (alpha - double * x) * current + 2.0 * (n + alpha) * n * previous;
    (current, slope / (double * (1.0 - x * x)))
}

/// Pₖ from Pₖ₋₁ and Pₖ₋₂. The recurrence is 0/0 for k = 1 and α = 0, so that P₁ is written out.
fn next_jacobi(k: f64, alpha: f64, x: f64, last: f64, before: f64) -> f64 {
    if k < 1.5 {
        return alpha + 1.0 + 0.5 * (alpha + 2.0) * (x - 1.0);
    }
    let c = 2.0 * k + alpha;
    let upper = (c - 1.0) * (c * (c - 2.0) * x + alpha * alpha) * last;
    let lower = 2.0 * (k + alpha - 1.0) * (k - 1.0) * c * before;
    (upper - lower) / (2.0 * k * (k + alpha) * (c - 2.0))
}

#[cfg(test)]
mod tests {
    use super::gauss_jacobi;
    use crate::exactness::{LEAST_WRONG_ERROR, ROUNDING_ALLOWED, chebyshev};
    use crate::gauss_legendre;

    /// ∫₀¹ (1 − s)^α s^p ds = p! α! / (p + α + 1)!, as Π over the shorter factorial.
    fn exact(alpha: u32, power: usize) -> f64 {
        let shared: f64 = (1..=alpha).map(|k| f64::from(k) / (power as f64 + f64::from(k))).product();
        shared / (power as f64 + f64::from(alpha) + 1.0)
    }

    /// Relative to the measure; the largest value of s^p is 1.
    fn error(n: usize, alpha: u32, power: usize) -> f64 {
        let got = gauss_jacobi(n, alpha).integrate(0.0, 1.0, |s| s.powi(power as i32));
        (got - exact(alpha, power)).abs() * f64::from(alpha + 1)
    }

    /// The error of T_2n, against Gauss–Legendre with (1 − s)^α as a part of the integrand.
    fn beyond(n: usize, alpha: u32) -> f64 {
        let next = |s: f64| chebyshev(2 * n, s);
        let exact = gauss_legendre(n + 4).integrate(0.0, 1.0, |s| (1.0 - s).powi(alpha as i32) * next(s));
        (gauss_jacobi(n, alpha).integrate(0.0, 1.0, next) - exact).abs() * f64::from(alpha + 1)
    }

    #[test]
    fn integrates_every_polynomial_of_its_degree_and_no_more() {
        for (n, alpha) in (1..=40).flat_map(|n| (0..=4).map(move |alpha| (n, alpha))) {
            let worst = (0..2 * n).map(|power| error(n, alpha, power)).fold(0.0, f64::max);
            assert!(worst <= ROUNDING_ALLOWED, "n = {n}, α = {alpha}: {worst:e}");
            assert!(beyond(n, alpha) > LEAST_WRONG_ERROR, "n = {n}, α = {alpha}: {:e}", beyond(n, alpha));
        }
    }

    #[test]
    fn large_rules_keep_their_points_apart_and_their_weights_positive() {
        for alpha in 0..=4 {
            let rule = gauss_jacobi(200, alpha);
            assert!(rule.points.windows(2).all(|x| x[0] < x[1]) && rule.weights.iter().all(|&w| w > 0.0));
            assert!(
                (rule.weights.iter().sum::<f64>() * f64::from(alpha + 1) - 1.0).abs() < 1e-13,
                "α = {alpha}"
            );
        }
    }

    #[test]
    fn is_gauss_legendre_for_the_weight_1() {
        for n in [1, 2, 7, 64] {
            let (jacobi, legendre) = (gauss_jacobi(n, 0), gauss_legendre(n));
            let close = |a: &[f64], b: &[f64]| a.iter().zip(b).all(|(a, b)| (a - b).abs() < 2e-15);
            assert!(
                close(&jacobi.points, &legendre.points) && close(&jacobi.weights, &legendre.weights),
                "n = {n}"
            );
        }
    }
}
