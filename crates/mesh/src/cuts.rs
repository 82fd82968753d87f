//! A convex polygon cut along segments: the constrained Delaunay triangulation of its corners with the segments as sides.
//!
//! L. P. Chew, Algorithmica 4 (1989) 97–108, doi:10.1007/BF01553881; the triangulation itself is spade's. Segments that cross are cut where they do. Metres.

use spade::{ConstrainedDelaunayTriangulation, Point2, Triangulation};

use crate::Vec3;

/// Distance, over the size of the polygon, below which two places are one.
const NEAR: f64 = 1e-7;
/// Area, over that of the polygon, below which a triangle is one of rounding.
const SLIVER: f64 = 1e-12;

/// Triangles, counter-clockwise about `normal`, that fill a convex polygon and have the parts of segments in its plane that lie in it as sides. `corners` may have any number of corners on one side.
///
/// A polygon that cannot be triangulated gives no triangle.
#[must_use]
pub fn cut_polygon(corners: &[Vec3], normal: Vec3, segments: &[[Vec3; 2]]) -> Vec<[Vec3; 3]> {
    let Some(plane) = Plane::new(corners, normal) else { return Vec::new() };
    let mut cdt = ConstrainedDelaunayTriangulation::<Point2<f64>>::new();
    for &corner in corners {
        let _ = cdt.insert(plane.flat(corner));
    }
    for segment in segments {
        let Some(ends) = part_inside(corners, normal, *segment) else { continue };
        let ends = ends.map(|end| plane.flat(snapped(corners, end, NEAR * plane.size)));
        if let (Ok(from), Ok(to)) = (cdt.insert(ends[0]), cdt.insert(ends[1]))
            && from != to
        {
            cdt.add_constraint_and_split(from, to, |point| point);
        }
    }
    let triangle = |points: [Point2<f64>; 3]| points.map(|point| plane.place(point));
    let triangles = cdt.inner_faces().map(|face| triangle(face.positions()));
    let area = |[a, b, c]: &[Vec3; 3]| 0.5 * (*b - *a).cross(*c - *a).dot(normal);
    triangles.filter(|triangle| area(triangle) > SLIVER * plane.size * plane.size).collect()
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

/// The corner that a place is next to, or the place.
fn snapped(corners: &[Vec3], x: Vec3, near: f64) -> Vec3 {
    corners.iter().copied().find(|corner| corner.distance(x) <= near).unwrap_or(x)
}

/// The part of a segment inside a convex polygon (M. Cyrus, J. Beck, Comput. Graph. 3 (1978) 23–28, doi:10.1016/0097-8493(78)90021-3).
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

    const SQUARE: [Vec3; 5] = [
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
        let triangles = cut_polygon(&SQUARE, Vec3::Z, &segments);
        assert!((triangles.iter().map(area).sum::<f64>() - 1.0).abs() < 1e-12);
        assert!(triangles.iter().all(|triangle| area(triangle) > 0.0) && triangles.len() >= 10);
        for [from, to] in &segments[..3] {
            let side = |x: Vec3| (*to - *from).cross(x - *from).z;
            for triangle in &triangles {
                // Where a triangle has corners on both sides of the line, the segment does not reach it.
                let heights = triangle.map(side);
                let both = heights.iter().any(|h| *h > 1e-9) && heights.iter().any(|h| *h < -1e-9);
                let middle = (triangle[0] + triangle[1] + triangle[2]) / 3.0;
                let along = (middle - *from).dot(*to - *from) / from.distance_squared(*to);
                assert!(!both || !(-0.2..1.0).contains(&along) || along > 0.95, "{triangle:?} {from} {to}");
            }
        }
    }

    #[test]
    fn what_touches_nothing_cuts_nothing() {
        let away = [[at(2.0, 0.0), at(2.0, 1.0)], [at(0.0, 0.0), at(1.0, 0.0)]];
        let plain = cut_polygon(&SQUARE, Vec3::Z, &[]);
        assert_eq!(plain.len(), 3);
        assert_eq!(cut_polygon(&SQUARE, Vec3::Z, &away), plain);
        assert!(cut_polygon(&[], Vec3::Z, &away).is_empty());
    }
}
