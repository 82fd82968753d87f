//! The parts of two patches that face each other, and what stands between them.
//!
//! Points of i behind the plane of j see nothing of it: A_i F_ij = ∫ ∫ over {p ∈ i : n_j·(p − c_j)
//! ≥ 0} and the same of j. All methods integrate over these parts only, so that patches that cross
//! each other's plane are right. Lengths in metres.

use super::Evaluated;
use crate::form_factor::{extent, flat, front, front_of};
use crate::kernel::lambert;
use crate::polygon::{HalfSpace, clip};
use fredholm_mesh::{Patch, Vec3};
use fredholm_quadrature::Estimate;
use fredholm_visibility::Occluders;

/// The part of one patch in front of the other.
pub(super) struct Part {
    /// Corners, counter-clockwise about the normal.
    pub corners: Vec<Vec3>,
    /// The same part as patches: the patch itself, or a fan of triangles.
    pub cells: Vec<Patch>,
    /// Unit normal of the patch.
    pub normal: Vec3,
}

/// Two patches of which parts face each other.
pub(super) struct Facing<'a> {
    pub a: Part,
    pub b: Part,
    occluders: Option<&'a Occluders>,
    between: usize,
    extent: f64,
}

impl<'a> Facing<'a> {
    /// `None` where the patches exchange nothing.
    pub(super) fn new(a: &Patch, b: &Patch, occluders: &'a Occluders) -> Option<Self> {
        let (extent, flat) = (extent(a, b), flat(a, b));
        let planes = [a, b].map(front_of);
        let parts = (Part::of(a, planes[1], flat)?, Part::of(b, planes[0], flat)?);
        let between = between(a, b, planes, flat, occluders);
        let occluders = (between > 0).then_some(occluders);
        Some(Self { a: parts.0, b: parts.1, occluders, between, extent })
    }

    /// Number of occluders in the space between both patches.
    pub(super) fn between(&self) -> usize {
        self.between
    }

    /// Largest distance that matters, m.
    pub(super) fn extent(&self) -> f64 {
        self.extent
    }

    /// The estimate, its error no larger than the value or the smaller area: the truth lies between
    /// 0 and that area.
    pub(super) fn evaluated(&self, estimate: Estimate, evaluations: u64) -> Evaluated {
        let got = Evaluated::new(estimate, evaluations);
        let most = got.value.max(self.a.area().min(self.b.area()));
        Evaluated { error: got.error.min(most), ..got }
    }

    /// Whether two points see each other.
    pub(super) fn sees(&self, p: Vec3, q: Vec3) -> bool {
        self.occluders.is_none_or(|occluders| occluders.unoccluded(p, q))
    }

    /// The kernel with visibility between a point of `a` and one of `b`, 1/m².
    pub(super) fn kernel(&self, p: Vec3, q: Vec3) -> f64 {
        let open = lambert(p, self.a.normal, q, self.b.normal);
        if open > 0.0 && self.sees(p, q) { open } else { 0.0 }
    }
}

impl Part {
    fn of(patch: &Patch, plane: HalfSpace, flat: f64) -> Option<Self> {
        let mut corners = Vec::new();
        front(patch, plane, flat, &mut corners);
        let cells = if corners == patch.corners() { vec![*patch] } else { fan(&corners) };
        (!cells.is_empty()).then_some(Self { corners, cells, normal: patch.normal() })
    }

    /// Area, m².
    pub(super) fn area(&self) -> f64 {
        self.cells.iter().map(Patch::area).sum()
    }

    /// Centroid, m.
    pub(super) fn centroid(&self) -> Vec3 {
        let moment = |cell: &Patch| cell.centroid() * cell.area();
        self.cells.iter().map(moment).sum::<Vec3>() / self.area()
    }

    /// Largest distance of a corner from the centroid, m.
    pub(super) fn radius(&self) -> f64 {
        let centre = self.centroid();
        self.corners.iter().map(|x| x.distance(centre)).fold(0.0, f64::max)
    }

