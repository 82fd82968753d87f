//! Geometry from mesh files: bytes in, faces out, or an error with file and line, or file and byte.
//!
//! A format is one file in this folder, one row of [`FORMATS`] and one arm of the match in
//! [`import`]. The readers are our own where a crate for the format could not say at which line or
//! byte a file is wrong, or takes memory for what a header promises.

mod cursor;
mod gltf;
mod gmsh;
mod json;
mod mitsuba;
mod mtl;
mod obj;
mod ply;
mod radiance;
mod stl;
pub(crate) mod vs3;

use std::collections::BTreeMap;
use std::ops::Range;
use std::path::Path;
use std::sync::Arc;

use fredholm_mesh::Vec3;

use crate::error::{ErrorKind, SceneError};
use crate::files::Files;
use crate::resolve::Camera;
use crate::source::Source;

pub(crate) use mtl::{MeshMaterial, mesh_materials};

/// Most corners of a face: it is cut into triangles in a time that grows with their square.
const MOST_CORNERS: usize = 10_000;

/// Most faces of a file that may name the same mesh many times: a small file could ask for any
/// number.
const MOST_FACES: usize = 20_000_000;

/// Endings of the names of files that [`import`] reads, and what they are.
pub(crate) const FORMATS: [(&str, &str); 9] = [
    ("obj", "Wavefront OBJ"),
    ("stl", "STL"),
    ("ply", "PLY"),
    ("gltf", "glTF 2.0"),
    ("glb", "binary glTF 2.0"),
    ("msh", "Gmsh 4.1"),
    ("rad", "Radiance"),
    ("xml", "Mitsuba 3"),
    ("vs3", "View3D"),
];

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
#[derive(Clone, Debug, Default)]
pub(crate) struct Group {
    pub object: Option<String>,
    pub material: Option<Name>,
    pub faces: Vec<ImportedFace>,
    /// Whether the file says that it is lit on both sides.
    pub two_sided: bool,
}

/// Something that a file says and that is not taken over.
#[derive(Clone, Debug)]
pub(crate) struct Note {
    pub span: Range<usize>,
    pub what: String,
    pub help: String,
}

/// What a file holds.
#[derive(Debug)]
pub(crate) struct Imported {
    pub source: Arc<Source>,
    /// Groups with at least one face, in the order of the file.
    pub groups: Vec<Group>,
    /// Material libraries that the file names.
    pub libraries: Vec<Name>,
    /// Materials that the file defines itself.
    pub materials: Vec<MeshMaterial>,
    pub notes: Vec<Note>,
    pub camera: Option<Camera>,
}

impl Imported {
    /// Faces, and nothing besides. Groups of the same object and material are one.
    fn new(source: impl Into<Arc<Source>>, all: Vec<Group>) -> Self {
        let (mut groups, mut numbers): (Vec<Group>, _) = (vec![], BTreeMap::new());
        for group in all.into_iter().filter(|group| !group.faces.is_empty()) {
            let key = (group.object.clone(), group.material.as_ref().map(|name| name.text.clone()));
            let number = *numbers.entry(key).or_insert(groups.len());
            if let Some(known) = groups.get_mut(number) {
                known.faces.extend(group.faces);
                known.two_sided |= group.two_sided;
            } else {
                groups.push(group);
            }
        }
        let (libraries, materials, notes) = (vec![], vec![], vec![]);
        Self { source: source.into(), groups, libraries, materials, notes, camera: None }
    }
}

/// A file to be read, and where those lie that it names.
struct Input<'a> {
    /// Its name as the scene gives it: files that it names lie beside it.
    name: &'a Path,
    path: &'a Path,
    files: &'a mut Files,
}

/// Whether the name of a file is that of a mesh file.
pub(crate) fn is_mesh(path: &Path) -> bool {
    FORMATS.iter().any(|(known, _)| *known == ending(path))
}

