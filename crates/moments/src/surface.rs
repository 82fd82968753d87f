//! A surface of flat triangles with common vertices. Metres.

use crate::{MomentsError, Topology};
use fredholm_mesh::{Mesh, Vec3, Weld};
use std::collections::BTreeMap;

/// Area over the square of the longest side below which a triangle has none.
const LEAST_RELATIVE_AREA: f64 = 1e-12;

/// Triangles over common vertices: only vertices that are the same, not those that are at the same
/// place, join triangles to a surface that carries current from one to the other.
#[derive(Clone, Debug, PartialEq)]
pub struct Surface {
    vertices: Vec<Vec3>,
    triangles: Vec<[u32; 3]>,
}

impl Surface {
    /// Takes vertices (m) and the three vertices of every triangle, counter-clockwise seen from the
    /// side of its normal.
    ///
    /// # Errors
    /// [`MomentsError::Empty`], [`MomentsError::NoSuchVertex`], [`MomentsError::NotFinite`] and
    /// [`MomentsError::Degenerate`].
    pub fn new(vertices: Vec<Vec3>, triangles: Vec<[u32; 3]>) -> Result<Self, MomentsError> {
        if triangles.is_empty() {
            return Err(MomentsError::Empty);
        }
        if let Some(vertex) = vertices.iter().position(|vertex| !vertex.is_finite()) {
            return Err(MomentsError::NotFinite { vertex });
        }
        let surface = Self { vertices, triangles };
        (0..surface.triangles.len()).try_for_each(|triangle| surface.check(triangle))?;
        Ok(surface)
    }

    fn check(&self, triangle: usize) -> Result<(), MomentsError> {
        let corners = self.triangles[triangle];
        let vertices = self.vertices.len();
        if let Some(&vertex) = corners.iter().find(|&&vertex| vertex as usize >= vertices) {
            return Err(MomentsError::NoSuchVertex { triangle, vertex, vertices });
        }
        let [a, b, c] = self.corners(triangle);
        let longest = a.distance_squared(b).max(b.distance_squared(c)).max(c.distance_squared(a));
        // Written so that what overflows is refused.
        if self.area(triangle) > LEAST_RELATIVE_AREA * longest {
            Ok(())
        } else {
            Err(MomentsError::Degenerate { triangle })
        }
    }

    /// The leaves of a mesh, quadrilaterals cut along the shorter diagonal, those at the same place
    /// along the same, and corners at the same place joined.
    ///
    /// # Errors
    /// Those of [`Surface::new`].
    pub fn from_mesh(mesh: &Mesh) -> Result<Self, MomentsError> {
        let welded = mesh.welded(Weld::Everywhere);
        let mut triangles = Vec::new();
        let mut diagonals: BTreeMap<[usize; 4], [usize; 2]> = BTreeMap::new();
        for patch in welded.patches() {
            match *patch {
                [a, b, c, d] => {
                    let across = |i: usize, j: usize| welded.vertices[i].distance(welded.vertices[j]);
                    let mut sorted = [a, b, c, d];
                    sorted.sort_unstable();
                    let shorter = if across(a, c) <= across(b, d) { [a, c] } else { [b, d] };
                    let diagonal = *diagonals.entry(sorted).or_insert(shorter);
                    triangles.extend(if diagonal.contains(&a) {
                        [[a, b, c], [a, c, d]]
                    } else {
                        [[a, b, d], [b, c, d]]
                    });
                }
                [a, b, c] => triangles.push([a, b, c]),
                _ => {}
            }
        }
        let triangles = triangles.into_iter().map(|corners| corners.map(|vertex| vertex as u32)).collect();
        Self::new(welded.vertices, triangles)
    }

    /// Both surfaces together. They are joined nowhere; see [`Surface::welded`].
    ///
    /// # Errors
    /// [`MomentsError::NoSuchVertex`] for more vertices than can be counted.
    pub fn with(mut self, other: &Self) -> Result<Self, MomentsError> {
        let first = self.vertices.len() as u32;
        self.vertices.extend(&other.vertices);
        self.triangles.extend(other.triangles.iter().map(|corners| corners.map(|v| v.wrapping_add(first))));
        Self::new(self.vertices, self.triangles)
    }

    /// The surface with vertices closer to each other than `tolerance` (m) joined to the first of
    /// them: the cure for duplicate vertices.
    ///
    /// # Errors
    /// [`MomentsError::Degenerate`] where that closes a triangle.
    pub fn welded(&self, tolerance: f64) -> Result<Self, MomentsError> {
        let mut names: Vec<u32> = (0..self.vertices.len() as u32).collect();
        for [first, second] in crate::topology::close_pairs(&self.vertices, tolerance) {
            names[second] = names[first];
        }
        let triangles = self.triangles.iter().map(|corners| corners.map(|v| names[v as usize])).collect();
        Self::new(self.vertices.clone(), triangles)
    }

    /// The surface with triangles turned over so that neighbours agree, and closed bodies have
    /// their normals outwards: the cure for inverted triangles. Of an open surface the first
    /// triangle keeps its side.
    #[must_use]
    pub fn oriented(&self) -> Self {
        let turned = Topology::new(self).turned(self);
        let turn = |(&[a, b, c], turned): (&[u32; 3], bool)| if turned { [a, c, b] } else { [a, b, c] };
        let triangles = self.triangles.iter().zip(turned).map(turn).collect();
        Self { vertices: self.vertices.clone(), triangles }
    }

    /// Positions, m.
    #[must_use]
    pub fn vertices(&self) -> &[Vec3] {
        &self.vertices
    }

    /// The vertices of every triangle.
    #[must_use]
    pub fn triangles(&self) -> &[[u32; 3]] {
        &self.triangles
    }

    /// The corners of a triangle, m.
    ///
    /// # Panics
    /// Like a slice, where there is no such triangle.
    #[must_use]
    pub fn corners(&self, triangle: usize) -> [Vec3; 3] {
        self.triangles[triangle].map(|vertex| self.vertices[vertex as usize])
    }

    /// The centroid of a triangle, m.
    ///
    /// # Panics
    /// Like a slice, where there is no such triangle.
    #[must_use]
    pub fn centre(&self, triangle: usize) -> Vec3 {
        let [a, b, c] = self.corners(triangle);
        (a + b + c) / 3.0
    }

    /// The unit normal of a triangle.
    ///
    /// # Panics
    /// Like a slice, where there is no such triangle.
    #[must_use]
    pub fn normal(&self, triangle: usize) -> Vec3 {
        let [a, b, c] = self.corners(triangle);
        (b - a).cross(c - a).normalize_or_zero()
    }

    /// The area of a triangle, m².
    ///
    /// # Panics
    /// Like a slice, where there is no such triangle.
    #[must_use]
    pub fn area(&self, triangle: usize) -> f64 {
        let [a, b, c] = self.corners(triangle);
        0.5 * (b - a).cross(c - a).length()
    }
}
