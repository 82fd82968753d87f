//! The parts of a flat patch that points of another one see, exactly: convex polygons.
//!
//! The target is clipped by the horizon of the source, and the shadows of the occluders between
//! both are cut out of it. T. Nishita & E. Nakamae, SIGGRAPH 1985, doi:10.1145/325165.325169, treat
//! the same geometry. Lengths in metres. For integrals of the kernel times a function over what is
//! seen; the factor alone is the integral of the kernel.

use super::shadow::Hiding;
use super::{flat, front, front_of, point_to_polygon};
use crate::polygon::HalfSpace;
use fredholm_mesh::{Patch, Vec3};
use fredholm_visibility::Occluders;
use fredholm_visibility::body::{Bodies, Screen};

/// What points of one patch see of another. Buffers are kept between pairs and points.
#[derive(Clone, Debug)]
pub struct VisibleParts<'a> {
    occluders: &'a Occluders,
    bodies: &'a Bodies,
    between: Vec<Screen<'a>>,
    target: Vec<Vec3>,
    hiding: Hiding,
    behind: Option<HalfSpace>,
    normal: Vec3,
    flat: f64,
}

impl<'a> VisibleParts<'a> {
    /// Views behind `bodies`, which were put together from `occluders`.
    #[must_use]
    pub fn new(occluders: &'a Occluders, bodies: &'a Bodies) -> Self {
        Self {
            occluders,
            bodies,
            between: Vec::new(),
            target: Vec::new(),
            hiding: Hiding::default(),
            behind: None,
            normal: Vec3::ZERO,
            flat: 0.0,
        }
    }

    /// Prepares the view from points of `from` to `to`. Returns whether any point can see anything.
    pub fn prepare(&mut self, from: &Patch, to: &Patch) -> bool {
        let far = front_of(to);
        self.flat = flat(from, to);
        (self.normal, self.behind) = (from.normal(), Some(far));
        front(to, front_of(from), self.flat, &mut self.target);
        let faces = from.corners().iter().any(|&x| far.height(x) > self.flat);
        let shaft = self.occluders.shaft_between(from, to).filter(|_| faces && self.target.len() >= 3);
        self.between.clear();
        if let Some(shaft) = &shaft {
            let tolerance = self.bodies.tolerance();
            let reaching = self.occluders.reaching(self.bodies, shaft);
            let screens =
                reaching.map(|(_, body)| Screen::new(body, from.corners(), &self.target, tolerance));
            self.between.extend(screens);
        }
        shaft.is_some()
    }

    /// Whether nothing stands between the two patches.
    #[must_use]
    pub fn is_open(&self) -> bool {
        self.between.is_empty()
    }

    /// The part of the target above the horizon, m.
    #[must_use]
    pub fn target(&self) -> &[Vec3] {
        &self.target
    }

    /// Form factor from the point `p` of the source patch to what it sees of the target;
    /// [`parts`](Self::parts) then are what it sees.
    pub fn factor(&mut self, p: Vec3) -> f64 {
        let front = self.behind.is_some_and(|plane| plane.height(p) > self.flat);
        let target = if front { &self.target[..] } else { &[] };
        self.hiding.hide(p, self.normal, target, &self.between);
        self.parts().map(|part| point_to_polygon(self.normal, part.iter().copied())).sum()
    }

    /// The convex parts that the last point saw, relative to it, m.
    pub fn parts(&self) -> impl Iterator<Item = &[Vec3]> {
        self.hiding.visible().iter()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

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
        let bodies = Bodies::new(&occluders, &[&floor, &ceiling], &[]);
        let mut parts = VisibleParts::new(&occluders, &bodies);
        assert!(parts.prepare(&floor, &ceiling) && !parts.is_open());
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
        let bodies = Bodies::default();
        assert!(!VisibleParts::new(&occluders, &bodies).prepare(&floor, &below));
    }
}
