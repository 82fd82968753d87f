//! Shafts: the room that all segments between two patches keep to.
//!
//! The segments between the points of two convex polygons fill their convex hull. The hull is the
//! intersection of half-spaces: the front sides of the two polygons, and the supporting planes
//! through an edge of one and a corner of the other. A patch that lies outside one of them blocks
//! no segment.
//!
//! Reference: E. A. Haines, J. R. Wallace, "Shaft culling for efficient ray-cast radiosity", in:
//! Photorealistic Rendering in Computer Graphics, Springer 1994, 122–138,
//! [doi:10.1007/978-3-642-57963-9_12](https://doi.org/10.1007/978-3-642-57963-9_12).

mod half_space;
mod outline;
mod query;
mod supporting;

use fredholm_mesh::{Patch, Vec3};

use crate::frame::Frame;
pub(crate) use half_space::HalfSpace;
use outline::Outline;
use supporting::supporting_planes;

/// Two front sides and a supporting plane for each edge of two polygons of up to five corners.
pub(crate) const MOST_PLANES: usize = 12;
/// Corners of two polygons of up to five corners.
const MOST_CORNERS: usize = 10;
/// Part by which a capsule is wider than what it holds: far more than rounding.
const CAPSULE_MARGIN: f64 = 1e-9;

/// The convex hull of two polygons, or of a point and a polygon.
#[derive(Clone, Copy, Debug)]
pub struct Shaft {
    planes: [HalfSpace; MOST_PLANES],
    plane_count: usize,
    corners: [Vec3; MOST_CORNERS],
    corner_count: usize,
    capsule: Capsule,
}

/// What is within a distance of a line: it holds the whole shaft, and is asked quickly.
#[derive(Clone, Copy, Debug, Default)]
struct Capsule {
    start: Vec3,
    way: Vec3,
    /// 1/|way|², 0 where it has no length.
    inverse: f64,
    radius: f64,
}

impl Capsule {
    /// Around two polygons.
    fn around(a: &[Vec3], b: &[Vec3]) -> Self {
        let centre = |corners: &[Vec3]| corners.iter().sum::<Vec3>() / corners.len().max(1) as f64;
        let (start, end) = (centre(a), centre(b));
        let reach = |corners: &[Vec3], centre: Vec3| {
            corners.iter().map(|corner| corner.distance_squared(centre)).fold(0.0, f64::max)
        };
        let (way, radius) = (end - start, reach(a, start).max(reach(b, end)).sqrt());
        let square = way.length_squared();
        Self { start, way, inverse: if square > 0.0 { square.recip() } else { 0.0 }, radius }
    }

    /// Whether a ball is outside, more than rounding would make it so.
    #[inline]
    fn is_beside(&self, (centre, radius): (Vec3, f64)) -> bool {
        let to = centre - self.start;
        let along = (to.dot(self.way) * self.inverse).clamp(0.0, 1.0);
        let reach = (self.radius + radius) * (1.0 + CAPSULE_MARGIN);
        (to - self.way * along).length_squared() > reach * reach
    }
}

impl Shaft {
    /// The hull of the parts of two patches that lie in front of each other, or `None` where no
    /// such parts exist.
    pub(crate) fn between(a: &Patch, b: &Patch, frame: &Frame) -> Option<Self> {
        let (whole_a, whole_b) = (Outline::of(a, frame), Outline::of(b, frame));
        let (front_a, front_b) = (whole_a.front(), whole_b.front());
        let a = whole_a.clip(&front_b, frame.tolerance);
        let b = whole_b.clip(&front_a, frame.tolerance);
        if a.corners().len() < 3 || b.corners().len() < 3 {
            return None;
        }
        let mut shaft = Self::empty();
        shaft.bound(front_a, frame);
        shaft.bound(front_b, frame);
        supporting_planes(&a, b.corners(), frame.tolerance, |plane| shaft.bound(plane, frame));
        supporting_planes(&b, a.corners(), frame.tolerance, |plane| shaft.bound(plane, frame));
        shaft.span(a.corners());
        shaft.span(b.corners());
        shaft.capsule = Capsule::around(a.corners(), b.corners());
        Some(shaft)
    }

    /// The hull of a point and a patch, or `None` where the point is not in front of the patch.
    pub(crate) fn from_point(point: Vec3, patch: &Patch, frame: &Frame) -> Option<Self> {
        let point = frame.local(point);
        let patch = Outline::of(patch, frame);
        let front = patch.front();
        if front.depth(point) <= frame.tolerance {
            return None;
        }
        let mut shaft = Self::empty();
        shaft.bound(front, frame);
        supporting_planes(&patch, &[point], frame.tolerance, |plane| shaft.bound(plane, frame));
        shaft.span(patch.corners());
        shaft.span(&[point]);
        shaft.capsule = Capsule::around(patch.corners(), &[point]);
        Some(shaft)
    }

    fn empty() -> Self {
        let planes = [HalfSpace::default(); MOST_PLANES];
        let corners = [Vec3::ZERO; MOST_CORNERS];
        Self { planes, plane_count: 0, corners, corner_count: 0, capsule: Capsule::default() }
    }

    /// The half-spaces, less a layer of the tolerance so that a patch that merely touches the shaft
    /// is outside.
    pub(crate) fn planes(&self) -> &[HalfSpace] {
        &self.planes[..self.plane_count]
    }

    /// The corners of both polygons.
    pub(crate) fn corners(&self) -> &[Vec3] {
        &self.corners[..self.corner_count]
    }

    fn bound(&mut self, plane: HalfSpace, frame: &Frame) {
        if let Some(slot) = self.planes.get_mut(self.plane_count) {
            *slot = plane.shrunk(frame.tolerance);
            self.plane_count += 1;
        }
    }

    fn span(&mut self, corners: &[Vec3]) {
        for &corner in corners {
            if let Some(slot) = self.corners.get_mut(self.corner_count) {
                *slot = corner;
                self.corner_count += 1;
            }
        }
    }
}
