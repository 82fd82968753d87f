//! `run.json`: what made a result. Format `fredholm-run-1`.
//!
//! Units: seconds, bytes; residuals ‖b − A x‖₂/‖b‖₂ and the other figures of quality are
//! dimensionless unless said.

use std::collections::BTreeMap;
use std::fs;
use std::io::{self, Write};
use std::path::Path;

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};
use serde_json::Value;

use crate::{Hierarchy, ReportError, reading};

/// Name and version of the format of run records.
pub const FORMAT: &str = "fredholm-run-1";

/// What made a result, and how far it can be trusted.
///
/// Reading is lenient: unknown keys are passed over and missing ones take their default, so that
/// records of older and newer programs with the same format name can be read. A number that is not
/// finite is written as `null`.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(default)]
pub struct RunRecord {
    /// Format of the record: [`FORMAT`].
    pub format: String,
    /// Version of the program.
    pub version: String,
    /// Path of the scene file, as it was given.
    pub scene: String,
    /// SHA-256 of the scene and the files it names, in hexadecimal.
    pub scene_sha256: String,
    /// The complete options, defaults included.
    pub options: Value,
    /// Names of the bands, in the order of all vectors.
    pub bands: Vec<String>,
    /// Sizes of the problem.
    pub counts: Counts,
    /// Wall-clock time of each stage, in order.
    pub timings: Vec<Timing>,
    /// Memory predicted before any was taken, bytes.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub predicted_memory_bytes: Option<u64>,
    /// Largest memory in use, bytes, where the system tells.
    pub peak_memory_bytes: Option<u64>,
    /// Name of the discretisation.
    pub discretisation: String,
    /// What the values of elements are means of.
    pub means: String,
    /// Name of the solver.
    pub solver: String,
    /// Relative residual asked for.
    pub tolerance: Option<f64>,
    /// Residuals along the way.
    pub history: History,
    /// Work done, by name of the counter.
    pub work: BTreeMap<String, u64>,
    /// Why the solver stopped.
    pub stop_reason: String,
    /// What the faces receive, one entry a band.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub received: Vec<Received>,
    /// Standard error of the irradiance of the faces over the irradiance, L2 over the faces in the worst band,
    /// where it was traced.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub standard_error: Option<f64>,
    /// Row sums of the form factors against 1.
    pub closure: Closure,
    /// Pairs of elements by the method that computed their form factor.
    pub pairs: BTreeMap<String, u64>,
    /// Estimated error of the mesh.
    pub mesh_error: Option<MeshError>,
    /// What hierarchical radiosity did, where it did.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub hierarchy: Option<Hierarchy>,
    /// Where an accuracy was asked for: the way it was reached, and why.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub choice: Option<String>,
    /// How the picture was made: where its light comes from, and how it was mapped to what a screen
    /// shows.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub picture: Option<String>,
    /// Estimated error of the field as piecewise polynomials.
    pub field_error: Option<FieldError>,
    /// Largest violation of `A_i F_ij = A_j F_ji` among the partly occluded pairs checked, as a
    /// form factor.
    pub reciprocity: Option<f64>,
    /// Estimated error of the form factors.
    pub form_factor_error: FormFactorError,
    /// Energy balance, one entry a band.
    pub energy: Vec<Energy>,
    /// Names of the files of the folder, in the order in which they were written.
    pub files: Vec<String>,
    /// What the user should know.
    pub warnings: Vec<String>,
    /// Whether the run was interrupted, so that the field is not the solution asked for.
    pub partial: bool,
}

impl Default for RunRecord {
    fn default() -> Self {
        Self {
            format: FORMAT.to_owned(),
            version: String::new(),
            scene: String::new(),
            scene_sha256: String::new(),
            options: Value::Null,
            bands: Vec::new(),
            counts: Counts::default(),
            timings: Vec::new(),
            predicted_memory_bytes: None,
            peak_memory_bytes: None,
            discretisation: String::new(),
            means: String::new(),
            solver: String::new(),
            tolerance: None,
            history: History::default(),
            work: BTreeMap::new(),
            stop_reason: String::new(),
            received: Vec::new(),
            standard_error: None,
            closure: Closure::default(),
            pairs: BTreeMap::new(),
            mesh_error: None,
            hierarchy: None,
            choice: None,
            picture: None,
            field_error: None,
            reciprocity: None,
            form_factor_error: FormFactorError::default(),
            energy: Vec::new(),
            files: Vec::new(),
            warnings: Vec::new(),
            partial: false,
        }
    }
}

