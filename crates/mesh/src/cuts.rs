//! A convex polygon cut along segments: the constrained Delaunay triangulation of its corners with
//! the segments as sides.
//!
//! L. P. Chew, Algorithmica 4 (1989) 97–108, doi:10.1007/BF01553881; the triangulation itself is
//! spade's. Segments that cross are cut where they do. Places that nearly coincide are made one and
//! crossings are computed before the triangulation sees them: it then only connects given points,
//! which its exact predicates always can, and invents none that rounding may put on the wrong side
//! of a constraint. Metres.

use spade::{ConstrainedDelaunayTriangulation, Point2, Triangulation};

use crate::Vec3;

/// Distance, over the size of the polygon, below which two places are one.
const SAME_PLACE_DISTANCE: f64 = 1e-7;
/// Area, over that of the polygon, below which a triangle is one of rounding.
const SLIVER_AREA: f64 = 1e-12;
/// Sine of the angle between segments below which they do not cross but lie beside or on each
/// other.
const PARALLEL_SINE: f64 = 1e-12;

/// Triangles, counter-clockwise about `normal`, that fill a convex polygon and have the parts of
/// segments in its plane that lie in it as sides. `corners` may have any number of corners on one
/// side.
///
/// A part of a segment that comes to cross another one when their ends are made one with what is
/// near is left out. A polygon that cannot be triangulated gives no triangle.
#[must_use]
pub fn cut_polygon(corners: &[Vec3], normal: Vec3, segments: &[[Vec3; 2]]) -> Vec<[Vec3; 3]> {
    let Some(plane) = Plane::new(corners, normal) else { return Vec::new() };
    let near = SAME_PLACE_DISTANCE * plane.size;
    let parts: Vec<[Vec3; 2]> =
        segments.iter().filter_map(|&segment| part_inside(corners, normal, segment)).collect();
    let places = places(corners, normal, &parts, near);
    let mut cdt = ConstrainedDelaunayTriangulation::<Point2<f64>>::new();
    let vertices: Vec<_> = places.iter().map(|&place| cdt.insert(plane.flat(place)).ok()).collect();
    for part in &parts {
        for step in along(part, &places, near).windows(2) {
            if let (Some(from), Some(to)) = (vertices[step[0]], vertices[step[1]])
                && from != to
            {
                cdt.try_add_constraint(from, to);
            }
        }
    }
    let triangle = |points: [Point2<f64>; 3]| points.map(|point| plane.place(point));
    let triangles = cdt.inner_faces().map(|face| triangle(face.positions()));
    let area = |[a, b, c]: &[Vec3; 3]| 0.5 * (*b - *a).cross(*c - *a).dot(normal);
    triangles.filter(|triangle| area(triangle) > SLIVER_AREA * plane.size * plane.size).collect()
}

/// The corners, the ends of segments and the places where those cross, none of them near another.
fn places(corners: &[Vec3], normal: Vec3, parts: &[[Vec3; 2]], near: f64) -> Vec<Vec3> {
    let crossings = (0..parts.len()).flat_map(|i| (0..i).map(move |j| (i, j)));
    let crossings = crossings.filter_map(|(i, j)| crossing(parts[i], parts[j], normal));
    let mut places = corners.to_vec();
    for place in parts.iter().flatten().copied().chain(crossings) {
        if places.iter().all(|other| other.distance(place) > near) {
            places.push(place);
        }
    }
    places
}

/// Where two segments of a plane cross.
fn crossing([a, b]: [Vec3; 2], [c, d]: [Vec3; 2], normal: Vec3) -> Option<Vec3> {
    let (first, second) = (b - a, d - c);
    let turn = first.cross(second).dot(normal);
    if turn.abs() <= PARALLEL_SINE * first.length() * second.length() {
        return None;
    }
    let t = (c - a).cross(second).dot(normal) / turn;
    let u = (c - a).cross(first).dot(normal) / turn;
    ((0.0..=1.0).contains(&t) && (0.0..=1.0).contains(&u)).then(|| a.lerp(b, t))
}

