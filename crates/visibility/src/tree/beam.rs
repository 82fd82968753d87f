//! Which boxes of a node does a segment meet?
//!
//! Along o + t d a slab between two planes of one axis is met for t between (near − o)/d and (far − o)/d; a box is met
//! where the largest entry is not past the smallest exit.
//!
//! With all coordinates in [−1, 1] the rounding of o and d moves the segment by less than ε/2 and that of the
//! three operations moves a plane by less than 3 ε, together less than half of the padding of the boxes (ε = 2⁻²³).

use glam::Vec4;

use super::{Node, PADDING, VECTORS};
use crate::frame::Frame;
use crate::probe::Probe;
use fredholm_mesh::Vec3;

/// Largest coordinate of a beam; where a segment reaches farther, it is first cut to the scene.
const LIMIT: f64 = 1.0;
/// A component of a direction that is smaller than this is replaced by it: that keeps every quotient finite, and
/// moves the segment by less than any rounding.
const LEAST: f32 = 1e-20;

/// A segment in the coordinates of the boxes.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Beam {
    origin: [Vec4; 3],
    inverse: [Vec4; 3],
    near: [usize; 3],
    /// Largest t, from 0 to 1 on the whole beam.
    end: Vec4,
    /// Where the beam starts and what share of the probe it covers: t = 0 is the fraction `part[0]` of the probe, and
    /// t = 1 is `part[0] + part[1]`.
    part: [f64; 2],
}

impl Beam {
    /// The part of the segment that can meet a box, or `None` where there is no such part.
    #[inline]
    pub(crate) fn new(probe: &Probe, frame: &Frame) -> Option<Self> {
        let (p, q) = (probe.p, probe.q);
        if within(p) && within(q) { Some(Self::between(p, q, [0.0, 1.0])) } else { Self::inside(p, q, frame) }
    }

    /// The part inside the bounding box of the scene.
    #[cold]
    fn inside(p: Vec3, q: Vec3, frame: &Frame) -> Option<Self> {
        let half = frame.half + 4.0 * f64::from(PADDING);
        let [enter, leave] = cut(p, q, half)?;
        let at = |fraction: f64| p + (q - p) * fraction;
        Some(Self::between(at(enter), at(leave), [enter, leave - enter]))
    }

    #[inline]
    fn between(p: Vec3, q: Vec3, part: [f64; 2]) -> Self {
        let (o, q) = (p.as_vec3(), q.as_vec3());
        let d = (q - o).to_array().map(|c| if c.abs() < LEAST { LEAST } else { c });
        Self {
            origin: o.to_array().map(Vec4::splat),
            inverse: d.map(|c| Vec4::splat(1.0 / c)),
            near: d.map(|c| usize::from(c < 0.0)),
            end: Vec4::ONE,
            part,
        }
    }

    /// The beam up to a fraction of the probe, or a little farther.
    pub(crate) fn up_to(self, fraction: f64) -> Self {
        let t = ((fraction - self.part[0]) / self.part[1]) as f32;
        Self { end: Vec4::splat(t.max(0.0) + f32::EPSILON).min(Vec4::ONE), ..self }
    }

    /// Whether the beam goes on to t.
    pub(crate) fn reaches(&self, t: f32) -> bool {
        t <= self.end.x
    }

    /// Bit i is set where box i is met.
    #[inline]
    pub(crate) fn meets(&self, node: &Node) -> u32 {
        let mut met = 0;
        for i in 0..VECTORS {
            let (enter, leave) = self.slabs(node, i);
            met |= enter.cmple(leave).bitmask() << (4 * i);
        }
        met
    }

    /// Where the boxes of group `i` are entered and left.
    #[inline]
    pub(crate) fn slabs(&self, node: &Node, i: usize) -> (Vec4, Vec4) {
        let (mut enter, mut leave) = (Vec4::ZERO, self.end);
        for axis in 0..3 {
            let near = self.near[axis] & 1;
            let planes = &node.planes[axis];
            enter = ((planes[near][i] - self.origin[axis]) * self.inverse[axis]).max(enter);
            leave = ((planes[1 - near][i] - self.origin[axis]) * self.inverse[axis]).min(leave);
        }
        (enter, leave)
    }
}

#[inline]
fn within(p: Vec3) -> bool {
    (p.x.abs() <= LIMIT) & (p.y.abs() <= LIMIT) & (p.z.abs() <= LIMIT)
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
