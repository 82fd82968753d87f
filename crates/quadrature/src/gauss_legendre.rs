//! Gauss–Legendre rules: n points, degree 2n − 1.
//!
//! Points on [−1, 1] are the roots of Pₙ, weights wᵢ = 2 / ((1 − xᵢ²) Pₙ′(xᵢ)²) (DLMF 3.5.24,
//! <https://dlmf.nist.gov/3.5>). The roots are found by Newton's iteration from Tricomi's starting values;
//! the rule is then mapped to [0, 1].

use crate::IntervalRule;
use std::f64::consts::PI;

/// Newton steps: the starting values are good to O(n⁻⁴), so that convergence takes four or fewer.
const NEWTON_STEPS: usize = 8;

/// The Gauss–Legendre rule with `n` points on [0, 1]. A rule of no point integrates everything to 0.
///
/// ```
/// let rule = fredholm_quadrature::gauss_legendre(3);
/// let fifth = rule.integrate(0.0, 1.0, |x| x.powi(5));
/// assert!((fifth - 1.0 / 6.0).abs() < 1e-15);
/// ```
#[must_use]
pub fn gauss_legendre(n: usize) -> IntervalRule {
    let mut points = vec![0.5; n];
    let mut weights = vec![0.0; n];
    for i in 0..n.div_ceil(2) {
        let (x, slope) = root(n, i);
        let weight = 1.0 / ((1.0 - x * x) * slope * slope);
        points[i] = 0.5 * (1.0 - x);
        points[n - 1 - i] = 0.5 * (1.0 + x);
        weights[i] = weight;
        weights[n - 1 - i] = weight;
    }
    IntervalRule { points, weights, degree: (2 * n).saturating_sub(1) }
}

/// The i-th largest root of Pₙ and the derivative there.
fn root(n: usize, i: usize) -> (f64, f64) {
    if 2 * i + 1 == n {
        return (0.0, legendre(n, 0.0).1);
    }
    let mut x = (PI * (i as f64 + 0.75) / (n as f64 + 0.5)).cos();
    for _ in 0..NEWTON_STEPS {
        let (value, slope) = legendre(n, x);
        x -= value / slope;
    }
    (x, legendre(n, x).1)
}

/// Pₙ(x) and Pₙ′(x) by the three-term recurrence k Pₖ = (2k − 1) x Pₖ₋₁ − (k − 1) Pₖ₋₂.
fn legendre(n: usize, x: f64) -> (f64, f64) {
    let (mut previous, mut current) = (0.0, 1.0);
    for k in 1..=n {
        let k = k as f64;
        (previous, current) = (current, ((2.0 * k - 1.0) * x * current - (k - 1.0) * previous) / k);
    }
    (current, n as f64 * (previous - x * current) / (1.0 - x * x))
}

#[cfg(test)]
mod tests {
    use super::gauss_legendre;
    use crate::exactness::interval_degree;

    #[test]
    fn every_rule_has_its_degree_and_no_more() {
        for n in 1..=64 {
            interval_degree(&gauss_legendre(n));
        }
    }

    #[test]
    fn large_rules_keep_their_weights_positive_and_summed() {
        let rule = gauss_legendre(1000);
        assert!(rule.weights.iter().all(|&w| w > 0.0));
        assert!((rule.weights.iter().sum::<f64>() - 1.0).abs() < 1e-13);
        assert!(rule.points.windows(2).all(|x| x[0] < x[1]));
    }

    #[test]
    fn a_rule_of_no_point_is_empty() {
        assert!(gauss_legendre(0).points.is_empty());
    }
}
