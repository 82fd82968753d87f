//! What a point sees of a convex polygon behind convex occluders, exactly: the polygon minus the occluders' shadows.
//!
//! Seen from a point, a convex occluder with corners o_k is the cone {v : m_k·v ≥ 0}, m_k = ± o_k × o_{k+1}. Subtracting it cuts a convex piece
//! along the planes m_k·v = 0 into parts outside (kept, convex) and a rest inside all of them (hidden). The occluders must lie between
//! the point and the polygon. T. Nishita & E. Nakamae, SIGGRAPH 1985, doi:10.1145/325165.325169, treat the same geometry.

use crate::form_factor::point_to_polygon;
use crate::polygon::crossing;
use fredholm_mesh::Vec3;

/// Convex polygons stored one behind the other.
#[derive(Clone, Debug, Default)]
pub(crate) struct PolygonList {
    corners: Vec<Vec3>,
    ends: Vec<usize>,
}

impl PolygonList {
    pub(crate) fn clear(&mut self) {
        self.corners.clear();
        self.ends.clear();
    }

    pub(crate) fn len(&self) -> usize {
        self.ends.len()
    }

    pub(crate) fn iter(&self) -> impl Iterator<Item = &[Vec3]> {
        (0..self.len()).map(|i| self.get(i))
    }

    fn get(&self, i: usize) -> &[Vec3] {
        let start = if i == 0 { 0 } else { self.ends[i - 1] };
        &self.corners[start..self.ends[i]]
    }

    /// Appends what `write` puts on the stack of corners, unless that is no polygon.
    pub(crate) fn push_with(&mut self, write: impl FnOnce(&mut Vec<Vec3>)) {
        let start = self.corners.len();
        write(&mut self.corners);
        if self.corners.len() < start + 3 {
            self.corners.truncate(start);
        } else {
            self.ends.push(self.corners.len());
        }
    }
}

/// Corners that a quad has at most after two cuts, and room for two more.
const CORNERS: usize = 8;

/// Inward normals of the planes through a point and the edges of a convex polygon: the cone under which the point sees it.
#[derive(Clone, Copy, Debug)]
struct Cone {
    planes: [Vec3; CORNERS],
    count: usize,
}

/// Buffers of the subtraction, kept between points.
#[derive(Clone, Debug, Default)]
pub(crate) struct Shadow {
    visible: PolygonList,
    next: PolygonList,
    rest: Vec<Vec3>,
    inside: Vec<Vec3>,
    heights: Vec<f64>,
    whole: bool,
}

impl Shadow {
    /// Whether the last point saw the target uncut.
    pub(crate) fn is_whole(&self) -> bool {
        self.whole
    }

    /// What the last point saw of the target: convex polygons, relative to the point.
    pub(crate) fn parts(&self) -> &PolygonList {
        &self.visible
    }

    /// Form factor from the point `p` with normal `n` to what it sees of `target` behind `occluders`.
    pub(crate) fn visible_factor(
        &mut self,
        p: Vec3,
        n: Vec3,
        target: &[Vec3],
        occluders: &PolygonList,
    ) -> f64 {
        self.whole = true;
        self.visible.clear();
        self.visible.push_with(|corners| corners.extend(target.iter().map(|&x| x - p)));
        let view = self.visible.iter().next().and_then(Cone::of);
        for occluder in occluders.iter() {
            if self.visible.len() == 0 {
                return 0.0;
            }
            self.subtract(p, occluder, view.as_ref());
        }
        self.visible.iter().map(|piece| point_to_polygon(n, piece.iter().copied())).sum()
    }

    /// Replaces the visible pieces by their parts outside the cone of one occluder; `view` is the cone of the whole target.
    fn subtract(&mut self, p: Vec3, occluder: &[Vec3], view: Option<&Cone>) {
        let mut corners = [Vec3::ZERO; CORNERS];
        let corners = &mut corners[..occluder.len().min(CORNERS)];
        corners.iter_mut().zip(occluder).for_each(|(corner, &x)| *corner = x - p);
        if view.is_some_and(|view| view.misses(corners)) {
            return;
        }
        if let Some(cone) = Cone::of(corners) {
            self.cut_out(&cone);
        }
    }

    fn cut_out(&mut self, cone: &Cone) {
        self.next.clear();
        for i in 0..self.visible.len() {
            let piece = self.visible.get(i);
            if cone.misses(piece) {
                self.next.push_with(|corners| corners.extend_from_slice(piece));
                continue;
            }
            self.whole = false;
            self.rest.clear();
            self.rest.extend_from_slice(piece);
            for &plane in cone.planes() {
                let outside = |corners: &mut Vec<Vec3>| {
                    split(&self.rest, plane, &mut self.heights, &mut self.inside, corners);
                };
                self.next.push_with(outside);
                std::mem::swap(&mut self.rest, &mut self.inside);
            }
        }
        std::mem::swap(&mut self.visible, &mut self.next);
    }
}

impl Cone {
    /// The cone of a polygon seen from the origin; `None` where the origin lies in its plane, or it has too many corners.
    fn of(corners: &[Vec3]) -> Option<Self> {
        let towards = *corners.first()?;
        if corners.len() > CORNERS {
            return None;
        }
        let mut cone = Self { planes: [Vec3::ZERO; CORNERS], count: 0 };
        for k in 0..corners.len() {
            cone.push(corners[k].cross(corners[(k + 1) % corners.len()]));
        }
        let sum = cone.planes().iter().sum::<Vec3>();
        let size: f64 = cone.planes().iter().map(|m| m.length_squared()).sum();
        let turn = sum.dot(towards);
        if turn * turn <= 1e-24 * size * towards.length_squared() {
            return None;
        }
        Some(if turn < 0.0 { cone.turned() } else { cone })
    }

