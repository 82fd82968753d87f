//! The record of a matrix, a JSON file beside it. Format `fredholm-viewfactors-1`. Seconds, bytes;
//! the rest dimensionless unless said.

use std::collections::BTreeMap;
use std::fs;
use std::io::{self, Write};
use std::path::Path;

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};
use serde_json::Value;

use super::error::ViewFactorsError;
use crate::{Closure, FormFactorError, Timing};

/// Name and version of the format.
pub const VIEW_FACTORS_FORMAT: &str = "fredholm-viewfactors-1";

/// What made a matrix of view factors, and how far it can be trusted. Reading is lenient, as of a
/// run record.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(default)]
pub struct ViewFactorsRecord {
    /// [`VIEW_FACTORS_FORMAT`].
    pub format: String,
    /// Version of the program.
    pub version: String,
    /// The geometry, as it was given.
    pub input: String,
    /// SHA-256 of it and the files it names, in hexadecimal.
    pub input_sha256: String,
    /// What the geometry is called.
    pub title: Option<String>,
    /// The complete options, defaults included.
    pub options: Value,
    /// Sizes: `elements`, `rows`, `occluders`, `points`, `stored` factors.
    pub counts: BTreeMap<String, u64>,
    /// Pairs of elements by the method that computed their form factor.
    pub pairs: BTreeMap<String, u64>,
    /// Wall-clock time of each stage, in order.
    pub timings: Vec<Timing>,
    /// Memory predicted before any was taken.
    pub predicted_memory_bytes: Option<u64>,
    /// Largest memory in use, where the system tells.
    pub peak_memory_bytes: Option<u64>,
    /// Row sums against 1; `worst_element` is a row.
    pub closure: Closure,
    /// Estimated errors.
    pub form_factor_error: FormFactorError,
    /// Largest violation of `A_i F_ij = A_j F_ji` among the pairs checked, as a form factor.
    pub reciprocity: Option<f64>,
    /// Largest sum of the factors that a row dropped.
    pub dropped_max: Option<f64>,
    /// Largest `|Σ_j F_j − 1|` of the points.
    pub point_closure_max: Option<f64>,
    /// What enforcing closure changed, where it was asked for.
    pub enforced: Option<ClosureChange>,
    /// What the user should know.
    pub warnings: Vec<String>,
}

/// What enforcing closure changed.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(default)]
pub struct ClosureChange {
    /// Largest `|Σ_j F_ij − 1|` before.
    pub closure_before: Option<f64>,
    /// Largest `|F'_ij − F_ij|`.
    pub largest: Option<f64>,
    /// Largest `Σ_j |F'_ij − F_ij|` of a row.
    pub row_max: Option<f64>,
    /// Largest of these over the stated error of its row, over rows with a stated error above
    /// rounding.
    pub over_stated: Option<f64>,
    /// Steps of Newton's method.
    pub steps: u64,
}

impl Default for ViewFactorsRecord {
    fn default() -> Self {
        Self {
            format: VIEW_FACTORS_FORMAT.to_owned(),
            version: String::new(),
            input: String::new(),
            input_sha256: String::new(),
            title: None,
            options: Value::Null,
            counts: BTreeMap::new(),
            pairs: BTreeMap::new(),
            timings: Vec::new(),
            predicted_memory_bytes: None,
            peak_memory_bytes: None,
            closure: Closure::default(),
            form_factor_error: FormFactorError::default(),
            reciprocity: None,
            dropped_max: None,
            point_closure_max: None,
            enforced: None,
            warnings: Vec::new(),
        }
    }
}

impl ViewFactorsRecord {
    /// Writes the record as indented JSON.
    ///
    /// # Errors
    /// What `out` reports.
    pub fn write(&self, out: &mut dyn Write) -> io::Result<()> {
        serde_json::to_writer_pretty(&mut *out, self)?;
        writeln!(out)
    }
}

/// Reads a record.
///
/// # Errors
/// [`ViewFactorsError::Read`] where the file cannot be read, [`ViewFactorsError::Record`] where it
/// is damaged or of another format.
pub fn read_view_factors_record(path: &Path) -> Result<ViewFactorsRecord, ViewFactorsError> {
    let bytes = fs::read(path).map_err(|source| ViewFactorsError::Read { path: path.to_owned(), source })?;
    let broken = |why: String| ViewFactorsError::Record { path: path.to_owned(), why };
    let record: ViewFactorsRecord =
        serde_json::from_slice(&bytes).map_err(|error| broken(error.to_string()))?;
    let whole = serde_json::from_slice::<Value>(&bytes).is_ok_and(|value| value.get("format").is_some());
    if whole && record.format == VIEW_FACTORS_FORMAT {
        Ok(record)
    } else {
        Err(broken(format!("its \"format\" is not \"{VIEW_FACTORS_FORMAT}\"")))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn read(text: &[u8]) -> Result<ViewFactorsRecord, ViewFactorsError> {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("F.json");
        fs::write(&path, text).unwrap();
        read_view_factors_record(&path)
    }

    #[test]
    fn a_record_reads_back_and_others_are_refused() {
        let record = ViewFactorsRecord {
            version: "1".into(),
            counts: BTreeMap::from([("rows".into(), 6)]),
            enforced: Some(ClosureChange { largest: Some(1e-7), ..ClosureChange::default() }),
            ..ViewFactorsRecord::default()
        };
        let mut out = Vec::new();
        record.write(&mut out).unwrap();
        assert_eq!(read(&out).unwrap(), record);
        for text in [&out[..out.len() / 2], b"{}", b"[]", b"{\"format\": \"fredholm-run-1\"}"] {
            assert!(matches!(read(text), Err(ViewFactorsError::Record { .. })));
        }
    }
}
