//! Shared vertices of the leaves.
//!
//! Corners closer than 1e-9 of the mesh's diagonal become one vertex. Points are sorted into cubes
//! four times as wide, so that a corner is compared with the points of one to eight cubes. Vertices
//! are numbered in the order of the leaves and stand where the first corner stood. Metres.

use std::collections::HashMap;

use crate::{Bounds, Mesh, Vec3};

/// Distance, relative to the diagonal of the mesh, up to which corners are one vertex.
const TOLERANCE: f64 = 1e-9;
/// Width of the cubes over the tolerance.
const CUBE_WIDTH: f64 = 4.0;

/// Which corners at one place become one vertex.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Weld {
    /// All of them.
    Everywhere,
    /// Those of one surface whose normals are within this angle of that of the vertex's first leaf:
    /// for shading that is smooth over curved surfaces and keeps their edges.
    Smooth {
        /// Largest angle between normals, in degrees.
        degrees: f64,
    },
}

/// The leaves of a mesh over shared vertices, and without cracks between leaves of different size,
/// as long as these come from halving the same sides.
#[derive(Clone, Debug, PartialEq)]
pub struct Anchored {
    /// The leaves with their own corners.
    pub leaves: Welded,
    /// The same with the corners of smaller neighbours that lie on their sides: a side is one of
    /// two leaves, or of one on the border.
    pub polygons: Welded,
    /// Vertices in the middle of sides, those of the longest sides first.
    pub hanging: Vec<Hanging>,
}

