//! The files of a solution, each a value: its name, when it is written, how, and what it holds.
//!
//! A new file is a module here with its [`OutputFile`], and a line in [`ALL`]. `run.json` is
//! written last: a folder that has one is complete, and all its files belong together, since what
//! earlier runs have left is removed first.

mod meshes;
mod page;
mod pictures;
mod tables;

use std::io::{self, Write};
use std::path::PathBuf;

use crate::catalogue::CataloguedFile;
use crate::{
    Camera, ElementLinks, Exposure, FalseColourPicture, Field, FieldStep, Picture, PointTable, ReportError,
    ReportModel, ReportPage, ResultFolder, RunRecord, ShadowMesh, render,
};

/// The commands that write what every solution has.
const LIGHT_COMMANDS: &str = "solve, resume";

/// All files of a solution, in the order in which they are written.
const ALL: &[&dyn OutputFile] = &[
    &pictures::Mesh,
    &pictures::Links,
    &pictures::Pixels,
    &pictures::FalseColours,
    &tables::FalseColours,
    &tables::Points,
    &meshes::Shadows,
    &meshes::Ply,
    &meshes::Glb,
    &pictures::Exr,
    &tables::Elements,
    &tables::Faces,
    &tables::Surfaces,
    &meshes::Vtu,
    &meshes::Npz,
    &pictures::Image,
    &page::Convergence,
    &page::Page,
    &page::Record,
];

/// The picture.
pub const IMAGE: &str = "image.png";
/// The page for the browser.
pub const REPORT: &str = "report.html";
/// The picture of the elements.
pub const MESH_PICTURE: &str = "mesh.png";
/// The picture of the links of an element.
pub const LINKS_PICTURE: &str = "links.png";
/// The irradiance of the picture in false colour.
pub const FALSE_COLOUR: &str = "false_colour.png";
/// The elements with colours, as PLY.
pub const FIELD_PLY: &str = "field.ply";
/// The same as binary glTF.
pub const FIELD_GLB: &str = "field.glb";
/// The linear colours of the picture, as OpenEXR.
pub const FIELD_EXR: &str = "image.exr";
/// The record of a run that has solved or traced a scene.
pub const RUN: &str = "run.json";

/// A file of the folder of a solution.
pub trait OutputFile: Sync {
    /// Its name in the folder.
    fn name(&self) -> &'static str;

    /// What it holds, for `docs/results.md`. There is none where that of another file tells both,
    /// or where the keys are told by their type.
    fn about(&self) -> Option<CataloguedFile>;

    /// Whether a run writes it by its settings.
    fn is_wanted(&self, wanted: &Wanted) -> bool;

    /// Whether there is what it is made from: a run that was stopped may lack it.
    fn is_ready(&self, _: &Extras<'_>) -> bool {
        true
    }

    /// Writes its contents.
    ///
    /// # Errors
    /// What `out` reports.
    fn write(&self, contents: &Contents<'_>, out: &mut dyn Write) -> io::Result<()>;
}

/// All files of a solution, in the order in which they are written.
pub fn output_files() -> impl Iterator<Item = &'static dyn OutputFile> {
    ALL.iter().copied()
}

/// The names of the files that a run writes by its settings.
pub fn wanted_files(wanted: &Wanted) -> impl Iterator<Item = &'static str> {
    output_files().filter(|file| file.is_wanted(wanted)).map(OutputFile::name)
}

/// Which files the settings of a run ask for, besides those that every solution has.
#[derive(Clone, Debug, Default)]
#[allow(clippy::struct_excessive_bools, reason = "each is a wish of its own")]
pub struct Wanted {
    /// [`IMAGE`].
    pub image: bool,
    /// [`REPORT`].
    pub page: bool,
    /// [`MESH_PICTURE`] and [`LINKS_PICTURE`].
    pub links: bool,
    /// [`PIXELS`](crate::PIXELS).
    pub gather: bool,
    /// [`FALSE_COLOUR`] and its table.
    pub false_colour: bool,
    /// The irradiance of points.
    pub points: bool,
    /// The elements cut along the borders of shadows.
    pub shadows: bool,
    /// Which of [`FIELD_PLY`], [`FIELD_GLB`] and [`FIELD_EXR`].
    pub also: Vec<&'static str>,
}

