//! Neighbours in one plane become one convex polygon: fewer, larger blockers.

use fredholm_mesh::Vec3;

use super::weld::{Polygon, connected, undirected};

/// Part of its area, or of its perimeter, by which a hull may differ from the polygons that fill
/// it.
const AREA_TOLERANCE: f64 = 1e-9;

/// Tangent of the angle between the first side of a polygon and the direction along which corners
/// are sorted.
const ORDER_TANGENT: f64 = 0.573_1;

/// Merges polygons that share a side and lie in one plane up to `tolerance` (m). A group that is
/// not convex is halved until its parts are.
pub(super) fn merge(points: &[Vec3], polygons: &[Polygon], tolerance: f64) -> Vec<Polygon> {
    let flat = |a: &Polygon, b: &Polygon| {
        let origin = points[a.corners[0] as usize];
        b.corners.iter().all(|&k| (points[k as usize] - origin).dot(a.normal).abs() <= tolerance)
    };
    let coplanar = |a: usize, b: usize| flat(&polygons[a], &polygons[b]) && flat(&polygons[b], &polygons[a]);
    let mut merged = Vec::new();
    for list in connected(polygons, coplanar) {
        join(points, polygons, &list, &mut merged);
    }
    merged
}

/// Joins a list to one polygon, or else parts of it. A list can be parted as often as it is long,
/// too deep for a recursion.
fn join(points: &[Vec3], polygons: &[Polygon], list: &[usize], merged: &mut Vec<Polygon>) {
    let mut lists = vec![list.to_vec()];
    while let Some(list) = lists.pop() {
        if let [single] = *list {
            merged.push(polygons[single].clone());
            continue;
        }
        let plane = Plane::of(points, &polygons[list[0]]);
        if let Some(hull) = plane.filled_hull(polygons, &list) {
            merged.push(hull);
            continue;
        }
        let [low, high] = plane.halve(polygons, &list);
        if low.is_empty() || high.is_empty() {
            merged.extend(list.iter().map(|&k| polygons[k].clone()));
        } else {
            lists.extend([high, low]);
        }
    }
}

/// Coordinates in the plane of a polygon.
struct Plane<'a> {
    points: &'a [Vec3],
    normal: Vec3,
    axes: [Vec3; 2],
}

impl<'a> Plane<'a> {
    fn of(points: &'a [Vec3], polygon: &Polygon) -> Self {
        let [a, b] = [0, 1].map(|k| points[polygon.corners[k] as usize]);
        let u = (b - a).normalize_or_zero();
        Self { points, normal: polygon.normal, axes: [u, polygon.normal.cross(u)] }
    }

    /// Where a corner lies along a direction that no side is expected to be at right angles to:
    /// places of corners on such a side differ by rounding alone, and their order would be none.
    fn place(&self, k: u32) -> [f64; 2] {
        let [u, v] = self.axes;
        [u + v * ORDER_TANGENT, v - u * ORDER_TANGENT].map(|axis| axis.dot(self.points[k as usize]))
    }

    /// The convex hull of the listed polygons, if they fill it.
    fn filled_hull(&self, polygons: &[Polygon], list: &[usize]) -> Option<Polygon> {
        let mut corners: Vec<u32> = list.iter().flat_map(|&k| polygons[k].corners.iter().copied()).collect();
        corners.sort_unstable();
        corners.dedup();
        let hull = self.hull(corners);
        let ends = || hull.iter().zip(hull.iter().cycle().skip(1)).map(|(&a, &b)| [a, b]);
        let origin = self.points[*hull.first()? as usize];
        let at = |k: u32| self.points[k as usize] - origin;
        let area = 0.5 * ends().map(|[a, b]| at(a).cross(at(b)).dot(self.normal)).sum::<f64>();
        let perimeter: f64 = ends().map(|side| self.length(side)).sum();
        let filled: f64 = list.iter().map(|&k| polygons[k].area).sum();
        let border = self.border(polygons, list);
        let fits = (filled - area).abs() <= AREA_TOLERANCE * area
            && (border - perimeter).abs() <= AREA_TOLERANCE * perimeter;
        fits.then_some(Polygon { corners: hull, normal: self.normal, area })
    }

    fn length(&self, [a, b]: [u32; 2]) -> f64 {
        self.points[a as usize].distance(self.points[b as usize])
    }

    /// Length of the sides that belong to one polygon only.
    fn border(&self, polygons: &[Polygon], list: &[usize]) -> f64 {
        let mut sides: Vec<[u32; 2]> =
            list.iter().flat_map(|&k| polygons[k].sides().map(undirected)).collect();
        sides.sort_unstable();
        sides.chunk_by(|a, b| a == b).filter(|run| run.len() == 1).map(|run| self.length(run[0])).sum()
    }

    /// The corners of the convex hull, counter-clockwise about the normal, without those on its
    /// sides. A. M. Andrew, Inf. Process. Lett. 9 (1979) 216–219, doi:10.1016/0020-0190(79)90072-3.
    fn hull(&self, mut corners: Vec<u32>) -> Vec<u32> {
        let order = |a: &u32, b: &u32| {
            let (a, b) = (self.place(*a), self.place(*b));
            a[0].total_cmp(&b[0]).then(a[1].total_cmp(&b[1]))
        };
        corners.sort_by(order);
        let mut hull = self.chain(corners.iter().copied());
        hull.pop();
        let upper = self.chain(corners.iter().rev().copied());
        hull.extend(&upper[..upper.len().saturating_sub(1)]);
        hull
    }

    fn chain(&self, corners: impl Iterator<Item = u32>) -> Vec<u32> {
        let mut chain: Vec<u32> = Vec::new();
        for k in corners {
            while let [.., a, b] = chain[..]
                && !self.turns_left(a, b, k)
            {
                chain.pop();
            }
            chain.push(k);
        }
        chain
    }

    /// Whether the corner b is a real one, beyond rounding.
    fn turns_left(&self, a: u32, b: u32, c: u32) -> bool {
        let [a, b, c] = [a, b, c].map(|k| self.points[k as usize]);
        let (first, second) = (b - a, c - b);
        first.cross(second).dot(self.normal) > AREA_TOLERANCE * first.length() * second.length()
    }

    /// The list halved at the middle of its longer extent.
    fn halve(&self, polygons: &[Polygon], list: &[usize]) -> [Vec<usize>; 2] {
        let centre = |k: usize| {
            let corners = &polygons[k].corners;
            corners.iter().map(|&c| self.points[c as usize]).sum::<Vec3>() / corners.len() as f64
        };
        let range = |axis: Vec3| {
            let places = || list.iter().map(|&k| axis.dot(centre(k)));
            (places().fold(f64::INFINITY, f64::min), places().fold(f64::NEG_INFINITY, f64::max))
        };
        let ranges = self.axes.map(range);
        let longer = usize::from(ranges[1].1 - ranges[1].0 > ranges[0].1 - ranges[0].0);
        let middle = 0.5 * (ranges[longer].0 + ranges[longer].1);
        let (low, high) = list.iter().partition(|&&k| self.axes[longer].dot(centre(k)) < middle);
        [low, high]
    }
}
