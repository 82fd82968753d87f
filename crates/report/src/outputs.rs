//! The result folder.
//!
//! `run.json` is written last: a folder that has one is complete, and all its files belong together, since what earlier
//! runs have left is removed first.

use std::io::{self, Write};
use std::path::PathBuf;

use crate::{
    Camera, Exposure, Field, FieldStep, Picture, PointTable, ReportError, ReportModel, ReportPage,
    ResultFolder, RunRecord, ShadowMesh, render, write_convergence, write_faces_csv, write_field_csv,
    write_field_glb, write_field_ply, write_npz, write_points_csv, write_run, write_shadows_vtu,
    write_surfaces_csv, write_vtu,
};

/// Names of the files of a result folder, in the order in which they are written.
pub const FILES: [&str; 9] = [
    "field.csv",
    "faces.csv",
    "surfaces.csv",
    "field.vtu",
    "field.npz",
    "image.png",
    "convergence.svg",
    REPORT,
    "run.json",
];

/// The picture among them.
pub const IMAGE: &str = "image.png";

/// The page among them.
pub const REPORT: &str = "report.html";

/// Names of further files that a result folder may hold: pictures of the mesh, of links and of the final gather, the table of points, triangles cut along shadows, and the field as a mesh
/// with colours.
pub const EXTRAS: [&str; 8] =
    ["mesh.png", "links.png", GATHER, POINTS, SHADOWS, FIELD_PLY, FIELD_GLB, FIELD_EXR];

/// The picture for which every pixel gathers its light.
pub const GATHER: &str = "gather.png";
/// The irradiance of points.
pub const POINTS: &str = "points.csv";
/// The elements cut along the borders of shadows.
pub const SHADOWS: &str = "shadows.vtu";
/// The field as a mesh with colours, as PLY.
pub const FIELD_PLY: &str = "field.ply";
/// The same as binary glTF.
pub const FIELD_GLB: &str = "field.glb";

/// The linear colours of the picture, as OpenEXR.
pub const FIELD_EXR: &str = "image.exr";

/// What a result folder holds besides the usual files.
#[derive(Default)]
pub struct Extras<'a> {
    /// The usual picture.
    pub image: Option<Picture>,
    /// Its linear colours, for [`FIELD_EXR`].
    pub linear: Vec<[f32; 3]>,
    /// Further pictures with their names, which are among [`EXTRAS`].
    pub pictures: Vec<(&'static str, Picture)>,
    /// How bright the colours of [`FIELD_PLY`] and [`FIELD_GLB`] are.
    pub exposure: Exposure,
    /// The irradiance of points.
    pub points: Option<PointTable>,
    /// Triangles cut along the borders of shadows.
    pub shadows: Option<ShadowMesh>,
    /// Which of [`FIELD_PLY`], [`FIELD_GLB`] and [`FIELD_EXR`] are wanted.
    pub baked: Vec<&'static str>,
    /// What makes the page.
    pub report: Option<RunReport<'a>>,
}

/// What the page of a run holds besides the field and the record.
#[derive(Clone, Copy)]
pub struct RunReport<'a> {
    /// What the scene is called.
    pub title: &'a str,
    /// Where it is seen from.
    pub view: &'a View,
    /// The field on the way to the solution, and what the steps are.
    pub steps: (&'a str, &'a [FieldStep]),
}

/// What fills a file.
type Writer<'a> = dyn Fn(&mut dyn Write) -> io::Result<()> + 'a;

/// What the picture shows.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct View {
    /// Where it is taken from.
    pub camera: Camera,
    /// How bright it is.
    pub exposure: Exposure,
}

impl View {
    /// The whole scene, brightness chosen by the picture.
    #[must_use]
    pub fn framing(field: &Field<'_>) -> Self {
        Self { camera: Camera::framing(field), exposure: Exposure::Auto }
    }
}

/// Writes all files of a result into a folder and returns their paths.
///
/// # Errors
/// [`ReportError::Write`] with the file or folder that could not be written; the errors of [`render`](crate::render) for a view that makes
/// no picture. The folder then has no `run.json`.
pub fn write_all(
    folder: &ResultFolder,
    field: &Field<'_>,
    run: &RunRecord,
    view: &View,
) -> Result<Vec<PathBuf>, ReportError> {
    let image = Some(render(field, &view.camera, view.exposure)?);
    write_with(folder, field, run, &Extras { image, exposure: view.exposure, ..Extras::default() })
}