/// What the files of a solution are made from.
pub struct Contents<'a> {
    /// The field.
    pub field: &'a Field<'a>,
    /// The record.
    pub run: &'a RunRecord,
    /// What was drawn and computed besides.
    pub more: &'a Extras<'a>,
    page: Option<ReportPage<'a>>,
}

/// What a result folder holds besides the usual files.
#[derive(Default)]
pub struct Extras<'a> {
    /// The usual picture.
    pub image: Option<Picture>,
    /// Its linear colours, for [`FIELD_EXR`] and [`PIXELS`](crate::PIXELS).
    pub linear: Vec<[f32; 3]>,
    /// Standard error of them, where light was gathered.
    pub standard_error: Vec<[f32; 3]>,
    /// Further pictures with their names: [`MESH_PICTURE`], [`LINKS_PICTURE`].
    pub pictures: Vec<(&'static str, Picture)>,
    /// The irradiance in false colour, for [`FALSE_COLOUR`] and its table.
    pub false_colour: Option<FalseColourPicture>,
    /// How bright the colours of [`FIELD_PLY`] and [`FIELD_GLB`] are.
    pub exposure: Exposure,
    /// The irradiance of points.
    pub points: Option<PointTable>,
    /// Triangles cut along the borders of shadows.
    pub shadows: Option<ShadowMesh>,
    /// Which of [`FIELD_PLY`], [`FIELD_GLB`] and [`FIELD_EXR`] are wanted.
    pub also: Vec<&'static str>,
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
    /// What lights the elements most, where that is known.
    pub links: Option<&'a ElementLinks>,
}

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
/// [`ReportError::Write`] with the file or folder that could not be written; the errors of
/// [`render`](crate::render) for a view that makes no picture. The folder then has no `run.json`.
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
    let page = more.report.map(|RunReport { title, view, steps: (steps_title, steps), links }| {
        let model = ReportModel { steps, steps_title, links, ..ReportModel::lit(field, view) };
        ReportPage::of_run(title, field, run, model, more.image.as_ref())
    });
    let contents = Contents { field, run, more, page };
    let ready = output_files().filter(|file| file.is_ready(more));
    ready.map(|file| folder.write(file.name(), |out| file.write(&contents, out))).collect()
}

#[cfg(test)]
mod tests {
    use std::fs;
    use std::path::Path;

    use super::*;
    use crate::field::tests::{names, sample};
    use crate::read_run;
    use crate::run::tests::record;

    /// The files that a solution has without further wishes.
    fn usual() -> impl Iterator<Item = &'static str> {
        let wanted = Wanted { image: true, page: true, ..Wanted::default() };
        wanted_files(&wanted).collect::<Vec<_>>().into_iter()
    }

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
        let named: Vec<PathBuf> = usual().map(|name| folder.join(name)).collect();
        let page = folder.join(REPORT);
        let without_page: Vec<PathBuf> = named.iter().filter(|path| **path != page).cloned().collect();
        assert_eq!(paths, without_page, "no page was asked for");
        let report = RunReport { title: "box", view: &view, steps: ("", &[]), links: None };
        let image = Some(render(&field, &view.camera, view.exposure).unwrap());
        let more = Extras { image, report: Some(report), ..Extras::default() };
        let paths = write_with(&claim(&folder), &field, &record(), &more).unwrap();
        assert_eq!(paths, named);
        assert!(paths.iter().all(|path| fs::metadata(path).unwrap().len() > 50));
        let count = || fs::read_dir(&folder).unwrap().count();
        assert_eq!(count(), usual().count() + 1, "the files and their list");
        let [run, arrays] = [RUN, "field.npz"].map(|name| folder.join(name));
        assert_eq!(read_run(&run).unwrap(), record());
        // A folder in the place of a file makes the third attempt fail.
        fs::remove_file(&arrays).unwrap();
        fs::create_dir(&arrays).unwrap();
        let error = write_all(&claim(&folder), &field, &record(), &view).unwrap_err();
        assert!(error.to_string().contains("field.npz"), "{error}");
        assert!(!run.exists());
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
        assert_eq!(paths.len(), usual().count() - 2);
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
