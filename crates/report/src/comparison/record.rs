//! What a comparison of solvers on one system comes to.

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};
use serde_json::Value;

use crate::{Timing, reading};

/// Name of the format of `compare.json`.
pub const COMPARISON_FORMAT: &str = "fredholm-compare-1";

/// Everything that made a comparison, and what it found.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(default)]
pub struct ComparisonRecord {
    /// [`COMPARISON_FORMAT`].
    pub format: String,
    /// Version of the program.
    pub version: String,
    /// Path of the scene file.
    pub scene: String,
    /// SHA-256 of the scene file.
    pub scene_sha256: String,
    /// Options in force.
    pub options: Value,
    /// Names of the bands.
    pub bands: Vec<String>,
    /// Number of unknowns in each band.
    pub unknowns: u64,
    /// Stored entries of the matrix.
    pub entries: u64,
    /// Largest reflectance of each case; one case unless the reflectance is swept.
    pub cases: Vec<ComparisonCase>,
    /// Times of the stages before the solutions.
    pub timings: Vec<Timing>,
    /// Most memory held by the process, bytes.
    pub peak_memory_bytes: Option<u64>,
    /// What the user should know.
    pub warnings: Vec<String>,
}

/// All solvers on one system.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(default)]
pub struct ComparisonCase {
    /// Largest reflectance of any material in any band.
    #[serde(deserialize_with = "reading::number")]
    pub reflectance: f64,
    /// Solver that the errors are measured against.
    pub reference: String,
    /// Residual of the reference, worst band.
    #[serde(deserialize_with = "reading::number")]
    pub reference_residual: f64,
    /// Solvers in the order asked for.
    pub runs: Vec<ComparisonRun>,
}

/// One solver on one system.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(default)]
pub struct ComparisonRun {
    /// The solver as it was asked for, options included.
    pub solver: String,
    /// `converged`, `not converged`, `diverged`, or `refused`.
    pub outcome: String,
    /// Why it was refused.
    pub reason: Option<String>,
    /// Iterations.
    pub iterations: u64,
    /// Applications of the matrix.
    pub applications: u64,
    /// Rows visited.
    pub rows: u64,
    /// Columns visited.
    pub columns: u64,
    /// Stored entries read.
    pub entries: u64,
    /// Seconds.
    #[serde(deserialize_with = "reading::number")]
    pub seconds: f64,
    /// ‖b − A x‖₂/‖b‖₂ at the end, worst band.
    #[serde(deserialize_with = "reading::number")]
    pub residual: f64,
    /// ‖x − x*‖₂/‖x*‖₂ against the reference, worst band.
    #[serde(deserialize_with = "reading::number")]
    pub error: f64,
    /// Residuals on the way.
    pub history: ComparisonHistory,
}

/// Residuals of a run, one entry an iteration from the start on.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(default)]
pub struct ComparisonHistory {
    /// Stored entries read by then.
    pub entries: Vec<u64>,
    /// Seconds by then.
    #[serde(deserialize_with = "reading::row")]
    pub seconds: Vec<f64>,
    /// ‖b − A x‖₂/‖b‖₂, worst band.
    #[serde(deserialize_with = "reading::row")]
    pub residual: Vec<f64>,
}

#[cfg(test)]
pub(crate) mod tests {
    use super::*;

    /// Two solvers, one of them refused, on two systems.
    pub(crate) fn sample() -> ComparisonRecord {
        let history = ComparisonHistory {
            entries: vec![0, 10, 20],
            seconds: vec![0.0, 0.25, 0.5],
            residual: vec![1.0, 1e-3, 1e-9],
        };
        let run = ComparisonRun {
            solver: "sor:omega=1.2".into(),
            outcome: "converged".into(),
            iterations: 2,
            entries: 20,
            seconds: 0.5,
            residual: 1e-9,
            error: 2e-9,
            history,
            ..ComparisonRun::default()
        };
        let refused = ComparisonRun {
            solver: "cg-psi".into(),
            outcome: "refused".into(),
            reason: Some("not symmetric, \"so\"".into()),
            residual: f64::NAN,
            error: f64::NAN,
            ..ComparisonRun::default()
        };
        let case = |reflectance| ComparisonCase {
            reflectance,
            reference: "lu".into(),
            reference_residual: 1e-15,
            runs: vec![run.clone(), refused.clone()],
        };
        ComparisonRecord {
            format: COMPARISON_FORMAT.into(),
            version: "0".into(),
            scene: "a.toml".into(),
            scene_sha256: String::new(),
            options: Value::Null,
            bands: vec!["grey".into()],
            unknowns: 4,
            entries: 10,
            cases: vec![case(0.5), case(0.9)],
            timings: Vec::new(),
            peak_memory_bytes: None,
            warnings: Vec::new(),
        }
    }
}
