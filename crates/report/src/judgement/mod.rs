//! What another tracer has found, and the files of its judgement. `judge.json` is written last.
//!
//! Columns of `judge.csv`: `kind` (`pixel`, `tile`, `picture`, or `face`, `surface`, `whole`),
//! `place` (its number, from 0; pixels and tiles row by row from the top), `band`, then
//! `reference`, `reference_error`, `found`, `standard_error` (radiance in W/(m² sr), or irradiance
//! in W/m²), `z`, `p`, and `significant` (1 or 0). `judge.svg` is the histogram of z; `judge.png`,
//! for pixels, their z in the worst band: red is where the tracer is the brighter, blue where it is
//! the darker; full at |z| = 5.

mod bundle;
mod pictures;
mod table;

use std::borrow::Cow;
use std::io::{self, Write};

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

pub use bundle::{
    ReferenceFaces, ReferenceValues, read_reference_faces, read_reference_pixels, read_reference_record,
};
pub use pictures::{PictureShape, read_measured_pixels};
pub use table::read_measured_faces;

use crate::csv::{numbers, quoted};
use crate::stochastic::{headline, json, score_colour, with_score_bar};
use crate::{CrosscheckPower, Picture, ReportError, ResultFolder, Timing, reading, write_score_histogram};

/// Names of the files, in the order in which they are written.
pub const JUDGE_FILES: [&str; 4] = ["judge.csv", "judge.svg", "judge.png", "judge.json"];
/// Name and version of the format of the record.
pub const JUDGE_FORMAT: &str = "fredholm-judge-1";

/// The values of another program.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Measured {
    /// The values of each independent run, place by place and band by band.
    pub seeds: Vec<Vec<f64>>,
    /// Their standard errors, where they are given.
    pub sigma: Option<Vec<f64>>,
    /// Relative rounding of the numbers in the file, where it is more than that of an f32.
    pub rounding: f64,
}

/// One place in one band.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(default)]
pub struct JudgedPlace {
    /// `pixel`, `tile`, `picture`, or `face`, `surface`, `whole`.
    pub kind: Cow<'static, str>,
    /// Its number.
    pub place: usize,
    /// Where it is, in words.
    pub name: String,
    /// The band.
    pub band: String,
    /// Reference value and its standard deviation.
    pub reference: [f64; 2],
    /// The tracer's value and its standard error.
    pub found: [f64; 2],
    /// Normal score of the difference.
    #[serde(deserialize_with = "reading::number")]
    pub z: f64,
    /// Two-sided probability of it.
    #[serde(deserialize_with = "reading::number")]
    pub p: f64,
    /// Whether it is significant.
    pub significant: bool,
}

/// What a judgement came to.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(default)]
pub struct JudgeRecord {
    /// Format of the record: [`JUDGE_FORMAT`].
    pub format: String,
    /// Version of the program.
    pub version: String,
    /// The bundle, as it was given.
    pub bundle: String,
    /// SHA-256 of the scene of the bundle and the files it names, in hexadecimal.
    pub scene_sha256: String,
    /// The files judged, as they were given.
    pub files: Vec<String>,
    /// `radiance of pixels` or `irradiance of faces`.
    pub quantity: String,
    /// `agree`, `disagree`, or `undecided` where too little was sampled.
    pub verdict: String,
    /// Level of significance.
    pub significance: f64,
    /// Correction for many tests.
    pub correction: String,
    /// Independent runs of the tracer.
    pub seeds: usize,
    /// Where the tracer's error comes from: `seeds`, `sigma` or `exact`.
    pub error_from: String,
    /// Relative standard deviation that is allowed for rounding.
    pub rounding: f64,
    /// Places times bands.
    pub places: usize,
    /// How many are significantly apart.
    pub significant: usize,
    /// What would have been found; face, surface and whole stand for pixel, tile and picture.
    pub power: CrosscheckPower,
    /// Mean of the scores of faces or pixels, without those where neither side has an error.
    #[serde(deserialize_with = "reading::number")]
    pub score_mean: f64,
    /// Mean of their squares.
    #[serde(deserialize_with = "reading::number")]
    pub score_variance: f64,
    /// The worst places.
    pub worst: Vec<JudgedPlace>,
    /// Wall-clock time of each stage.
    pub timings: Vec<Timing>,
}

/// Writes all files into a folder. `shape` is that of the picture, whose pixels are then the first
/// places.
///
/// # Errors
/// [`ReportError::Write`] with the file or folder that could not be written. The folder then has no
/// `judge.json`.
pub fn write_judgement(
    folder: &ResultFolder,
    places: &[JudgedPlace],
    shape: Option<PictureShape>,
    record: &JudgeRecord,
) -> Result<(), ReportError> {
    let [values, histogram, image, last] = JUDGE_FILES;
    let scores: Vec<f64> = places.iter().map(|place| place.z).collect();
    let JudgeRecord { verdict, significant, places: count, score_mean, score_variance, .. } = record;
    let title = headline(verdict, [*significant, *count], [*score_mean, *score_variance]);
    folder.write(values, |out| table(places, out))?;
    folder.write(histogram, |out| write_score_histogram(&title, &scores, out))?;
    if let Some(shape) = shape {
        let title = "Tracer and reference: red where the tracer is brighter";
        let picture = with_score_bar(title, &picture(&scores, shape))?;
        folder.write(image, |out| picture.write_png(out))?;
    }
    folder.write(last, |out| json(record, out)).map(drop)
}

fn table(places: &[JudgedPlace], out: &mut dyn Write) -> io::Result<()> {
    writeln!(out, "kind,place,band,reference,reference_error,found,standard_error,z,p,significant")?;
    for place in places {
        write!(out, "{},{},{}", place.kind, place.place, quoted(&place.band))?;
        numbers(out, place.reference.into_iter().chain(place.found).chain([place.z, place.p]))?;
        writeln!(out, ",{}", u8::from(place.significant))?;
    }
    Ok(())
}

/// The worst band of every pixel.
fn picture(scores: &[f64], shape: PictureShape) -> Picture {
    let worse = |a: f64, b: f64| if b.abs() > a.abs() { b } else { a };
    let pixels = scores.chunks(shape.bands).take(shape.width * shape.height);
    let colour = |pixel: &[f64]| score_colour(pixel.iter().copied().fold(0.0, worse));
    // Sides of a picture are numbers that were u32 before.
    let [width, height] = [shape.width, shape.height].map(|side| side as u32);
    Picture { width, height, pixels: pixels.flat_map(colour).collect() }
}
