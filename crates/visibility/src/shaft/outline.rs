//! The part of a convex polygon in front of a plane.
//!
//! Reference: I. E. Sutherland, G. W. Hodgman, "Reentrant polygon clipping", Commun. ACM 17 (1974)
//! 32–42, [doi:10.1145/360767.360802](https://doi.org/10.1145/360767.360802).

use fredholm_mesh::{Patch, Vec3};

use super::HalfSpace;
use crate::frame::Frame;

/// Corners of a patch of four corners that was cut by one plane.
const MOST_CORNERS: usize = 5;

/// A flat convex polygon of up to five corners, in local coordinates.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Outline {
    corners: [Vec3; MOST_CORNERS],
    len: usize,
    /// Unit normal.
    pub normal: Vec3,
}

impl Outline {
    pub(crate) fn of(patch: &Patch, frame: &Frame) -> Self {
        let mut outline = Self { corners: [Vec3::ZERO; MOST_CORNERS], len: 0, normal: patch.normal() };
        for &corner in patch.corners() {
            outline.push(frame.local(corner));
        }
        outline
    }

    pub(crate) fn corners(&self) -> &[Vec3] {
        &self.corners[..self.len]
    }

    /// The front side of its plane.
    pub(crate) fn front(&self) -> HalfSpace {
        HalfSpace { normal: self.normal, offset: self.normal.dot(self.corners[0]) }
    }

    /// Cuts away what lies more than `tolerance` behind the plane.
    pub(crate) fn clip(&self, plane: &HalfSpace, tolerance: f64) -> Self {
        let depths = self.corners.map(|p| plane.depth(p));
        if depths[..self.len].iter().all(|&d| d >= -tolerance) {
            return *self;
        }
        let mut kept = Self { len: 0, ..*self };
        for i in 0..self.len {
            let j = if i + 1 == self.len { 0 } else { i + 1 };
            if depths[i] >= -tolerance {
                kept.push(self.corners[i]);
            }
            if (depths[i] > tolerance && depths[j] < -tolerance)
                || (depths[i] < -tolerance && depths[j] > tolerance)
            {
                let t = depths[i] / (depths[i] - depths[j]);
                kept.push(self.corners[i] + (self.corners[j] - self.corners[i]) * t);
            }
        }
        kept
    }

    /// A convex polygon cut by one plane has at most one corner more; a sixth could only come from
    /// rounding.
    fn push(&mut self, corner: Vec3) {
        if let Some(slot) = self.corners.get_mut(self.len) {
            *slot = corner;
            self.len += 1;
        }
    }
}
