//! The time that the fields of a scene take, before they are computed.
//!
//! What a run does is done on fewer facets, with all edges s times as long and all frequencies s
//! times lower: then a facet has as many neighbours within a wavelength, and an equation about as
//! many iterations. The facets are doubled as long as the trial is short. From the seconds t of the
//! last trials, of n facets each, every part of the run takes
//!
//! ```text
//! T = t (N/n)^p
//! ```
//!
//! on its N facets, with the exponent p that they grew with. A scene small enough is computed as it
//! is. Of many points and directions some are taken, and of many frequencies.
//!
//! Three parts are tried apart, since trials on few facets say little of them: fields at points
//! near facets, which take longer the longer these are beside the distance, on the facets as they
//! are, of currents that are no solution; the matrix of boundary elements, of which near pairs take
//! most up to some size, by some of its rows; and factorisation, whose rate of operations grows with
//! the size of the matrix, of a matrix of numbers that mean nothing.

use std::mem;

use fredholm_linop::{Dense, MultiVector, Symmetry, Watch};
use fredholm_scene::waves::{Cuts, Layout, Places};
use fredholm_waves::{Complex64, Wave};

use super::compute::{compute, incident_fields};
use super::geometry::Geometry;
use super::interpolation;
use super::model::{BY_MATRIX, BY_SYMMETRIC_MATRIX, Band, Receiver};
use super::over_frequency::MOST_PICTURED;
use super::{CouplingStorage, Method, Model, galerkin, registry, solving};
use crate::error::Error;
use crate::meter::{Meter, alone, spent};
use crate::stages::Stages;

/// Facets of the first trial, about, and the most that it may have: of several bounces, and of one.
const FIRST_FACETS: [f64; 2] = [40.0, 20_000.0];
const MOST_FIRST: [usize; 2] = [600, 40_000];
/// Seconds that the next trial may be expected to take, and after which it is given up.
const MOST_EXPECTED_SECONDS: f64 = 1.5;
const MOST_SECONDS: f64 = 3.0;
/// Exponent that is expected of the second trial.
const EXPECTED_EXPONENT: f64 = 1.5;
/// Unknowns of the matrix that is factorised for its rate, at most: a fraction of a second.
const MOST_FACTORISED: usize = 800;
/// Seconds from which on the growth of a part is measured; below, usual exponents are taken.
const CLEAR_SECONDS: f64 = 4e-3;
/// Growth from which on an exponent is one.
const LEAST_GROWTH: f64 = 1.9;
/// Points and directions of a receiver in a trial, at least, times facets; and waves of a sweep, of
/// which its error takes eight.
const LEAST_PLACES: usize = 48;
const FACETS_TIMES_PLACES: usize = 2_000_000;
const MOST_SWEPT: usize = 32;
/// Frequencies in a trial, of few and of many.
const TRIED_FREQUENCIES: usize = 2;
/// Seconds of a value in the files, and of a plot or a map.
const SECONDS_A_VALUE: f64 = 1.2e-6;
const SECONDS_A_PLOT: f64 = 0.01;

/// The parts of a run, by the words that the names of their stages begin with.
const PARTS: [&str; 4] = ["coupling", "currents", "fields", "sweep"];

/// What a trial took.
#[derive(Clone, Copy, Debug)]
struct Trial {
    facets: f64,
    /// Seconds by parts.
    seconds: [f64; PARTS.len()],
}

/// Seconds that a run of the model takes one thread; none where its surfaces cannot be meshed
/// coarser and are no trial themselves, where the number of frequencies is not known before, or
/// where the trials fail.
///
/// `unknowns` are those of its system, where it has one.
pub(super) fn seconds(model: &mut Model, unknowns: Option<usize>, watch: &dyn Watch) -> Option<f64> {
    if interpolation::accuracy(model).is_some() {
        return None;
    }
    alone(|| on_this_thread(model, unknowns, watch)).flatten()
}

