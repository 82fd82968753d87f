//! The mesh: surfaces, faces, and the element trees of the faces.

use std::ops::Range;

use crate::{Bounds, Patch, Vec3};

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
    pub(crate) surfaces: Vec<Surface>,
    pub(crate) faces: Vec<Face>,
    pub(crate) elements: Vec<Element>,
    pub(crate) leaves: Vec<usize>,
    pub(crate) occluders: Vec<Patch>,
    /// What each shape was cut into.
    pub(crate) shapes: Vec<Cut>,
}

/// The faces of a shape and the occluders that stand for it, as ranges of their numbers.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Cut {
    pub faces: Range<usize>,
    pub occluders: Range<usize>,
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
    #[must_use]
    pub fn patches(&self) -> impl ExactSizeIterator<Item = &Patch> {
        self.leaves.iter().map(|&e| &self.elements[e].patch)
    }

    /// The undivided flat pieces of the input geometry: what blocks the view, as few polygons as
    /// possible.
    #[must_use]
    pub fn occluders(&self) -> &[Patch] {
        &self.occluders
    }

    /// The smallest box along the axes that holds all leaves and occluders; none for an empty mesh.
    #[must_use]
    pub fn bounds(&self) -> Option<Bounds> {
        Bounds::around(self.patches().chain(&self.occluders).flat_map(Patch::corners).copied())
    }
}