/// Sizes of a problem.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(default)]
pub struct Counts {
    /// Named surfaces.
    pub surfaces: u64,
    /// Input faces.
    pub faces: u64,
    /// Leaf elements.
    pub elements: u64,
    /// Unknowns of the system, in each band.
    pub unknowns: u64,
    /// Undivided pieces that block the view.
    pub occluders: u64,
    /// Bands.
    pub bands: u64,
    /// Stored entries of the operator.
    pub matrix_entries: u64,
}

/// Estimated error of the irradiance of faces from the size of the elements.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(default)]
pub struct MeshError {
    /// Relative L2 norm over the faces, per band.
    pub relative_l2: Vec<f64>,
    /// Largest error of a face, W/m², per band.
    pub largest: Vec<f64>,
}

/// Estimated error of the irradiance as piecewise polynomials E_h, from the iterated one H B_h.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(default)]
pub struct FieldError {
    /// ‖E_h − H B_h‖/‖H B_h‖ in L2 over the surfaces, per band.
    pub relative_l2: Vec<f64>,
}

/// Wall-clock time of a stage.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(default)]
pub struct Timing {
    /// Name of the stage.
    pub stage: String,
    /// Seconds.
    pub seconds: f64,
}

/// Residuals along the way. All vectors have one entry a point; `residual` has one such vector a
/// band.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(default)]
pub struct History {
    /// Iterations done.
    pub iterations: Vec<u64>,
    /// Seconds since the solver started.
    #[serde(deserialize_with = "reading::row")]
    pub seconds: Vec<f64>,
    /// ‖b − A x‖₂/‖b‖₂: `residual[band][point]`.
    #[serde(deserialize_with = "reading::rows")]
    pub residual: Vec<Vec<f64>>,
}

/// Irradiance of the faces in a band, W/m².
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(default)]
pub struct Received {
    /// Name of the band.
    pub band: String,
    /// Area mean.
    pub mean: f64,
    /// Of the darkest face.
    pub least: f64,
    /// Of the brightest.
    pub most: f64,
}

/// How far the row sums `Σ_j F_ij` of the elements that see anything are from 1, and where the
/// light goes that they lack. A share is dimensionless.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(default)]
pub struct Closure {
    /// Largest `|Σ_j F_ij − 1|`.
    pub max: Option<f64>,
    /// Area mean of `|Σ_j F_ij − 1|`.
    pub mean: Option<f64>,
    /// Leaf element of the largest.
    pub worst_element: Option<u64>,
    /// Surface of the largest.
    pub worst_surface: Option<String>,
    /// Share of the area that sees nothing: other surfaces stand on it, it lies on one, or it looks
    /// into the void.
    pub blind: Option<f64>,
    /// Rays that were cast from the elements all of which sees something, with even places and the
    /// directions of light.
    pub rays: Option<u64>,
    /// Share of them that meets nothing: the openings of the scene.
    pub open: Option<f64>,
    /// Share of them that ends on the back of a one-sided surface.
    pub backs: Option<f64>,
    /// What the row sums of these elements lack of 1, the area mean.
    pub missing: Option<f64>,
}

/// Estimated error of the form factors.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(default)]
pub struct FormFactorError {
    /// Error asked for.
    pub tolerance: Option<f64>,
    /// Largest estimate for a pair.
    pub max: Option<f64>,
    /// Largest sum of estimates over a row.
    pub row_max: Option<f64>,
}

/// Energy balance of a band, W.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(default)]
pub struct Energy {
    /// Name of the band.
    pub band: String,
    /// What the surfaces emit by themselves, `Σ A_i M_i`.
    pub emitted: Option<f64>,
    /// What the surfaces absorb, `Σ A_i (1 − ρ_i) E_i`.
    pub absorbed: Option<f64>,
    /// What leaves through openings, `Σ A_i B_i (1 − Σ_j F_ij)`.
    pub escaped: Option<f64>,
}

/// Writes a run record as indented JSON.
///
/// # Errors
/// What `out` reports.
pub fn write_run(run: &RunRecord, out: &mut dyn Write) -> io::Result<()> {
    serde_json::to_writer_pretty(&mut *out, run)?;
    writeln!(out)
}

