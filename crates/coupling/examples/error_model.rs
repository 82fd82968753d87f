//! Measures how far the errors that are stated for exchanges behind bodies hold, and fits the
//! constants of the error model:
//! `cargo run --release -p fredholm-coupling --example error_model [-- --fit]`.
//!
//! The pairs are made from seeds, with one to six things between; what they exchange is known to
//! many more digits. Two sets of pairs, which the fit does not see, judge it. The fit goes down in
//! single steps: each constant is made smaller or larger by a tenth and stays so where that costs
//! fewer points, as long as 99 % of true errors are below the stated ones at every tolerance.

// A program that measures should panic where it cannot.
#![allow(clippy::unwrap_used)]

#[allow(dead_code, reason = "shared with the tests")]
#[path = "../tests/random_pairs/behind.rs"]
mod behind;
#[allow(dead_code, reason = "shared with the tests")]
#[path = "../tests/random_pairs/generator.rs"]
mod generator;
#[allow(dead_code, reason = "shared with the tests")]
#[path = "../tests/random_pairs/reference.rs"]
mod reference;

use behind::{PAIRS, SETS, resolved, scenes};
use fredholm_coupling::form_factor::{ErrorModel, Exchange, Method, PairIntegrator, Workspace};
use fredholm_mesh::Patch;
use fredholm_visibility::Occluders;
use rayon::prelude::*;

/// Tolerances at which errors are looked at.
const TOLERANCES: [f64; 3] = [1e-2, 1e-3, 1e-4];
/// Sets of pairs that constants are fitted to; the others judge them.
const FITTED_SETS: usize = 3;
/// Share of true errors that must be below the stated ones.
const LEAST_COVERED_SHARE: f64 = 0.99;
/// By what a constant is multiplied in a step.
const STEP_FACTOR: f64 = 1.1;
/// Relative saving from which on a step is taken.
const LEAST_SAVING: f64 = 1e-3;

/// A pair with what stands between, and its exchange, m².
struct Trial {
    patches: Vec<Patch>,
    occluders: Occluders,
    exact: f64,
}

impl Trial {
    /// What an error model makes of the pair, and the points that it asks for.
    fn exchange(&self, model: ErrorModel, tolerance: f64) -> (Exchange, u64) {
        let pair = PairIntegrator::new(&self.patches[..2], &self.occluders, tolerance);
        let mut work = Workspace::default();
        let found = pair.with_error_model(model).exchange(0, 1, &mut work);
        (found, work.points_behind_bodies())
    }
}

/// The trials of each set.
fn trials() -> Vec<Vec<Trial>> {
    let mut exact = resolved().into_iter();
    SETS.iter()
        .map(|&seed| {
            let all = scenes(seed).map(|patches| {
                let occluders = Occluders::new(&patches).unwrap();
                Trial { patches, occluders, exact: 0.0 }
            });
            let behind =
                |trial: &Trial| trial.exchange(ErrorModel::FITTED, TOLERANCES[0]).0.method == Method::Clipped;
            all.filter(behind)
                .take(PAIRS)
                .map(|trial| Trial { exact: exact.next().unwrap(), ..trial })
                .collect()
        })
        .collect()
}

/// What a model does on some trials at one tolerance.
#[derive(Clone, Copy, Debug)]
struct Figures {
    /// Share of true errors below the stated ones.
    covered: f64,
    /// Stated over true errors, the median.
    over: f64,
    /// Points, of all trials.
    points: u64,
}

fn figures(trials: &[&Trial], model: ErrorModel, tolerance: f64) -> Figures {
    let judge = |trial: &&Trial| {
        let (found, points) = trial.exchange(model, tolerance);
        let off = (found.value - trial.exact).abs();
        (off <= found.error, found.error / off.max(1e-3 * found.error), points)
    };
    let found: Vec<(bool, f64, u64)> = trials.par_iter().map(judge).collect();
    let mut over: Vec<f64> = found.iter().map(|(_, over, _)| *over).collect();
    over.sort_by(f64::total_cmp);
    let covered = found.iter().filter(|(covered, ..)| *covered).count() as f64 / found.len() as f64;
    let points = found.iter().map(|(.., points)| points).sum();
    Figures { covered, over: over[over.len() / 2], points }
}

fn say(name: &str, trials: &[&Trial], model: ErrorModel) {
    for tolerance in TOLERANCES {
        let Figures { covered, over, points } = figures(trials, model, tolerance);
        let (pairs, covered) = (trials.len(), 100.0 * covered);
        let each = points as f64 / pairs as f64;
        println!(
            "{name}, T = {tolerance:e}: {pairs} pairs, {covered:.2} % of true errors below the stated ones, stated over \
             true {over:.1} in the median, {each:.1} points a pair"
        );
    }
}

/// The constants that are fitted. How fast old refinements are forgotten is not.
fn constants(model: &mut ErrorModel) -> Vec<&mut f64> {
    let ErrorModel {
        smooth,
        smooth_near,
        broken,
        broken_near,
        between,
        behind,
        safety,
        surprise,
        unknown,
        many,
        memory: _,
        largest_surprise,
    } = model;
    let lists = [&mut smooth[..], smooth_near, broken_near, between, unknown];
    let single = [broken, behind, safety, surprise, many, largest_surprise];
    lists.into_iter().flatten().chain(single).collect()
}

/// What a model costs, the mean over the tolerances of the logarithm of points; none where it
/// states too little.
fn cost(trials: &[&Trial], model: ErrorModel) -> Option<f64> {
    let mut sum = 0.0;
    for tolerance in TOLERANCES {
        let found = figures(trials, model, tolerance);
        if found.covered < LEAST_COVERED_SHARE {
            return None;
        }
        sum += (found.points as f64).ln();
    }
    Some(sum / TOLERANCES.len() as f64)
}

fn fit(trials: &[&Trial]) -> ErrorModel {
    let mut model = ErrorModel::FITTED;
    // A model that states too little costs more than any other.
    let mut least = cost(trials, model).unwrap_or(f64::INFINITY);
    let count = constants(&mut model).len();
    loop {
        let before = least;
        for k in 0..count {
            for factor in [STEP_FACTOR.recip(), STEP_FACTOR] {
                let mut next = model;
                *constants(&mut next)[k] *= factor;
                if let Some(found) = cost(trials, next).filter(|found| *found < least - LEAST_SAVING) {
                    (model, least) = (next, found);
                    println!("{:.4} {model:?}", least.exp());
                    break;
                }
            }
        }
        if least >= before {
            return model;
        }
    }
}

fn main() {
    let trials = trials();
    let [seen, unseen] = [&trials[..FITTED_SETS], &trials[FITTED_SETS..]]
        .map(|sets| sets.iter().flatten().collect::<Vec<_>>());
    say("seen by the fit", &seen, ErrorModel::FITTED);
    say("not seen", &unseen, ErrorModel::FITTED);
    if std::env::args().any(|argument| argument == "--fit") {
        let model = fit(&seen);
        println!("{model:#?}");
        say("seen by the fit, anew", &seen, model);
        say("not seen, anew", &unseen, model);
    }
}
