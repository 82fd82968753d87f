//! Convex polygons as lists of corners, and their clipping by half-spaces.
//!
//! Sutherland & Hodgman, Commun. ACM 17(1) 32, 1974, doi:10.1145/360767.360802, for one half-space
//! at a time.

use fredholm_mesh::{Patch, Vec3};

/// A closed half-space {x : n·x ≥ c}. With a unit normal, distances are in metres.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct HalfSpace {
    /// Inward normal n.
    pub normal: Vec3,
    /// Offset c.
    pub offset: f64,
}

impl HalfSpace {
    /// The half-space on the side of `normal` of the plane through `point`.
    #[must_use]
    pub fn through(point: Vec3, normal: Vec3) -> Self {
        Self { normal, offset: normal.dot(point) }
    }

    /// n·x − c: positive inside.
    #[must_use]
    pub fn height(&self, x: Vec3) -> f64 {
        self.normal.dot(x) - self.offset
    }
}

/// Appends to `inside` the part of `corners` at height ≥ 0; heights of at most `tolerance` count as 0. A polygon of which
/// no corner is above the tolerance leaves nothing.
pub fn clip(corners: &[Vec3], plane: HalfSpace, tolerance: f64, inside: &mut Vec<Vec3>) {
    let height = |x: Vec3| snap(plane.height(x), tolerance);
    if !corners.iter().any(|&x| height(x) > 0.0) {
        return;
    }
    let Some(&last) = corners.last() else { return };
    let mut from = (last, height(last));
    for &corner in corners {
        let to = (corner, height(corner));
        if from.1 * to.1 < 0.0 {
            inside.push(crossing(from, to));
        }
        if to.1 >= 0.0 {
            inside.push(corner);
        }
        from = to;
    }
}

/// How a convex polygon lies to a plane.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Side {
    /// No corner is above the tolerance.
    Below,
    /// No corner is below it.
    Above,
    /// It is cut in two.
    Both,
}

/// Cuts a polygon by a plane where it lies on both sides: `above` and `below` then hold the parts, as [`clip`] leaves
/// them, and are not touched otherwise. Heights of at most `tolerance` count as 0.
pub fn part(
    corners: &[Vec3],
    plane: HalfSpace,
    tolerance: f64,
    (above, below): (&mut Vec<Vec3>, &mut Vec<Vec3>),
) -> Side {
    let height = |x: Vec3| snap(plane.height(x), tolerance);
    let (mut low, mut high) = (0.0_f64, 0.0_f64);
    for &corner in corners {
        let height = height(corner);
        (low, high) = (low.min(height), high.max(height));
    }
    if high <= 0.0 {
        return Side::Below;
    }
    if low >= 0.0 {
        return Side::Above;
    }
    above.clear();
    below.clear();
    let last = corners[corners.len() - 1];
    let mut from = (last, height(last));
    for &corner in corners {
        let to = (corner, height(corner));
        if from.1 * to.1 < 0.0 {
            let between = crossing(from, to);
            above.push(between);
            below.push(between);
        }
        if to.1 >= 0.0 {
            above.push(corner);
        }
        if to.1 <= 0.0 {
            below.push(corner);
        }
        from = to;
    }
    Side::Both
}

/// The point of the segment where the height vanishes.
pub(crate) fn crossing(from: (Vec3, f64), to: (Vec3, f64)) -> Vec3 {
    // Always from the same end, so that neighbours that share the segment cut it at the same point.
    let (low, high) = if from.1 < to.1 { (from, to) } else { (to, from) };
    low.0 + (high.0 - low.0) * (low.1 / (low.1 - high.1))
}

fn snap(height: f64, tolerance: f64) -> f64 {
    if height.abs() <= tolerance { 0.0 } else { height }
}

/// Parameters of a point of the patch for a point of the unit square; on a triangle the upper half
/// of the square is folded down.
#[must_use]
pub fn folded(patch: &Patch, u: f64, v: f64) -> (f64, f64) {
    if patch.sides() == 3 && u + v > 1.0 { (1.0 - u, 1.0 - v) } else { (u, v) }
}

#[cfg(test)]
mod tests {
    use super::*;

    const UNIT_SQUARE: [Vec3; 4] = [
        Vec3::new(0.0, 0.0, 0.0),
        Vec3::new(1.0, 0.0, 0.0),
        Vec3::new(1.0, 1.0, 0.0),
        Vec3::new(0.0, 1.0, 0.0),
    ];

    /// Area vector ½ Σ pᵢ × pᵢ₊₁, m².
    fn area_vector(corners: &[Vec3]) -> Vec3 {
        let Some(&origin) = corners.first() else { return Vec3::ZERO };
        let fans = corners.windows(2).map(|e| (e[0] - origin).cross(e[1] - origin));
        fans.sum::<Vec3>() * 0.5
    }

    fn clipped_area(point: Vec3, normal: Vec3) -> f64 {
        let mut inside = Vec::new();
        clip(&UNIT_SQUARE, HalfSpace::through(point, normal), 1e-14, &mut inside);
        area_vector(&inside).z
    }

    #[test]
    fn a_plane_through_the_middle_leaves_half() {
        assert!((clipped_area(Vec3::splat(0.5), Vec3::X) - 0.5).abs() < 1e-15);
        assert!((clipped_area(Vec3::splat(0.5), Vec3::new(1.0, 1.0, 0.0).normalize()) - 0.5).abs() < 1e-15);
    }

    #[test]
    fn both_parts_are_those_that_clipping_leaves() {
        let normal = Vec3::new(1.0, 2.0, 0.0).normalize();
        let plane = HalfSpace::through(Vec3::splat(0.4), normal);
        let opposite = HalfSpace { normal: -normal, offset: -plane.offset };
        let (mut above, mut below) = (Vec::new(), Vec::new());
        assert_eq!(part(&UNIT_SQUARE, plane, 1e-14, (&mut above, &mut below)), Side::Both);
        for (found, half) in [(&above, plane), (&below, opposite)] {
            let mut clipped = Vec::new();
            clip(&UNIT_SQUARE, half, 1e-14, &mut clipped);
            // Heights over opposite planes are rounded in different ways.
            let near = |(a, b): (&Vec3, &Vec3)| a.distance(*b) < 1e-15;
            assert!(
                found.len() == clipped.len() && found.iter().zip(&clipped).all(near),
                "{found:?} {clipped:?}"
            );
        }
        let beside = |point: Vec3| HalfSpace::through(point, Vec3::X);
        let mut side = |plane| part(&UNIT_SQUARE, plane, 1e-14, (&mut above, &mut below));
        assert_eq!([side(beside(Vec3::X)), side(beside(Vec3::ZERO))], [Side::Below, Side::Above]);
    }

    #[test]
    fn a_corner_cut_leaves_seven_eighths() {
        let normal = Vec3::new(1.0, 1.0, 0.0).normalize();
        assert!((clipped_area(Vec3::new(0.5, 0.0, 0.0), normal) - 0.875).abs() < 1e-15);
    }

    #[test]
    fn a_touching_plane_keeps_all_or_nothing() {
        assert!((clipped_area(Vec3::ZERO, Vec3::X) - 1.0).abs() < 1e-15);
        assert!(clipped_area(Vec3::ZERO, Vec3::NEG_X) == 0.0);
        assert!(clipped_area(Vec3::ZERO, Vec3::Z) == 0.0, "a polygon in the plane is not in front of it");
    }
}
