//! The files of a comparison of a deterministic with a stochastic solution. `crosscheck.json` is
//! written last.
//!
//! Columns of `crosscheck.csv`: `face, surface, cx, cy, cz, area, band`, then `deterministic`,
//! `deterministic_error`, `stochastic`, `standard_error` (irradiance, W/m²), `z`, `p`, and
//! `significant` (1 or 0).

use std::io::{self, Write};
use std::path::PathBuf;

use fredholm_mesh::Mesh;
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use super::faces::{COLUMNS, place};
use super::histogram::write_score_histogram;
use crate::csv::{numbers, quoted};
use crate::words::number;
use crate::{
    Picture, REPORT, ReportError, ReportModel, ReportPage, ResultFolder, Timing, View, face_scores, reading,
};

/// Names of the files, in the order in which they are written.
pub const CROSSCHECK_FILES: [&str; 4] =
    ["crosscheck.csv", "crosscheck.svg", "crosscheck.png", "crosscheck.json"];
/// Name and version of the format of the record.
pub const CROSSCHECK_FORMAT: &str = "fredholm-crosscheck-1";

/// One face in one band; irradiances in W/m².
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct CrosscheckRow {
    /// The face.
    pub face: usize,
    /// The band.
    pub band: usize,
    /// Deterministic value and what it says of its error.
    pub deterministic: [f64; 2],
    /// Stochastic value and its standard error.
    pub stochastic: [f64; 2],
    /// Normal score of the difference.
    pub z: f64,
    /// Two-sided probability of it.
    pub p: f64,
    /// Whether it is significant.
    pub significant: bool,
}

/// A place far apart.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(default)]
pub struct WorstPlace {
    /// `face`, `surface`, `whole`, or `point` of a receiver.
    pub kind: String,
    /// The face, or the point of a receiver.
    pub face: usize,
    /// Its surface, or the receiver.
    pub surface: String,
    /// Its centroid, or where it lies, m.
    pub centroid: [f64; 3],
    /// The band, or component and frequency.
    pub band: String,
    /// The score.
    #[serde(deserialize_with = "reading::number")]
    pub z: f64,
    /// Difference over the deterministic value.
    #[serde(deserialize_with = "reading::number")]
    pub relative: f64,
}

/// The smallest deviations that would have been found nine times out of ten, over the irradiance;
/// none where nothing is lit.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(default)]
pub struct CrosscheckPower {
    /// Of the mean over everything, in the worst band.
    pub whole: Option<f64>,
    /// Of the mean over a surface, the median of all.
    pub surface: Option<f64>,
    /// Of a face, the median of all.
    pub face: Option<f64>,
}

/// What a comparison came to.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(default)]
pub struct CrosscheckRecord {
    /// Format of the record: [`CROSSCHECK_FORMAT`].
    pub format: String,
    /// Version of the program.
    pub version: String,
    /// Path of the scene file, as it was given.
    pub scene: String,
    /// SHA-256 of the scene and the files it names, in hexadecimal.
    pub scene_sha256: String,
    /// `agree`, `disagree`, or `undecided` where too little was sampled.
    pub verdict: String,
    /// Level of significance.
    pub significance: f64,
    /// Correction for many tests.
    pub correction: String,
    /// Faces, surfaces and the whole times bands, or numbers of the field.
    pub places: usize,
    /// How many are significantly apart.
    pub significant: usize,
    /// What would have been found; not known of fields.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub power: Option<CrosscheckPower>,
    /// Mean of the scores, and mean of their squares.
    #[serde(deserialize_with = "reading::number")]
    pub score_mean: f64,
    /// Mean of the squares of the scores.
    #[serde(deserialize_with = "reading::number")]
    pub score_variance: f64,
    /// The worst places.
    pub worst: Vec<WorstPlace>,
    /// Stochastic method.
    pub method: String,
    /// Seed.
    pub seed: u64,
    /// Batches.
    pub batches: u64,
    /// Relative standard error in L² over the faces, the worst band.
    #[serde(deserialize_with = "reading::number")]
    pub relative_error: f64,
    /// Deterministic solver.
    pub solver: String,
    /// Wall-clock time of each stage.
    pub timings: Vec<Timing>,
}

