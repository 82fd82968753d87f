//! A segment on its way through the scene.
//!
//! Units: metres.

use fredholm_mesh::Vec3;

use crate::frame::Frame;

/// A segment from p to q, with what the tests of all facets share.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Probe {
    /// The ends as they were given.
    pub ends: [Vec3; 2],
    /// Start, relative to the centre of the scene.
    pub p: Vec3,
    /// End, relative to the centre of the scene.
    pub q: Vec3,
    /// The x, y and z of p and q.
    pub axes: [[f64; 2]; 3],
    /// Heights over a plane up to which p and q belong to it.
    pub near: [f64; 2],
    /// Square of a length that bounds all distances between p, q and the occluders, m².
    pub reach_squared: f64,
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
        let [p, q] = ends.map(|end| end - frame.centre);
        let reach = p.length_squared() + q.length_squared() + frame.half.length_squared();
        reach.is_finite().then_some(Self { ends, p, q, axes: [[p.x,q.x],[p.y,q.y],[p.z,q.z]], near, reach_squared: 4.0 * reach })
    }
}
