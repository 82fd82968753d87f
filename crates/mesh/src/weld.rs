//! Shared vertices of the leaves.
//!
//! Corners closer than 1e-9 of the mesh's diagonal become one vertex. Points are sorted into cubes four times as wide,
//! so that a corner is compared with the points of one to eight cubes. Vertices are numbered in the order of the leaves
//! and stand where the first corner stood. Metres.

use std::collections::HashMap;

use crate::{Mesh, Vec3};

/// Distance, relative to the diagonal of the mesh, up to which corners are one vertex.
const TOLERANCE: f64 = 1e-9;
/// Width of the cubes over the tolerance.
const CUBE: f64 = 4.0;

/// Which corners at one place become one vertex.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Weld {
    /// All of them.
    Everywhere,
    /// Those of one surface whose normals are within this angle of that of the vertex's first leaf: for shading that is
    /// smooth over curved surfaces and keeps their edges.
    Smooth {
        /// Largest angle between normals, in degrees.
        degrees: f64,
    },
}

/// The leaves of a mesh as polygons over shared vertices.
#[derive(Clone, Debug, PartialEq)]
pub struct Welded {
    /// Positions, m.
    pub vertices: Vec<Vec3>,
    corners: Vec<usize>,
    ends: Vec<usize>,
}

impl Welded {
    /// Number of patches: one for each leaf.
    #[must_use]
    pub fn len(&self) -> usize {
        self.ends.len()
    }

    /// Whether there is no patch.
    #[must_use]
    pub fn is_empty(&self) -> bool {
        self.ends.is_empty()
    }

    /// The vertices of a leaf, counter-clockwise seen from its lit side.
    ///
    /// # Panics
    /// Like a slice, where the mesh had no such leaf.
    #[must_use]
    pub fn patch(&self, leaf: usize) -> &[usize] {
        let start = leaf.checked_sub(1).map_or(0, |before| self.ends[before]);
        &self.corners[start..self.ends[leaf]]
    }

    /// The vertices of every leaf, in order.
    #[must_use]
    pub fn patches(&self) -> impl ExactSizeIterator<Item = &[usize]> {
        (0..self.len()).map(|leaf| self.patch(leaf))
    }
}

impl Mesh {
    /// Welds the corners of all leaves.
    ///
    /// ```
    /// use fredholm_mesh::{Cutting, MeshBuilder, Shape, Vec3, Weld};
    ///
    /// let mut builder = MeshBuilder::default();
    /// builder.surface("box", 0);
    /// let shape = Shape::Box { min: Vec3::ZERO, max: Vec3::ONE, inward: false };
    /// builder.add(&shape, &Cutting::default())?;
    /// let mesh = builder.build();
    /// assert_eq!(mesh.welded(Weld::Everywhere).vertices.len(), 8);
    /// assert_eq!(mesh.welded(Weld::Smooth { degrees: 30.0 }).vertices.len(), 24);
    /// # Ok::<(), fredholm_mesh::MeshError>(())
    /// ```
    #[must_use]
    pub fn welded(&self, weld: Weld) -> Welded {
        let mut points = Points::new(self);
        let mut corners = Vec::new();
        let mut ends = Vec::with_capacity(self.len());
        for (leaf, patch) in self.patches().enumerate() {
            let joins = |first: usize| self.joins(weld, first, leaf);
            corners.extend(patch.corners().iter().map(|&corner| points.vertex(corner, leaf, joins)));
            ends.push(corners.len());
        }
        Welded { vertices: points.vertices, corners, ends }
    }

    fn joins(&self, weld: Weld, first: usize, leaf: usize) -> bool {
        match weld {
            Weld::Everywhere => true,
            Weld::Smooth { degrees } => {
                let cosine = self.patch(first).normal().dot(self.patch(leaf).normal());
                self.surface_of(first) == self.surface_of(leaf) && cosine >= degrees.to_radians().cos()
            }
        }
    }
}

/// Vertices, found by their position. The map is only ever asked for a cube, so that its order plays no part.
struct Points {
    origin: Vec3,
    tolerance: f64,
    cubes: HashMap<[i64; 3], Vec<usize>>,
    vertices: Vec<Vec3>,
    /// The leaf that each vertex was made for.
    leaves: Vec<usize>,
}

impl Points {
    fn new(mesh: &Mesh) -> Self {
        let bounds = mesh.bounds();
        let origin = bounds.map_or(Vec3::ZERO, |bounds| bounds.min);
        let tolerance = TOLERANCE * bounds.map_or(1.0, |bounds| bounds.diagonal());
        Self { origin, tolerance, cubes: HashMap::new(), vertices: Vec::new(), leaves: Vec::new() }
    }

    fn vertex(&mut self, point: Vec3, leaf: usize, joins: impl Fn(usize) -> bool) -> usize {
        self.find(point, joins).unwrap_or_else(|| {
            self.cubes.entry(self.cube(point)).or_default().push(self.vertices.len());
            self.vertices.push(point);
            self.leaves.push(leaf);
            self.vertices.len() - 1
        })
    }

    /// The first vertex within the tolerance that may be joined.
    fn find(&self, point: Vec3, joins: impl Fn(usize) -> bool) -> Option<usize> {
        let (low, high) = (self.cube(point - self.tolerance), self.cube(point + self.tolerance));
        let fits = |&&vertex: &&usize| {
            self.vertices[vertex].distance(point) <= self.tolerance && joins(self.leaves[vertex])
        };
        let mut found: Option<usize> = None;
        for x in low[0]..=high[0] {
            for y in low[1]..=high[1] {
                for z in low[2]..=high[2] {
                    let inside = self.cubes.get(&[x, y, z]).into_iter().flatten();
                    found = inside.filter(fits).copied().chain(found).min();
                }
            }
        }
        found
    }

    fn cube(&self, point: Vec3) -> [i64; 3] {
        ((point - self.origin) / (CUBE * self.tolerance)).floor().as_i64vec3().to_array()
    }
}
