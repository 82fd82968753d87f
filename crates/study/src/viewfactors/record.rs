//! The record of a run.

use std::collections::BTreeMap;

use fredholm_report::{Closure, ClosureChange, FormFactorError, ViewFactors, ViewFactorsRecord};
use serde_json::Value;

use super::compute::Solution;
use super::method::BUDGET;
use super::options::ViewFactorOptions;
use super::problem::Problem;
use crate::memory;
use crate::stages::Stages;

/// Row errors, in tolerances, that are reported. Where the tolerance is a pair's, the errors of a row
/// add up to about twice as much; where it is a row's, it is met in the mean of the rows.
const REPORTED_ROW_ERROR: f64 = 3.0;
/// Estimated error of a row that may be rounding alone.
const ROUNDING: f64 = 1e-11;

/// Change of a row by closing, Σ_j |F'_ij − F_ij|, that is reported.
const REPORTED_CHANGE: f64 = 0.01;

/// Everything that is worth knowing of a run.
pub(super) fn record(
    asked: &ViewFactorOptions,
    problem: &Problem,
    solution: &Solution,
    stages: &Stages,
) -> ViewFactorsRecord {
    let factors = &solution.factors;
    let form_factor_error = FormFactorError {
        tolerance: problem.asked(),
        max: Some(solution.largest),
        row_max: largest(factors.surfaces.row_error.iter().copied().take(problem.surface_rows())),
    };
    let warnings = problem.geometry.warnings().iter().cloned();
    ViewFactorsRecord {
        version: env!("CARGO_PKG_VERSION").to_owned(),
        input: asked.input.path().display().to_string(),
        input_sha256: problem.geometry.sha256().to_owned(),
        title: problem.geometry.title().map(str::to_owned),
        options: serde_json::to_value(&problem.options).unwrap_or(Value::Null),
        counts: counts(problem, factors),
        pairs: solution.pairs.clone(),
        timings: stages.timings().to_vec(),
        predicted_memory_bytes: u64::try_from(problem.plan.peak().0).ok(),
        peak_memory_bytes: memory::peak_bytes(),
        closure: closure(factors),
        reciprocity: solution.reciprocity,
        dropped_max: problem.options.threshold.and_then(|_| largest(factors.row_dropped.iter().copied())),
        point_closure_max: point_closure(factors),
        enforced: solution.enforced.clone(),
        warnings: warnings
            .chain(inexact(&form_factor_error, &problem.options.method))
            .chain(solution.enforced.as_ref().and_then(bent))
            .collect(),
        form_factor_error,
        ..ViewFactorsRecord::default()
    }
}

fn counts(problem: &Problem, factors: &ViewFactors) -> BTreeMap<String, u64> {
    let counts = [
        ("elements", problem.rows.row_of.len()),
        ("rows", factors.len()),
        ("occluders", problem.occluders.len()),
        ("points", problem.receivers.len()),
        ("stored", factors.stored()),
    ];
    counts.map(|(name, count)| (name.to_owned(), count as u64)).into()
}

/// Largest and mean |Σ_j F_ij − 1| of a matrix of view factors.
#[must_use]
pub fn closure(factors: &ViewFactors) -> Closure {
    let mut found = Closure::default();
    let (mut sum, mut whole) = (0.0, 0.0);
    for (row, (defect, area)) in factors.defects().into_iter().zip(&factors.surfaces.area).enumerate() {
        sum += area * defect;
        whole += area;
        if found.max.is_none_or(|max| defect > max) {
            (found.max, found.worst_element) = (Some(defect), Some(row as u64));
            found.worst_surface = factors.surfaces.names.get(row).cloned();
        }
    }
    found.mean = Some(sum / whole);
    found
}

/// Largest |Σ_j F_j − 1| of the points of a matrix of view factors.
#[must_use]
pub fn point_closure(factors: &ViewFactors) -> Option<f64> {
    let points = factors.points.as_ref()?;
    let rows = points.factors.chunks(factors.len().max(1));
    largest(rows.map(|row| (row.iter().sum::<f64>() - 1.0).abs()))
}

/// The largest of some numbers; none of none.
#[must_use]
pub fn largest(values: impl Iterator<Item = f64>) -> Option<f64> {
    values.reduce(f64::max)
}

/// Whether closing the rows changed more than errors of a computation should make.
fn bent(change: &ClosureChange) -> Option<String> {
    let most = change.row_max.filter(|&most| most > REPORTED_CHANGE)?;
    Some(format!(
        "--close changed a row by {most:.1e} in all: such factors are those of another room; use a finer tolerance or setting"
    ))
}

/// Whether the factors came out less exact than asked for.
fn inexact(error: &FormFactorError, method: &str) -> Option<String> {
    let (of, mend) = if method == BUDGET {
        ("row", "ask for a finer --tolerance, or cut the surfaces more finely where they almost touch")
    } else {
        ("pair", "cut the surfaces more finely where they almost touch")
    };
    let (found, asked) = (error.row_max?, error.tolerance?);
    (found > (REPORTED_ROW_ERROR * asked).max(ROUNDING)).then(|| {
        format!("the estimated error of a row is {found:.1e}, where {asked:.1e} was asked for a {of}; {mend}")
    })
}
