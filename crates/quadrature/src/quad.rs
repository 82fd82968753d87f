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
    use crate::exactness::{plane_sum, square_degree_of};

    #[test]
    fn every_rule_has_its_degree_and_no_more() {
        for n in 1..=40 {
            let points = tensor_quad(n);
            square_degree_of(&format!("n = {n}"), 2 * n - 1, |f| plane_sum(&points, f));
        }
    }
}
