//! The mesh: surfaces, faces, and the element trees of the faces.

use crate::{MeshError, Patch, Vec3};

/// Largest number of elements: indices are stored in 32 bits.
const LIMIT: usize = u32::MAX as usize;

/// A named surface of the scene.
#[derive(Clone, Debug, PartialEq)]
pub struct Surface {
    /// Name from the scene file.
    pub name: String,
    /// Index of its material in the scene.
    pub material: usize,
}

/// An input face: what results are reported on.
#[derive(Clone, Debug, PartialEq)]
pub struct Face {
    /// Surface it belongs to.
    pub surface: usize,
    /// Area, m².
    pub area: f64,
    /// Centroid, m.
    pub centroid: Vec3,
}

/// A node of an element tree.
#[derive(Clone, Debug, PartialEq)]
pub struct Element {
    /// Geometry.
    pub patch: Patch,
    /// Face it belongs to.
    pub face: usize,
    /// Element it was split from.
    pub parent: Option<usize>,
    /// First of its four consecutive children.
    pub children: Option<usize>,
    /// Number of splits between it and its root.
    pub level: u32,
}

/// Surfaces cut into faces, faces into trees of elements.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Mesh {
    surfaces: Vec<Surface>,
    faces: Vec<Face>,
    elements: Vec<Element>,
    leaves: Vec<usize>,
    occluders: Vec<Patch>,
}

impl Mesh {
    /// The surfaces, in the order of the scene file.
    #[must_use]
    pub fn surfaces(&self) -> &[Surface] {
        &self.surfaces
    }

    /// The input faces.
    #[must_use]
    pub fn faces(&self) -> &[Face] {
        &self.faces
    }

    /// All nodes of all element trees.
    #[must_use]
    pub fn elements(&self) -> &[Element] {
        &self.elements
    }

    /// Indices of the leaf elements: unknown i lives on element `leaves()[i]`.
    #[must_use]
    pub fn leaves(&self) -> &[usize] {
        &self.leaves
    }

    /// Number of leaves, that is of unknowns.
    #[must_use]
    pub fn len(&self) -> usize {
        self.leaves.len()
    }

    /// Whether there is nothing in the mesh.
    #[must_use]
    pub fn is_empty(&self) -> bool {
        self.leaves.is_empty()
    }

    /// Patch of leaf `i`.
    #[must_use]
    pub fn patch(&self, leaf: usize) -> &Patch {
        &self.elements[self.leaves[leaf]].patch
    }

    /// Face of leaf `i`.
    #[must_use]
    pub fn face_of(&self, leaf: usize) -> usize {
        self.elements[self.leaves[leaf]].face
    }

    /// Surface of leaf `i`.
    #[must_use]
    pub fn surface_of(&self, leaf: usize) -> usize {
        self.faces[self.face_of(leaf)].surface
    }

    /// Patches of all leaves, in order.
    pub fn patches(&self) -> impl ExactSizeIterator<Item = &Patch> {
        self.leaves.iter().map(|&e| &self.elements[e].patch)
    }

    /// The undivided flat pieces of the input geometry: what blocks the view, as few polygons as possible.
    #[must_use]
    pub fn occluders(&self) -> &[Patch] {
        &self.occluders
    }
}

/// Collects surfaces, faces and occluders into a [`Mesh`].
#[derive(Clone, Debug, Default)]
pub struct MeshBuilder {
    mesh: Mesh,
}

impl MeshBuilder {
    /// Starts a surface; the faces that follow belong to it.
    pub fn surface(&mut self, name: impl Into<String>, material: usize) -> usize {
        self.mesh.surfaces.push(Surface { name: name.into(), material });
        self.mesh.surfaces.len() - 1
    }

    /// Adds an undivided piece of geometry that blocks the view.
    pub fn occluder(&mut self, patch: Patch) {
        self.mesh.occluders.push(patch);
    }

    /// Adds a face of the last surface, computed on the given root elements, and returns its index.
    ///
    /// # Errors
    /// [`MeshError::TooLarge`] past 2³² − 1 elements; [`MeshError::NoArea`] for a face of no element.
    pub fn face(&mut self, roots: &[Patch]) -> Result<usize, MeshError> {
        let (area, centroid) = mean(roots)?;
        if self.mesh.elements.len() + roots.len() > LIMIT {
            return Err(MeshError::TooLarge { limit: LIMIT });
        }
        let face = self.mesh.faces.len();
        let surface = self.mesh.surfaces.len().saturating_sub(1);
        self.mesh.faces.push(Face { surface, area, centroid });
        for &patch in roots {
            self.mesh.leaves.push(self.mesh.elements.len());
            self.mesh.elements.push(Element { patch, face, parent: None, children: None, level: 0 });
        }
        Ok(face)
    }

    /// The finished mesh.
    #[must_use]
    pub fn build(self) -> Mesh {
        self.mesh
    }
}

fn mean(roots: &[Patch]) -> Result<(f64, Vec3), MeshError> {
    let area: f64 = roots.iter().map(Patch::area).sum();
    if roots.is_empty() || !area.is_finite() {
        return Err(MeshError::NoArea { area, longest: 0.0 });
    }
    let centroid = roots.iter().map(|p| p.centroid() * (p.area() / area)).sum();
    Ok((area, centroid))
}
