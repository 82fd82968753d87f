//! The exchange of a large polygon with a small patch before it: A F = ∫ F(x → polygon) dA by the
//! rule of degree 2 or 3 over the small patch.
//!
//! F from a point in closed form is smooth over a patch that is far from the edges of the polygon,
//! measured in its radius. The error is that of the midpoint rule times the ratio of both: the next
//! terms of the expansion are smaller by its square. The second derivative of F across an edge at a
//! distance d is at most 0.43/d², that of ½(1 + x/√(x² + d²)), which bounds the error of the
//! midpoint rule where that suffices. In m².

use super::{Segment, flat, front_of, jacobian, point_to_polygon, to_segments};
use crate::polygon::HalfSpace;
use fredholm_mesh::{Patch, Vec3};
use fredholm_quadrature::{Estimate, PlanePoint, symmetric_triangle, tensor_quad};
use std::sync::LazyLock;

/// Radius of the patch over its distance from the edges of the polygon, at most.
const MOST_RADIUS_OVER_DISTANCE: f64 = 0.5;
/// Error of the midpoint rule over the square of that ratio, at most. One straight edge gives
/// 0.43/12; several may add up, and be nearer to the other points.
const MIDPOINT_ERROR: f64 = 0.125;

static TRIANGLE: LazyLock<Vec<PlanePoint>> = LazyLock::new(|| symmetric_triangle(2).unwrap_or_default());
static QUAD: LazyLock<Vec<PlanePoint>> = LazyLock::new(|| tensor_quad(2));

/// The exchange to an absolute `goal` (m²), or `None` where the patches do not face each other
/// wholly or the rule does not suffice.
pub(crate) fn small_receiver(large: &Patch, small: &Patch, goal: f64) -> Option<Estimate> {
    let (before_large, before_small) = (front_of(large), front_of(small));
    let faces = in_front(small, before_large, flat(large, small))
        && in_front(large, before_small, flat(large, small));
    let centre = small.centroid();
    let corners = large.corners();
    let sides = corners.iter().zip(corners.iter().cycle().skip(1)).map(|(&a, &b)| [a, b]);
    let reach = 0.5 * small.diameter() / to_segments(centre, sides.map(Segment::new));
    if !faces || reach > MOST_RADIUS_OVER_DISTANCE {
        return None;
    }
    let seen = |x: Vec3| point_to_polygon(small.normal(), large.corners().iter().map(|&y| y - x));
    let rule = if small.sides() == 3 { &*TRIANGLE } else { &*QUAD };
    let term = |p: &PlanePoint| p.weight * jacobian(small, p.u, p.v) * seen(small.point(p.u, p.v));
    let value: f64 = rule.iter().map(term).sum();
    let bound = MIDPOINT_ERROR * reach.powi(3) * small.area();
    let error = if bound <= goal { bound } else { reach * (value - small.area() * seen(centre)).abs() };
    (error <= goal).then_some(Estimate { value, error })
}

/// Whether no corner is behind a plane, and one before it.
fn in_front(patch: &Patch, plane: HalfSpace, flat: f64) -> bool {
    let heights = || patch.corners().iter().map(|&x| plane.height(x));
    heights().all(|height| height >= -flat) && heights().any(|height| height > flat)
}

#[cfg(test)]
#[allow(clippy::unwrap_used, reason = "a test ends where something is missing")]
mod tests {
    use super::*;
    use crate::form_factor::contour_integral;

    fn rectangle(corner: Vec3, u: Vec3, v: Vec3) -> Patch {
        Patch::quad([corner, corner + u, corner + u + v, corner + v]).unwrap().unwrap()
    }

    #[test]
    fn it_is_the_contour_integral_within_its_error_or_nothing() {
        let wall = rectangle(Vec3::ZERO, Vec3::Y * 3.0, Vec3::Z * 2.0);
        let (mut found, mut left) = (0, 0);
        for (i, j) in (0..20).flat_map(|i| (0..20).map(move |j| (i, j))) {
            let corner = Vec3::new(0.2 * f64::from(i), 0.15 * f64::from(j), 0.0);
            let tile = rectangle(corner, Vec3::X * 0.2, Vec3::Y * 0.15);
            let Some(estimate) = small_receiver(&wall, &tile, 1e-3 * tile.area()) else {
                left += 1;
                continue;
            };
            let exact = contour_integral(wall.corners(), tile.corners(), 1e-10 * tile.area());
            assert!(
                (estimate.value - exact.value).abs() <= estimate.error + 1e-9 * tile.area(),
                "{i} {j} {estimate:?} {exact:?}"
            );
            found += 1;
        }
        assert!(found > 300 && left > 10, "{found} {left}");
    }

    #[test]
    fn the_bound_of_the_midpoint_rule_holds_wherever_a_patch_lies() {
        let lot = |k: u64| (k as f64 * 0.754_877_666_246_693).fract();
        let (mut worst, mut rule) = (0.0f64, 0.0f64);
        for k in 0..4000 {
            let [a, b, c, d, e, f] = [1, 2, 3, 5, 7, 11].map(|step| lot(k * step + step));
            let wall = rectangle(Vec3::new(0.0, -a, -b), Vec3::Y * (a + 0.02), Vec3::Z * (b + 0.5 * c));
            let (side, turn) = (0.01 + 0.1 * d, std::f64::consts::TAU * e);
            let u = Vec3::new(turn.cos(), turn.sin(), 0.0) * side;
            let v = u.cross(Vec3::new(turn.sin() * f, -turn.cos() * f, 1.0 - f).normalize());
            let corner = Vec3::new(0.1 + 1.5 * f, 2.0 * lot(k * 13) - 1.0, 2.0 * lot(k * 17) - 1.0);
            let tile = rectangle(corner, u, v);
            let Some(estimate) = small_receiver(&wall, &tile, 1.0) else { continue };
            let exact = contour_integral(wall.corners(), tile.corners(), 1e-12 * tile.area()).value;
            let sides = (0..4).map(|k| [wall.corners()[k], wall.corners()[(k + 1) % 4]]);
            let reach = 0.5 * tile.diameter() / to_segments(tile.centroid(), sides.map(Segment::new));
            let middle = point_to_polygon(tile.normal(), wall.corners().iter().map(|&y| y - tile.centroid()));
            worst = worst
                .max((tile.area() * middle - exact).abs() / (MIDPOINT_ERROR * reach.powi(2) * tile.area()));
            rule = rule.max((estimate.value - exact).abs() / estimate.error);
        }
        assert!(worst < 1.0 && worst > 0.1, "{worst}");
        assert!(rule < 1.0 && rule > 1e-3, "{rule}");
    }

    #[test]
    fn a_patch_that_looks_away_or_crosses_the_plane_or_lies_in_it_is_left_to_others() {
        let wall = rectangle(Vec3::ZERO, Vec3::Y * 3.0, Vec3::Z * 2.0);
        let away = rectangle(Vec3::new(2.0, 1.0, 0.0), Vec3::Y * 0.1, Vec3::X * 0.1);
        let across = rectangle(Vec3::new(-0.05, -2.0, 0.5), Vec3::X * 0.1, Vec3::Z * 0.1);
        let within = rectangle(Vec3::new(0.0, 1.0, 1.0), Vec3::Y * 0.1, Vec3::Z * 0.1);
        assert!([away, across, within].iter().all(|patch| small_receiver(&wall, patch, 1.0).is_none()));
    }
}
