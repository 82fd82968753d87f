//! How two patches lie to each other: what counts as flat, which parts face each other, and the exchange that tolerances are relative to.

use crate::polygon::{HalfSpace, clip};
use fredholm_mesh::{Patch, Vec3};
use std::f64::consts::FRAC_1_PI;

/// Heights below this part of the pair's extent count as 0.
const FLAT: f64 = 1e-12;

/// Largest distance that matters to a pair, with the rounding of a far place, m.
pub(crate) fn extent(a: &Patch, b: &Patch) -> f64 {
    let rounding = a.corner(0).abs().max_element() * 1e-3;
    a.centroid().distance(b.centroid()) + a.diameter() + b.diameter() + rounding
}

/// Height up to which a point of one patch lies in the plane of the other, m.
pub(crate) fn flat(a: &Patch, b: &Patch) -> f64 {
    FLAT * extent(a, b)
}

/// A_i A_j / (π d²), at most the smaller area, m²: the exchange of two patches squarely facing each other.
pub(crate) fn facing_exchange(a: &Patch, b: &Patch) -> f64 {
    let d2 = a.centroid().distance_squared(b.centroid());
    (FRAC_1_PI * a.area() * b.area() / d2).min(a.area().min(b.area()))
}

/// The room in front of a patch.
pub(crate) fn front_of(patch: &Patch) -> HalfSpace {
    HalfSpace::through(patch.centroid(), patch.normal())
}

/// Distance of a point from the nearest of some segments, m.
pub(crate) fn to_segments(x: Vec3, segments: impl Iterator<Item = [Vec3; 2]>) -> f64 {
    let to = |[a, b]: [Vec3; 2]| {
        let along = b - a;
        let t = ((x - a).dot(along) / along.length_squared().max(f64::MIN_POSITIVE)).clamp(0.0, 1.0);
        x.distance_squared(a + along * t)
    };
    segments.map(to).fold(f64::INFINITY, f64::min).sqrt()
}

/// Writes the part of a patch in front of a plane to `corners`.
pub(crate) fn front(patch: &Patch, plane: HalfSpace, flat: f64, corners: &mut Vec<Vec3>) {
    corners.clear();
    clip(patch.corners(), plane, flat, corners);
}
