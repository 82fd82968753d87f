//! Collapsed (conical product) rules on the unit triangle: u = s, v = (1 − s) t, du dv = (1 − s) ds
//! dt.
//!
//! A. H. Stroud, *Approximate Calculation of Multiple Integrals*, Prentice-Hall 1971, section 2.4.
//! Gauss–Jacobi in s carries the factor 1 − s as its weight, so that n × n points are exact to
//! degree 2n − 1, as on the square.

use crate::{PlanePoint, gauss_jacobi, gauss_legendre};

/// The collapsed n × n rule on u, v ≥ 0, u + v ≤ 1, exact to total degree 2n − 1.
///
/// ```
/// let rule = fredholm_quadrature::collapsed_triangle(2);
/// let third: f64 = rule.iter().map(|p| p.weight * p.u.powi(3)).sum();
/// assert!((third - 1.0 / 20.0).abs() < 1e-15);
/// ```
#[must_use]
pub fn collapsed_triangle(n: usize) -> Vec<PlanePoint> {
    let (across, along) = (gauss_jacobi(n, 1), gauss_legendre(n));
    let mut points = Vec::with_capacity(n * n);
    for (&s, &a) in across.points.iter().zip(&across.weights) {
        let row = along.points.iter().zip(&along.weights);
        points.extend(row.map(|(&t, &b)| PlanePoint { u: s, v: (1.0 - s) * t, weight: a * b }));
    }
    points
}

#[cfg(test)]
mod tests {
    use super::collapsed_triangle;
    use crate::exactness::triangle_degree;

    #[test]
    fn every_rule_has_its_degree_and_no_more() {
        for n in 1..=40 {
            triangle_degree(&collapsed_triangle(n), 2 * n - 1);
        }
    }

    #[test]
    fn a_rule_of_no_point_is_empty() {
        assert!(collapsed_triangle(0).is_empty());
    }
}
