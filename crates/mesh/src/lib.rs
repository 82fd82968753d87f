//! Surfaces, faces, patches and element trees.
//!
//! A *surface* is what the scene file names. It is cut into *faces*, the input faces that results
//! are reported on. A face is computed on *elements*: quads or triangles, organised as trees whose
//! leaves are the unknowns. Every leaf is a [`Patch`]: a flat convex polygon of three or four
//! corners, counter-clockwise seen from its lit side.
//!
//! A [`MeshBuilder`] cuts [`Shape`]s as a [`Cutting`] says, or takes faces that an importer has
//! made.
//!
//! Units: metres. No input or output happens here.

mod border;
mod bounds;
mod builder;
mod cuboid;
mod cuts;
mod cutting;
mod cylinder;
mod disc;
mod error;
mod facet;
mod flatten;
mod inspection;
mod mesh;
mod patch;
mod plane;
mod polygon;
mod quad;
mod quality;
mod shape;
mod solid;
mod sphere;
mod tree;
mod triangle;
mod triangulation;
mod weld;

pub use bounds::Bounds;
pub use builder::MeshBuilder;
pub use cuts::{cut_polygon, part_inside};
pub use cutting::{Cutting, Lines};
pub use error::{MeshError, Ring};
pub use flatten::{Flattened, flatten};
pub use glam::DVec3 as Vec3;
pub use inspection::{Component, Contacts, Overlap, Repeat, Topology};
pub use mesh::{Element, Face, Mesh, Surface};
pub use patch::Patch;
pub use quality::Quality;
pub use shape::Shape;
pub use weld::{Anchored, Hanging, Weld, Welded};
