//! Two flat convex polygons: do they lie on each other, do they cross, and what of one is not
//! covered by others?
//!
//! Polygons are clipped at the sides of others: I. E. Sutherland and G. W. Hodgman, Comm. ACM 17
//! (1974) 32–42, doi:10.1145/360767.360802. Metres.

use crate::{Patch, Vec3};

/// Cosine, less than 1 by this, above which planes are compared point by point.
const PARALLEL_COSINE_DEFECT: f64 = 1e-6;
/// Widths, over the tolerance, below which an overlap is one of rounding.
const LEAST_WIDTH: f64 = 8.0;

/// A line in a plane: the half-plane to its left, seen from the tip of the plane's normal.
struct HalfPlane {
    point: Vec3,
    /// Unit vector to the inside.
    inward: Vec3,
}

impl HalfPlane {
    fn height(&self, x: Vec3) -> f64 {
        self.inward.dot(x - self.point)
    }
}

/// The half-planes whose intersection is a patch, in the plane with this normal.
fn sides(patch: &Patch, normal: Vec3) -> impl Iterator<Item = HalfPlane> + '_ {
    let turned = patch.normal().dot(normal) < 0.0;
    (0..patch.sides()).map(move |k| {
        let (a, b) = (patch.corner(k), patch.corner(k + 1));
        let along = if turned { a - b } else { b - a };
        HalfPlane { point: a, inward: normal.cross(along).normalize_or_zero() }
    })
}

/// The parts of a convex polygon to the left and to the right of a line; what is within `tolerance`
/// of the line is on it.
fn cut(polygon: &[Vec3], line: &HalfPlane, tolerance: f64) -> [Vec<Vec3>; 2] {
    let heights: Vec<f64> = polygon.iter().map(|&p| line.height(p)).collect();
    let (mut left, mut right) = (Vec::new(), Vec::new());
    for (k, &p) in polygon.iter().enumerate() {
        let next = (k + 1) % polygon.len();
        let (h, g) = (heights[k], heights[next]);
        if h >= -tolerance {
            left.push(p);
        }
        if h <= tolerance {
            right.push(p);
        }
        if (h > tolerance && g < -tolerance) || (h < -tolerance && g > tolerance) {
            let at = p + (polygon[next] - p) * (h / (h - g));
            left.push(at);
            right.push(at);
        }
    }
    let most = heights.iter().copied().fold(f64::NEG_INFINITY, f64::max);
    let least = heights.iter().copied().fold(f64::INFINITY, f64::min);
    if most <= tolerance {
        left.clear();
    }
    if least >= -tolerance {
        right.clear();
    }
    [left, right]
}

/// The part of `a` that lies on `b`, where both are in one plane there up to `tolerance`.
pub(super) fn common(a: &Patch, b: &Patch, tolerance: f64) -> Option<Vec<Vec3>> {
    if a.normal().dot(b.normal()).abs() < 1.0 - PARALLEL_COSINE_DEFECT {
        return None;
    }
    let mut polygon = a.corners().to_vec();
    for line in sides(b, a.normal()) {
        let [left, _] = cut(&polygon, &line, tolerance);
        polygon = left;
        if polygon.len() < 3 {
            return None;
        }
    }
    let off = |p: &Vec3| (*p - b.corner(0)).dot(b.normal()).abs();
    let width = 2.0 * area(&polygon, a.normal()) / extent(&polygon);
    (width > LEAST_WIDTH * tolerance && polygon.iter().all(|p| off(p) <= tolerance)).then_some(polygon)
}

/// The parts of `a`, as convex polygons, that none of the others covers. They must lie in its
/// plane.
pub(super) fn uncovered(a: &Patch, others: &[&Patch], tolerance: f64) -> Vec<Vec<Vec3>> {
    let mut parts = vec![a.corners().to_vec()];
    for other in others {
        let mut left_over = Vec::new();
        for part in parts {
            without(part, other, a.normal(), tolerance, &mut left_over);
        }
        parts = left_over;
    }
    parts
}

/// Appends the parts of a polygon outside another one.
fn without(polygon: Vec<Vec3>, other: &Patch, normal: Vec3, tolerance: f64, found: &mut Vec<Vec<Vec3>>) {
    let (mut rest, mut outside) = (polygon.clone(), Vec::new());
    for line in sides(other, normal) {
        let [left, right] = cut(&rest, &line, tolerance);
        if right.len() > 2 {
            outside.push(right);
        }
        rest = left;
        if rest.len() < 3 {
            // Nothing of it is covered: it need not be cut.
            found.push(polygon);
            return;
        }
    }
    found.extend(outside);
}

/// Area of a convex polygon about a normal, m².
pub(super) fn area(polygon: &[Vec3], normal: Vec3) -> f64 {
    let fan = polygon.windows(2).map(|side| (side[0] - polygon[0]).cross(side[1] - polygon[0]));
    0.5 * fan.sum::<Vec3>().dot(normal)
}

