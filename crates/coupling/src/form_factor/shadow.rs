//! What convex bodies hide of a convex polygon from a point, exactly: F = Σ over the pieces of the polygon that lie in the shadows.
//!
//! The shadow of a body is an intersection of half-spaces. Clipping a convex polygon by them leaves the hidden piece, convex again; what is cut off on the
//! way stays visible and is asked about the next body. T. Nishita & E. Nakamae, SIGGRAPH 1985, doi:10.1145/325165.325169, treat the same geometry.

use crate::form_factor::point_to_polygon;
use crate::polygon::crossing;
use fredholm_mesh::Vec3;
use fredholm_visibility::body::{Room, Screen, Shadow};

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

    pub(crate) fn get(&self, i: usize) -> &[Vec3] {
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

    /// Keeps the first `len` polygons.
    fn truncate(&mut self, len: usize) {
        self.ends.truncate(len);
        self.corners.truncate(self.ends.last().copied().unwrap_or(0));
    }

    /// Cuts every polygon by the plane n·x = c into its parts on both sides. Heights of at most `tolerance` count as 0.
    pub(crate) fn cut(&mut self, n: Vec3, c: f64, tolerance: f64, work: &mut Cutter, spare: &mut Self) {
        spare.clear();
        for i in 0..self.len() {
            let polygon = self.get(i);
            if work.split(polygon, n, c, tolerance) == Cut::Both {
                spare.push_with(|corners| corners.extend_from_slice(&work.inside));
                spare.push_with(|corners| corners.extend_from_slice(&work.outside));
            } else {
                spare.push_with(|corners| corners.extend_from_slice(polygon));
            }
        }
        std::mem::swap(self, spare);
    }
}

/// Buffers of a cut.
#[derive(Clone, Debug, Default)]
pub(crate) struct Cutter {
    inside: Vec<Vec3>,
    outside: Vec<Vec3>,
}

impl Cutter {
    /// Splits a convex polygon into its parts with n·x ≥ c and ≤ c, which are in `inside` and `outside` only where the plane cuts it.
    #[inline]
    fn split(&mut self, polygon: &[Vec3], n: Vec3, c: f64, tolerance: f64) -> Cut {
        let (mut above, mut below) = (false, false);
        for corner in polygon {
            let height = n.dot(*corner) - c;
            above |= height > tolerance;
            below |= height < -tolerance;
        }
        if above && below {
            self.cut(polygon, |x| n.dot(x) - c, tolerance);
            return Cut::Both;
        }
        if above { Cut::Inside } else { Cut::Outside }
    }

    fn cut(&mut self, polygon: &[Vec3], height: impl Fn(Vec3) -> f64, tolerance: f64) {
        self.inside.clear();
        self.outside.clear();
        let with_height = |x: Vec3| {
            let h = height(x);
            (x, if h.abs() <= tolerance { 0.0 } else { h })
        };
        let mut from = with_height(polygon[polygon.len() - 1]);
        for &corner in polygon {
            let to = with_height(corner);
            self.side(from, to);
            from = to;
        }
    }

    fn side(&mut self, from: (Vec3, f64), to: (Vec3, f64)) {
        if from.1 * to.1 < 0.0 {
            let cut = crossing(from, to);
            self.inside.push(cut);
            self.outside.push(cut);
        }
        if to.1 >= 0.0 {
            self.inside.push(to.0);
        }
        if to.1 <= 0.0 {
            self.outside.push(to.0);
        }
    }
}

/// On which side of a plane a polygon lies.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Cut {
    Inside,
    Outside,
    Both,
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
    /// Form factor from the point `x` with normal `n` to what `screens` hide of `target`, which lies in front of the point.
    pub(crate) fn hidden_factor(&mut self, x: Vec3, n: Vec3, target: &[Vec3], screens: &[Screen]) -> f64 {
        let Some((last, others)) = screens.split_last() else { return 0.0 };
        let hidden = self.hide(x, n, target, others);
        // After the last body nobody asks for what is left.
        hidden + self.behind(last, x, n, false)
    }

    /// As [`hidden_factor`](Self::hidden_factor), and leaves what is seen in [`visible`](Self::visible).
    pub(crate) fn hide(&mut self, x: Vec3, n: Vec3, target: &[Vec3], screens: &[Screen]) -> f64 {
        self.visible.clear();
        self.visible.push_with(|corners| corners.extend(target.iter().map(|&y| y - x)));
        screens.iter().map(|screen| self.behind(screen, x, n, true)).sum()
    }

    /// What the last point saw: convex polygons, relative to it.
    pub(crate) fn visible(&self) -> &PolygonList {
        &self.visible
    }

    /// Moves what lies in the shadow of a body from the visible pieces to the hidden sum.
    fn behind(&mut self, screen: &Screen, x: Vec3, n: Vec3, keep: bool) -> f64 {
        if screen.shadow(x, &mut self.room) == Shadow::Nothing {
            return 0.0;
        }
        self.next.clear();
        let hidden = (0..self.visible.len()).map(|i| self.darken(i, n, keep)).sum();
        std::mem::swap(&mut self.visible, &mut self.next);
        hidden
    }

    /// Form factor of the part of a visible piece that lies in the room; with `keep` the rest goes to the next pieces.
    fn darken(&mut self, i: usize, n: Vec3, keep: bool) -> f64 {
        self.rest.clear();
        self.rest.extend_from_slice(self.visible.get(i));
        let start = self.next.len();
        for &(m, c) in self.room.planes() {
            match self.cutter.split(&self.rest, m, c, 0.0) {
                Cut::Inside => {}
                Cut::Outside => {
                    self.next.truncate(start);
                    self.next.push_with(|corners| corners.extend_from_slice(self.visible.get(i)));
                    return 0.0;
                }
                Cut::Both => {
                    std::mem::swap(&mut self.rest, &mut self.cutter.inside);
                    if keep {
                        self.next.push_with(|corners| corners.extend_from_slice(&self.cutter.outside));
                    }
                }
            }
        }
        point_to_polygon(n, self.rest.iter().copied())
    }
}
