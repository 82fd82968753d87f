//! Collapsed (Stroud conical) rules on the unit triangle: u = s, v = (1 − s) t, du dv = (1 − s) ds dt.
//!
//! A. H. Stroud, *Approximate Calculation of Multiple Integrals*, Prentice-Hall 1971, section 2.4. Gauss–Legendre is used in
//! both directions, which absorbs the factor 1 − s at the price of one degree: n × n points are exact to degree 2n − 2.

use crate::{PlanePoint, gauss_legendre};

/// The collapsed n × n rule on u, v ≥ 0, u + v ≤ 1, exact to total degree 2n − 2.
///
/// ```
/// let area: f64 = fredholm_quadrature::collapsed_triangle(2).iter().map(|p| p.weight).sum();
/// assert!((area - 0.5).abs() < 1e-15);
/// ```
#[must_use]
pub fn collapsed_triangle(n: usize) -> Vec<PlanePoint> {
    let rule = gauss_legendre(n);
    let nodes = || rule.points.iter().zip(&rule.weights);
    let point =
        |s: f64, a: f64, t: f64, b: f64| PlanePoint { u: s, v: (1.0 - s) * t, weight: a * b * (1.0 - s) };
    nodes().flat_map(|(&s, &a)| nodes().map(move |(&t, &b)| point(s, a, t, b))).collect()
}

#[cfg(test)]
mod tests {
    use super::collapsed_triangle;

    /// ∫ u^a v^b over the unit triangle is a! b! / (a + b + 2)!.
    fn exact(a: usize, b: usize) -> f64 {
        let factorial = |n: usize| (1..=n).map(|k| k as f64).product::<f64>();
        factorial(a) * factorial(b) / factorial(a + b + 2)
    }

    fn error(n: usize, a: usize, b: usize) -> f64 {
        let term = |u: f64, v: f64| u.powi(a as i32) * v.powi(b as i32);
        let sum: f64 = collapsed_triangle(n).iter().map(|p| p.weight * term(p.u, p.v)).sum();
        (sum - exact(a, b)).abs() / exact(a, b)
    }

    #[test]
    fn integrates_every_monomial_of_its_degree() {
        for n in 1..=10 {
            for a in 0..=2 * n - 2 {
                for b in 0..=2 * n - 2 - a {
                    assert!(error(n, a, b) < 1e-13, "n = {n}, u^{a} v^{b}: {}", error(n, a, b));
                }
            }
        }
    }

    #[test]
    fn fails_beyond_its_degree() {
        for n in 1..=6 {
            assert!(error(n, 2 * n - 1, 0) > 1e-10);
        }
    }
}
