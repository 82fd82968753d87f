//! How two patches lie to each other: what counts as flat, which parts face each other, and the
//! exchange that tolerances are relative to.

use crate::polygon::{HalfSpace, clip};
use fredholm_mesh::{Patch, Vec3};
use std::f64::consts::FRAC_1_PI;

/// Heights below this part of the pair's extent count as 0.
const ZERO_HEIGHT: f64 = 1e-12;

/// A patch with what every pair asks of it.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Side<'a> {
    pub patch: &'a Patch,
    /// The room in front.
    pub plane: HalfSpace,
    pub centroid: Vec3,
    pub diameter: f64,
}

impl<'a> Side<'a> {
    pub(crate) fn of(patch: &'a Patch) -> Self {
        Self { patch, plane: front_of(patch), centroid: patch.centroid(), diameter: patch.diameter() }
    }

    fn extent(&self, other: &Self) -> f64 {
        let rounding = self.patch.corner(0).abs().max_element() * 1e-3;
        self.centroid.distance(other.centroid) + self.diameter + other.diameter + rounding
    }

    /// As [`flat`].
    pub(crate) fn flat(&self, other: &Self) -> f64 {
        ZERO_HEIGHT * self.extent(other)
    }

    /// As [`facing_exchange`].
    pub(crate) fn facing_exchange(&self, other: &Self) -> f64 {
        let d2 = self.centroid.distance_squared(other.centroid);
        let [a, b] = [self, other].map(|side| side.patch.area());
        (FRAC_1_PI * a * b / d2).min(a.min(b))
    }
}

/// Largest distance that matters to a pair, with the rounding of a far place, m.
pub(crate) fn extent(a: &Patch, b: &Patch) -> f64 {
    Side::of(a).extent(&Side::of(b))
}

/// Height up to which a point of one patch lies in the plane of the other, m.
pub(crate) fn flat(a: &Patch, b: &Patch) -> f64 {
    Side::of(a).flat(&Side::of(b))
}

/// A_i A_j / (π d²), at most the smaller area, m²: the exchange of two patches squarely facing each
/// other.
pub(crate) fn facing_exchange(a: &Patch, b: &Patch) -> f64 {
    Side::of(a).facing_exchange(&Side::of(b))
}

/// The room in front of a patch.
pub(crate) fn front_of(patch: &Patch) -> HalfSpace {
    HalfSpace::through(patch.centroid(), patch.normal())
}

/// A segment from which distances are asked.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Segment {
    start: Vec3,
    along: Vec3,
    /// Its direction over its squared length.
    share: Vec3,
}

impl Segment {
    pub(crate) fn new([a, b]: [Vec3; 2]) -> Self {
        let along = b - a;
        Self { start: a, along, share: along / along.length_squared().max(f64::MIN_POSITIVE) }
    }

    #[inline]
    fn distance_squared(&self, x: Vec3) -> f64 {
        let arm = x - self.start;
        let t = arm.dot(self.share).clamp(0.0, 1.0);
        arm.distance_squared(self.along * t)
    }
}

/// Distance of a point from the nearest of some segments, m.
pub(crate) fn to_segments(x: Vec3, segments: impl Iterator<Item = Segment>) -> f64 {
    segments.map(|segment| segment.distance_squared(x)).fold(f64::INFINITY, f64::min).sqrt()
}

/// Writes the part of a patch in front of a plane to `corners`.
pub(crate) fn front(patch: &Patch, plane: HalfSpace, flat: f64, corners: &mut Vec<Vec3>) {
    corners.clear();
    clip(patch.corners(), plane, flat, corners);
}
