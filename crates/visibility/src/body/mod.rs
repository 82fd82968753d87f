//! Convex bodies that block the view, and the shadow that one casts from a point.
//!
//! Seen from a point x, the shadow of a convex body is the volume within its outline, {y : m_k·(y −
//! x) ≥ 0} with m_k = (a − x) × (b − x) for the edges a b of the outline, and behind the faces that
//! look at x. An edge is on the outline where one of its two faces looks at x and the other does
//! not. A flat polygon is a body with two faces. Lengths in metres.

mod bodies;
mod clip;
mod coplanar;
mod outline;
mod screen;
mod solid;
mod weld;

use fredholm_mesh::Vec3;

use crate::frame::Frame;
pub use bodies::Bodies;
pub use outline::{Shadow, ShadowVolume};
pub use screen::{Looking, Screen, SilhouetteEdge};

/// A plane n·x = c with a unit normal.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Face {
    /// Unit normal, pointing out of the body.
    pub normal: Vec3,
    /// Offset c, m.
    pub offset: f64,
}

impl Face {
    /// The plane through a point.
    #[must_use]
    pub fn through(point: Vec3, normal: Vec3) -> Self {
        Self { normal, offset: normal.dot(point) }
    }

    /// Height of a point over the face, m: positive outside the body.
    #[must_use]
    #[inline]
    pub fn height(&self, x: Vec3) -> f64 {
        self.normal.dot(x) - self.offset
    }
}

/// An edge of a body, counter-clockwise round the first of its faces seen from outside.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Edge {
    /// Its ends, as places in [`Body::corners`].
    pub ends: [u32; 2],
    /// The two faces that meet, as places in [`Body::faces`].
    pub faces: [u32; 2],
}

/// A convex body: a flat polygon, or a solid.
#[derive(Clone, Debug)]
pub struct Body {
    corners: Vec<Vec3>,
    faces: Vec<Face>,
    edges: Vec<Edge>,
    /// Corners in the coordinates of the scene's frame.
    pub(crate) local: Vec<Vec3>,
    solid: bool,
}

impl Body {
    fn new(corners: Vec<Vec3>, faces: Vec<Face>, mut edges: Vec<Edge>, frame: &Frame) -> Self {
        let local = corners.iter().map(|&x| frame.local(x)).collect();
        let solid = faces.len() > 2;
        let middle = |edge: &Edge| place(edge.ends.iter().map(|&k| &corners[k as usize]));
        edges.sort_by(|a, b| middle(a).total_cmp(&middle(b)));
        Self { corners, faces, edges, local, solid }
    }

    /// A flat convex polygon, counter-clockwise about `normal`.
    fn flat(corners: Vec<Vec3>, normal: Vec3, frame: &Frame) -> Self {
        let n = corners.len() as u32;
        let up = Face::through(corners[0], normal);
        let down = Face { normal: -normal, offset: -up.offset };
        let edges = (0..n).map(|k| Edge { ends: [k, (k + 1) % n], faces: [0, 1] }).collect();
        Self::new(corners, vec![up, down], edges, frame)
    }

    /// The corners, m.
    #[must_use]
    #[inline]
    pub fn corners(&self) -> &[Vec3] {
        &self.corners
    }

    /// The planes of the faces: two opposite ones for a flat polygon.
    #[must_use]
    #[inline]
    pub fn faces(&self) -> &[Face] {
        &self.faces
    }

    /// The edges.
    #[must_use]
    #[inline]
    pub fn edges(&self) -> &[Edge] {
        &self.edges
    }

    /// A ball around the body in the coordinates of the scene's frame: its centre and its radius.
    fn ball(&self) -> (Vec3, f64) {
        let centre = self.local.iter().sum::<Vec3>() / self.local.len().max(1) as f64;
        let square = self.local.iter().map(|corner| corner.distance_squared(centre)).fold(0.0, f64::max);
        (centre, square.sqrt())
    }

    /// Area of face `k` of a solid, m².
    fn face_area(&self, k: usize) -> f64 {
        let doubled = self.edges.iter().map(|edge| {
            let [a, b] = self.ends(edge).map(|end| end - self.corners[0]);
            match edge.faces.map(|face| face as usize == k) {
                [true, _] => a.cross(b),
                [_, true] => b.cross(a),
                _ => Vec3::ZERO,
            }
        });
        0.5 * doubled.sum::<Vec3>().length()
    }

    /// Whether it encloses a volume.
    #[must_use]
    #[inline]
    pub fn is_solid(&self) -> bool {
        self.solid
    }

    /// The two ends of an edge, m.
    #[must_use]
    #[inline]
    pub fn ends(&self, edge: &Edge) -> [Vec3; 2] {
        edge.ends.map(|k| self.corners[k as usize])
    }
}

/// A direction along which parts of a scene have different places, whatever its design: an order
/// along it does not depend on numbers.
pub const GENERIC_DIRECTION: Vec3 = Vec3::new(0.573_1, 0.319_7, 0.754_5);

/// Where points lie in the mean along [`GENERIC_DIRECTION`], m: an order that the numbers of the
/// patches do not change.
fn place<'a>(points: impl ExactSizeIterator<Item = &'a Vec3>) -> f64 {
    let n = points.len() as f64;
    points.sum::<Vec3>().dot(GENERIC_DIRECTION) / n
}
