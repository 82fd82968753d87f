//! Pairs that touch, nearly touch, or reach behind each other's plane: the contour integral of the parts that face each other.

use crate::form_factor::contour_integral;
use crate::polygon::{HalfSpace, clip};
use fredholm_mesh::{Patch, Vec3};
use fredholm_quadrature::Estimate;

/// Heights below this part of the pair's extent count as 0.
const FLAT: f64 = 1e-12;

/// A_i F_ij (m²) to an absolute `tolerance` in m²; `front` are buffers. The same bits in either order.
pub(super) fn close(a: &Patch, b: &Patch, tolerance: f64, front: &mut [Vec<Vec3>; 2]) -> Estimate {
    let (a, b) = if precedes(a, b) { (a, b) } else { (b, a) };
    let rounding = a.corner(0).abs().max_element() * 1e-3;
    let extent = a.centroid().distance(b.centroid()) + a.diameter() + b.diameter() + rounding;
    let [first, second] = front;
    facing(a, b, FLAT * extent, first);
    facing(b, a, FLAT * extent, second);
    contour_integral(first, second, tolerance)
}

/// An order of patches that depends on where they lie, and not on their numbers.
fn precedes(a: &Patch, b: &Patch) -> bool {
    let [first, second] = [a, b].map(|patch| patch.corners().iter().flat_map(Vec3::to_array));
    first.lt(second)
}

/// The part of `patch` in front of `other`.
fn facing(patch: &Patch, other: &Patch, flat: f64, corners: &mut Vec<Vec3>) {
    corners.clear();
    clip(patch.corners(), HalfSpace::through(other.centroid(), other.normal()), flat, corners);
}
