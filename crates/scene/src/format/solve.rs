//! Defaults of the solution, as they are written.

use schemars::JsonSchema;
use serde::Deserialize;

use super::At;

/// How to solve, where the command line does not say.
#[derive(Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields, expecting = "a table of solver settings")]
#[schemars(rename = "Solve")]
pub(crate) struct SolveEntry {
    /// Name of the discretisation, such as "galerkin-1". Default: "galerkin-0", constants on the
    /// elements.
    pub discretisation: Option<At<String>>,
    /// Name of the solver. Default: chosen by the program.
    pub solver: Option<At<String>>,
    /// Residual ‖b − A x‖₂/‖b‖₂ to stop at, above 0 and below 1. Default: chosen by the program.
    pub tolerance: Option<At<f64>>,
    /// Most iterations, at least 1. Default: chosen by the program.
    pub max_iterations: Option<At<u64>>,
    /// Largest estimated error of a form factor, above 0 and below 1. Default: chosen by the
    /// program.
    pub form_factor_tolerance: Option<At<f64>>,
    /// Relative error of the irradiance of faces to reach, above 0 and below 1: elements are then
    /// chosen by the program. Default: elements as given.
    pub accuracy: Option<At<f64>>,
    /// Precision in which form factors are stored. Default: "f64".
    pub storage: Option<StorageEntry>,
}

/// Precision in which form factors are stored.
#[derive(Clone, Copy, Debug, Deserialize, JsonSchema)]
#[serde(rename_all = "lowercase")]
#[schemars(rename = "Storage")]
pub(crate) enum StorageEntry {
    /// Eight bytes a number.
    F64,
    /// Four bytes a number: half the memory, seven digits.
    F32,
}
