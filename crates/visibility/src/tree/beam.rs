//! Which boxes of a node does a segment meet?
//!
//! Along o + t d a slab between two planes of one axis is met for t between (near − o)/d and (far −
//! o)/d; a box is met where the largest entry is not past the smallest exit.
//!
//! With o and the planes c in [−1, 1] the rounding of o moves the segment by less than ε/2, and
//! that of d by less than ε within the scene; c/d − o/d with each quotient rounded moves a plane by
//! less than 3 ε more, together less than the padding of the boxes (ε = 2⁻²³).

#![allow(clippy::inline_always, reason = "what is not inlined is compiled for the narrowest vectors")]

use super::{Node, PADDING};
use crate::eight::Eight;
use crate::frame::Frame;
use crate::probe::Probe;
use fredholm_mesh::Vec3;

/// Largest coordinates of the start and of the end of a beam; a segment that reaches farther is
/// first cut to the scene.
const LARGEST_COORDINATES: [f64; 2] = [1.0, 1e6];
/// A component of a direction that is smaller than this is replaced by it: that keeps every
/// quotient finite, and moves the segment by less than any rounding.
const LEAST_COMPONENT: f32 = 1e-20;

/// A segment in the coordinates of the boxes.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Beam {
    origin: [f32; 3],
    inverse: [f32; 3],
    /// Where the beam starts and what share of the probe it covers: t = 0 is the fraction `part[0]`
    /// of the probe, and t = 1 is `part[0] + part[1]`.
    part: [f64; 2],
}

/// A beam in the lanes of vectors.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Splat<E: Eight> {
    /// Over d: −o.
    origin: [E::Vector; 3],
    inverse: [E::Vector; 3],
    /// 1 where d is negative.
    near: [usize; 3],
    zero: E::Vector,
    /// Largest t, from 0 to 1 on the whole beam.
    end: f32,
    ends: E::Vector,
}

impl Beam {
    /// The part of the segment that can meet a box, or `None` where there is no such part.
    #[inline(always)]
    pub(crate) fn new(probe: &Probe, frame: &Frame) -> Option<Self> {
        let (p, q) = (probe.p, probe.q);
        if within(p, LARGEST_COORDINATES[0]) && within(q, LARGEST_COORDINATES[1]) {
            Some(Self::between(p, q, [0.0, 1.0]))
        } else {
            Self::inside(p, q, frame)
        }
    }

    /// The part inside the bounding box of the scene.
    #[cold]
    fn inside(p: Vec3, q: Vec3, frame: &Frame) -> Option<Self> {
        let half = frame.half + 4.0 * f64::from(PADDING);
        let [enter, leave] = cut(p, q, half)?;
        let at = |fraction: f64| p + (q - p) * fraction;
        Some(Self::between(at(enter), at(leave), [enter, leave - enter]))
    }

    #[inline(always)]
    fn between(p: Vec3, q: Vec3, part: [f64; 2]) -> Self {
        let d =
            (q - p).as_vec3().to_array().map(|c| if c.abs() < LEAST_COMPONENT { LEAST_COMPONENT } else { c });
        Self { origin: p.as_vec3().to_array(), inverse: d.map(|c| 1.0 / c), part }
    }

    /// The place on the beam of a fraction of the probe, or a little farther.
    #[inline(always)]
    pub(crate) fn place(&self, fraction: f64) -> f32 {
        let t = ((fraction - self.part[0]) / self.part[1]) as f32;
        (t.max(0.0) + f32::EPSILON).min(1.0)
    }

    #[inline(always)]
    pub(crate) fn splat<E: Eight>(&self, eight: E) -> Splat<E> {
        let ([o_x, o_y, o_z], [x, y, z]) = (self.origin, self.inverse);
        Splat {
            origin: [eight.splat(-o_x * x), eight.splat(-o_y * y), eight.splat(-o_z * z)],
            inverse: [eight.splat(x), eight.splat(y), eight.splat(z)],
            near: [usize::from(x < 0.0), usize::from(y < 0.0), usize::from(z < 0.0)],
            zero: eight.splat(0.0),
            end: 1.0,
            ends: eight.splat(1.0),
        }
    }
}

impl<E: Eight> Splat<E> {
    /// Whether the beam goes on to t.
    #[inline(always)]
    pub(crate) fn reaches(&self, t: f32) -> bool {
        t <= self.end
    }

    /// Ends the beam at t, where it goes on so far.
    #[inline(always)]
    pub(crate) fn shorten(&mut self, eight: E, t: f32) {
        if t < self.end {
            self.end = t;
            self.ends = eight.splat(t);
        }
    }

    /// Bit i is set where box i is met.
    #[inline(always)]
    pub(crate) fn meets(&self, eight: E, node: &Node) -> u32 {
        let (enter, leave) = self.slabs(eight, node);
        eight.at_most(enter, leave)
    }

    /// Where the boxes are entered and left.
    #[inline(always)]
    pub(crate) fn slabs(&self, eight: E, node: &Node) -> (E::Vector, E::Vector) {
        let (mut enter, mut leave) = (self.zero, self.ends);
        for axis in 0..3 {
            let near = self.near[axis] & 1;
            let (inverse, origin) = (self.inverse[axis], self.origin[axis]);
            let planes = &node.planes[axis];
            enter = eight.max(eight.mul_add(eight.load(&planes[near]), inverse, origin), enter);
            leave = eight.min(eight.mul_add(eight.load(&planes[1 - near]), inverse, origin), leave);
        }
        (enter, leave)
    }
}

#[inline(always)]
fn within(p: Vec3, limit: f64) -> bool {
    (p.x.abs() <= limit) & (p.y.abs() <= limit) & (p.z.abs() <= limit)
}

/// The fractions between which the segment lies inside the box from −half to half.
fn cut(p: Vec3, q: Vec3, half: Vec3) -> Option<[f64; 2]> {
    let d = q - p;
    let (mut enter, mut leave) = (0.0f64, 1.0f64);
    for axis in 0..3 {
        let (low, high) = (-half[axis] - p[axis], half[axis] - p[axis]);
        if d[axis] != 0.0 {
            let (a, b) = (low / d[axis], high / d[axis]);
            (enter, leave) = (enter.max(a.min(b)), leave.min(a.max(b)));
        } else if low > 0.0 || high < 0.0 {
            return None;
        }
    }
    (enter <= leave).then_some([enter, leave])
}