fn on_this_thread(model: &mut Model, unknowns: Option<usize>, watch: &dyn Watch) -> Option<f64> {
    let all: Vec<Wave> = model.bands.iter().map(|band| band.wave).collect();
    let counts: Vec<usize> = model.receivers.iter().map(|receiver| count(&receiver.places)).collect();
    let values = counts.iter().sum::<usize>() as f64 * all.len() as f64;
    let plots = (counts.len() * all.len().min(MOST_PICTURED)) as f64;
    let facets = model.geometry.mesh.len() as f64;
    let waves = some(&all, if all.len() > MOST_PICTURED { MOST_PICTURED + 1 } else { TRIED_FREQUENCIES });
    let share = all.len() as f64 / waves.len() as f64;
    let receivers = mem::take(&mut model.receivers);
    model.balanced = false;
    let apart = has_fields_as_they_are(model);
    // Fields that are tried apart would only keep trials from more facets.
    let places = |facets| {
        if apart { sampled(&receivers, facets, LEAST_PLACES) } else { sampled(&receivers, facets, 1) }
    };
    let trials = trials(model, (&waves, facets), &places, watch)?;
    let last = *trials.last()?;
    let mut whole = last.seconds;
    let exponents = [0, 1, 2, 3].map(|part| exponent(&trials, part, bounds(model, part)));
    let mut grown = exponents.map(|exponent| (facets / last.facets).powf(exponent));
    let coarse = last.facets < facets;
    let mut tried: fn(&Model, &dyn Watch) -> Option<[f64; PARTS.len()]> = trial;
    if apart {
        stretched(model, &waves, 1.0).ok()?;
        model.receivers = sampled(&receivers, model.geometry.mesh.len(), 1);
        tried = incident;
        (whole[2], grown[2]) = (tried(model, watch)?[2], 1.0);
    }
    // What does not grow with the points and directions, from a trial with fewer of them.
    let taken = |receivers: &[Receiver]| [false, true].map(|swept| total(receivers, swept));
    let [all_places, places] = [taken(&receivers), taken(&model.receivers)];
    if all_places.iter().zip(places).any(|(all, some)| *all > some) {
        model.receivers = sampled(&receivers, model.geometry.mesh.len(), 4);
        let (fewer, less) = (taken(&model.receivers), tried(model, watch)?);
        for (kind, part) in [2, 3].into_iter().enumerate() {
            let each = (whole[part] - less[part]) / (places[kind] - fewer[kind]).max(1.0);
            whole[part] += each.max(0.0) * (all_places[kind] - places[kind]);
        }
    }
    let stored = coarse && model.storage == Some(CouplingStorage::Matrix);
    if let (true, Some(equations)) = (stored, model.galerkin) {
        stretched(model, &waves, 1.0).ok()?;
        (whole[0], grown[0]) = (galerkin::assembly(model, equations, &spent).ok()?, 1.0);
    }
    if let Some(unknowns) = unknowns.filter(|_| stored && whole[1] > 0.0 && is_factorised(model)) {
        (whole[1], grown[1]) = (waves.len() as f64 * factorisation(model, unknowns, watch)?, 1.0);
    }
    let fields: f64 = whole.iter().zip(grown).map(|(seconds, grown)| seconds * grown).sum();
    Some(share * fields + SECONDS_A_VALUE * values + SECONDS_A_PLOT * plots)
}

/// What a part is likely to grow with, where nothing was measured, and the least and the most:
/// assembly with the pairs of facets, of boundary elements less steeply since near pairs take most;
/// products with the pairs, factorisation with the cube; fields with the facets, of which trials of
/// more have fewer places.
fn bounds(model: &Model, part: usize) -> [f64; 3] {
    let by_products = match &model.method {
        Method::Solver { solver, .. } => registry::by_products().contains(&solver.name()),
        Method::Bounces(_) => true,
    };
    match part {
        0 if model.galerkin.is_some() => [1.75, 1.0, 1.75],
        0 => [2.0, 1.0, 2.2],
        1 if by_products => [2.0, 1.0, 2.2],
        1 => [3.0, 2.0, 3.0],
        2 => [1.0; 3],
        _ => [1.5, 0.5, 2.5],
    }
}

/// Whether the matrix is factorised.
fn is_factorised(model: &Model) -> bool {
    let factorises = |name: &str| [BY_MATRIX, BY_SYMMETRIC_MATRIX].contains(&name);
    matches!(&model.method, Method::Solver { solver, .. } if factorises(solver.name()))
}