/// Largest distance from the first corner, m.
fn extent(polygon: &[Vec3]) -> f64 {
    polygon.iter().map(|p| p.distance(polygon[0])).fold(f64::MIN_POSITIVE, f64::max)
}

/// Whether two polygons cross: points of each lie on both sides of the other, farther than
/// `tolerance`, and the lines along which they meet the planes have a piece in common.
pub(super) fn cross(a: &Patch, b: &Patch, tolerance: f64) -> bool {
    let (Some(p), Some(q)) = (line_in(a, b, tolerance), line_in(b, a, tolerance)) else { return false };
    let along = (p[1] - p[0]).try_normalize().or_else(|| (q[1] - q[0]).try_normalize());
    let Some(along) = along else { return false };
    let interval = |ends: [Vec3; 2]| {
        let [x, y] = ends.map(|end| along.dot(end - p[0]));
        [x.min(y), x.max(y)]
    };
    let ([a0, a1], [b0, b1]) = (interval(p), interval(q));
    a1.min(b1) - a0.max(b0) > LEAST_WIDTH * tolerance
}

/// The segment in which a polygon meets the plane of another, where corners lie on both sides of
/// it.
fn line_in(a: &Patch, b: &Patch, tolerance: f64) -> Option<[Vec3; 2]> {
    let height = |p: Vec3| (p - b.corner(0)).dot(b.normal());
    let heights: Vec<f64> = a.corners().iter().map(|&p| height(p)).collect();
    let (below, above) = (heights.iter().any(|h| *h < -tolerance), heights.iter().any(|h| *h > tolerance));
    if !(below && above) {
        return None;
    }
    let mut ends = Vec::new();
    for k in 0..a.sides() {
        let (h, g) = (heights[k], heights[(k + 1) % a.sides()]);
        if (h > 0.0) != (g > 0.0) {
            ends.push(a.corner(k) + (a.corner(k + 1) - a.corner(k)) * (h / (h - g)));
        }
    }
    match ends[..] {
        [p, q] => Some([p, q]),
        _ => None,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const T: f64 = 1e-9;

    fn rectangle(x: [f64; 2], y: [f64; 2], z: f64) -> Patch {
        let v = |x, y| Vec3::new(x, y, z);
        Patch::quad([v(x[0], y[0]), v(x[1], y[0]), v(x[1], y[1]), v(x[0], y[1])]).unwrap().unwrap()
    }

    #[test]
    fn what_two_rectangles_have_in_common_is_a_rectangle() {
        let (a, b) = (rectangle([0.0, 2.0], [0.0, 1.0], 0.0), rectangle([1.5, 3.0], [-1.0, 0.5], 0.0));
        for other in [b, b.flipped()] {
            let both = common(&a, &other, T).unwrap();
            assert!((area(&both, Vec3::Z) - 0.25).abs() < 1e-15);
            let rest: f64 = uncovered(&a, &[&other], T).iter().map(|p| area(p, Vec3::Z)).sum();
            assert!((rest - 1.75).abs() < 1e-15, "{rest}");
        }
        assert!(uncovered(&a, &[&a], T).is_empty());
        let apart = [rectangle([2.0, 3.0], [0.0, 1.0], 0.0), rectangle([0.0, 2.0], [0.0, 1.0], 1e-8)];
        assert!(apart.iter().all(|other| common(&a, other, T).is_none()));
        assert_eq!(uncovered(&a, &[&apart[0]], T).len(), 1, "a neighbour cuts nothing");
    }

    #[test]
    fn several_covers_leave_what_none_of_them_covers() {
        let a = rectangle([0.0, 1.0], [0.0, 1.0], 0.0);
        let covers = [
            rectangle([0.2, 0.6], [0.2, 0.6], 0.0),
            rectangle([0.4, 0.8], [0.4, 0.8], 0.0),
            rectangle([0.9, 2.0], [-1.0, 2.0], 0.0),
        ];
        let rest = uncovered(&a, &covers.iter().collect::<Vec<_>>(), T);
        let total: f64 = rest.iter().map(|p| area(p, Vec3::Z)).sum();
        assert!((total - (1.0 - 0.28 - 0.1)).abs() < 1e-14, "{total}");
        assert!(rest.iter().all(|p| area(p, Vec3::Z) > 0.0));
    }

    #[test]
    fn polygons_cross_where_both_have_points_on_both_sides() {
        let floor = rectangle([0.0, 1.0], [0.0, 1.0], 0.0);
        let wall = |x: f64, low: f64| {
            let v = |y, z| Vec3::new(x, y, z);
            Patch::quad([v(0.2, low), v(0.8, low), v(0.8, 1.0), v(0.2, 1.0)]).unwrap().unwrap()
        };
        assert!(cross(&floor, &wall(0.5, -0.5), T) && cross(&wall(0.5, -0.5), &floor, T));
        assert!(!cross(&floor, &wall(0.5, 0.0), T), "it stands on it");
        assert!(!cross(&floor, &wall(1.5, -0.5), T), "it is beside it");
        assert!(!cross(&floor, &wall(1.0, -0.5), T), "it touches its border");
    }
}
