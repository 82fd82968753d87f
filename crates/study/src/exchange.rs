//! Scenes and meshes in the formats of others.

use std::path::{Path, PathBuf};

use fredholm_linop::Watch;
use fredholm_report::ResultFolder;
use fredholm_scene::{Camera, ExportFormat, Exported, Outline, Scene};

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

/// Writes a scene in the format of another program: geometry, diffuse reflectances, emitters and the
/// camera, which takes in the whole scene where the scene has none. `band` is the band that stands
/// for grey, for a scene whose bands are no colours.
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
    if outline.camera.is_none() {
        let fredholm_report::Camera { eye, target, up, vertical_fov_degrees, width, height } =
            framing(scene)?;
        let exposure = None;
        outline.camera = Some(Camera { eye, target, up, vertical_fov_degrees, width, height, exposure });
    }
    Ok(outline)
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

/// Writes a mesh file, or the surfaces of a scene, as another mesh file; the ending of its name is the
/// format.
///
/// # Errors
/// As for [`export`]; [`ErrorKind::Input`] for a name whose ending is that of no known format.
pub fn convert(
    source: impl Into<SceneSource>,
    target: impl AsRef<Path>,
    watch: &dyn Watch,
) -> Result<Written, Error> {
    let target = target.as_ref();
    let format = ExportFormat::of(target).ok_or_else(|| {
        let endings: Vec<String> = ExportFormat::ALL.iter().map(|(_, _, e)| format!(".{e}")).collect();
        let text = format!("`{}` has the ending of no format that is written", target.display());
        Error::new(ErrorKind::Input, text).with_help(format!("end its name in {}", endings.join(", ")))
    })?;
    let scene = source.into().load(None, &mut Stages::new(watch))?;
    let mut outline = scene.outline(None).map_err(scene_failure)?.bare(&scene);
    outline.camera = None;
    let stem = target.file_stem().map_or_else(String::new, |stem| stem.to_string_lossy().into_owned());
    let folder = claim_to_add(target.parent().unwrap_or(Path::new("")), "another name")?;
    let mut written = write(&outline, format, &folder, &stem)?;
    written.notes.splice(0..0, scene.notes().iter().map(ToString::to_string));
    Ok(written)
}