/// Seconds that a factorisation of so many unknowns takes, from that of fewer.
fn factorisation(model: &Model, unknowns: usize, watch: &dyn Watch) -> Option<f64> {
    let fewer = unknowns.min(MOST_FACTORISED);
    // What is taken away from 1 is small beside it, so that no pivot vanishes.
    let entry = |at: usize| {
        let (i, j) = (at / fewer, at % fewer);
        let angle = (i * j + i + j) as f64;
        Complex64::new((1.7 * angle).sin(), (0.3 * angle).cos()) / (2 * fewer) as f64
    };
    let entries = (0..fewer * fewer).map(entry).collect();
    let matrix = Dense::new(fewer, entries).ok()?.with_symmetry(Symmetry::Symmetric).ok()?;
    let b = MultiVector::from_fn(fewer, 1, |_, _| Complex64::ONE);
    let meter = Meter::new(watch, MOST_SECONDS);
    let stages = Stages::new(&meter);
    let began = meter.seconds();
    solving::solved(&matrix, &b, &model.method, &stages.signals()).ok()?;
    Some((meter.seconds() - began) * (unknowns as f64 / fewer as f64).powi(3))
}

/// Whether fields are tried on the facets as they are: not of sweeps, which are solved for, and of
/// boundary elements, where they take little beside the matrix.
fn has_fields_as_they_are(model: &Model) -> bool {
    let solved = matches!(model.method, Method::Solver { .. });
    solved && model.galerkin.is_none() && !model.has_sweep()
}

/// Seconds of the fields of the currents that the sources alone drive, by parts.
fn incident(model: &Model, watch: &dyn Watch) -> Option<[f64; PARTS.len()]> {
    let meter = Meter::new(watch, MOST_SECONDS);
    incident_fields(model, &mut Stages::new(&meter)).ok()?;
    Some(by_parts(meter))
}

/// Trials on more and more facets, as far as they are short.
fn trials(
    model: &mut Model,
    (waves, facets): (&[Wave], f64),
    receivers: &dyn Fn(usize) -> Vec<Receiver>,
    watch: &dyn Watch,
) -> Option<Vec<Trial>> {
    let mut trials: Vec<Trial> = Vec::new();
    let one = usize::from(matches!(model.method, Method::Bounces(1)) && model.coarse.is_none());
    let mut stretch = if model.is_closed_form() { 1.0 } else { (facets / FIRST_FACETS[one]).sqrt().max(1.0) };
    loop {
        stretched(model, waves, stretch).ok()?;
        let here = model.geometry.mesh.len();
        model.receivers = receivers(here);
        if trials.is_empty() && here > MOST_FIRST[one] {
            return None;
        }
        let all = |trial: &Trial| trial.seconds.iter().sum::<f64>();
        if let Some(last) = trials.last() {
            let before = trials.len().checked_sub(2).map(|i| trials[i]);
            let steep = before.map_or(EXPECTED_EXPONENT, |before| {
                (all(last) / all(&before)).ln() / (last.facets / before.facets).ln()
            });
            let expected = all(last) * (here as f64 / last.facets).powf(steep.clamp(1.0, 3.0));
            if here as f64 > last.facets && expected > MOST_EXPECTED_SECONDS {
                break;
            }
        }
        // Longer edges may be refused where shorter ones are not.
        if let Some(seconds) = trial(model, watch) {
            trials.push(Trial { facets: here as f64, seconds });
        } else if watch.go_on().is_break() || !trials.is_empty() {
            break;
        }
        if stretch <= 1.0 {
            break;
        }
        stretch = (stretch / 2.0_f64.sqrt()).max(1.0);
    }
    // The model is left at the facets of the last trial.
    let last = trials.last()?.facets;
    if last < model.geometry.mesh.len() as f64 {
        stretched(model, waves, stretch * 2.0_f64.sqrt()).ok()?;
        model.receivers = receivers(model.geometry.mesh.len());
    }
    Some(trials)
}

/// Gives the model longer edges and lower frequencies.
fn stretched(model: &mut Model, waves: &[Wave], stretch: f64) -> Result<(), Error> {
    let refused = |error| model.refused(&error, None);
    let lower: Vec<Wave> = waves
        .iter()
        .map(|wave| Wave::new(wave.frequency() / stretch))
        .collect::<Result<_, _>>()
        .map_err(refused)?;
    let band = |wave: Wave| {
        let materials = model.scene.materials(&wave).map_err(crate::problem::scene_failure)?;
        Ok(Band { wave, materials })
    };
    let bands: Vec<Band> = lower.into_iter().map(band).collect::<Result<_, Error>>()?;
    let wavelength = model.scene.waves().iter().map(Wave::wavelength).fold(f64::INFINITY, f64::min);
    let whole = model.is_closed_form();
    // There are fewer facets than are admitted already.
    let cut = |stretch| Geometry::new(&model.scene, Cuts { wavelength, stretch, whole }, &|_| Ok(()));
    let geometry = cut(stretch)?;
    let coarse = model.coarse.is_some().then(|| cut(2.0 * stretch)).transpose()?;
    (model.geometry, model.coarse, model.bands) = (geometry, coarse, bands);
    Ok(())
}

