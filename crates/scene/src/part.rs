//! A surface that is ready to be cut.

use std::ops::Range;
use std::sync::Arc;

use fredholm_mesh::{Cutting, Shape};

/// A surface of the mesh to be: its shapes and how they are cut.
#[derive(Clone, Debug)]
pub(crate) struct Part {
    pub name: String,
    /// Index of the material in the scene.
    pub material: usize,
    pub shapes: Arc<[Shape]>,
    pub cutting: Cutting,
    /// Number of elements that it will have.
    pub elements: u128,
    pub origin: Origin,
    /// Its name in the scene file.
    pub span: Range<usize>,
}

/// Where a part comes from.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Origin {
    Scene,
    MeshFile,
    /// The light around a mesh file that stands for a scene.
    Sky,
}
