//! A bundle of reference values with stated errors, for checking other tracers. `reference.json` is
//! written last.
//!
//! `pixels.npz`: the pixels of the camera ([`Pixels`](super::Pixels)); their radiance is the
//! radiosity over π. `reference.csv`: a row a face, `face, surface, cx, cy, cz, area`, then band by
//! band `E_BAND` (mean irradiance over the whole face, W/m²), `E_error_BAND` (one standard
//! deviation, all known errors together), `E_deterministic_BAND`, `B_BAND` (radiosity, M + ρ E),
//! `rho_BAND` and `M_BAND`. `patches.obj`: the outlines, an object a surface, a group a face; lit
//! on the side from which corners run counter-clockwise.

use std::io::{self, Write};
use std::path::PathBuf;

use fredholm_mesh::Mesh;
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use super::Pixels;
use super::crosscheck::json;
use super::faces::{COLUMNS, place};
use crate::csv::{header, numbers};
use crate::number::Number;
use crate::{
    Exposure, Field, REPORT, ReportError, ReportModel, ReportPage, ResultFolder, Timing, View,
    face_quantities,
};

/// Names of the files, in the order in which they are written.
pub const REFERENCE_FILES: [&str; 4] = ["reference.csv", "patches.obj", "pixels.npz", "reference.json"];
/// Name and version of the format of the record.
pub const REFERENCE_FORMAT: &str = "fredholm-reference-3";

/// Values of every face and band, face-major.
#[derive(Clone, Debug, PartialEq)]
pub struct ReferenceTable {
    /// Mean irradiance, W/m².
    pub irradiance: Vec<f64>,
    /// Its standard deviation, W/m².
    pub error: Vec<f64>,
    /// The deterministic irradiance, W/m².
    pub deterministic: Vec<f64>,
    /// Reflectance.
    pub reflectance: Vec<f64>,
    /// Exitance, W/m².
    pub exitance: Vec<f64>,
}

/// The camera whose pixels are known, and how they were sampled. A sample is at an even place of
/// its pixel (a box filter).
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct ReferencePixels {
    /// Where the eye stands, m.
    pub eye: [f64; 3],
    /// The point in the middle of the picture, m.
    pub target: [f64; 3],
    /// Direction that is up in the picture.
    pub up: [f64; 3],
    /// Field of view from the lower to the upper edge, degrees.
    pub vertical_fov_degrees: f64,
    /// Pixels in a row.
    pub width: u32,
    /// Rows of pixels, from the top.
    pub height: u32,
    /// Whether the scene has no camera, or one that stands behind a wall, so that one was chosen.
    pub chosen: bool,
    /// Batches of samples of a pixel.
    pub batches: u32,
    /// Samples of a batch.
    pub samples: u32,
    /// Standard error over the value in L² over the pixels, the worst band.
    pub relative_error: f64,
}

/// What made the values.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(default)]
pub struct ReferenceRecord {
    /// Format of the record: [`REFERENCE_FORMAT`].
    pub format: String,
    /// Version of the program.
    pub version: String,
    /// Path of the scene file, as it was given.
    pub scene: String,
    /// SHA-256 of the scene and the files it names, in hexadecimal.
    pub scene_sha256: String,
    /// Signs and units of the table.
    pub conventions: Vec<String>,
    /// How the values came about.
    pub method: String,
    /// Names of the bands.
    pub bands: Vec<String>,
    /// Number of faces.
    pub faces: usize,
    /// Stated error over the value in L² over the faces, weighted by area, the worst band.
    pub relative_error: f64,
    /// Stated error of a face over its own value: the median over the faces and bands that are lit.
    pub median_error: f64,
    /// Error asked for in a row of form factors.
    pub form_factor_tolerance: f64,
    /// Seed.
    pub seed: u64,
    /// Batches.
    pub batches: u64,
    /// The camera and its pixels.
    pub pixels: ReferencePixels,
    /// Wall-clock time of each stage.
    pub timings: Vec<Timing>,
}

/// Writes all files into a folder and returns their paths; with a title, `report.html` too, seen
/// from where the view has it.
///
/// # Errors
/// [`ReportError::Length`] for a table of another length, [`ReportError::Write`] with the file that
/// could not be written.
pub fn write_reference(
    folder: &ResultFolder,
    mesh: &Mesh,
    (table, pixels): (&ReferenceTable, &Pixels),
    record: &ReferenceRecord,
    report: Option<(&str, &View)>,
) -> Result<Vec<PathBuf>, ReportError> {
    let (expected, found) = (mesh.faces().len() * record.bands.len(), table.irradiance.len());
    let columns =
        [&table.irradiance, &table.error, &table.deterministic, &table.reflectance, &table.exitance];
    if columns.iter().any(|column| column.len() != expected) {
        return Err(ReportError::Length { what: "the reference table", expected, found });
    }
    pixels.check(record.bands.len())?;
    let [values, patches, picture, last] = REFERENCE_FILES;
    if let Some(report) = report {
        page(folder, mesh, (table, pixels), record, report)?;
    }
    Ok(vec![
        folder.write(values, |out| csv(mesh, table, &record.bands, out))?,
        folder.write(patches, |out| obj(mesh, out))?,
        folder.write(picture, |out| pixels.write_npz(out))?,
        folder.write(last, |out| json(record, out))?,
    ])
}

