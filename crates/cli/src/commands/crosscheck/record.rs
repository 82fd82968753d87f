//! The record and the rows of a comparison.

use fredholm_montecarlo::State;
use fredholm_montecarlo::statistics::{Crosscheck, Place};
use fredholm_report::{CROSSCHECK_FORMAT, CrosscheckRecord, CrosscheckRow, WorstPlace};

use super::CrosscheckArgs;
use crate::problem::Problem;
use crate::stages::Stages;

/// Places that are named.
pub(super) const WORST: usize = 5;

/// What the comparison came to.
pub(super) fn record(
    args: &CrosscheckArgs,
    problem: &Problem,
    (values, state): (&[f64], &State),
    found: &Crosscheck,
    stages: &Stages,
) -> CrosscheckRecord {
    let relative = |at: usize| {
        if values[at] == 0.0 { f64::INFINITY } else { state.groups.mean()[at] / values[at] - 1.0 }
    };
    CrosscheckRecord {
        format: CROSSCHECK_FORMAT.to_owned(),
        version: env!("CARGO_PKG_VERSION").to_owned(),
        scene: problem.scene.path().display().to_string(),
        scene_sha256: problem.scene.sha256().to_owned(),
        verdict: if found.agrees() { "agree" } else { "disagree" }.to_owned(),
        significance: args.significance,
        correction: args.correction.correction().name().to_owned(),
        places: found.places.len(),
        significant: found.significant,
        score_mean: found.suite.mean,
        score_variance: found.suite.variance,
        worst: found.worst(WORST).iter().map(|place| worst(problem, place, relative(place.index))).collect(),
        method: state.method.clone(),
        seed: state.seed,
        batches: state.batches(),
        relative_error: state.relative_error(),
        solver: problem.options.solver.clone(),
        timings: stages.timings().to_vec(),
    }
}

fn worst(problem: &Problem, place: &Place, relative: f64) -> WorstPlace {
    let bands = problem.scene.bands();
    let (number, band) = (place.index / bands.len(), place.index % bands.len());
    let face = &problem.mesh.faces()[number];
    WorstPlace {
        face: number,
        surface: problem.mesh.surfaces()[face.surface].name.clone(),
        centroid: face.centroid.to_array(),
        band: bands[band].clone(),
        z: place.z,
        relative,
    }
}

/// A row a face and band.
pub(super) fn rows(
    problem: &Problem,
    (values, error): (&[f64], &[f64]),
    state: &State,
    found: &Crosscheck,
) -> Vec<CrosscheckRow> {
    let (bands, errors) = (problem.scene.bands().len(), state.groups.standard_errors());
    let row = |place: &Place| CrosscheckRow {
        face: place.index / bands,
        band: place.index % bands,
        deterministic: [values[place.index], error[place.index]],
        stochastic: [state.groups.mean()[place.index], errors[place.index]],
        z: place.z,
        p: place.p,
        significant: place.significant,
    };
    found.places.iter().map(row).collect()
}
