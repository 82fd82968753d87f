//! Surfaces, faces, patches and element trees.
//!
//! A *surface* is what the scene file names. It is cut into *faces*, the input faces that results are reported on.
//! A face is computed on *elements*: quads or triangles, organised as trees whose leaves are the unknowns. Every leaf
//! is a [`Patch`]: a flat convex polygon of three or four corners, counter-clockwise seen from its lit side.
//!
//! Units: metres. No input or output happens here.

mod error;
mod mesh;
mod patch;

pub use error::MeshError;
pub use glam::DVec3 as Vec3;
pub use mesh::{Element, Face, Mesh, MeshBuilder, Surface};
pub use patch::Patch;
