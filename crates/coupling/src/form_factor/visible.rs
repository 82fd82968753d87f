//! The parts of a flat patch that points of another one see, exactly: convex polygons.
//!
//! The target is clipped by the horizon of the source, and the shadows of the occluders between both are cut out of it. T. Nishita & E. Nakamae,
//! SIGGRAPH 1985, doi:10.1145/325165.325169, treat the same geometry. Lengths in metres. For integrals of the kernel times a function over what is
//! seen; the factor alone is the integral of the kernel.

use super::shadow::{PolygonList, Shadow};
use crate::polygon::{HalfSpace, clip};
use fredholm_mesh::{Patch, Vec3};
use fredholm_visibility::Occluders;

/// Heights below this part of the pair's extent count as 0.
const FLAT: f64 = 1e-12;

/// What points of one patch see of another. Buffers are kept between pairs and points.
#[derive(Clone, Debug, Default)]
pub struct VisibleParts {
    candidates: Vec<u32>,
    once: Vec<Vec3>,
    occluders: PolygonList,
    target: Vec<Vec3>,
    shadow: Shadow,
    behind: Option<HalfSpace>,
    normal: Vec3,
    flat: f64,
}

impl VisibleParts {
    /// Prepares the view from points of `from` to `to`, behind `occluders`. Returns whether any point can see anything.
    pub fn prepare(&mut self, from: &Patch, to: &Patch, occluders: &Occluders) -> bool {
        let [near, far] = [from, to].map(|patch| HalfSpace::through(patch.centroid(), patch.normal()));
        let apart = from.centroid().distance(to.centroid());
        let rounding = from.corner(0).abs().max_element() * 1e-3;
        self.flat = FLAT * (apart + from.diameter() + to.diameter() + rounding);
        (self.normal, self.behind) = (from.normal(), Some(far));
        self.target.clear();
        clip(to.corners(), near, self.flat, &mut self.target);
        let faces = from.corners().iter().any(|&x| far.height(x) > self.flat);
        if !faces || self.target.len() < 3 {
            return false;
        }
        occluders.shaft(from, to, &mut self.candidates);
        self.between(near, far, occluders);
        true
    }

    /// Whether nothing stands between the two patches.
    #[must_use]
    pub fn is_open(&self) -> bool {
        self.occluders.len() == 0
    }

    /// The part of the target above the horizon, m.
    #[must_use]
    pub fn target(&self) -> &[Vec3] {
        &self.target
    }

    /// Form factor from the point `p` of the source patch to what it sees of the target; [`parts`](Self::parts) then are what it sees.
    pub fn factor(&mut self, p: Vec3) -> f64 {
        let front = self.behind.is_some_and(|plane| plane.height(p) > self.flat);
        let target = if front { &self.target[..] } else { &[] };
        self.shadow.visible_factor(p, self.normal, target, &self.occluders)
    }

    /// The convex parts that the last point saw, relative to it, m.
    pub fn parts(&self) -> impl Iterator<Item = &[Vec3]> {
        self.shadow.parts().iter()
    }

    /// Clips the candidates to the space in front of both planes.
    fn between(&mut self, near: HalfSpace, far: HalfSpace, occluders: &Occluders) {
        self.occluders.clear();
        for &candidate in &self.candidates {
            self.once.clear();
            clip(occluders.patches()[candidate as usize].corners(), near, self.flat, &mut self.once);
            self.occluders.push_with(|corners| clip(&self.once, far, self.flat, corners));
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::form_factor::point_to_polygon;

    fn square(z: f64, half: f64, up: bool) -> Patch {
        let corner = |x: f64, y: f64| Vec3::new(half * x, half * y, z);
        let corners = [corner(-1., -1.), corner(1., -1.), corner(1., 1.), corner(-1., 1.)];
        let patch = Patch::quad(corners).unwrap().unwrap();
        if up { patch } else { patch.flipped() }
    }

    #[test]
    fn a_square_in_front_hides_the_larger_square_behind_it() {
        let (floor, ceiling) = (square(0.0, 0.1, true), square(1.0, 1.0, false));
        let occluders = Occluders::new(&[square(0.5, 0.25, true)]).unwrap();
        let mut parts = VisibleParts::default();
        assert!(parts.prepare(&floor, &ceiling, &occluders) && !parts.is_open());
        let seen = parts.factor(Vec3::ZERO);
        let hidden = square(1.0, 0.5, false);
        let whole = |patch: &Patch| point_to_polygon(Vec3::Z, patch.corners().iter().copied());
        assert!((seen - (whole(&ceiling) - whole(&hidden))).abs() < 1e-15);
        let by_parts: f64 = parts.parts().map(|part| point_to_polygon(Vec3::Z, part.iter().copied())).sum();
        assert!(seen > 0.1 && (by_parts - seen).abs() < 1e-15);
    }

    #[test]
    fn a_patch_behind_is_not_seen() {
        let (floor, below) = (square(0.0, 1.0, true), square(-1.0, 1.0, true));
        let occluders = Occluders::new(&[]).unwrap();
        assert!(!VisibleParts::default().prepare(&floor, &below, &occluders));
    }
}
