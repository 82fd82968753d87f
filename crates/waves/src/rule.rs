//! How many Gauss points a facet needs, and the points themselves.
//!
//! Over a side of length h, the integrand e^{jκx} f(x) has two enemies of an n-point Gauss rule (P.
//! J. Davis, P. Rabinowitz, Methods of Numerical Integration, 2nd ed., Academic Press 1984, § 2.7
//! and 4.6), relative to its size:
//!
//! ```text
//! the phase:    (n!)⁴ (κh)^{2n} / ((2n + 1) ((2n)!)³)
//! the distance: C ϱ^{−2n}, ϱ = s + √(s² − 1), for a pole s half-diameters from the centre
//! ```
//!
//! C = 6 stands for the growth of up to 1/R³ on the ellipse of ϱ and both directions. Lengths in
//! metres.

use crate::Facet;
use fredholm_mesh::{Patch, Vec3};
use fredholm_quadrature::{PlanePoint, near_triangle, symmetric_triangle, tensor_quad};

/// C of the module's text.
const KERNEL_GROWTH: f64 = 6.0;
/// Most points a side that a rule is given.
pub(crate) const MOST_POINTS: usize = 12;
/// Points a side of each part of a nearly singular rule.
const NEARLY_SINGULAR_POINTS: usize = 14;

/// Bound of the relative error of n points for the phase κh, both directions.
#[must_use]
pub(crate) fn phase_error(n: usize, phase: f64) -> f64 {
    // (n!)⁴/((2n)!)³ as a product, which neither overflows nor vanishes before its time.
    let factor: f64 = (1..=n)
        .map(|i| {
            let i = i as f64;
            let (a, b) = (2.0 * i - 1.0, 2.0 * i);
            i.powi(4) * (phase / (a * b)).powi(2) / (a * b)
        })
        .product();
    2.0 * factor / (2 * n + 1) as f64
}

/// Distance of the pole, in half-diameters, beyond which n points have the relative error
/// `tolerance`.
#[must_use]
pub(crate) fn reach(n: usize, tolerance: f64) -> f64 {
    let ellipse = (KERNEL_GROWTH / tolerance).powf(0.5 / n as f64).max(1.0);
    0.5 * (ellipse + 1.0 / ellipse)
}

/// Fewest points a side, at most [`MOST_POINTS`], for the phase κh at this tolerance.
#[must_use]
pub(crate) fn points_for_phase(phase: f64, tolerance: f64) -> usize {
    (1..MOST_POINTS).find(|&n| phase_error(n, phase) <= tolerance).unwrap_or(MOST_POINTS)
}

/// Fewest points a side for a pole `distance` half-diameters away, where a rule of at most [`MOST_POINTS`]
/// reaches so close.
#[must_use]
pub(crate) fn points_for_distance(distance: f64, tolerance: f64) -> Option<usize> {
    (1..=MOST_POINTS).find(|&n| reach(n, tolerance) <= distance)
}

/// Points (m) and weights (m²) of n × n Gauss points, or of the triangle's rule of the same degree.
/// One point is the centroid.
#[must_use]
pub(crate) fn regular(facet: &Facet, n: usize) -> Vec<(Vec3, f64)> {
    if n <= 1 {
        return vec![(facet.centre, facet.area)];
    }
    let patch = &facet.patch;
    if patch.sides() == 4 {
        placed(facet, &tensor_quad(n), |u, v| quad_jacobian(patch, u, v))
    } else {
        // The degrees asked for, at most 2 · MOST_POINTS − 1, exist; the product rule is as good where one
        // should not.
        let rule =
            symmetric_triangle(2 * n - 1).unwrap_or_else(|_| fredholm_quadrature::collapsed_triangle(n));
        placed(facet, &rule, |_, _| 2.0 * patch.area())
    }
}

/// How many points [`regular`] has.
#[must_use]
pub(crate) fn points_of(facet: &Facet, n: usize) -> usize {
    match (n, facet.patch.sides()) {
        (..=1, _) => 1,
        (_, 4) => n * n,
        _ => symmetric_triangle(2 * n - 1).map_or(n * n, |rule| rule.len()),
    }
}

fn placed(facet: &Facet, rule: &[PlanePoint], jacobian: impl Fn(f64, f64) -> f64) -> Vec<(Vec3, f64)> {
    let scale = facet.area / facet.patch.area();
    let place = |p: &PlanePoint| (facet.patch.point(p.u, p.v), p.weight * jacobian(p.u, p.v) * scale);
    rule.iter().map(place).collect()
}