/// As [`write_all`], with what was drawn and computed before, and nothing else.
///
/// # Errors
/// [`ReportError::Write`], as for [`write_all`].
pub fn write_with(
    folder: &ResultFolder,
    field: &Field<'_>,
    run: &RunRecord,
    more: &Extras<'_>,
) -> Result<Vec<PathBuf>, ReportError> {
    let picture = more.image.as_ref();
    let mut paths = Vec::new();
    for (name, picture) in &more.pictures {
        paths.push(folder.write(name, |out| picture.write_png(out))?);
    }
    if let Some(table) = &more.points {
        paths.push(folder.write(POINTS, |out| write_points_csv(table, field.bands(), out))?);
    }
    if let Some(mesh) = &more.shadows {
        paths.push(folder.write(SHADOWS, |out| write_shadows_vtu(mesh, field.bands(), out))?);
    }
    for name in &more.baked {
        paths.push(folder.write(name, |out| match *name {
            FIELD_PLY => write_field_ply(field, more.exposure, out),
            FIELD_EXR => picture.map_or(Ok(()), |picture| picture.write_exr(&more.linear, out)),
            _ => write_field_glb(field, more.exposure, out),
        })?);
    }
    let page = more.report.map(|RunReport { title, view, steps: (steps_title, steps) }| {
        let model = ReportModel { steps, steps_title, ..ReportModel::lit(field, view) };
        ReportPage::of_run(title, field, run, model, picture)
    });
    let draw = |out: &mut dyn Write| picture.map_or(Ok(()), |picture| picture.write_png(out));
    let show = |out: &mut dyn Write| page.as_ref().map_or(Ok(()), |page| page.write(out));
    let writers: [&Writer; 9] = [
        &|out| write_field_csv(field, out),
        &|out| write_faces_csv(field, out),
        &|out| write_surfaces_csv(field, out),
        &|out| write_vtu(field, out),
        &|out| write_npz(field, out),
        &draw,
        &|out| write_convergence(run, out),
        &show,
        &|out| write_run(run, out),
    ];
    let wanted = |name: &str| match name {
        IMAGE => picture.is_some(),
        REPORT => page.is_some(),
        _ => true,
    };
    for (name, write) in FILES.into_iter().zip(writers).filter(|(name, _)| wanted(name)) {
        paths.push(folder.write(name, write)?);
    }
    Ok(paths)
}

#[cfg(test)]
mod tests {
    use std::fs;
    use std::path::Path;

    use super::*;
    use crate::field::tests::{names, sample};
    use crate::read_run;
    use crate::run::tests::record;

    #[test]
    fn a_folder_is_complete_or_has_no_record() {
        let (mesh, bands) = (sample(), names(&["r", "g"]));
        let values = [1.0; 6];
        let field = Field::new(&mesh, &bands, &values, &values).unwrap();
        let view = View::framing(&field);
        let base = tempfile::tempdir().unwrap();
        let folder = base.path().join("new").join("result");
        let claim = |folder: &Path| ResultFolder::claim(folder).unwrap();
        let paths = write_all(&claim(&folder), &field, &record(), &view).unwrap();
        let named: Vec<PathBuf> = FILES.iter().map(|name| folder.join(name)).collect();
        let usual = [&named[..7], &named[8..]].concat();
        assert_eq!(paths, usual, "no page was asked for");
        let report = RunReport { title: "box", view: &view, steps: ("", &[]) };
        let image = Some(render(&field, &view.camera, view.exposure).unwrap());
        let more = Extras { image, report: Some(report), ..Extras::default() };
        let paths = write_with(&claim(&folder), &field, &record(), &more).unwrap();
        assert_eq!(paths, named);
        assert!(paths.iter().all(|path| fs::metadata(path).unwrap().len() > 50));
        let count = || fs::read_dir(&folder).unwrap().count();
        assert_eq!(count(), FILES.len() + 1, "the files and their list");
        assert_eq!(read_run(&paths[8]).unwrap(), record());
        // A folder in the place of a file makes the third attempt fail.
        fs::remove_file(&paths[4]).unwrap();
        fs::create_dir(&paths[4]).unwrap();
        let error = write_all(&claim(&folder), &field, &record(), &view).unwrap_err();
        assert!(error.to_string().contains("field.npz"), "{error}");
        assert!(!paths[8].exists());
        assert_eq!(count(), 2, "no file of an earlier result stays, but their list");
    }

    #[test]
    fn without_a_picture_an_old_one_goes_and_all_else_is_written() {
        let (mesh, bands) = (sample(), names(&["r", "g"]));
        let values = [1.0; 6];
        let field = Field::new(&mesh, &bands, &values, &values).unwrap();
        let folder = tempfile::tempdir().unwrap();
        let claim = || ResultFolder::claim(folder.path()).unwrap();
        write_all(&claim(), &field, &record(), &View::framing(&field)).unwrap();
        assert!(folder.path().join(IMAGE).exists());
        let paths = write_with(&claim(), &field, &record(), &Extras::default()).unwrap();
        assert_eq!(paths.len(), FILES.len() - 2);
        assert!(!folder.path().join(IMAGE).exists() && paths.iter().all(|path| path.exists()));
    }

    #[test]
    fn a_bad_view_leaves_an_old_result_alone() {
        let (mesh, bands) = (sample(), names(&["r", "g"]));
        let values = [1.0; 6];
        let field = Field::new(&mesh, &bands, &values, &values).unwrap();
        let view = View { exposure: Exposure::Fixed(-1.0), ..View::framing(&field) };
        let base = tempfile::tempdir().unwrap();
        assert!(matches!(
            write_all(&ResultFolder::claim(base.path()).unwrap(), &field, &record(), &view),
            Err(ReportError::Exposure { .. })
        ));
        assert_eq!(fs::read_dir(base.path()).unwrap().count(), 0);
    }
}