/// Seconds of a model as it is, by parts.
fn trial(model: &Model, watch: &dyn Watch) -> Option<[f64; PARTS.len()]> {
    let meter = Meter::new(watch, MOST_SECONDS);
    compute(model, &mut Stages::new(&meter)).ok()?;
    Some(by_parts(meter))
}

/// The seconds of the stages of each part.
fn by_parts(meter: Meter<'_>) -> [f64; PARTS.len()] {
    let mut seconds = [0.0; PARTS.len()];
    for (stage, spent) in meter.readings().stages {
        let part = PARTS.iter().position(|part| stage.starts_with(part)).unwrap_or(2);
        seconds[part] += spent;
    }
    seconds
}

/// What a part grew with from one trial to the last, where both took time that is clear.
fn exponent(trials: &[Trial], part: usize, [usual, least, most]: [f64; 3]) -> f64 {
    let Some(last) = trials.last() else { return usual };
    let before = trials.iter().rev().find(|trial| last.facets >= LEAST_GROWTH * trial.facets);
    let measured = before
        .filter(|before| before.seconds[part] > CLEAR_SECONDS)
        .map(|before| (last.seconds[part] / before.seconds[part]).ln() / (last.facets / before.facets).ln());
    measured.map_or(usual, |exponent| exponent.clamp(least, most))
}

/// Points or directions.
fn count(places: &Places) -> usize {
    match places {
        Places::Near { points, .. } => points.len(),
        Places::Far(angles) | Places::Monostatic(angles) => angles.len(),
    }
}

/// Places of the receivers at points and in directions, or waves of those that sweep.
fn total(receivers: &[Receiver], swept: bool) -> f64 {
    let places = receivers.iter().map(|receiver| &receiver.places);
    let of = places.filter(|places| matches!(places, Places::Monostatic(_)) == swept);
    of.map(count).sum::<usize>() as f64
}

/// The receivers at some of their places, as many as such facets allow, over a divisor.
fn sampled(receivers: &[Receiver], facets: usize, divisor: usize) -> Vec<Receiver> {
    let most = |places: &Places| match places {
        Places::Monostatic(_) => (MOST_SWEPT / divisor).max(1),
        _ => ((FACETS_TIMES_PLACES / facets.max(1)).max(LEAST_PLACES) / divisor).max(1),
    };
    receivers.iter().map(|receiver| fewer(receiver, most(&receiver.places))).collect()
}

/// Some of many, evenly.
fn some<T: Clone>(all: &[T], most: usize) -> Vec<T> {
    let count = all.len().min(most);
    (0..count).map(|i| all[(2 * i + 1) * all.len() / (2 * count)].clone()).collect()
}

/// The same receiver at some of its places.
fn fewer(receiver: &Receiver, most: usize) -> Receiver {
    let places = match &receiver.places {
        Places::Near { points, .. } => Places::Near { points: some(points, most), layout: Layout::Points },
        Places::Far(angles) => Places::Far(some(angles, most)),
        Places::Monostatic(angles) => Places::Monostatic(some(angles, most)),
    };
    Receiver { places, ..receiver.clone() }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_grows_is_told_from_what_does_not() {
        let trial = |facets: f64, seconds| Trial { facets, seconds };
        let trials = [
            trial(100.0, [0.01, 0.01, 0.001, 0.1]),
            trial(200.0, [0.04, 0.08, 0.002, 0.1]),
            trial(400.0, [0.16, 0.64, 0.04, 0.1]),
        ];
        let found = [2.0, 2.0, 1.0, 2.0]
            .iter()
            .enumerate()
            .map(|(part, usual)| exponent(&trials, part, [*usual, 0.5, 3.0]));
        for (found, wanted) in found.zip([2.0, 3.0, 1.0, 0.5]) {
            assert!((found - wanted).abs() < 1e-12, "{found} {wanted}");
        }
    }

    #[test]
    fn some_of_many_lie_evenly() {
        assert_eq!(some(&[0, 1, 2, 3, 4, 5, 6, 7, 8], 3), [1, 4, 7]);
        assert_eq!(some(&[0, 1], 3), [0, 1]);
    }
}
