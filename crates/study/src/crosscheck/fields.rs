//! Scenes of waves: sampled fields against computed ones, number by number.
//!
//! δ of a number is the estimated error of the mesh and that of the radiation integral together,
//! relative to the root mean square of the scattered E over the points of its receiver.

use fredholm_montecarlo::statistics::{Comparison, Correction, Place, Suite, crosscheck as compare};
use fredholm_montecarlo::waves::FieldEstimate;
use fredholm_report::{
    COMPONENTS, CROSSCHECK_FORMAT, CrosscheckRecord, FieldScore, ResultFolder, WorstPlace,
    write_field_crosscheck,
};
use fredholm_scene::waves::Places;
use fredholm_waves::TOLERANCE;
use std::collections::BTreeMap;

use super::record::PLACES_NAMED;
use super::{CrosscheckOptions, Verdict};
use crate::error::Error;
use crate::options::SceneSource;
use crate::solve::report_failure;
use crate::stages::Stages;
use crate::stochastic::{FieldPoint, FieldRun, failure, field_points};
use crate::waves::{self, Band, Method, Model, Outcome};

/// Method where none is asked for, and the error it is asked for.
const USUAL_METHOD: &str = "surface-sampling";
const USUAL_ERROR: f64 = 0.01;

pub(super) fn run(
    source: &SceneSource,
    asked: &CrosscheckOptions,
    folder: &ResultFolder,
    mut stages: Stages,
) -> Result<(CrosscheckRecord, Verdict), Error> {
    let load = || Model::load_estimated(source.path(), asked.problem.memory);
    let mut model = stages.run("scene", load)?;
    let stop = asked.stop.or_to(USUAL_ERROR);
    let run = FieldRun::new(asked.method_or(USUAL_METHOD), &asked.paths, &stop, &model, stages.watch)?;
    // Both sides sum the same bounces, of the same currents.
    model.method = Method::Bounces(run.bounces());
    model.edge_currents = false;
    model.receivers.retain(|receiver| matches!(receiver.places, Places::Near { .. }));
    let outcome = waves::compute(&model, &mut stages)?;
    let mut rows = Vec::new();
    let mut states = Vec::new();
    for band in &model.bands {
        let state = sampled(&run, &model, band, &mut stages)?;
        rows.extend(compared(&model, band, &outcome, &state)?);
        states.push(state);
    }
    decide(&mut rows, asked.correction.correction(), asked.significance);
    let record = record(asked, &model, (&rows, &states), &stages);
    write_field_crosscheck(folder, &rows, &record).map_err(report_failure)?;
    let verdict = if record.significant == 0 { Verdict::Agree } else { Verdict::Disagree };
    Ok((record, verdict))
}

fn sampled(run: &FieldRun, model: &Model, band: &Band, stages: &mut Stages) -> Result<FieldEstimate, Error> {
    let name = format!("sampling at {} MHz", band.wave.frequency() / 1e6);
    let watch = stages.watch;
    let state = stages.run(&name, || run.sample(model, band, None, watch))?;
    if stages.is_cancelled() { Err(Error::cancelled()) } else { Ok(state) }
}

/// The scattered E at the points of one frequency, and δ.
fn computed(model: &Model, band: &Band, outcome: &Outcome) -> (Vec<[f64; 6]>, Vec<f64>) {
    let frequency = band.wave.frequency();
    let here = |of: f64| of.to_bits() == frequency.to_bits();
    let rows = outcome.near.iter().filter(|row| here(row.frequency));
    let fields: BTreeMap<(usize, usize), [f64; 6]> =
        rows.map(|row| ((row.receiver, row.index), std::array::from_fn(|i| row.scattered[i]))).collect();
    let error = |receiver: usize| {
        let of = || fields.iter().filter(|((number, _), _)| *number == receiver).map(|(_, e)| e);
        let squares: f64 = of().flatten().map(|x| x * x).sum();
        let meshed = outcome.mesh_errors.iter().find(|e| e.receiver == receiver && here(e.frequency));
        let relative = meshed.map_or(0.0, |error| error.relative).hypot(TOLERANCE);
        relative * (squares / of().count().max(1) as f64).sqrt()
    };
    let errors: Vec<f64> = (0..model.receivers.len()).map(error).collect();
    let points = field_points(model);
    let value = |&(receiver, index, _): &FieldPoint| fields.get(&(receiver, index)).copied();
    (points.iter().filter_map(value).collect(), points.iter().map(|&(r, _, _)| errors[r]).collect())
}