/// Reads a run record.
///
/// # Errors
/// [`ReportError::Read`] where the file cannot be read, [`ReportError::BrokenRun`] for a file cut
/// short or damaged, [`ReportError::ForeignRun`] for JSON of another kind.
pub fn read_run(path: &Path) -> Result<RunRecord, ReportError> {
    let bytes = fs::read(path).map_err(|source| ReportError::Read { path: path.to_owned(), source })?;
    let broken =
        |error: &serde_json::Error| ReportError::BrokenRun { path: path.to_owned(), why: error.to_string() };
    let value: Value = serde_json::from_slice(&bytes).map_err(|error| broken(&error))?;
    match value.get("format") {
        Some(Value::String(format)) if format == FORMAT => {
            serde_json::from_value(value).map_err(|error| broken(&error))
        }
        other => Err(foreign(path, other)),
    }
}

fn foreign(path: &Path, format: Option<&Value>) -> ReportError {
    let found = format.map_or_else(|| "missing".to_owned(), ToString::to_string);
    ReportError::ForeignRun { path: path.to_owned(), found, expected: FORMAT }
}

#[cfg(test)]
pub(crate) mod tests {
    use super::*;
    use std::path::PathBuf;

    pub(crate) fn record() -> RunRecord {
        RunRecord {
            version: "1.2.3".into(),
            scene: "scenes/box.toml".into(),
            scene_sha256: "ab".repeat(32),
            options: serde_json::json!({ "solver": "gauss-seidel", "tolerance": 1e-9 }),
            bands: vec!["r".into(), "g".into()],
            counts: Counts { elements: 3, bands: 2, matrix_entries: 6, ..Counts::default() },
            timings: vec![Timing { stage: "solve".into(), seconds: 0.1 + 0.2 }],
            peak_memory_bytes: Some(u64::MAX),
            solver: "gauss-seidel".into(),
            tolerance: Some(1e-9),
            history: History {
                iterations: vec![0, 1, 2],
                seconds: vec![0.0, 0.1, 1.0 / 3.0],
                residual: vec![vec![1.0, 1e-3, 7.1e-11], vec![1.0, 2e-3, 0.0]],
            },
            work: BTreeMap::from([("row_visits".into(), 6)]),
            stop_reason: "converged".into(),
            closure: Closure { max: Some(1e-4), worst_surface: Some("floor".into()), ..Closure::default() },
            energy: vec![Energy { band: "r".into(), emitted: Some(5.0), ..Energy::default() }],
            warnings: vec!["half \"open\"".into()],
            partial: true,
            ..RunRecord::default()
        }
    }

    fn saved(text: &[u8]) -> (tempfile::TempDir, PathBuf) {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("run.json");
        fs::write(&path, text).unwrap();
        (folder, path)
    }

    fn written(run: &RunRecord) -> Vec<u8> {
        let mut out = Vec::new();
        write_run(run, &mut out).unwrap();
        out
    }

    #[test]
    fn a_record_reads_back() {
        let (_folder, path) = saved(&written(&record()));
        assert_eq!(read_run(&path).unwrap(), record());
    }

    #[test]
    fn a_diverged_history_reads_back() {
        let mut run = record();
        run.history.residual[1][2] = f64::INFINITY;
        let (_folder, path) = saved(&written(&run));
        let back = read_run(&path).unwrap();
        assert!(back.history.residual[1][2].is_nan());
        assert_eq!(back.history.residual[0], run.history.residual[0]);
    }

    #[test]
    fn unknown_and_missing_keys_are_tolerated() {
        let (_folder, path) = saved(br#"{"format": "fredholm-run-1", "solver": "lu", "colour": 3}"#);
        assert_eq!(read_run(&path).unwrap(), RunRecord { solver: "lu".into(), ..RunRecord::default() });
    }

    #[test]
    fn every_truncation_is_noticed() {
        let text = written(&record());
        for length in 0..text.len() - 2 {
            let (_folder, path) = saved(&text[..length]);
            let error = read_run(&path).unwrap_err();
            assert!(matches!(error, ReportError::BrokenRun { .. }), "{length}: {error}");
        }
    }

    #[test]
    fn foreign_files_are_refused() {
        for (text, found) in [("[]", "missing"), ("{\"format\": \"x\"}", "\"x\""), ("{\"format\": 3}", "3")] {
            let (_folder, path) = saved(text.as_bytes());
            let message = read_run(&path).unwrap_err().to_string();
            assert!(message.contains(&format!("\"format\" is {found}, not")), "{message}");
        }
        let (_folder, path) = saved(br#"{"format": "fredholm-run-1", "bands": 7}"#);
        assert!(matches!(read_run(&path).unwrap_err(), ReportError::BrokenRun { .. }));
        let missing = read_run(Path::new("/nonexistent/run.json")).unwrap_err();
        assert!(matches!(missing, ReportError::Read { .. }));
    }
}
