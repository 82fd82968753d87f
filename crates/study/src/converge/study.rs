//! What the levels tell together.

use fredholm_discretisation::{Convergence, Verdict, convergence};
use fredholm_linop::StopReason;
use fredholm_report::{BandConvergence, RefinementRecord};
use serde_json::Value;

use super::level::Level;
use crate::memory;
use crate::options::SolveSettings;
use crate::problem::Problem;

/// Relative rounding of a solution.
const ROUNDING: f64 = 64.0 * f64::EPSILON;
/// Relative errors of the solution over the residual and rounding that they come from, for
/// reflectance 0.
const ERROR_OVER_RESIDUAL: f64 = 10.0;

/// The record of a study.
pub(super) fn record(problem: &Problem, options: &SolveSettings, levels: &[Level]) -> RefinementRecord {
    let (scene, mesh) = (&problem.scene, &problem.mesh);
    let highest = problem.discretisation.order();
    let found: Vec<Convergence> =
        (0..scene.bands().len()).map(|band| follow(problem, options, levels, band)).collect();
    RefinementRecord {
        version: env!("CARGO_PKG_VERSION").to_owned(),
        scene: scene.path().display().to_string(),
        scene_sha256: scene.sha256().to_owned(),
        options: serde_json::to_value(options).unwrap_or(Value::Null),
        discretisation: problem.options.discretisation.clone(),
        surfaces: mesh.surfaces().iter().map(|surface| surface.name.clone()).collect(),
        levels: levels.iter().enumerate().map(|(number, level)| level.record(number)).collect(),
        bands: scene.bands().iter().zip(&found).map(|(name, found)| band(name, found, highest)).collect(),
        warnings: warnings(problem, levels, &found),
        peak_memory_bytes: memory::peak_bytes(),
        ..RefinementRecord::default()
    }
}

/// Convergence of the means over the faces in a band.
fn follow(problem: &Problem, options: &SolveSettings, levels: &[Level], band: usize) -> Convergence {
    let values: Vec<Vec<f64>> = levels.iter().map(|level| level.faces.vector(band)).collect();
    let areas: Vec<f64> = problem.mesh.faces().iter().map(|face| face.area).collect();
    convergence(&values, &areas, noise(problem, options, band), problem.discretisation.order())
}

/// How well a solution is known: ‖A⁻¹‖ is about 1/(1 − ρ), but for least squares, which squares it.
fn noise(problem: &Problem, options: &SolveSettings, band: usize) -> f64 {
    let reflectances = problem.scene.materials().iter().map(|material| material.reflectance[band]);
    ERROR_OVER_RESIDUAL * (options.tolerance + ROUNDING) / (1.0 - reflectances.fold(0.0, f64::max))
}

fn band(name: &str, found: &Convergence, highest: f64) -> BandConvergence {
    let (order, remaining) = match found.verdict {
        Verdict::Order { order, remaining } => (Some(order), Some(remaining)),
        _ => (None, None),
    };
    BandConvergence {
        band: name.to_owned(),
        verdict: verdict(found, highest),
        order,
        remaining,
        differences: found.difference.clone(),
        errors: found.error.clone(),
        orders: found.order.clone(),
        remainders: found.remaining.clone(),
    }
}

/// What a band comes to, in words.
fn verdict(found: &Convergence, highest: f64) -> String {
    let last = found.difference.iter().rev().nth(1).copied().unwrap_or(0.0);
    match found.verdict {
        Verdict::Order { order, remaining } => {
            let lasting = if order > highest { format!(" (counted as {highest:.0})") } else { String::new() };
            format!(
                "order {order:.2}{lasting}; the finest level is right within {remaining:.1e} (estimate by Richardson)"
            )
        }
        Verdict::Settled => {
            format!(
                "settled: the last three levels agree, the last two within {last:.1e}: rounding and residual"
            )
        }
        Verdict::Lost => {
            format!(
                "no order: the last step is {last:.1e}, no more than rounding and residual, but the one before is larger"
            )
        }
        Verdict::Irregular => {
            format!(
                "no order: the steps from level to level are not monotone; the last is {last:.1e}, and what remains is not known"
            )
        }
        Verdict::TooFew => format!("no order: that takes three levels; the last step is {last:.1e}"),
    }
}

/// What the user should know.
fn warnings(problem: &Problem, levels: &[Level], found: &[Convergence]) -> Vec<String> {
    let unsolved = levels.iter().any(|level| level.reason != StopReason::Converged);
    let unsolved = unsolved.then(|| {
        "a level was not solved to the tolerance; allow more with --max-iterations or --tolerance".to_owned()
    });
    problem.warnings.iter().cloned().chain(unsolved).chain(inexact(levels, found)).collect()
}

/// Whether the steps are lost in the errors of the form factors.
fn inexact(levels: &[Level], found: &[Convergence]) -> Option<String> {
    let error = levels.last()?.record(0).row_error?;
    let orderly =
        found.iter().filter(|band| matches!(band.verdict, Verdict::Order { .. } | Verdict::Irregular));
    let steps = orderly.filter_map(|band| band.difference.iter().rev().nth(1).copied());
    let least = steps.reduce(f64::min).filter(|&step| step < error)?;
    Some(format!(
        "the last step is {least:.1e}, less than the estimated error {error:.1e} of a row of form factors; the order means \
         more with a finer --form-factor-tolerance"
    ))
}
