//! One traced run, with its progress.

use std::ops::ControlFlow;

use fredholm_linop::Watch;
use fredholm_montecarlo::light::{Control, Estimator, PathTracing};
use fredholm_montecarlo::{Enclosure, Groups, MonteCarloError, State, Stop, Tracing};

use super::options::{PathOptions, TraceStop};
use crate::error::{Error, ErrorKind};

/// Paths of a batch that gathers, about: the more of them an element has, the more evenly they are
/// spread, and the more there are at least in all.
const GATHERED_PATHS: usize = 1 << 16;
/// Fewest and most of each element.
const FEWEST_GATHERED: usize = 4;
const MOST_GATHERED: usize = 32;
/// Samples of a batch that shoots, for each element.
const SHOT_SAMPLES: u32 = 8;
/// Fewest and most samples of a batch that shoots.
const FEWEST_SAMPLES: u32 = 1 << 12;
const MOST_SAMPLES: u32 = 1 << 20;
/// Batches of the trial that tells whether vertices are to be compared in pairs, and what keeps
/// their random numbers apart from those of the run.
const TRIAL_BATCHES: u64 = 8;
const TRIAL_SEED: u64 = 0x5bd1_e995_0000_0000;

/// A method on a scene, and when it ends.
pub(crate) struct Tracer<'a> {
    tracing: Tracing<'a>,
    stop: Stop,
}

impl<'a> Tracer<'a> {
    pub(crate) fn new(
        scene: &'a Enclosure,
        estimator: &'a dyn Estimator,
        groups: Groups,
        paths: &PathOptions,
        stop: &TraceStop,
    ) -> Result<Self, Error> {
        let samples = paths.batch.unwrap_or_else(|| batch(scene, estimator));
        let tracing = Tracing::new(scene, estimator, groups, paths.seed, samples).map_err(failure)?;
        let batches = stop.samples.map(|all| all.div_ceil(samples.into()).max(2));
        let stop = Stop { batches, seconds: stop.seconds, error: stop.error };
        Ok(Self { tracing: tracing.with_points(paths.point_set()), stop })
    }

    /// A run that has not begun.
    pub(crate) fn start(&self) -> State {
        self.tracing.start()
    }

    /// Runs to the end, or until it is cancelled: what is there by then is a valid result.
    pub(crate) fn run(&self, state: &mut State, watch: &dyn Watch) -> Result<(), Error> {
        self.tracing.go_on(state, &self.stop, watch).map_err(failure)
    }

    /// Why a run has ended, in words.
    pub(crate) fn reason(&self, state: &State) -> String {
        let error = state.relative_error();
        let what = self.stop.ended(state.batches(), error, state.seconds);
        format!("{what}, standard error {:.3} % (L2 over the faces)", 100.0 * error)
    }
}

fn batch(scene: &Enclosure, estimator: &dyn Estimator) -> u32 {
    if estimator.gathers() {
        let even = GATHERED_PATHS.div_ceil(scene.len().max(1)).next_power_of_two();
        return even.clamp(FEWEST_GATHERED, MOST_GATHERED) as u32;
    }
    let samples = u32::try_from(scene.len()).unwrap_or(MOST_SAMPLES).saturating_mul(SHOT_SAMPLES);
    samples.clamp(FEWEST_SAMPLES, MOST_SAMPLES).next_power_of_two()
}

/// Paths with a control variate; in pairs where a trial needs fewer rays for the same error so.
pub(crate) fn controlled(
    scene: &Enclosure,
    known: Control,
    groups: &Groups,
    paths: &PathOptions,
    watch: &dyn Watch,
) -> Result<PathTracing, Error> {
    let apart = PathOptions { seed: paths.seed ^ TRIAL_SEED, ..*paths };
    let rays = |method: &PathTracing| {
        let tracer = Tracer::new(scene, method, groups.clone(), &apart, &TraceStop::default())?;
        let trial = Tracer { stop: Stop { batches: Some(TRIAL_BATCHES), ..Stop::default() }, ..tracer };
        let mut state = trial.start();
        trial.run(&mut state, &Silent(watch))?;
        // Errors fall with the root of the work.
        Ok::<f64, Error>(state.relative_error().powi(2) * state.rays as f64)
    };
    let method = PathTracing::continuous(paths.switches()).with_control(known).paired(true);
    let in_pairs = rays(&method)?;
    let method = method.paired(false);
    let single = rays(&method)?;
    Ok(method.paired(in_pairs < single))
}

/// Passes on whether to go on, and nothing else: the share of a part is not that of the whole.
pub(crate) struct Silent<'a>(pub(crate) &'a dyn Watch);

impl Watch for Silent<'_> {
    fn go_on(&self) -> ControlFlow<()> {
        self.0.go_on()
    }
}

/// What is wrong with a traced scene is wrong with the input.
pub(crate) fn failure(error: MonteCarloError) -> Error {
    Error::new(ErrorKind::Input, error)
}
