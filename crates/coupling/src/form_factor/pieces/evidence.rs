//! Which critical lines are active, as far as the points of a rule tell: a line is active if the
//! topology of the shadow differs on its two sides.
//!
//! A line may also pass between the points and the border of a part. No sample lies beyond such a
//! line: its state is unknown.

use super::EQUAL_ERROR_TOLERANCE;
use crate::form_factor::critical::Plane;
use crate::form_factor::shadow::Topology;
use fredholm_mesh::Vec3;

/// What is known of a line that cuts a part.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Line {
    /// Points of one topology on both sides.
    Silent,
    /// The topologies on one side are others than those on the other.
    Active,
    /// No point on one side.
    Unseen,
}

/// Points on a part with h there and their topologies.
#[derive(Clone, Debug, Default)]
pub(super) struct Points {
    pub places: Vec<Vec3>,
    pub found: Vec<(f64, Topology)>,
    /// The topologies that occur, and which of them each point has, as a bit.
    topologies: Vec<Topology>,
    bits: Vec<u64>,
}

impl Points {
    pub(super) fn clear(&mut self) {
        self.places.clear();
        self.found.clear();
        self.topologies.clear();
        self.bits.clear();
    }

    /// Asks for h at the points that are new, and sorts them by topology. Beyond 64 topologies the
    /// rest counts as one.
    pub(super) fn ask(&mut self, h: &mut impl FnMut(&[Vec3], &mut Vec<(f64, Topology)>)) {
        h(&self.places[self.found.len()..], &mut self.found);
        for (_, topology) in &self.found[self.bits.len()..] {
            let known = self.topologies.iter().position(|k| k == topology);
            let place = known.unwrap_or(self.topologies.len());
            if known.is_none() {
                self.topologies.push(*topology);
            }
            self.bits.push(1 << place.min(63));
        }
    }

    /// Leaves out the topologies of points at heights of at most `flat` over one of the lines:
    /// rounding decides about them.
    pub(super) fn leave_out(&mut self, lines: &[(Plane, f64)], flat: f64) {
        for (x, bit) in self.places.iter().zip(&mut self.bits) {
            if lines.iter().any(|((n, c), _)| (n.dot(*x) - c).abs() <= flat) {
                *bit = 0;
            }
        }
    }

    /// The topology of all points, if it is one.
    pub(super) fn topology(&self) -> Option<Topology> {
        let all = self.bits.iter().fold(0, |all, bit| all | bit);
        all.is_power_of_two().then(|| self.topologies[all.trailing_zeros() as usize])
    }

    /// Largest less least h.
    pub(super) fn range(&self) -> f64 {
        let each = |[low, high]: [f64; 2], (h, _): &(f64, Topology)| [low.min(*h), high.max(*h)];
        let [low, high] = self.found.iter().fold([f64::INFINITY, f64::NEG_INFINITY], each);
        high - low
    }

    /// The largest value at the points of a function that is not negative.
    pub(super) fn largest(&self, f: impl Fn(Vec3) -> f64) -> f64 {
        self.places.iter().map(|&x| f(x)).fold(0.0, f64::max)
    }

    /// What the points tell about a line.
    pub(super) fn judge(&self, (n, c): Plane) -> Line {
        let (mut above, mut below) = (0, 0);
        for (x, bit) in self.places.iter().zip(&self.bits) {
            let side = if n.dot(*x) > c { &mut above } else { &mut below };
            *side |= bit;
        }
        if above == 0 || below == 0 {
            Line::Unseen
        } else if above & below == 0 {
            Line::Active
        } else {
            Line::Silent
        }
    }

    /// Largest difference of h at the last point from h at the nearest others.
    pub(super) fn jump(&self) -> f64 {
        let last = self.places.len() - 1;
        let distances = || self.places[..last].iter().map(|x| x.distance(self.places[last]));
        let nearest = distances().fold(f64::INFINITY, f64::min) * (1.0 + EQUAL_ERROR_TOLERANCE);
        let near = distances().zip(&self.found).filter(|(distance, _)| *distance <= nearest);
        near.map(|(_, (h, _))| (h - self.found[last].0).abs()).fold(0.0, f64::max)
    }
}
