//! Composed rules: the domain is cut into equal parts, and each gets a scaled copy of one rule of
//! degree d.
//!
//! P. J. Davis, P. Rabinowitz, *Methods of Numerical Integration*, 2nd ed., Academic Press 1984,
//! section 2.1. With parts of width h the error is O(h^(d+1)) on smooth integrands; the degree
//! stays d. Two numbers of parts give an error estimate,
//! [`Estimate::from_pair`](crate::Estimate::from_pair).

use crate::{IntervalRule, PlanePoint};

/// `rule` on each of `parts` equal parts of [0, 1]. No parts give a rule without points.
///
/// ```
/// use fredholm_quadrature::{Estimate, composed_interval, gauss_legendre};
/// let by = |parts| composed_interval(&gauss_legendre(3), parts).integrate(0.0, 1.0, f64::exp);
/// let got = Estimate::from_pair(by(8), by(16));
/// assert!((got.value - (std::f64::consts::E - 1.0)).abs() < got.error);
/// ```
#[must_use]
pub fn composed_interval(rule: &IntervalRule, parts: usize) -> IntervalRule {
    let h = 1.0 / parts as f64;
    let points = (0..parts).flat_map(|i| rule.points.iter().map(move |x| h * (i as f64 + x))).collect();
    let weights = (0..parts).flat_map(|_| rule.weights.iter().map(|w| h * w)).collect();
    IntervalRule { points, weights, degree: rule.degree }
}

/// A rule for the unit square on each of `parts` × `parts` equal squares.
///
/// ```
/// let rule = fredholm_quadrature::composed_quad(&fredholm_quadrature::tensor_quad(2), 3);
/// assert_eq!(rule.len(), 36);
/// ```
#[must_use]
pub fn composed_quad(rule: &[PlanePoint], parts: usize) -> Vec<PlanePoint> {
    let h = 1.0 / parts as f64;
    let cells = (0..parts).flat_map(|i| (0..parts).map(move |j| (h * i as f64, h * j as f64)));
    cells.flat_map(|corner| scaled(rule, corner, h)).collect()
}

/// A rule for the unit triangle on each of `parts`² equal triangles, those of the odd half upside
/// down.
///
/// ```
/// let rule = fredholm_quadrature::composed_triangle(&fredholm_quadrature::collapsed_triangle(2), 3);
/// assert_eq!(rule.len(), 36);
/// ```
#[must_use]
pub fn composed_triangle(rule: &[PlanePoint], parts: usize) -> Vec<PlanePoint> {
    let h = 1.0 / parts as f64;
    let mut points = Vec::with_capacity(rule.len() * parts * parts);
    for i in 0..parts {
        for j in 0..parts - i {
            points.extend(scaled(rule, (h * i as f64, h * j as f64), h));
        }
        for j in 1..parts - i {
            points.extend(scaled(rule, (h * (i + 1) as f64, h * j as f64), -h));
        }
    }
    points
}

/// The rule scaled by h (negative: turned by 180°) and moved to a corner.
fn scaled(rule: &[PlanePoint], corner: (f64, f64), h: f64) -> impl Iterator<Item = PlanePoint> {
    let place = move |p: &PlanePoint| PlanePoint {
        u: corner.0 + h * p.u,
        v: corner.1 + h * p.v,
        weight: h * h * p.weight,
    };
    rule.iter().map(place)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::exactness::{interval_degree, plane_sum, square_degree_of, triangle_degree};
    use crate::{collapsed_triangle, gauss_legendre, newton_cotes_closed, symmetric_triangle, tensor_quad};

    #[test]
    fn composing_keeps_the_degree_on_the_interval() {
        for (parts, n) in (1..=5).flat_map(|parts| (1..=5).map(move |n| (parts, n))) {
            interval_degree(&composed_interval(&gauss_legendre(n), parts));
            interval_degree(&composed_interval(&newton_cotes_closed(n + 1).unwrap(), parts));
        }
    }

    #[test]
    fn composing_keeps_the_degree_on_the_square_and_the_triangle() {
        for (parts, n) in (1..=5).flat_map(|parts| (1..=5).map(move |n| (parts, n))) {
            let quad = composed_quad(&tensor_quad(n), parts);
            square_degree_of(&format!("{parts} parts, n = {n}"), 2 * n - 1, |f| plane_sum(&quad, f));
            let (even, odd) = (symmetric_triangle(2 * n).unwrap(), collapsed_triangle(n));
            triangle_degree(&composed_triangle(&even, parts), 2 * n);
            triangle_degree(&composed_triangle(&odd, parts), 2 * n - 1);
        }
    }

    /// log₂ of the fall of the error from one halving of h to the next.
    fn order(coarse: f64, fine: f64, exact: f64) -> f64 {
        ((coarse - exact).abs() / (fine - exact).abs()).log2()
    }

    #[test]
    fn the_error_falls_with_the_order_of_the_rule() {
        let by =
            |parts| composed_interval(&newton_cotes_closed(3).unwrap(), parts).integrate(0.0, 1.0, f64::exp);
        assert!((order(by(8), by(16), 1f64.exp_m1()) - 4.0).abs() < 0.05);
        let sum =
            |points: Vec<PlanePoint>| points.iter().map(|p| p.weight * (p.u + 2.0 * p.v).exp()).sum::<f64>();
        let quad = |parts| sum(composed_quad(&tensor_quad(2), parts));
        assert!((order(quad(4), quad(8), 1f64.exp_m1() * 0.5 * 2f64.exp_m1()) - 4.0).abs() < 0.05);
        // ∫₀¹ eᵘ (e^(2 − 2u) − 1)/2 du = (e² − 2e + 1)/2.
        let triangle = |parts| sum(composed_triangle(&symmetric_triangle(2).unwrap(), parts));
        let fall = order(triangle(8), triangle(16), 0.5 * 1f64.exp_m1().powi(2));
        assert!(fall > 2.9, "order {fall}");
    }

    #[test]
    fn no_parts_give_no_points() {
        assert!(composed_interval(&gauss_legendre(2), 0).points.is_empty());
        assert!(
            composed_quad(&tensor_quad(2), 0).is_empty() && composed_triangle(&tensor_quad(2), 0).is_empty()
        );
    }
}
