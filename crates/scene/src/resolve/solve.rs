//! Defaults of the solution.

use crate::error::SceneError;
use crate::format::{At, SolveEntry, StorageEntry};
use crate::source::Source;

/// Precision in which form factors are stored.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Storage {
    /// Eight bytes a number.
    F64,
    /// Four bytes a number.
    F32,
}

/// What a scene says about its solution; `None` where it says nothing.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct SolveDefaults {
    /// Name of the discretisation.
    pub discretisation: Option<String>,
    /// Name of the solver.
    pub solver: Option<String>,
    /// Residual ‖b − A x‖₂/‖b‖₂ to stop at.
    pub tolerance: Option<f64>,
    /// Most iterations.
    pub max_iterations: Option<u64>,
    /// Largest estimated error of a form factor.
    pub form_factor_tolerance: Option<f64>,
    /// Relative error of the irradiance of faces to reach; elements are then chosen by the program.
    pub accuracy: Option<f64>,
    /// Precision in which form factors are stored.
    pub storage: Option<Storage>,
}

pub(super) fn solve(source: &Source, entry: &SolveEntry) -> Result<SolveDefaults, SceneError> {
    let below_1 = |number: &Option<At<f64>>, name| {
        number.as_ref().map(|number| source.below(number, 1.0, name)).transpose()
    };
    Ok(SolveDefaults {
        discretisation: entry.discretisation.as_deref().cloned(),
        solver: entry.solver.as_deref().cloned(),
        tolerance: below_1(&entry.tolerance, "tolerance")?,
        max_iterations: entry.max_iterations.as_ref().map(|n| at_least_1(source, n)).transpose()?,
        form_factor_tolerance: below_1(&entry.form_factor_tolerance, "form_factor_tolerance")?,
        accuracy: below_1(&entry.accuracy, "accuracy")?,
        storage: entry.storage.map(|storage| match storage {
            StorageEntry::F64 => Storage::F64,
            StorageEntry::F32 => Storage::F32,
        }),
    })
}

fn at_least_1(source: &Source, count: &At<u64>) -> Result<u64, SceneError> {
    if **count > 0 {
        return Ok(**count);
    }
    Err(source.value_error(count, "max_iterations is 0".to_owned(), "write a whole number, at least 1"))
}
