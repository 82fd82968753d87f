//! `converge.json`: a study of convergence. Format `fredholm-converge-1`.
//!
//! Metres, seconds, W/m²; differences and errors are ‖E_a − E_b‖/‖E‖ over the faces of the scene,
//! √(Σ A E²), dimensionless.

use std::io::{self, Write};

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};
use serde_json::Value;

use crate::Timing;

/// Name and version of the format.
pub const REFINEMENT_FORMAT: &str = "fredholm-converge-1";

/// A scene solved on meshes that are each twice as fine as the one before.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(default)]
pub struct RefinementRecord {
    /// [`REFINEMENT_FORMAT`].
    pub format: String,
    /// Version of the program.
    pub version: String,
    /// Path of the scene file, as it was given.
    pub scene: String,
    /// SHA-256 of the scene and the files it names, in hexadecimal.
    pub scene_sha256: String,
    /// The complete options, defaults included.
    pub options: Value,
    /// Name of the discretisation.
    pub discretisation: String,
    /// Names of the surfaces.
    pub surfaces: Vec<String>,
    /// The meshes, the coarsest first.
    pub levels: Vec<RefinementLevel>,
    /// What every band comes to.
    pub bands: Vec<BandConvergence>,
    /// What the user should know.
    pub warnings: Vec<String>,
    /// Largest memory in use, bytes, where the system tells.
    pub peak_memory_bytes: Option<u64>,
}

impl Default for RefinementRecord {
    fn default() -> Self {
        Self {
            format: REFINEMENT_FORMAT.to_owned(),
            version: String::new(),
            scene: String::new(),
            scene_sha256: String::new(),
            options: Value::Null,
            discretisation: String::new(),
            surfaces: Vec::new(),
            levels: Vec::new(),
            bands: Vec::new(),
            warnings: Vec::new(),
            peak_memory_bytes: None,
        }
    }
}

/// One mesh and its solution.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(default)]
pub struct RefinementLevel {
    /// Number of refinements.
    pub level: u64,
    /// Elements.
    pub elements: u64,
    /// Unknowns.
    pub unknowns: u64,
    /// Largest diameter of an element, m.
    pub h: f64,
    /// Wall-clock time of all stages.
    pub seconds: f64,
    /// Wall-clock time of each stage, in order.
    pub timings: Vec<Timing>,
    /// Why the solver stopped.
    pub stop_reason: String,
    /// Largest estimated error of a row of form factors, where the method states one.
    pub row_error: Option<f64>,
    /// Mean irradiance, W/m²: `irradiance[surface][band]`.
    pub irradiance: Vec<Vec<f64>>,
}

/// Convergence of a band; vectors have an entry a level.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(default)]
pub struct BandConvergence {
    /// Name of the band.
    pub band: String,
    /// What it comes to, in words.
    pub verdict: String,
    /// Observed order of the last three levels.
    pub order: Option<f64>,
    /// Estimated error of the finest level.
    pub remaining: Option<f64>,
    /// Difference to the finest level.
    pub differences: Vec<f64>,
    /// Error against the limit by Richardson.
    pub errors: Vec<Option<f64>>,
    /// Order from each level and the two before.
    pub orders: Vec<Option<f64>>,
    /// Estimated error of each level by that order.
    pub remainders: Vec<Option<f64>>,
}

impl RefinementRecord {
    /// Writes the record as indented JSON.
    ///
    /// # Errors
    /// What `out` reports.
    pub fn write(&self, out: &mut dyn Write) -> io::Result<()> {
        serde_json::to_writer_pretty(&mut *out, self)?;
        writeln!(out)
    }
}

#[cfg(test)]
pub(super) mod tests {
    use super::*;

    /// Errors 4^−l in two bands, the second without an order.
    pub(crate) fn sample() -> RefinementRecord {
        let level = |l: i32| RefinementLevel {
            level: l as u64,
            elements: 2 * 4_u64.pow(l as u32),
            unknowns: 8 * 4_u64.pow(l as u32),
            h: 0.5_f64.powi(l),
            seconds: 0.25,
            irradiance: vec![vec![1.0 + 0.25_f64.powi(l), 2.0]],
            ..RefinementLevel::default()
        };
        let good = BandConvergence {
            band: "r".into(),
            verdict: "order 2.00".into(),
            order: Some(2.0),
            remaining: Some(0.0625),
            differences: vec![0.9375, 0.1875, 0.0],
            errors: [0, 1, 2].map(|l| Some(0.25_f64.powi(l))).to_vec(),
            orders: vec![None, None, Some(2.0)],
            remainders: vec![None, None, Some(0.0625)],
        };
        let flat = BandConvergence {
            band: "g".into(),
            differences: vec![0.0; 3],
            errors: vec![None; 3],
            orders: vec![None; 3],
            remainders: vec![None; 3],
            ..BandConvergence::default()
        };
        RefinementRecord {
            surfaces: vec!["floor, lower".into()],
            levels: (0..3).map(level).collect(),
            bands: vec![good, flat],
            ..RefinementRecord::default()
        }
    }

    #[test]
    fn a_record_reads_back() {
        let mut out = Vec::new();
        sample().write(&mut out).unwrap();
        assert_eq!(serde_json::from_slice::<RefinementRecord>(&out).unwrap(), sample());
    }
}
