//! Scenes and meshes in the formats of others.

use std::path::{Path, PathBuf};

use fredholm_linop::Watch;
use fredholm_mesh::{Mesh, Vec3};
use fredholm_report::ResultFolder;
use fredholm_scene::{Camera, ExportFormat, Exported, Outline, Scene};
use fredholm_visibility::Occluders;

use crate::check::framing;
use crate::error::{Error, ErrorKind};
use crate::folder::claim_to_add;
use crate::options::SceneSource;
use crate::problem::scene_failure;
use crate::solve::report_failure;
use crate::stages::Stages;

/// What was written.
#[derive(Clone, Debug)]
pub struct Written {
    /// The files, the one to open first.
    pub files: Vec<PathBuf>,
    /// What is not as it was.
    pub notes: Vec<String>,
    /// Number of surfaces, and of flat polygons of three or four corners.
    pub surfaces: usize,
    /// Polygons of three or four corners.
    pub polygons: usize,
}

/// Cosine below which a surface is seen edge-on.
const EDGE_ON: f64 = 1e-9;
/// Share of the way to the target by which the eye stands before a wall that it was moved through.
const SHARE_BEFORE_WALL: f64 = 0.02;
/// Vertical field of view of an eye inside a room, degrees.
const INSIDE_FIELD_OF_VIEW: f64 = 75.0;

/// Writes a scene in the format of another program: geometry, diffuse reflectances, emitters and
/// the camera. Where the scene has none, it takes in the whole scene; an eye that would see a wall
/// from behind is moved through it. `band` is the band that stands for grey, for a scene whose
/// bands are no colours.
///
/// # Errors
/// What is wrong with the scene; [`ErrorKind::Files`] for a file that cannot be written.
pub fn export(
    source: impl Into<SceneSource>,
    format: ExportFormat,
    band: Option<&str>,
    folder: &ResultFolder,
    watch: &dyn Watch,
) -> Result<Written, Error> {
    let scene = source.into().load(None, &mut Stages::new(watch))?;
    let stem = scene.path().file_stem().map_or_else(String::new, |stem| stem.to_string_lossy().into_owned());
    write(&outline(&scene, band)?, format, folder, &stem)
}

/// The scene as others read it, with a camera.
pub(crate) fn outline(scene: &Scene, band: Option<&str>) -> Result<Outline, Error> {
    let mut outline = scene.outline(band).map_err(scene_failure)?;
    outline.camera = Some(camera(scene)?);
    Ok(outline)
}

/// The camera of a scene; where it has none, one that takes in the whole scene. Other programs show
/// the backs of walls, which the pictures here leave out, so that an eye is moved through those
/// that stand before what is to be seen.
pub(crate) fn camera(scene: &Scene) -> Result<Camera, Error> {
    let camera = scene.camera().copied().map_or_else(|| whole(scene), Ok)?;
    let mesh = scene.face_mesh().map_err(scene_failure)?;
    Ok(match before_backs(&mesh, camera.eye, camera.target)? {
        Some(eye) => Camera { eye, vertical_fov_degrees: INSIDE_FIELD_OF_VIEW, ..camera },
        None => camera,
    })
}

/// A camera that takes in the whole scene.
fn whole(scene: &Scene) -> Result<Camera, Error> {
    let fredholm_report::Camera { eye, target, up, vertical_fov_degrees, width, height } = framing(scene)?;
    Ok(Camera { eye, target, up, vertical_fov_degrees, width, height, exposure: None })
}

/// Where an eye stands that has gone through all walls that it sees from behind on its way to the
/// target; none where there are none.
fn before_backs(mesh: &Mesh, eye: Vec3, target: Vec3) -> Result<Option<Vec3>, Error> {
    let pieces = mesh.occluders();
    let occluders = Occluders::new(pieces).map_err(|error| Error::new(ErrorKind::Input, error))?;
    let (way, mut last) = ((target - eye).normalize_or_zero(), None);
    loop {
        let from: Vec3 = last.unwrap_or(eye);
        let hit = occluders.closest(from, way, (target - from).length());
        let back = hit.filter(|hit| pieces[hit.patch].normal().dot(way) > EDGE_ON);
        match back {
            Some(hit) => last = Some(hit.point),
            None => return Ok(last.map(|wall| wall + (target - wall) * SHARE_BEFORE_WALL)),
        }
    }
}

/// Writes the files of a format into a folder.
pub(crate) fn write(
    outline: &Outline,
    format: ExportFormat,
    folder: &ResultFolder,
    stem: &str,
) -> Result<Written, Error> {
    let Exported { files, notes } = outline.export(format, stem);
    let mut paths = vec![];
    // The main file is written last: where it stands, the others do.
    for (name, bytes) in files.iter().rev() {
        paths.push(folder.write(name, |out| out.write_all(bytes)).map_err(report_failure)?);
    }
    paths.reverse();
    let surfaces = outline.surfaces.len();
    let polygons = outline.surfaces.iter().map(|surface| surface.faces.len()).sum();
    Ok(Written { files: paths, notes, surfaces, polygons })
}

/// Writes a mesh file, or the surfaces of a scene, as another mesh file; the ending of its name is
/// the format.
///
/// # Errors
/// As for [`export`]; [`ErrorKind::Input`] for a name whose ending is that of no known format.
pub fn convert(
    source: impl Into<SceneSource>,
    target: impl AsRef<Path>,
    watch: &dyn Watch,
) -> Result<Written, Error> {
    convert_scene(&source.into(), target.as_ref(), watch)
}

/// [`convert`], compiled once and not for each kind of source.
fn convert_scene(source: &SceneSource, target: &Path, watch: &dyn Watch) -> Result<Written, Error> {
    let format = ExportFormat::of(target).ok_or_else(|| {
        let endings: Vec<String> = ExportFormat::ALL.iter().map(|(_, _, e)| format!(".{e}")).collect();
        let text = format!("`{}` has the ending of no format that is written", target.display());
        Error::new(ErrorKind::Input, text).with_help(format!("end its name in {}", endings.join(", ")))
    })?;
    let scene = source.load(None, &mut Stages::new(watch))?;
    let mut outline = scene.outline(None).map_err(scene_failure)?.bare(&scene);
    outline.camera = None;
    let stem = target.file_stem().map_or_else(String::new, |stem| stem.to_string_lossy().into_owned());
    let folder = claim_to_add(target.parent().unwrap_or(Path::new("")), "another name")?;
    let mut written = write(&outline, format, &folder, &stem)?;
    written.notes.splice(0..0, scene.notes().iter().map(ToString::to_string));
    Ok(written)
}
