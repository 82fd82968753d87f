//! Pairs that touch, nearly touch, or reach behind each other's plane: the contour integral of the
//! parts that face each other.

use crate::form_factor::{contour_integral, flat, front, front_of};
use fredholm_mesh::{Patch, Vec3};
use fredholm_quadrature::Estimate;

/// A_i F_ij (m²) to an absolute `tolerance` in m²; `parts` are buffers. The same bits in either
/// order.
pub(super) fn close(a: &Patch, b: &Patch, tolerance: f64, parts: &mut [Vec<Vec3>; 2]) -> Estimate {
    let (a, b) = if precedes(a, b) { (a, b) } else { (b, a) };
    let flat = flat(a, b);
    let [first, second] = parts;
    front(a, front_of(b), flat, first);
    front(b, front_of(a), flat, second);
    contour_integral(first, second, tolerance)
}

/// An order of patches that depends on where they lie, and not on their numbers.
fn precedes(a: &Patch, b: &Patch) -> bool {
    let [first, second] = [a, b].map(|patch| patch.corners().iter().flat_map(Vec3::to_array));
    first.lt(second)
}
