//! A mesh file on its own as a scene: materials from its libraries, light from all sides where
//! nothing emits, a camera before it.

use std::f64::consts::PI;
use std::path::Path;

use fredholm_mesh::{Bounds, Cutting, Shape, Vec3};

use crate::check::Warning;
use crate::error::{ErrorKind, SceneError};
use crate::files::Files;
use crate::import::{Imported, import};
use crate::parse::parse;
use crate::part::{Origin, Part};
use crate::resolve::{Camera, Material, Resolved, USUAL_REFLECTANCE, load_library, own_library, resolve};
use crate::source::Source;

/// Name of the material of faces that have none, and of the light from all sides.
const PLAIN_MATERIAL: &str = "plain";
const SKY_NAME: &str = "sky";
/// Distance of the enclosing box that is the light, over the diagonal of the mesh.
const BOX_DISTANCE: f64 = 0.5;
/// From where the mesh is looked at.
const VIEW_DIRECTION: Vec3 = Vec3::new(0.55, 0.45, 1.0);
/// Angle from the lower to the upper edge of the picture, degrees, and room left around the mesh.
const FIELD_OF_VIEW: f64 = 40.0;
const BOX_MARGIN: f64 = 1.02;

/// The meaning of a mesh file, and the source that errors about the whole of it name.
pub(crate) fn meaning(path: &Path, files: &mut Files) -> Result<(Source, Resolved), SceneError> {
    let name = path.file_name().unwrap_or_default();
    let bytes = files.load(Path::new(name)).map_err(|error| {
        let what = format!("cannot read the mesh: {error}");
        let help = "correct the name of the file, or its permissions";
        SceneError::new(ErrorKind::Io, path, what, help).caused_by(error)
    })?;
    let (mut coloured, mut camera) = (false, None);
    if let Some(imported) = import(Path::new(name), bytes, files).transpose()? {
        coloured = is_coloured(Path::new(name), &imported, files)?;
        camera = imported.camera;
    }
    let text = text(path, coloured);
    let entry = parse(&Source::of(path, text))?;
    // What the text made here says has no place in a file.
    let source = Source::of(path, String::new());
    let mut meaning = resolve(&source, &entry, files, Some(0))?;
    meaning.camera = camera;
    complete(&source, &mut meaning);
    Ok((source, meaning))
}

/// Whether a library of the mesh that can be read has a material that is not grey.
fn is_coloured(name: &Path, imported: &Imported, files: &mut Files) -> Result<bool, SceneError> {
    if own_library(imported).is_coloured() {
        return Ok(true);
    }
    for library in &imported.libraries {
        match load_library(files, name, imported, library) {
            Ok(library) if library.is_coloured() => return Ok(true),
            Err(error) if !error.is_io() => return Err(error),
            _ => {}
        }
    }
    Ok(false)
}

/// A scene file that says what there is to say.
fn text(path: &Path, coloured: bool) -> String {
    let quoted = |text: &str| serde_json::Value::from(text).to_string();
    let stem = path
        .file_stem()
        .map_or_else(String::new, |stem| stem.to_string_lossy().replace(char::is_control, " "));
    let stem = if stem.is_empty() { "mesh".to_owned() } else { stem };
    let file = path.file_name().unwrap_or_default().to_string_lossy();
    let bands = if coloured { "bands = [\"r\", \"g\", \"b\"]\n" } else { "" };
    format!(
        "{bands}[materials.{PLAIN_MATERIAL}]\nreflectance = {USUAL_REFLECTANCE}\n[[surface]]\nname = {}\nmaterial = \"{PLAIN_MATERIAL}\"\nmesh = {{ file = {} }}\n",
        quoted(&stem),
        quoted(&file)
    )
}

/// Adds light where nothing emits, a camera, and what is to be told of both.
fn complete(source: &Source, meaning: &mut Resolved) {
    let note = |what: String, help: &str| {
        let (file, place) = (source.path.clone(), source.place(0..0));
        Warning { file, place, what, help: help.to_owned() }
    };
    if meaning.parts.iter().any(|part| part.material == 0) {
        let what = format!("faces without a material that is known reflect {USUAL_REFLECTANCE}");
        meaning.notes.push(note(
            what,
            "give them materials in a scene file, or in the mesh (the .mtl file of an OBJ)",
        ));
    }
    let emits = |part: &Part| meaning.materials[part.material].exitance.iter().any(|&m| m > 0.0);
    if meaning.parts.iter().any(emits) {
        return;
    }
    let Some(bounds) = bounds(&meaning.parts) else { return };
    meaning.parts.push(sky(&bounds, meaning.materials.len()));
    let bands = meaning.bands.len();
    let (name, reflectance, exitance) = (SKY_NAME.to_owned(), vec![0.0; bands], vec![PI; bands]);
    meaning.materials.push(Material { name, reflectance, exitance });
    meaning.camera = meaning.camera.or_else(|| Some(camera(&bounds)));
    let what = "nothing emits, so a black box around the mesh, `sky`, lights it evenly from all sides: radiance 1 W/(m² sr)";
    meaning.notes.push(note(
        what.to_owned(),
        "give a material an emission in the mesh (Ke in the .mtl file of an OBJ), or exitance in a scene file",
    ));
}

/// The box around all corners.
fn bounds(parts: &[Part]) -> Option<Bounds> {
    let corners = |shape: &Shape| match shape {
        Shape::Quad { corners, .. } => corners.to_vec(),
        Shape::Triangle { corners } => corners.to_vec(),
        Shape::Polygon { outline, .. } => outline.clone(),
        _ => vec![],
    };
    Bounds::around(parts.iter().flat_map(|part| part.shapes.iter()).flat_map(corners))
}

fn sky(bounds: &Bounds, material: usize) -> Part {
    let away = Vec3::splat(BOX_DISTANCE * bounds.diagonal());
    let shape = Shape::Box { min: bounds.min - away, max: bounds.max + away, inward: true };
    let (name, shapes, cutting) = (SKY_NAME.to_owned(), [shape].into(), Cutting::default());
    Part { name, material, shapes, cutting, elements: 6, origin: Origin::Sky, span: 0..0 }
}

fn camera(bounds: &Bounds) -> Camera {
    let distance = BOX_MARGIN * 0.5 * bounds.diagonal() / (0.5 * FIELD_OF_VIEW).to_radians().sin();
    let target = bounds.centre();
    Camera {
        eye: target + VIEW_DIRECTION.normalize() * distance,
        target,
        up: Vec3::Y,
        vertical_fov_degrees: FIELD_OF_VIEW,
        width: 800,
        height: 600,
        exposure: None,
    }
}