/// The endings of [`FORMATS`], for a message.
pub(crate) fn endings() -> String {
    let all: Vec<String> = FORMATS.iter().map(|(ending, format)| format!(".{ending} ({format})")).collect();
    all.join(", ")
}

/// The ending of the name of a file, in small letters.
pub(crate) fn ending(path: &Path) -> String {
    path.extension().and_then(|ending| ending.to_str()).unwrap_or_default().to_lowercase()
}

/// Reads the mesh file called `name`, or gives `None` where the ending of its name is that of no
/// known format.
pub(crate) fn import(name: &Path, bytes: Vec<u8>, files: &mut Files) -> Option<Result<Imported, SceneError>> {
    let path = &files.path(name);
    match ending(path).as_str() {
        "obj" => Some(Source::decode_mesh(path, bytes).and_then(obj::parse)),
        "vs3" => Some(Source::decode(path, bytes).and_then(vs3::import)),
        "stl" => Some(stl::import(path, bytes)),
        "ply" => Some(ply::import(path, bytes)),
        "msh" => Some(gmsh::import(path, bytes)),
        "rad" => Some(Source::decode_mesh(path, bytes).and_then(radiance::import)),
        "gltf" | "glb" => Some(gltf::import(Input { name, path, files }, bytes)),
        "xml" => Some(mitsuba::import(Input { name, path, files }, bytes)),
        _ => None,
    }
}

/// The corners of a face by their numbers from 0, of which none may be beyond the last.
fn face(
    source: &Source,
    vertices: &[Vec3],
    indices: &[u64],
    span: Range<usize>,
) -> Result<ImportedFace, SceneError> {
    let count = vertices.len();
    let corner = |&index: &u64| {
        let found = usize::try_from(index).ok().and_then(|index| vertices.get(index));
        found.copied().ok_or_else(|| {
            let what = format!("there is no vertex {index}: there are {count}, counted from 0");
            let help = "mend the index, or write the file anew with the program that made it";
            source.error(ErrorKind::Value, span.clone(), what, help)
        })
    };
    let corners: Vec<Vec3> = indices.iter().map(corner).collect::<Result<_, _>>()?;
    Ok(ImportedFace { corners, span })
}

/// Refuses a face of too few or too many corners.
fn check_corners(source: &Source, count: usize, span: Range<usize>) -> Result<(), SceneError> {
    let (kind, help) = match count {
        0..3 => (ErrorKind::Syntax, "give a face at least three corners"),
        3..=MOST_CORNERS => return Ok(()),
        _ => (ErrorKind::TooLarge, "cut it into smaller faces"),
    };
    Err(source.error(kind, span, format!("a face of {count} corners"), help))
}

/// Refuses more faces than memory should be taken for.
fn check_faces(source: &Source, count: usize, span: Range<usize>) -> Result<(), SceneError> {
    if count <= MOST_FACES {
        return Ok(());
    }
    let what = format!("with this the file would have {count} faces, more than {MOST_FACES}");
    Err(source.error(ErrorKind::TooLarge, span, what, "use fewer copies, or coarser meshes"))
}

/// A material that emits as well as it reflects, under a name that none of the others has.
fn add_material(materials: &mut Vec<MeshMaterial>, material: MeshMaterial) -> String {
    let emission = |known: &MeshMaterial| known.emission.as_ref().map(|(value, _)| *value);
    let base = material.name.clone();
    let is_of = |known: &MeshMaterial| {
        known.name == base
            || known.name.strip_prefix(base.as_str()).is_some_and(|end| end.starts_with(" emitter"))
    };
    let same = materials.iter().find(|known| is_of(known) && emission(known) == emission(&material));
    if let Some(known) = same {
        return known.name.clone();
    }
    let others = materials.iter().filter(|known| is_of(known)).count();
    let name = if others == 0 { base } else { format!("{base} emitter {others}") };
    materials.push(MeshMaterial { name: name.clone(), ..material });
    name
}