/// A vertex in the middle of a side of a larger leaf.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Hanging {
    /// The vertex.
    pub vertex: usize,
    /// The ends of the side, or of the part of it that it halves.
    pub ends: [usize; 2],
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
        let (points, corners, ends) = self.points(weld);
        Welded { vertices: points.vertices, corners, ends }
    }

    /// Welds the corners of all leaves, and finds those that lie on sides of larger leaves.
    #[must_use]
    pub fn anchored(&self, weld: Weld) -> Anchored {
        let (points, own, own_ends) = self.points(weld);
        let (mut corners, mut ends, mut hanging) =
            (Vec::new(), Vec::with_capacity(own_ends.len()), Vec::new());
        let mut start = 0;
        for (leaf, &end) in own_ends.iter().enumerate() {
            let patch = &own[start..end];
            start = end;
            for (k, &from) in patch.iter().enumerate() {
                let joins = |first: usize| self.joins(weld, first, leaf);
                corners.push(from);
                points.between([from, patch[(k + 1) % patch.len()]], &joins, &mut corners, &mut hanging);
            }
            ends.push(corners.len());
        }
        let length = |h: &Hanging| points.vertices[h.ends[0]].distance(points.vertices[h.ends[1]]);
        hanging.sort_by(|a, b| length(b).total_cmp(&length(a)).then(a.vertex.cmp(&b.vertex)));
        let polygons = Welded { vertices: points.vertices.clone(), corners, ends };
        Anchored {
            leaves: Welded { vertices: points.vertices, corners: own, ends: own_ends },
            polygons,
            hanging,
        }
    }

    /// Vertices, those of the corners of all leaves, and where the leaves end among them.
    fn points(&self, weld: Weld) -> (Points, Vec<usize>, Vec<usize>) {
        let mut points = Points::new(self.bounds());
        let mut corners = Vec::new();
        let mut ends = Vec::with_capacity(self.len());
        for (leaf, patch) in self.patches().enumerate() {
            let joins = |first: usize| self.joins(weld, first, leaf);
            corners.extend(patch.corners().iter().map(|&corner| points.vertex(corner, leaf, joins)));
            ends.push(corners.len());
        }
        (points, corners, ends)
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

/// Vertices, found by their position. The map is only ever asked for a cube, so that its order
/// plays no part.
pub(crate) struct Points {
    origin: Vec3,
    /// m.
    pub tolerance: f64,
    cubes: HashMap<[i64; 3], Vec<usize>>,
    pub vertices: Vec<Vec3>,
    /// The leaf that each vertex was made for.
    leaves: Vec<usize>,
}

impl Points {
    /// For points within some bounds.
    pub fn new(bounds: Option<Bounds>) -> Self {
        let origin = bounds.map_or(Vec3::ZERO, |bounds| bounds.min);
        let tolerance = TOLERANCE * bounds.map_or(1.0, |bounds| bounds.diagonal());
        Self { origin, tolerance, cubes: HashMap::new(), vertices: Vec::new(), leaves: Vec::new() }
    }

    /// The vertex at a place, which is made where there is none that may be joined.
    pub fn vertex(&mut self, point: Vec3, leaf: usize, joins: impl Fn(usize) -> bool) -> usize {
        self.find(point, joins).unwrap_or_else(|| {
            self.cubes.entry(self.cube(point)).or_default().push(self.vertices.len());
            self.vertices.push(point);
            self.leaves.push(leaf);
            self.vertices.len() - 1
        })
    }

    /// Appends the vertices between two ends of a side: the one in the middle, where there is one,
    /// and those of both halves.
    fn between(
        &self,
        [a, b]: [usize; 2],
        joins: &impl Fn(usize) -> bool,
        corners: &mut Vec<usize>,
        hanging: &mut Vec<Hanging>,
    ) {
        let middle = 0.5 * (self.vertices[a] + self.vertices[b]);
        let inner = self.find(middle, joins).filter(|&vertex| vertex != a && vertex != b);
        let Some(vertex) = inner else { return };
        hanging.push(Hanging { vertex, ends: [a, b] });
        self.between([a, vertex], joins, corners, hanging);
        corners.push(vertex);
        self.between([vertex, b], joins, corners, hanging);
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
        ((point - self.origin) / (CUBE_WIDTH * self.tolerance)).floor().as_i64vec3().to_array()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{MeshBuilder, Patch};
    use std::collections::BTreeMap;

    /// Leaves of a patch split where a rule says so, up to some depth.
    fn split(patch: Patch, depth: usize, wanted: &impl Fn(&Patch) -> bool, leaves: &mut Vec<Patch>) {
        if depth == 0 || !wanted(&patch) {
            leaves.push(patch);
        } else {
            patch.split().unwrap().into_iter().for_each(|part| split(part, depth - 1, wanted, leaves));
        }
    }

    /// Two squares and a triangle side by side, split towards a point.
    fn uneven() -> Mesh {
        let v = |x: f64, y: f64| Vec3::new(x, y, 0.3 * x);
        let square =
            |x: f64| Patch::quad([v(x, 0.), v(x + 1., 0.), v(x + 1., 1.), v(x, 1.)]).unwrap().unwrap();
        let near = |patch: &Patch| patch.centroid().distance(v(0.9, 0.33)) < 1.1 * patch.diameter();
        let mut builder = MeshBuilder::default();
        builder.surface("floor", 0);
        for whole in [square(0.0), square(1.0), Patch::triangle([v(2., 0.), v(3., 0.), v(2., 1.)]).unwrap()] {
            let mut leaves = Vec::new();
            split(whole, 6, &near, &mut leaves);
            builder.face(&leaves).unwrap();
        }
        builder.build()
    }

    /// How many leaves have each side.
    fn sides(welded: &Welded) -> BTreeMap<[usize; 2], usize> {
        let mut sides = BTreeMap::new();
        for patch in welded.patches() {
            for (k, &a) in patch.iter().enumerate() {
                let b = patch[(k + 1) % patch.len()];
                *sides.entry([a.min(b), a.max(b)]).or_default() += 1;
            }
        }
        sides
    }

    /// Whether a point lies on the outline of the three faces.
    fn outer(p: Vec3) -> bool {
        let on = |d: f64| d.abs() < 1e-9;
        on(p.x) || on(p.y) || (p.x < 2.0 && on(p.y - 1.0)) || on(p.x + p.y - 3.0)
    }

    #[test]
    fn every_inner_side_is_shared_by_two_leaves() {
        let mesh = uneven();
        let Anchored { polygons: welded, hanging, .. } = mesh.anchored(Weld::Everywhere);
        assert!(hanging.len() > 20 && welded.len() == mesh.len());
        for ([a, b], count) in sides(&welded) {
            let middle = 0.5 * (welded.vertices[a] + welded.vertices[b]);
            assert_eq!(count, if outer(middle) { 1 } else { 2 }, "{middle}");
        }
        let plain = sides(&mesh.welded(Weld::Everywhere));
        assert!(plain.len() != sides(&welded).len(), "there were junctions to be mended");
    }

    #[test]
    fn hanging_vertices_halve_their_sides_and_depend_on_those_before() {
        let Anchored { leaves: welded, hanging, .. } = uneven().anchored(Weld::Everywhere);
        for (k, h) in hanging.iter().enumerate() {
            let [a, b] = h.ends.map(|end| welded.vertices[end]);
            assert!(welded.vertices[h.vertex].distance(0.5 * (a + b)) < 1e-12);
            let later = hanging[k..].iter().any(|other| h.ends.contains(&other.vertex));
            assert!(!later, "an end is settled before");
        }
    }

    #[test]
    fn an_even_mesh_has_nothing_to_anchor() {
        let mut builder = MeshBuilder::default();
        builder.surface("floor", 0);
        let v = |x: f64, y: f64| Vec3::new(x, y, 0.0);
        let whole = Patch::quad([v(0., 0.), v(1., 0.), v(1., 1.), v(0., 1.)]).unwrap().unwrap();
        builder.face(&whole.split().unwrap()).unwrap();
        let mesh = builder.build();
        let Anchored { polygons, hanging, .. } = mesh.anchored(Weld::Everywhere);
        assert!(hanging.is_empty() && polygons == mesh.welded(Weld::Everywhere));
    }
}