impl CrosscheckRecord {
    /// The verdict in one line.
    pub(crate) fn headline(&self) -> String {
        headline(&self.verdict, [self.significant, self.places], [self.score_mean, self.score_variance])
    }
}

/// A verdict in one line: places that are significantly apart of all, the mean of the scores and of
/// their squares.
pub(crate) fn headline(verdict: &str, [apart, places]: [usize; 2], [mean, variance]: [f64; 2]) -> String {
    let [mean, variance] = [mean, variance].map(number);
    format!("{verdict}: {apart} of {places} places apart, mean z {mean}, mean z² {variance}")
}

/// Writes the table.
///
/// # Errors
/// What `out` reports.
pub fn write_crosscheck_csv(
    mesh: &Mesh,
    bands: &[String],
    rows: &[CrosscheckRow],
    out: &mut dyn Write,
) -> io::Result<()> {
    writeln!(
        out,
        "{COLUMNS},band,deterministic,deterministic_error,stochastic,standard_error,z,p,significant"
    )?;
    for row in rows {
        place(mesh, row.face, out)?;
        write!(out, ",{}", quoted(&bands[row.band]))?;
        numbers(out, row.deterministic.into_iter().chain(row.stochastic).chain([row.z, row.p]))?;
        writeln!(out, ",{}", u8::from(row.significant))?;
    }
    Ok(())
}

/// Writes all files into a folder and returns their paths; with a title,
/// `report.html` too, where the scores are seen on the faces, from where the view has them.
///
/// # Errors
/// [`ReportError::Write`] with the file or folder that could not be written. The folder then has no
/// `crosscheck.json`.
pub fn write_crosscheck(
    folder: &ResultFolder,
    mesh: &Mesh,
    bands: &[String],
    (rows, map): (&[CrosscheckRow], &Picture),
    record: &CrosscheckRecord,
    report: Option<(&str, Option<&View>)>,
) -> Result<Vec<PathBuf>, ReportError> {
    let [table, histogram, drawn, last] = CROSSCHECK_FILES;
    let scores: Vec<f64> = rows.iter().map(|row| row.z).collect();
    let title = record.headline();
    let table = folder.write(table, |out| write_crosscheck_csv(mesh, bands, rows, out))?;
    let histogram = folder.write(histogram, |out| write_score_histogram(&title, &scores, out))?;
    let drawn = folder.write(drawn, |out| map.write_png(out))?;
    let values = report.map(|_| face_scores(mesh, bands, rows)).unwrap_or_default();
    if let Some((title, view)) = report {
        let model = ReportModel { view, values: &values, ..ReportModel::bare(mesh) };
        let page = ReportPage::of_crosscheck(title, record, rows, model, Some(map));
        folder.write(REPORT, |out| page.write(out))?;
    }
    Ok(vec![table, histogram, drawn, folder.write(last, |out| json(record, out))?])
}

pub(crate) fn json(record: &impl Serialize, out: &mut dyn Write) -> io::Result<()> {
    serde_json::to_writer_pretty(&mut *out, record)?;
    writeln!(out)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::csv::tests::parse;
    use crate::field::tests::{names, sample};

    #[test]
    fn rows_say_where_and_how_far() {
        let (mesh, bands) = (sample(), names(&["r, deep", "g"]));
        let row = CrosscheckRow {
            face: 2,
            band: 0,
            deterministic: [2.0, 0.5],
            stochastic: [3.0, 0.25],
            z: 1.5,
            p: 0.125,
            significant: true,
        };
        let mut out = Vec::new();
        write_crosscheck_csv(&mesh, &bands, &[row], &mut out).unwrap();
        let rows = parse(&String::from_utf8(out).unwrap());
        assert_eq!(rows[0].len(), rows[1].len());
        assert_eq!(rows[1][..2], ["2", "<lamp & shade>"]);
        assert_eq!(rows[1][6..], ["r, deep", "2", "0.5", "3", "0.25", "1.5", "0.125", "1"]);
    }
}
