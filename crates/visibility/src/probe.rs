//! A segment on its way through the scene.

use fredholm_mesh::Vec3;
use glam::Vec4;

use crate::frame::Frame;

/// A segment from p to q, with what the tests of all facets share. Local coordinates, but for the
/// ends.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Probe {
    /// The ends as they were given, m.
    pub ends: [Vec3; 2],
    /// Start.
    pub p: Vec3,
    /// End.
    pub q: Vec3,
    /// The x, y and z of p and q.
    pub axes: [[f64; 2]; 3],
    /// The same in f32, twice over.
    pub lanes: [Vec4; 3],
    /// Heights over a plane up to which p and q belong to it.
    pub near: [f64; 2],
    /// A length that bounds all distances between p, q and the occluders.
    pub reach: f32,
}

impl Probe {
    /// The open segment from p to q, or `None` where an end is not a place.
    #[inline]
    pub(crate) fn segment(p: Vec3, q: Vec3, frame: &Frame) -> Option<Self> {
        Self::new([p, q], [frame.tolerance; 2], frame)
    }

    /// A ray that starts at p and goes on to q. Unlike a segment it meets what lies close to q.
    pub(crate) fn ray(p: Vec3, q: Vec3, frame: &Frame) -> Option<Self> {
        Self::new([p, q], [frame.tolerance, 0.0], frame)
    }

    #[inline]
    fn new(ends: [Vec3; 2], near: [f64; 2], frame: &Frame) -> Option<Self> {
        let [p, q] = ends.map(|end| frame.local(end));
        let sum = p.abs() + q.abs() + frame.half;
        let reach = (sum.x + sum.y + sum.z) as f32;
        let axes = [[p.x, q.x], [p.y, q.y], [p.z, q.z]];
        let lanes = axes.map(|[p, q]| Vec4::new(p as f32, q as f32, p as f32, q as f32));
        reach.is_finite().then_some(Self { ends, p, q, axes, lanes, near, reach })
    }
}
