//! The exchange of a large polygon with a small patch before it: A F = ∫ F(x → polygon) dA by the rule of degree 2 or 3 over the small patch.
//!
//! F from a point in closed form is smooth over a patch that is far from the edges of the polygon, measured in its radius. The error is that of the midpoint rule times the ratio of both:
//! the next terms of the expansion are smaller by its square. In m².

use super::{flat, front_of, jacobian, point_to_polygon, to_segments};
use crate::polygon::HalfSpace;
use fredholm_mesh::{Patch, Vec3};
use fredholm_quadrature::{Estimate, PlanePoint, symmetric_triangle, tensor_quad};
use std::sync::LazyLock;

/// Radius of the patch over its distance from the edges of the polygon, at most.
const REACH: f64 = 0.5;

static TRIANGLE: LazyLock<Vec<PlanePoint>> = LazyLock::new(|| symmetric_triangle(2).unwrap_or_default());
static QUAD: LazyLock<Vec<PlanePoint>> = LazyLock::new(|| tensor_quad(2));

/// The exchange to an absolute `goal` (m²), or `None` where the patches do not face each other wholly or the rule does not suffice.
pub(crate) fn small_receiver(large: &Patch, small: &Patch, goal: f64) -> Option<Estimate> {
    let (before_large, before_small) = (front_of(large), front_of(small));
    let faces = in_front(small, before_large, flat(large, small))
        && in_front(large, before_small, flat(large, small));
    let centre = small.centroid();
    let corners = large.corners();
    let sides = corners.iter().zip(corners.iter().cycle().skip(1)).map(|(&a, &b)| [a, b]);
    let reach = 0.5 * small.diameter() / to_segments(centre, sides);
    if !faces || reach > REACH {
        return None;
    }
    let seen = |x: Vec3| point_to_polygon(small.normal(), large.corners().iter().map(|&y| y - x));
    let rule = if small.sides() == 3 { &*TRIANGLE } else { &*QUAD };
    let term = |p: &PlanePoint| p.weight * jacobian(small, p.u, p.v) * seen(small.point(p.u, p.v));
    let value: f64 = rule.iter().map(term).sum();
    let error = reach * (value - small.area() * seen(centre)).abs();
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
    fn a_patch_that_looks_away_or_crosses_the_plane_or_lies_in_it_is_left_to_others() {
        let wall = rectangle(Vec3::ZERO, Vec3::Y * 3.0, Vec3::Z * 2.0);
        let away = rectangle(Vec3::new(2.0, 1.0, 0.0), Vec3::Y * 0.1, Vec3::X * 0.1);
        let across = rectangle(Vec3::new(-0.05, -2.0, 0.5), Vec3::X * 0.1, Vec3::Z * 0.1);
        let within = rectangle(Vec3::new(0.0, 1.0, 1.0), Vec3::Y * 0.1, Vec3::Z * 0.1);
        assert!([away, across, within].iter().all(|patch| small_receiver(&wall, patch, 1.0).is_none()));
    }
}