/// A row a point and number.
fn compared(
    model: &Model,
    band: &Band,
    outcome: &Outcome,
    state: &FieldEstimate,
) -> Result<Vec<FieldScore>, Error> {
    let (fields, errors) = computed(model, band, outcome);
    let deterministic: Vec<f64> = fields.into_iter().flatten().collect();
    let deterministic_error: Vec<f64> = errors.into_iter().flat_map(|error| [error; 6]).collect();
    let parts = |e: fredholm_waves::ComplexVector| e.components().into_iter().flat_map(|c| [c.re, c.im]);
    let stochastic: Vec<f64> = state.mean().into_iter().flat_map(parts).collect();
    let standard_error: Vec<f64> = state.component_errors().into_iter().flatten().collect();
    let comparison = Comparison {
        deterministic: &deterministic,
        deterministic_error: &deterministic_error,
        stochastic: &stochastic,
        standard_error: &standard_error,
        single: &vec![0.0; standard_error.len()],
        batches: state.batches(),
    };
    // Of all frequencies together it is decided later what is significant.
    let places = compare(&comparison, Correction::Holm, 0.5).map_err(failure)?.places;
    let points = field_points(model);
    let row = |place: &Place| FieldScore {
        score: place.z,
        p: place.p,
        ..unscored(model, band, points[place.index / COMPONENTS.len()], &comparison, place.index)
    };
    Ok(places.iter().map(row).collect())
}

/// One number on both sides.
fn unscored(
    model: &Model,
    band: &Band,
    (receiver, index, point): FieldPoint,
    comparison: &Comparison<'_>,
    at: usize,
) -> FieldScore {
    FieldScore {
        receiver: model.receivers[receiver].name.clone(),
        index,
        position: point.to_array(),
        frequency: band.wave.frequency(),
        component: at % COMPONENTS.len(),
        deterministic: [comparison.deterministic[at], comparison.deterministic_error[at]],
        stochastic: [comparison.stochastic[at], comparison.standard_error[at]],
        score: 0.0,
        p: 1.0,
        significant: false,
    }
}

fn decide(rows: &mut [FieldScore], correction: Correction, significance: f64) {
    let probabilities: Vec<f64> = rows.iter().map(|row| row.p).collect();
    let significant = correction.significant(&probabilities, significance);
    rows.iter_mut().zip(significant).for_each(|(row, significant)| row.significant = significant);
}

fn record(
    asked: &CrosscheckOptions,
    model: &Model,
    (rows, states): (&[FieldScore], &[FieldEstimate]),
    stages: &Stages,
) -> CrosscheckRecord {
    let scores: Vec<f64> = rows.iter().map(|row| row.score).collect();
    let suite = Suite::new(&scores);
    let significant = rows.iter().filter(|row| row.significant).count();
    CrosscheckRecord {
        format: CROSSCHECK_FORMAT.to_owned(),
        version: env!("CARGO_PKG_VERSION").to_owned(),
        scene: model.path().display().to_string(),
        scene_sha256: model.scene.sha256().to_owned(),
        verdict: if significant == 0 { "agree" } else { "disagree" }.to_owned(),
        significance: asked.significance,
        correction: asked.correction.correction().name().to_owned(),
        places: rows.len(),
        significant,
        power: None,
        score_mean: suite.mean,
        score_variance: suite.variance,
        worst: worst(rows),
        method: asked.method_or(USUAL_METHOD).to_owned(),
        seed: asked.paths.seed,
        batches: states.iter().map(FieldEstimate::batches).sum(),
        relative_error: states.iter().map(FieldEstimate::relative_error).fold(0.0, f64::max),
        solver: model.method.name(),
        timings: stages.timings().to_vec(),
    }
}

/// The numbers farthest apart, the worst first.
fn worst(rows: &[FieldScore]) -> Vec<WorstPlace> {
    let mut order: Vec<&FieldScore> = rows.iter().collect();
    order.sort_by(|a, b| b.score.abs().total_cmp(&a.score.abs()));
    let place = |row: &&FieldScore| WorstPlace {
        kind: "point".to_owned(),
        face: row.index,
        surface: row.receiver.clone(),
        centroid: row.position,
        band: format!("{} at {} MHz", COMPONENTS[row.component], row.frequency / 1e6),
        z: row.score,
        relative: row.stochastic[0] / row.deterministic[0] - 1.0,
    };
    order.iter().take(PLACES_NAMED).map(place).collect()
}
