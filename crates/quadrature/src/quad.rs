//! Tensor rules on the unit square: ∫₀¹∫₀¹ f(u, v) du dv ≈ Σᵢ Σⱼ wᵢ wⱼ f(xᵢ, xⱼ).

use crate::{PlanePoint, gauss_legendre};

/// The n × n Gauss rule on [0, 1]², exact for u^a v^b with a, b ≤ 2n − 1.
///
/// ```
/// let sum: f64 = fredholm_quadrature::tensor_quad(2).iter().map(|p| p.weight * p.u.powi(3) * p.v).sum();
/// assert!((sum - 1.0 / 8.0).abs() < 1e-15);
/// ```
#[must_use]
pub fn tensor_quad(n: usize) -> Vec<PlanePoint> {
    let rule = gauss_legendre(n);
    let nodes = || rule.points.iter().zip(&rule.weights);
    nodes().flat_map(|(&u, &a)| nodes().map(move |(&v, &b)| PlanePoint { u, v, weight: a * b })).collect()
}

#[cfg(test)]
mod tests {
    use super::tensor_quad;

    fn error(n: usize, a: usize, b: usize) -> f64 {
        let exact = 1.0 / ((a + 1) * (b + 1)) as f64;
        let sum: f64 =
            tensor_quad(n).iter().map(|p| p.weight * p.u.powi(a as i32) * p.v.powi(b as i32)).sum();
        (sum - exact).abs() / exact
    }

    #[test]
    fn integrates_every_monomial_of_its_degree() {
        for n in 1..=10 {
            for a in 0..2 * n {
                for b in 0..2 * n {
                    assert!(error(n, a, b) < 1e-14, "n = {n}, u^{a} v^{b}");
                }
            }
        }
    }

    #[test]
    fn fails_beyond_its_degree() {
        for n in 1..=6 {
            assert!(error(n, 2 * n, 0) > 1e-10 && error(n, 0, 2 * n) > 1e-10);
        }
    }
}