/// The places on a segment, in their order along it.
fn along(&[from, to]: &[Vec3; 2], places: &[Vec3], near: f64) -> Vec<usize> {
    let (way, length) = (to - from, from.distance(to));
    let at = |k: usize| (places[k] - from).dot(way) / length;
    let on = |&k: &usize| {
        let t = at(k);
        (-near..=length + near).contains(&t) && places[k].distance(from + way * (t / length)) <= near
    };
    let mut found: Vec<usize> = (0..places.len()).filter(on).collect();
    found.sort_by(|&a, &b| at(a).total_cmp(&at(b)));
    found
}

/// Coordinates in the plane of a polygon.
struct Plane {
    origin: Vec3,
    axes: [Vec3; 2],
    size: f64,
}

impl Plane {
    fn new(corners: &[Vec3], normal: Vec3) -> Option<Self> {
        let origin = *corners.first()?;
        let u = corners.iter().map(|&x| x - origin).find_map(Vec3::try_normalize)?;
        let size = corners.iter().map(|x| x.distance(origin)).fold(0.0, f64::max);
        Some(Self { origin, axes: [u, normal.cross(u)], size })
    }

    fn flat(&self, x: Vec3) -> Point2<f64> {
        // spade refuses numbers near underflow.
        let [x, y] = self.axes.map(|axis| (x - self.origin).dot(axis));
        let number = |x: f64| if x.abs() < 1e-12 * self.size { 0.0 } else { x };
        Point2::new(number(x), number(y))
    }

    fn place(&self, point: Point2<f64>) -> Vec3 {
        self.origin + self.axes[0] * point.x + self.axes[1] * point.y
    }
}

/// The part of a segment inside a convex polygon (M. Cyrus, J. Beck, Comput. Graph. 3 (1978) 23–28,
/// doi:10.1016/0097-8493(78)90021-3).
#[must_use]
pub fn part_inside(corners: &[Vec3], normal: Vec3, [from, to]: [Vec3; 2]) -> Option<[Vec3; 2]> {
    let (mut low, mut high) = (0.0, 1.0);
    for (k, &a) in corners.iter().enumerate() {
        let inward = normal.cross(corners[(k + 1) % corners.len()] - a);
        let (start, end) = (inward.dot(from - a), inward.dot(to - a));
        if start <= 0.0 && end <= 0.0 {
            return None;
        }
        let crossing = start / (start - end);
        if start < 0.0 {
            low = f64::max(low, crossing);
        } else if end < 0.0 {
            high = f64::min(high, crossing);
        }
    }
    (low < high).then(|| [low, high].map(|t| from.lerp(to, t)))
}

#[cfg(test)]
mod tests {
    use super::*;

    const UNIT_SQUARE: [Vec3; 5] = [
        Vec3::new(0.0, 0.0, 2.0),
        Vec3::new(0.5, 0.0, 2.0),
        Vec3::new(1.0, 0.0, 2.0),
        Vec3::new(1.0, 1.0, 2.0),
        Vec3::new(0.0, 1.0, 2.0),
    ];

    fn area([a, b, c]: &[Vec3; 3]) -> f64 {
        0.5 * (*b - *a).cross(*c - *a).z
    }

    fn at(x: f64, y: f64) -> Vec3 {
        Vec3::new(x, y, 2.0)
    }

    #[test]
    fn segments_become_sides_and_the_triangles_fill_the_polygon() {
        let segments = [
            [at(-1.0, 0.2), at(2.0, 0.7)],
            [at(0.3, -0.5), at(0.3, 0.8)],
            [at(0.0, 0.0), at(1.0, 1.0)],
            [at(2.0, 2.0), at(3.0, 0.0)],
        ];
        let triangles = cut_polygon(&UNIT_SQUARE, Vec3::Z, &segments);
        assert!((triangles.iter().map(area).sum::<f64>() - 1.0).abs() < 1e-12);
        assert!(triangles.iter().all(|triangle| area(triangle) > 0.0) && triangles.len() >= 10);
        for [from, to] in &segments[..3] {
            let side = |x: Vec3| (*to - *from).cross(x - *from).z;
            for triangle in &triangles {
                // Where a triangle has corners on both sides of the line, the segment does not
                // reach it.
                let heights = triangle.map(side);
                let both = heights.iter().any(|h| *h > 1e-9) && heights.iter().any(|h| *h < -1e-9);
                let middle = (triangle[0] + triangle[1] + triangle[2]) / 3.0;
                let along = (middle - *from).dot(*to - *from) / from.distance_squared(*to);
                assert!(!both || !(-0.2..1.0).contains(&along) || along > 0.95, "{triangle:?} {from} {to}");
            }
        }
    }