/// `report.html`: the values of the faces on their elements, with their stated errors.
fn page(
    folder: &ResultFolder,
    mesh: &Mesh,
    (table, pixels): (&ReferenceTable, &Pixels),
    record: &ReferenceRecord,
    (title, view): (&str, &View),
) -> Result<(), ReportError> {
    let bands = &record.bands;
    let all = (0..mesh.len()).flat_map(|leaf| (0..bands.len()).map(move |band| (leaf, band)));
    let places: Vec<usize> = all.map(|(leaf, band)| mesh.face_of(leaf) * bands.len() + band).collect();
    let of_leaves = |values: &[f64]| -> Vec<f64> { places.iter().map(|&at| values[at]).collect() };
    let (irradiance, exitance) = (of_leaves(&table.irradiance), of_leaves(&table.exitance));
    let reflected = irradiance.iter().zip(of_leaves(&table.reflectance)).map(|(e, rho)| rho * e);
    let radiosity: Vec<f64> = reflected.zip(&exitance).map(|(reflected, m)| m + reflected).collect();
    let field = Field::new(mesh, bands, &irradiance, &radiosity)?.with_exitance(&exitance)?;
    let what = ("Stated error of E", "σ(E)", "W/m²");
    let errors = face_quantities(mesh, bands, &table.error, what);
    let model = ReportModel { values: &errors, ..ReportModel::lit(&field, view) };
    let picture = pixels.picture(bands, Exposure::Auto)?;
    let page = ReportPage::of_reference(title, &field, record, model, Some(&picture));
    folder.write(REPORT, |out| page.write(out)).map(drop)
}

fn csv(mesh: &Mesh, table: &ReferenceTable, bands: &[String], out: &mut dyn Write) -> io::Result<()> {
    header(out, COLUMNS, &["E", "E_error", "E_deterministic", "B", "rho", "M"], bands)?;
    for face in 0..mesh.faces().len() {
        place(mesh, face, out)?;
        for at in face * bands.len()..(face + 1) * bands.len() {
            let (e, rho, m) = (table.irradiance[at], table.reflectance[at], table.exitance[at]);
            numbers(out, [e, table.error[at], table.deterministic[at], m + rho * e, rho, m])?;
        }
        writeln!(out)?;
    }
    Ok(())
}

fn obj(mesh: &Mesh, out: &mut dyn Write) -> io::Result<()> {
    let (mut surface, mut face, mut corner) = (None, None, 1);
    for (leaf, patch) in mesh.patches().enumerate() {
        if surface != Some(mesh.surface_of(leaf)) {
            surface = Some(mesh.surface_of(leaf));
            writeln!(
                out,
                "o {}",
                mesh.surfaces()[mesh.surface_of(leaf)].name.replace(char::is_whitespace, "_")
            )?;
        }
        if face != Some(mesh.face_of(leaf)) {
            face = Some(mesh.face_of(leaf));
            writeln!(out, "g face_{}", mesh.face_of(leaf))?;
        }
        for p in patch.corners() {
            writeln!(out, "v {} {} {}", Number(p.x), Number(p.y), Number(p.z))?;
        }
        write!(out, "f")?;
        (0..patch.sides()).try_for_each(|i| write!(out, " {}", corner + i))?;
        writeln!(out)?;
        corner += patch.sides();
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::csv::tests::parse;
    use crate::field::tests::sample;

    #[test]
    fn the_bundle_holds_values_and_outlines() {
        let mesh = sample();
        let table = ReferenceTable {
            irradiance: vec![1.0, 2.0, 4.0],
            error: vec![0.5; 3],
            deterministic: vec![1.5; 3],
            reflectance: vec![0.25; 3],
            exitance: vec![0.0, 0.0, 3.0],
        };
        let mut out = Vec::new();
        csv(&mesh, &table, &["grey".to_owned()], &mut out).unwrap();
        let rows = parse(&String::from_utf8(out).unwrap());
        assert_eq!(rows[3][6..], ["4", "0.5", "1.5", "4", "0.25", "3"]);
        let mut out = Vec::new();
        obj(&mesh, &mut out).unwrap();
        let text = String::from_utf8(out).unwrap();
        assert_eq!(text.lines().filter(|line| line.starts_with("f ")).count(), 3);
        assert!(text.contains("g face_2") && text.ends_with("f 9 10 11\n"), "{text}");
    }
}