    /// Adds a plane; an edge of no length, or one that points at the origin, bounds nothing.
    fn push(&mut self, normal: Vec3) {
        if normal != Vec3::ZERO {
            self.planes[self.count] = normal;
            self.count += 1;
        }
    }

    fn turned(mut self) -> Self {
        self.planes.iter_mut().for_each(|m| *m = -*m);
        self
    }

    fn planes(&self) -> &[Vec3] {
        &self.planes[..self.count]
    }

    /// Whether one of the planes has all of a polygon outside.
    fn misses(&self, polygon: &[Vec3]) -> bool {
        self.planes().iter().any(|m| polygon.iter().all(|v| m.dot(*v) <= 0.0))
    }
}

/// Splits a convex polygon by a plane through the origin into the parts with m·v ≤ 0 (appended to `outside`) and ≥ 0 (replacing `inside`).
fn split(polygon: &[Vec3], m: Vec3, heights: &mut Vec<f64>, inside: &mut Vec<Vec3>, outside: &mut Vec<Vec3>) {
    heights.clear();
    heights.extend(polygon.iter().map(|v| m.dot(*v)));
    inside.clear();
    let start = outside.len();
    for i in 0..polygon.len() {
        let j = (i + 1) % polygon.len();
        let (from, to) = ((polygon[i], heights[i]), (polygon[j], heights[j]));
        if from.1 >= 0.0 {
            inside.push(from.0);
        }
        if from.1 <= 0.0 {
            outside.push(from.0);
        }
        if from.1 * to.1 < 0.0 {
            let cut = crossing(from, to);
            inside.push(cut);
            outside.push(cut);
        }
    }
    if heights.iter().all(|&h| h >= 0.0) {
        outside.truncate(start);
    }
    if heights.iter().all(|&h| h <= 0.0) {
        inside.clear();
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn square(centre: Vec3, half: f64) -> Vec<Vec3> {
        // Counter-clockwise seen from below.
        [(-1., -1.), (-1., 1.), (1., 1.), (1., -1.)]
            .map(|(x, y)| centre + Vec3::new(x, y, 0.0) * half)
            .to_vec()
    }

    fn list(polygons: &[Vec<Vec3>]) -> PolygonList {
        let mut list = PolygonList::default();
        for polygon in polygons {
            list.push_with(|corners| corners.extend_from_slice(polygon));
        }
        list
    }

    fn seen(target: &[Vec3], occluders: &[Vec<Vec3>]) -> f64 {
        Shadow::default().visible_factor(Vec3::ZERO, Vec3::Z, target, &list(occluders))
    }

    fn whole(target: &[Vec3]) -> f64 {
        point_to_polygon(Vec3::Z, target.iter().copied())
    }

    #[test]
    fn the_shadow_of_a_square_is_the_larger_square_it_hides() {
        let target = square(Vec3::Z, 1.0);
        let hidden = square(Vec3::Z, 0.5);
        let exact = whole(&target) - whole(&hidden);
        assert!((seen(&target, &[square(Vec3::Z * 0.5, 0.25)]) - exact).abs() < 1e-15);
    }

    #[test]
    fn overlapping_occluders_are_not_counted_twice() {
        let target = square(Vec3::Z, 1.0);
        let occluder = square(Vec3::Z * 0.5, 0.25);
        let once = seen(&target, std::slice::from_ref(&occluder));
        let behind = square(Vec3::Z * 0.7, 0.3);
        assert!((seen(&target, &[occluder.clone(), occluder.clone(), behind]) - once).abs() < 1e-15);
    }

    #[test]
    fn a_cover_hides_everything_and_a_neighbour_nothing() {
        let target = square(Vec3::Z, 1.0);
        assert!(seen(&target, &[square(Vec3::Z * 0.5, 0.6)]) == 0.0);
        let beside = square(Vec3::new(5.0, 0.0, 0.5), 0.5);
        assert!((seen(&target, &[beside]) - whole(&target)).abs() < 1e-16);
    }

    #[test]
    fn the_orientation_of_an_occluder_does_not_matter() {
        let target = square(Vec3::Z, 1.0);
        let mut occluder = square(Vec3::new(0.2, 0.1, 0.4), 0.2);
        let one = seen(&target, &[occluder.clone()]);
        occluder.reverse();
        assert!((seen(&target, &[occluder]) - one).abs() < 1e-16);
    }

    #[test]
    fn a_repeated_corner_changes_nothing() {
        let target = square(Vec3::Z, 1.0);
        let mut occluder = square(Vec3::new(0.2, 0.1, 0.4), 0.2);
        let plain = seen(&target, &[occluder.clone()]);
        occluder.insert(1, occluder[0]);
        assert!(plain < whole(&target) && (seen(&target, &[occluder]) - plain).abs() < 1e-16);
    }

    #[test]
    fn an_occluder_seen_edge_on_hides_nothing() {
        let target = square(Vec3::Z, 1.0);
        let edge_on = vec![Vec3::new(0.0, -0.1, 0.2), Vec3::new(0.0, 0.1, 0.2), Vec3::new(0.0, 0.0, 0.5)];
        assert!((seen(&target, &[edge_on]) - whole(&target)).abs() < 1e-16);
    }
}
