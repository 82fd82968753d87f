//! Shapes a scene is made of.
//!
//! Lengths in metres. A shape is cut into faces and elements as a [`Cutting`](crate::Cutting) says.

use crate::solid::Solid;
use crate::{Cutting, MeshError, Patch, Vec3};

/// A piece of surface, before it is cut. Lengths in metres.
///
/// Curved shapes are polyhedra of flat facets. Their corners are moved outwards a little so that
/// the facets together have exactly the area of the true shape (for a cylinder with caps: side and
/// caps together). Power is area times exitance, so that a curved lamp emits the power it should;
/// volume and cross-section are met only in the limit of many segments.
#[derive(Clone, Debug, PartialEq)]
pub enum Shape {
    /// Four corners, counter-clockwise seen from the lit side.
    ///
    /// u runs from corner 0 to corner 1, v from corner 0 to corner 3. Cell (i, j) of M × N is face
    /// i N + j: j, along v, runs fastest. Cells in `skip` are left out and later faces move up.
    ///
    /// Corners that are not coplanar span the bilinear surface through them, sampled where the
    /// lines cross: each cell is then one face of two triangles. A quad that is not convex is two
    /// triangles too, and cannot be cut by lines.
    Quad {
        /// Corners, m.
        corners: [Vec3; 4],
        /// Cells (i along u, j along v) that are left out.
        skip: Vec<[usize; 2]>,
    },
    /// Three corners, counter-clockwise seen from the lit side.
    Triangle {
        /// Corners, m.
        corners: [Vec3; 3],
    },
    /// A flat polygon, not necessarily convex, with holes. It is lit where its outline runs
    /// counter-clockwise.
    ///
    /// Left [`Whole`](crate::Lines::Whole) it is one face of several triangles; otherwise each
    /// triangle of its constrained Delaunay triangulation is cut alike.
    Polygon {
        /// Corners of the border, m.
        outline: Vec<Vec3>,
        /// Corners of each hole, m, either way round.
        holes: Vec<Vec<Vec3>>,
    },
    /// A box with its sides along the axes: six quads in the order −x, +x, −y, +y, −z, +z. On the
    /// +x side u runs along y and v along z, on the −x side the other way round, and so on
    /// cyclically.
    Box {
        /// Corner of least coordinates, m.
        min: Vec3,
        /// Corner of largest coordinates, m.
        max: Vec3,
        /// Lit inside instead of outside.
        inward: bool,
    },
    /// A sphere: an icosahedron whose triangles are divided evenly and pushed out to the sphere.
    Sphere {
        /// Centre, m.
        centre: Vec3,
        /// Radius, m.
        radius: f64,
        /// Lit inside instead of outside.
        inward: bool,
        /// Edges around, at least 3; rounded up to a multiple of five.
        segments: usize,
    },
    /// A disc: rings of triangles.
    Disc {
        /// Centre, m.
        centre: Vec3,
        /// Direction of the lit side, of any length.
        normal: Vec3,
        /// Radius, m.
        radius: f64,
        /// Edges around, at least 3.
        segments: usize,
    },
    /// A cylinder: one quad a segment (u around, v along the axis), then the triangles of the caps.
    Cylinder {
        /// Centre of the base, m.
        base: Vec3,
        /// From the centre of the base to the centre of the top, m.
        axis: Vec3,
        /// Radius, m.
        radius: f64,
        /// Whether base and top are closed by discs.
        caps: bool,
        /// Lit inside instead of outside.
        inward: bool,
        /// Edges around, at least 3.
        segments: usize,
    },
}

impl Shape {
    /// Number of elements that the shape would be cut into: exactly what
    /// [`MeshBuilder::add`](crate::MeshBuilder::add) creates, found without creating them. Memory
    /// is taken for the triangles of a polygon only.
    ///
    /// ```
    /// use fredholm_mesh::{Cutting, Lines, Shape, Vec3};
    ///
    /// let corners = [Vec3::ZERO, Vec3::X, Vec3::X + Vec3::Y, Vec3::Y];
    /// let micrometres = Cutting { lines: Lines::LargestEdge(1e-6), ..Cutting::default() };
    /// assert_eq!(Shape::Quad { corners, skip: vec![] }.count(&micrometres), Ok(1_000_000_000_000));
    /// ```
    ///
    /// # Errors
    /// Any [`MeshError`] for a shape that encloses no area or crosses itself, or lines that do not
    /// fit it; [`MeshError::TooLarge`] where the number has more than 128 bits.
    pub fn count(&self, cutting: &Cutting) -> Result<u128, MeshError> {
        Solid::new(self)?.count(cutting)
    }

    /// The undivided flat pieces of the shape that [`MeshBuilder::add`](crate::MeshBuilder::add)
    /// makes occluders, whatever side the cutting says is lit: as few polygons as possible, lit as
    /// the shape is.
    ///
    /// # Errors
    /// Those of [`Self::count`].
    pub fn blockers(&self, cutting: &Cutting) -> Result<Vec<Patch>, MeshError> {
        let solid = Solid::new(self)?;
        let blockers = solid.blockers(&solid.facets()?, &cutting.lines)?;
        Ok(if self.is_inward() { blockers.iter().map(Patch::flipped).collect() } else { blockers })
    }

    /// Whether it is lit on the inside.
    pub(crate) fn is_inward(&self) -> bool {
        match self {
            Self::Box { inward, .. } | Self::Sphere { inward, .. } | Self::Cylinder { inward, .. } => *inward,
            Self::Quad { .. } | Self::Triangle { .. } | Self::Polygon { .. } | Self::Disc { .. } => false,
        }
    }
}
