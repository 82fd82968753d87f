//! Geometry from mesh files: bytes in, faces out, or an error with file and line.
//!
//! A format is one file in this folder and one arm of the match in [`import`].

mod mtl;
mod obj;
pub(crate) mod vs3;

use std::ops::Range;
use std::path::Path;

use fredholm_mesh::Vec3;

use crate::error::SceneError;
use crate::source::Source;

pub(crate) use mtl::{MeshMaterial, mesh_materials};

/// A name in a file, and where.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(crate) struct Name {
    pub text: String,
    pub span: Range<usize>,
}

/// A flat or nearly flat polygon, counter-clockwise seen from its lit side, in units of the file.
#[derive(Clone, Debug)]
pub(crate) struct ImportedFace {
    pub corners: Vec<Vec3>,
    pub span: Range<usize>,
}

/// The faces of one object and one material.
#[derive(Clone, Debug)]
pub(crate) struct Group {
    pub object: Option<String>,
    pub material: Option<Name>,
    pub faces: Vec<ImportedFace>,
}

/// What a file holds.
#[derive(Debug)]
pub(crate) struct Imported {
    pub source: Source,
    /// Groups with at least one face, in the order of the file.
    pub groups: Vec<Group>,
    /// Material libraries that the file names.
    pub libraries: Vec<Name>,
}

/// Endings of the names of files that [`import`] knows.
pub(crate) const ENDINGS: &str = ".obj (Wavefront OBJ) or .vs3 (View3D)";

/// Reads a mesh file, or gives `None` where the ending of its name is that of no known format.
pub(crate) fn import(path: &Path, bytes: Vec<u8>) -> Option<Result<Imported, SceneError>> {
    let ending = path.extension()?.to_str()?.to_lowercase();
    match ending.as_str() {
        "obj" => Some(Source::decode_mesh(path, bytes).and_then(obj::parse)),
        "vs3" => Some(Source::decode(path, bytes).and_then(vs3::import)),
        _ => None,
    }
}