fn quad_jacobian(patch: &Patch, u: f64, v: f64) -> f64 {
    let [a, b, c, d] = [0, 1, 2, 3].map(|i| patch.corner(i));
    let along_u = (b - a) * (1.0 - v) + (c - d) * v;
    let along_v = (d - a) * (1.0 - u) + (c - b) * u;
    along_u.cross(along_v).length()
}

/// Points and weights for an integrand that peaks where the facet comes close to `x`.
#[must_use]
pub(crate) fn near(facet: &Facet, x: Vec3) -> Vec<(Vec3, f64)> {
    let patch = &facet.patch;
    let scale = facet.area / patch.area();
    let triangle = |i: usize| [patch.corner(0), patch.corner(i), patch.corner(i + 1)];
    let points = |corners: [Vec3; 3]| {
        let doubled = (corners[1] - corners[0]).cross(corners[2] - corners[0]).length();
        let rule = near_triangle(corners.map(Into::into), x.into(), NEARLY_SINGULAR_POINTS);
        let place = move |p: PlanePoint| {
            let point = corners[0] + (corners[1] - corners[0]) * p.u + (corners[2] - corners[0]) * p.v;
            (point, p.weight * doubled * scale)
        };
        rule.into_iter().map(place)
    };
    (1..patch.sides() - 1).flat_map(|i| points(triangle(i))).collect()
}

/// The rule for a kernel seen from `x`: Gauss where the error bound allows, else the nearly
/// singular rule.
#[must_use]
pub(crate) fn seen_from(facet: &Facet, x: Vec3, phase: f64, tolerance: f64) -> Vec<(Vec3, f64)> {
    let distance = x.distance(facet.centre) / (0.5 * facet.diameter);
    match points_for_distance(distance, tolerance) {
        Some(n) => regular(facet, n.max(points_for_phase(phase, tolerance))),
        None => near(facet, x),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::Kind;
    use num_complex::Complex64;

    fn facets() -> [Facet; 2] {
        let corners = [Vec3::ZERO, Vec3::X, Vec3::new(1.0, 1.0, 0.0), Vec3::Y];
        let quad = Patch::quad(corners).unwrap().unwrap();
        let triangle = Patch::triangle([Vec3::ZERO, Vec3::X, Vec3::Y]).unwrap();
        [quad, triangle].map(|patch| Facet::new(&patch, Kind::Sheet))
    }

    #[test]
    fn points_are_counted_before_they_are_made() {
        for facet in facets() {
            for n in 1..=MOST_POINTS {
                assert_eq!(points_of(&facet, n), regular(&facet, n).len(), "{n}");
            }
        }
    }

    #[test]
    fn the_phase_bound_holds_and_is_not_idle() {
        let [square, _] = facets();
        for kappa in [0.2, 1.0, 3.0, 6.0] {
            let half = 0.5 * kappa;
            let exact = Complex64::cis(half) * (half.sin() / half);
            for n in 1..=6 {
                let rule = regular(&square, n);
                let sum: Complex64 = rule.iter().map(|(p, w)| Complex64::cis(kappa * p.x) * w).sum();
                let (error, bound) = ((sum - exact).norm(), phase_error(n, kappa));
                assert!(error <= bound + 1e-15, "{kappa} {n}: {error:e} {bound:e}");
                assert!(
                    error >= 0.05 * bound || bound < 1e-13 || kappa > 2.0,
                    "{kappa} {n}: {error:e} {bound:e}"
                );
            }
        }
    }

    #[test]
    fn the_distance_bound_holds() {
        for facet in facets() {
            for tolerance in [1e-2, 1e-4] {
                for n in 1..=6 {
                    let distance = reach(n, tolerance) * 0.5 * facet.diameter;
                    for direction in [Vec3::X, Vec3::Z, Vec3::new(0.6, 0.64, 0.48)] {
                        let x = facet.centre + direction * distance;
                        let potential = |rule: Vec<(Vec3, f64)>| -> f64 {
                            rule.iter().map(|(p, w)| w * x.distance(*p).powi(-3)).sum()
                        };
                        let (sum, exact) = (potential(regular(&facet, n)), potential(near(&facet, x)));
                        assert!(
                            (sum / exact - 1.0).abs() < tolerance,
                            "{n} {tolerance}: {}",
                            sum / exact - 1.0
                        );
                    }
                }
            }
        }
    }

    #[test]
    fn every_rule_sums_to_the_area() {
        for facet in facets() {
            for rule in [regular(&facet, 1), regular(&facet, 4), near(&facet, Vec3::new(0.2, 0.3, 0.01))] {
                assert!((rule.iter().map(|(_, w)| w).sum::<f64>() - facet.area).abs() < 1e-9);
            }
        }
    }
}
