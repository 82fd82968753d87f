//! A ball round a group of patches and a cone round their normals: can two groups see each other at
//! all?
//!
//! From any point of a ball round c with radius r the direction to any point of another ball, at
//! the distance d of the centres, deviates from the line of the centres by at most δ = asin((r +
//! r')/d). A patch sees what is less than 90° off its normal; normals within α of an axis a see
//! nothing along u where the angle of a and u is at least 90° + α + δ. Lengths in metres, angles in
//! radians.

use super::radius;
use fredholm_mesh::{Patch, Vec3};
use std::f64::consts::{FRAC_PI_2, PI};

/// Centre and radius of a ball, axis and half angle of a cone.
#[derive(Clone, Copy, Debug)]
pub struct Cone {
    pub centre: Vec3,
    pub radius: f64,
    pub axis: Vec3,
    pub angle: f64,
}

impl Cone {
    /// Those of one patch.
    pub fn of(patch: &Patch) -> Self {
        let centre = patch.centroid();
        Self { centre, radius: radius(patch, centre), axis: patch.normal(), angle: 0.0 }
    }

    /// Those round several patches.
    pub fn around<'a>(patches: impl Iterator<Item = &'a Patch> + Clone) -> Self {
        let low = patches.clone().flat_map(Patch::corners).fold(Vec3::INFINITY, |low, x| low.min(*x));
        let high = patches.clone().flat_map(Patch::corners).fold(Vec3::NEG_INFINITY, |high, x| high.max(*x));
        let centre = 0.5 * (low + high);
        let far = patches.clone().map(|patch| radius(patch, centre)).fold(0.0, f64::max);
        let axis = patches.clone().map(|p| p.normal() * p.area()).sum::<Vec3>().normalize_or_zero();
        let turn = |patch: &Patch| axis.dot(patch.normal()).clamp(-1.0, 1.0).acos();
        let angle = if axis == Vec3::ZERO { PI } else { patches.map(turn).fold(0.0, f64::max) };
        Self { centre, radius: far, axis, angle }
    }

    /// Whether no point of the group looks at any point of a patch, or the other way round. The
    /// places that nobody in the ball with any normal of the cone looks at are an intersection of
    /// half-spaces, so that it is enough to ask for the corners.
    pub fn apart_from(&self, patch: &Patch) -> bool {
        let height = (self.centre - patch.corner(0)).dot(patch.normal());
        let unseen = |x: &Vec3| {
            let line = *x - self.centre;
            let off = line.angle_between(self.axis) - self.angle;
            line.length() * off.max(0.0).cos() + self.radius <= 0.0
        };
        height <= -self.radius || patch.corners().iter().all(unseen)
    }

    /// Distance from the centre to a patch, m, or less.
    pub fn distance(&self, patch: &Patch) -> f64 {
        let (n, corners) = (patch.normal(), patch.corners());
        let height = (self.centre - corners[0]).dot(n);
        let beyond = |k: usize| {
            let (x, y) = (corners[k], patch.corner(k + 1));
            (self.centre - x).dot((y - x).cross(n).normalize_or_zero())
        };
        height.hypot((0..corners.len()).map(beyond).fold(0.0, f64::max))
    }

    /// Whether no point of one group looks at any point of the other.
    pub fn turned_away(&self, other: &Self) -> bool {
        let line = other.centre - self.centre;
        let (distance, reach) = (line.length(), self.radius + other.radius);
        if distance <= reach {
            return false;
        }
        let (along, slack) = (line / distance, (reach / distance).asin());
        let away =
            |cone: &Self, u: Vec3| cone.axis.dot(u).clamp(-1.0, 1.0).acos() >= FRAC_PI_2 + cone.angle + slack;
        away(self, along) || away(other, -along)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn square(z: f64, up: bool) -> Patch {
        let corner = |x: f64, y: f64| Vec3::new(x, y, z);
        let patch = Patch::quad([corner(-1., -1.), corner(1., -1.), corner(1., 1.), corner(-1., 1.)]);
        let patch = patch.unwrap().unwrap();
        if up { patch } else { patch.flipped() }
    }

    #[test]
    fn groups_that_turn_their_backs_are_told() {
        let (low, high) = (square(0.0, true), square(9.0, false));
        let faces = |a: &Patch, b: &Patch| !Cone::of(a).turned_away(&Cone::of(b));
        assert!(faces(&low, &high));
        assert!(!faces(&low.flipped(), &high) && !faces(&low, &high.flipped()));
    }

    #[test]
    fn a_group_and_a_patch_that_do_not_see_each_other_are_told() {
        let (floor, group) = (square(0.0, true), Cone::around([square(9.0, false)].iter()));
        assert!(!group.apart_from(&floor) && group.apart_from(&floor.flipped()));
        let leaning = |angle: f64| Cone { angle, ..Cone::around([square(9.0, true)].iter()) };
        assert!(leaning(1.0).apart_from(&floor) && !leaning(1.5).apart_from(&floor));
    }

    #[test]
    fn the_distance_from_a_patch_is_not_overestimated() {
        let floor = square(0.0, true);
        let at =
            |x: f64, y: f64, z: f64| Cone { centre: Vec3::new(x, y, z), ..Cone::of(&floor) }.distance(&floor);
        assert!((at(0.5, -0.5, 2.0) - 2.0).abs() < 1e-12 && (at(5.0, 0.0, 3.0) - 5.0).abs() < 1e-12);
        assert!(at(5.0, 5.0, 3.0) <= 41f64.sqrt() && at(5.0, 5.0, 3.0) >= 5.0 - 1e-12);
    }

    #[test]
    fn a_group_of_all_directions_is_never_turned_away() {
        let both = [square(0.0, true), square(0.0, false)];
        assert!(!Cone::around(both.iter()).turned_away(&Cone::of(&square(9.0, false))));
    }
}
