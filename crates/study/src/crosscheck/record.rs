//! The record and the rows of a comparison.

use fredholm_montecarlo::State;
use fredholm_montecarlo::statistics::{Crosscheck, Place};
use fredholm_report::{CROSSCHECK_FORMAT, CrosscheckPower, CrosscheckRecord, CrosscheckRow, WorstPlace};

use super::places::{self, Places};
use super::{CrosscheckOptions, Power, Verdict};
use crate::problem::Problem;
use crate::stages::Stages;

/// Places that are named.
pub(crate) const PLACES_NAMED: usize = 5;

/// What the comparison came to.
pub(super) fn record(
    asked: &CrosscheckOptions,
    (problem, places): (&Problem, &Places),
    (values, state): (&[f64], &State),
    (found, power, verdict): (&Crosscheck, &Power, Verdict),
    stages: &Stages,
) -> CrosscheckRecord {
    let relative = |at: usize| {
        if values[at] == 0.0 { f64::INFINITY } else { state.groups.mean()[at] / values[at] - 1.0 }
    };
    let named = |place: &Place| worst(problem, places, place, relative(place.index));
    CrosscheckRecord {
        format: CROSSCHECK_FORMAT.to_owned(),
        version: env!("CARGO_PKG_VERSION").to_owned(),
        scene: problem.scene.path().display().to_string(),
        scene_sha256: problem.scene.sha256().to_owned(),
        verdict: verdict.name().to_owned(),
        significance: asked.significance,
        correction: asked.correction.correction().name().to_owned(),
        places: found.places.len(),
        significant: found.significant,
        power: Some(power.record()),
        score_mean: found.suite.mean,
        score_variance: found.suite.variance,
        worst: found.worst(PLACES_NAMED).iter().map(named).collect(),
        method: state.method.clone(),
        seed: state.seed,
        batches: state.batches(),
        relative_error: state.relative_error(),
        solver: problem.options.solver.clone(),
        timings: stages.timings().to_vec(),
    }
}

impl Power {
    pub(crate) fn record(&self) -> CrosscheckPower {
        let known = |part: f64| part.is_finite().then_some(part);
        CrosscheckPower { whole: known(self.whole), surface: known(self.surface), face: known(self.face) }
    }
}

fn worst(problem: &Problem, places: &Places, place: &Place, relative: f64) -> WorstPlace {
    let (at, band) = places.at(place.index);
    let band = problem.scene.bands()[band].clone();
    let (mesh, z) = (&problem.mesh, place.z);
    let named = |kind: &str, face: usize, surface: &str, centroid: [f64; 3]| WorstPlace {
        kind: kind.to_owned(),
        face,
        surface: surface.to_owned(),
        centroid,
        band,
        z,
        relative,
    };
    match at {
        places::Place::Face(number) => {
            let face = &mesh.faces()[number];
            named("face", number, &mesh.surfaces()[face.surface].name, face.centroid.to_array())
        }
        places::Place::Surface(number) => named("surface", number, &mesh.surfaces()[number].name, [0.0; 3]),
        places::Place::Whole => named("whole", 0, "", [0.0; 3]),
    }
}

/// A row a face and band.
pub(super) fn rows(
    problem: &Problem,
    (values, error): (&[f64], &[f64]),
    state: &State,
    faces: &[Place],
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
    faces.iter().map(row).collect()
}
