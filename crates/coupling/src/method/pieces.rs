//! The outer polygon cut up so that the factor to a close target has its layers along edges and its
//! peaks at corners of the pieces only.
//!
//! For a point p of the outer polygon, F(p → target) varies over the distance from p to the outline
//! of the target: along the projection of each edge of the target that is low over the outer plane,
//! and about that of each low corner. Cuts run along these projections, and across them at corners
//! where both edges project onto nearly one line. Lengths in metres.

use super::facing::Part;
use crate::polygon::{HalfSpace, clip};
use fredholm_mesh::Vec3;

/// Heights of cuts below this part of the radius count as 0.
const ZERO_HEIGHT: f64 = 1e-13;
/// Sine under which two directions count as nearly one.
const SAME_DIRECTION_SINE: f64 = 0.3;

/// Convex pieces of `outer`, counter-clockwise about its normal.
pub(super) fn pieces(outer: &Part, target: &Part) -> Vec<Vec<Vec3>> {
    let flat = ZERO_HEIGHT * (outer.radius() + target.radius());
    let mut pieces = vec![outer.corners.clone()];
    for plane in cuts(outer, target) {
        let back = HalfSpace { normal: -plane.normal, offset: -plane.offset };
        let halves = pieces.iter().flat_map(|piece| [part(piece, plane, flat), part(piece, back, flat)]);
        pieces = halves.filter(|piece| piece.len() >= 3).collect();
    }
    pieces
}

fn part(piece: &[Vec3], plane: HalfSpace, flat: f64) -> Vec<Vec3> {
    let mut inside = Vec::new();
    clip(piece, plane, flat, &mut inside);
    inside
}

/// Planes across the outer one along the low edges of the target, and at its low corners.
fn cuts(outer: &Part, target: &Part) -> Vec<HalfSpace> {
    let (n, start) = (outer.normal, outer.centroid());
    let low = |x: Vec3| (x - start).dot(n) < outer.radius();
    let corner = |k: usize| target.corners[k % target.corners.len()];
    let along = |k: usize| flattened(corner(k + 1) - corner(k), n);
    let mut planes = Vec::new();
    for k in 0..target.corners.len() {
        let (before, after) = (along(k + target.corners.len() - 1), along(k));
        if low(corner(k)) && before.cross(after).length() < SAME_DIRECTION_SINE {
            let across = if before == Vec3::ZERO { after } else { before };
            planes.extend(plane(corner(k), across));
        }
        if low(corner(k)) || low(corner(k + 1)) {
            planes.extend(plane(corner(k), after.cross(n)));
        }
    }
    planes
}

/// Unit direction of a projected edge, or zero where it is steep.
fn flattened(edge: Vec3, n: Vec3) -> Vec3 {
    let across = edge - n * edge.dot(n);
    if across.length() < SAME_DIRECTION_SINE * edge.length() {
        Vec3::ZERO
    } else {
        across.normalize_or_zero()
    }
}

fn plane(point: Vec3, normal: Vec3) -> Option<HalfSpace> {
    (normal != Vec3::ZERO).then(|| HalfSpace::through(point, normal))
}
