//! What convex bodies hide of a convex polygon from a point, exactly: F = Σ over the pieces of the polygon that lie in the shadows.
//!
//! The shadow of a body is an intersection of half-spaces. Clipping a convex polygon by them leaves the hidden piece, convex again; what is cut off on the
//! way stays visible and is asked about the next body. T. Nishita & E. Nakamae, SIGGRAPH 1985, doi:10.1145/325165.325169, treat the same geometry.

use crate::form_factor::point_to_polygon;
use crate::polygon::crossing;
use fredholm_mesh::Vec3;
use fredholm_visibility::body::{Body, Room, Shadow};

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

    /// Cuts every polygon by the plane n·x = c into its parts on both sides. Heights of at most `tolerance` count as 0.
    pub(crate) fn cut(&mut self, n: Vec3, c: f64, tolerance: f64, work: &mut Cutter, spare: &mut Self) {
        spare.clear();
        for i in 0..self.len() {
            work.split(self.get(i), n, c, tolerance);
            spare.push_with(|corners| corners.extend_from_slice(&work.inside));
            spare.push_with(|corners| corners.extend_from_slice(&work.outside));
        }
        std::mem::swap(self, spare);
    }
}

/// Buffers of a cut.
#[derive(Clone, Debug, Default)]
pub(crate) struct Cutter {
    heights: Vec<f64>,
    inside: Vec<Vec3>,
    outside: Vec<Vec3>,
}

impl Cutter {
    /// Splits a convex polygon into its parts with n·x ≥ c and ≤ c; a part without area is empty.
    fn split(&mut self, polygon: &[Vec3], n: Vec3, c: f64, tolerance: f64) {
        self.inside.clear();
        self.outside.clear();
        self.heights.clear();
        let height = |v: &Vec3| n.dot(*v) - c;
        self.heights.extend(polygon.iter().map(height).map(|h| if h.abs() <= tolerance { 0.0 } else { h }));
        let (above, below) = (self.heights.iter().any(|&h| h > 0.0), self.heights.iter().any(|&h| h < 0.0));
        if !above || !below {
            let whole = if above { &mut self.inside } else { &mut self.outside };
            whole.extend_from_slice(polygon);
            return;
        }
        for i in 0..polygon.len() {
            let j = if i + 1 == polygon.len() { 0 } else { i + 1 };
            self.side((polygon[i], self.heights[i]), (polygon[j], self.heights[j]));
        }
    }

    fn side(&mut self, from: (Vec3, f64), to: (Vec3, f64)) {
        if from.1 >= 0.0 {
            self.inside.push(from.0);
        }
        if from.1 <= 0.0 {
            self.outside.push(from.0);
        }
        if from.1 * to.1 < 0.0 {
            let cut = crossing(from, to);
            self.inside.push(cut);
            self.outside.push(cut);
        }
    }
}

/// Buffers of the subtraction, kept between points.
#[derive(Clone, Debug, Default)]
pub(crate) struct Hiding {
    visible: PolygonList,
    next: PolygonList,
    rest: Vec<Vec3>,
    cutter: Cutter,
    room: Room,
}

impl Hiding {
    /// Form factor from the point `x` with normal `n` to what `bodies` hide of `target`, which lies in front of the point.
    pub(crate) fn hidden_factor(&mut self, x: Vec3, n: Vec3, target: &[Vec3], bodies: &[&Body], tolerance: f64) -> f64 {
        self.visible.clear();
        self.visible.push_with(|corners| corners.extend(target.iter().map(|&y| y - x)));
        let mut hidden = 0.0;
        for (k, body) in bodies.iter().enumerate() {
            hidden += match body.shadow(x, tolerance, &mut self.room) {
                Shadow::Nothing => 0.0,
                Shadow::Room => self.darken(n, k + 1 == bodies.len()),
            };
        }
        hidden
    }

    /// Moves what lies in the room from the visible pieces to the hidden sum. After the last body nobody asks for the visible ones.
    fn darken(&mut self, n: Vec3, last: bool) -> f64 {
        self.next.clear();
        let mut hidden = 0.0;
        for i in 0..self.visible.len() {
            let piece = self.visible.get(i);
            if self.room.misses(piece) {
                self.next.push_with(|corners| corners.extend_from_slice(piece));
                continue;
            }
            self.rest.clear();
            self.rest.extend_from_slice(piece);
            for &(m, c) in self.room.planes() {
                self.cutter.split(&self.rest, m, c, 0.0);
                std::mem::swap(&mut self.rest, &mut self.cutter.inside);
                if !last {
                    self.next.push_with(|corners| corners.extend_from_slice(&self.cutter.outside));
                }
            }
            hidden += point_to_polygon(n, self.rest.iter().copied());
        }
        std::mem::swap(&mut self.visible, &mut self.next);
        hidden
    }
}
