//! A surface of triangles with common vertices, flat or curved. Metres.

use crate::element::Element;
use crate::{MomentsError, Topology};
use fredholm_mesh::{Mesh, Vec3, Weld};
use std::collections::BTreeMap;

/// Area over the square of the longest side below which a triangle has none.
const LEAST_RELATIVE_AREA: f64 = 1e-12;

/// Pieces that a side of a curved triangle is cut into where it is looked at as flat ones: they are
/// within a hundredth of what the whole is away from its chord.
const PIECES_OF_A_SIDE: usize = 8;

/// Triangles over common vertices: only vertices that are the same, not those that are at the same
/// place, join triangles to a surface that carries current from one to the other.
#[derive(Clone, Debug, PartialEq)]
pub struct Surface {
    vertices: Vec<Vec3>,
    triangles: Vec<[u32; 3]>,
    /// The middles of curved sides, by their vertices in order.
    middles: BTreeMap<[u32; 2], Vec3>,
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
        let surface = Self { vertices, triangles, middles: BTreeMap::new() };
        (0..surface.triangles.len()).try_for_each(|triangle| surface.check(triangle))?;
        Ok(surface)
    }

    /// The same with curved sides: those between two vertices go through the place (m) that is
    /// given for the two, the first with the lower number.
    ///
    /// # Errors
    /// [`MomentsError::Folded`] for a triangle that turns its other side somewhere.
    pub fn curved(mut self, middle: impl Fn([u32; 2]) -> Vec3) -> Result<Self, MomentsError> {
        for &[a, b, c] in &self.triangles {
            for side in [[a, b], [b, c], [c, a]] {
                let side = [side[0].min(side[1]), side[0].max(side[1])];
                let [from, to] = side.map(|vertex| self.vertices[vertex as usize]);
                let place = middle(side);
                if place == 0.5 * (from + to) {
                    self.middles.remove(&side);
                } else {
                    self.middles.insert(side, place);
                }
            }
        }
        let faces_back = |&triangle: &usize| {
            let (element, normal) = (self.element(triangle), self.normal(triangle));
            // Along the sides and at the middle; written so that what is not finite is refused.
            let shares = [[1.0, 0.0, 0.0], [0.5, 0.5, 0.0]];
            let turned = |at: [f64; 3], by: usize| [0, 1, 2].map(|i| at[(i + by) % 3]);
            let mut places = shares.iter().flat_map(|&at| (0..3).map(move |by| turned(at, by)));
            !places.all(|at| element.normal(at).dot(normal) > 0.0)
        };
        match (0..self.triangles.len()).find(faces_back) {
            Some(triangle) => Err(MomentsError::Folded { triangle }),
            None => Ok(self),
        }
    }

    /// Whether some sides are curved.
    #[must_use]
    pub fn is_curved(&self) -> bool {
        !self.middles.is_empty()
    }

    /// A triangle as the functions of the first full order need it.
    pub(crate) fn element(&self, triangle: usize) -> Element {
        let corners = self.corners(triangle);
        if !self.is_curved() {
            return Element::flat(corners);
        }
        let names = self.triangles[triangle];
        let middle = |i: usize| {
            let [a, b] = [names[(i + 1) % 3], names[(i + 2) % 3]];
            let straight = 0.5 * (corners[(i + 1) % 3] + corners[(i + 2) % 3]);
            self.middles.get(&[a.min(b), a.max(b)]).copied().unwrap_or(straight)
        };
        Element::curved(corners, [0, 1, 2].map(middle))
    }

    /// Flat triangles that follow a curved one, or the one itself where it is flat.
    pub(crate) fn pieces(&self, triangle: usize) -> Vec<[Vec3; 3]> {
        let element = self.element(triangle);
        if element == Element::flat(element.corners) {
            return vec![element.corners];
        }
        let steps = PIECES_OF_A_SIDE;
        let share = |i: usize| i as f64 / steps as f64;
        let at = |i: usize, j: usize| element.point([share(steps - i - j), share(i), share(j)]);
        let mut pieces = Vec::with_capacity(steps * steps);
        for i in 0..steps {
            for j in 0..steps - i {
                pieces.push([at(i, j), at(i + 1, j), at(i, j + 1)]);
                if i + j + 1 < steps {
                    pieces.push([at(i + 1, j), at(i + 1, j + 1), at(i, j + 1)]);
                }
            }
        }
        pieces
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
        let shifted = |(side, middle): (&[u32; 2], &Vec3)| (side.map(|v| v.wrapping_add(first)), *middle);
        self.middles.extend(other.middles.iter().map(shifted));
        Ok(Self::new(self.vertices, self.triangles)?.with_middles(self.middles))
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
        let renamed = |(&[a, b], &middle): (&[u32; 2], &Vec3)| {
            let [a, b] = [names[a as usize], names[b as usize]];
            ([a.min(b), a.max(b)], middle)
        };
        let middles = self.middles.iter().map(renamed).collect();
        Ok(Self::new(self.vertices.clone(), triangles)?.with_middles(middles))
    }

    /// The surface with triangles turned over so that neighbours agree, and closed bodies have
    /// their normals outwards: the cure for inverted triangles. Of an open surface the first
    /// triangle keeps its side.
    #[must_use]
    pub fn oriented(&self) -> Self {
        let turned = Topology::new(self).turned(self);
        let turn = |(&[a, b, c], turned): (&[u32; 3], bool)| if turned { [a, c, b] } else { [a, b, c] };
        let triangles = self.triangles.iter().zip(turned).map(turn).collect();
        Self { triangles, ..self.clone() }
    }

    /// Some of its triangles, or all turned over, with the same vertices.
    ///
    /// # Errors
    /// Those of [`Surface::new`].
    pub(crate) fn with_triangles(&self, triangles: Vec<[u32; 3]>) -> Result<Self, MomentsError> {
        Ok(Self::new(self.vertices.clone(), triangles)?.with_middles(self.middles.clone()))
    }

    fn with_middles(self, middles: BTreeMap<[u32; 2], Vec3>) -> Self {
        Self { middles, ..self }
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