    /// Smallest height of the corners of another part over the plane of this one, m: no point of it
    /// is closer.
    pub(super) fn clearance(&self, other: &Self) -> f64 {
        let height = |x: &Vec3| (*x - self.corners[0]).dot(self.normal);
        other.corners.iter().map(height).fold(f64::INFINITY, f64::min)
    }

    /// The part as triangles.
    pub(super) fn triangles(&self) -> Vec<Patch> {
        fan(&self.corners)
    }

    /// Where the ray from `p` meets the part from its lit side.
    pub(super) fn hit(&self, p: Vec3, direction: Vec3) -> Option<Vec3> {
        let start = *self.corners.first()?;
        let slope = direction.dot(self.normal);
        let t = (start - p).dot(self.normal) / slope;
        let q = p + direction * t;
        (slope < 0.0 && t > 0.0 && self.contains(q)).then_some(q)
    }

    fn contains(&self, q: Vec3) -> bool {
        let ends = self.corners.iter().zip(self.corners.iter().cycle().skip(1));
        ends.into_iter().all(|(&from, &to)| (to - from).cross(q - from).dot(self.normal) >= 0.0)
    }
}

/// A convex polygon as triangles; slivers that are no patches have no area to add.
pub(super) fn fan(corners: &[Vec3]) -> Vec<Patch> {
    let triangle = |k: usize| Patch::triangle([corners[0], corners[k - 1], corners[k]]).ok();
    (2..corners.len()).filter_map(triangle).collect()
}

/// Number of occluders that reach into the space in front of both planes, as far as the shaft of
/// the pair finds them.
fn between(a: &Patch, b: &Patch, planes: [HalfSpace; 2], flat: f64, occluders: &Occluders) -> usize {
    let mut candidates = Vec::new();
    occluders.shaft(a, b, &mut candidates);
    let reaches = |index: &&u32| {
        let (mut once, mut twice) = (Vec::new(), Vec::new());
        clip(occluders.patches()[**index as usize].corners(), planes[0], flat, &mut once);
        clip(&once, planes[1], flat, &mut twice);
        twice.len() >= 3
    };
    candidates.iter().filter(reaches).count()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn quad(corners: [[f64; 3]; 4]) -> Patch {
        Patch::quad(corners.map(Vec3::from)).unwrap().unwrap()
    }

    #[test]
    fn a_wall_through_the_middle_of_a_floor_sees_half_of_it() {
        let floor = quad([[0., 0., 0.], [1., 0., 0.], [1., 1., 0.], [0., 1., 0.]]);
        let wall = quad([[0.5, 0., -1.], [0.5, 1., -1.], [0.5, 1., 2.], [0.5, 0., 2.]]);
        let none = Occluders::new(&[]).unwrap();
        let facing = Facing::new(&floor, &wall, &none).unwrap();
        assert!((facing.a.area() - 0.5).abs() < 1e-15 && (facing.b.area() - 2.0).abs() < 1e-15);
        assert!((facing.a.centroid() - Vec3::new(0.75, 0.5, 0.0)).length() < 1e-15);
        assert!(Facing::new(&floor, &floor.flipped(), &none).is_none());
    }

    #[test]
    fn only_what_reaches_between_counts() {
        let floor = quad([[0., 0., 0.], [1., 0., 0.], [1., 1., 0.], [0., 1., 0.]]);
        let ceiling = quad([[0., 1., 1.], [1., 1., 1.], [1., 0., 1.], [0., 0., 1.]]);
        let block = quad([[0., 0., 0.5], [0.5, 0., 0.5], [0.5, 0.5, 0.5], [0., 0.5, 0.5]]);
        let count = |patches: &[Patch]| {
            let occluders = Occluders::new(patches).unwrap();
            Facing::new(&floor, &ceiling, &occluders).unwrap().between()
        };
        assert_eq!(count(&[floor, ceiling]), 0);
        assert_eq!(count(&[floor, ceiling, block, block.flipped()]), 2);
    }
}