    /// Segments as the shadows of tilted bodies make them: many through one place, copies moved or
    /// turned by almost nothing, ends almost on others, on sides and in corners.
    fn tangled(seed: u64) -> Vec<[Vec3; 2]> {
        let mut state = seed;
        let mut unit = || {
            state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
            (state >> 11) as f64 / (1_u64 << 53) as f64
        };
        let mut segments: Vec<[Vec3; 2]> = vec![];
        while segments.len() < 24 {
            let any =
                [at(2.0 * unit() - 0.5, 2.0 * unit() - 0.5), at(2.0 * unit() - 0.5, 2.0 * unit() - 0.5)];
            let kind = (unit() * 6.0) as usize;
            let little = 10_f64.powf(-5.0 - 12.0 * unit());
            let moved = at(little * (unit() - 0.5), little * (unit() - 0.5)) - at(0.0, 0.0);
            let next = match segments.last() {
                Some(&[a, b]) if kind == 1 => [a + moved, b],
                Some(&[a, b]) if kind == 2 => [a + moved, b + moved],
                Some(&[a, b]) if kind == 3 => [a.lerp(b, unit()) + moved, any[1]],
                _ if kind == 4 => [UNIT_SQUARE[3] + moved, any[1]],
                _ if kind == 5 => [at(unit(), little), at(unit(), 0.0)],
                _ => any,
            };
            segments.push(next);
        }
        segments
    }

    #[test]
    fn segments_that_nearly_coincide_cut_the_polygon_all_the_same() {
        for seed in 0..2_000 {
            let segments = tangled(seed);
            let triangles = cut_polygon(&UNIT_SQUARE, Vec3::Z, &segments);
            let sum = triangles.iter().map(area).sum::<f64>();
            assert!((sum - 1.0).abs() < 1e-6, "{seed}: the triangles fill {sum}");
            let [a, b] = segments[0];
            let Some([a, b]) = part_inside(&UNIT_SQUARE, Vec3::Z, [a, b]) else { continue };
            let height = |x: Vec3| (b - a).cross(x - a).z / a.distance(b);
            let middle = |triangle: &[Vec3; 3]| (triangle[0] + triangle[1] + triangle[2]) / 3.0;
            let beside =
                |t: &&[Vec3; 3]| (0.0..1.0).contains(&((middle(t) - a).dot(b - a) / a.distance_squared(b)));
            let crossed = |t: &&[Vec3; 3]| {
                let heights = t.map(height);
                heights.iter().any(|h| *h > 1e-5) && heights.iter().any(|h| *h < -1e-5)
            };
            let pieces = |t: &[Vec3; 3]| {
                // The part of the segment within the triangle.
                part_inside(t, Vec3::Z, [a, b]).map_or(0.0, |[from, to]| from.distance(to))
            };
            let uncut: f64 = triangles.iter().filter(beside).filter(crossed).map(pieces).sum();
            assert!(uncut <= 0.02 * a.distance(b), "{seed}: {uncut} of {} do not cut", a.distance(b));
        }
    }

    #[test]
    fn what_touches_nothing_cuts_nothing() {
        let away = [[at(2.0, 0.0), at(2.0, 1.0)], [at(0.0, 0.0), at(1.0, 0.0)]];
        let plain = cut_polygon(&UNIT_SQUARE, Vec3::Z, &[]);
        assert_eq!(plain.len(), 3);
        assert_eq!(cut_polygon(&UNIT_SQUARE, Vec3::Z, &away), plain);
        assert!(cut_polygon(&[], Vec3::Z, &away).is_empty());
    }
}
