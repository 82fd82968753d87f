//! One traced run, with its progress.

use std::ops::ControlFlow;

use fredholm_montecarlo::light::Estimator;
use fredholm_montecarlo::{Enclosure, FEWEST, Groups, MonteCarloError, State, Stop, Tracing};

use super::args::{PathArgs, TraceStopArgs};
use crate::failure::{Ending, Failure};
use crate::stages::Stages;

/// Samples of a batch of each element, and for each element.
const GATHERED: u32 = 4;
const SHOT: u32 = 8;
/// Fewest and most samples of a batch that shoots.
const LEAST: u32 = 1 << 12;
const MOST: u32 = 1 << 20;

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
        paths: &PathArgs,
        stop: &TraceStopArgs,
    ) -> Result<Self, Failure> {
        let samples = paths.batch.unwrap_or_else(|| batch(scene, estimator));
        let tracing = Tracing::new(scene, estimator, groups, paths.seed, samples).map_err(failure)?;
        let batches = stop.samples.map(|all| all.div_ceil(samples.into()).max(2));
        let stop = Stop { batches, seconds: stop.seconds, error: stop.to };
        Ok(Self { tracing: tracing.with_points(paths.point_set()), stop })
    }

    /// A run that has not begun.
    pub(crate) fn start(&self) -> State {
        self.tracing.start()
    }

    /// Runs to the end, or until Ctrl-C: what is there by then is a valid result.
    pub(crate) fn run(&self, state: &mut State, stages: &Stages) -> Result<(), Failure> {
        let (console, interrupt) = (stages.console, stages.interrupt);
        let watch = |state: &State| {
            let share = share(&self.stop, state.batches(), state.relative_error(), state.seconds);
            console.advance(share, &|| {
                let (batches, error) = (state.batches(), 100.0 * state.relative_error());
                format!("{batches} batches, standard error {error:.2} %")
            });
            if interrupt.requested() { ControlFlow::Break(()) } else { ControlFlow::Continue(()) }
        };
        self.tracing.go_on(state, &self.stop, &watch).map_err(failure)
    }

    /// Why a run has ended, in words.
    pub(crate) fn reason(&self, state: &State) -> String {
        let error = state.relative_error();
        let what = ended(&self.stop, state.batches(), error, state.seconds);
        format!("{what}, standard error {:.3} % (RMS over the faces)", 100.0 * error)
    }
}

/// Which of its ends a run has met after so many batches, with this error, after so many seconds.
pub(super) fn ended(stop: &Stop, batches: u64, error: f64, seconds: f64) -> &'static str {
    if stop.error.is_some_and(|asked| error <= asked) {
        "converged"
    } else if stop.batches.is_some_and(|all| batches >= all) {
        "all samples drawn"
    } else if stop.seconds.is_some_and(|asked| seconds >= asked) {
        "time spent"
    } else {
        "interrupted"
    }
}

/// How far a run has come.
pub(super) fn share(stop: &Stop, batches: u64, error: f64, seconds: f64) -> f64 {
    let done = batches as f64;
    let drawn = stop.batches.map_or(0.0, |all| done / all as f64);
    // Errors fall with the root of the work.
    let exact =
        stop.error.map_or(0.0, |asked| (asked / error).powi(2).min(done / f64::from(FEWEST)).min(1.0));
    let time = stop.seconds.map_or(0.0, |asked| seconds / asked);
    drawn.max(exact).max(time).min(1.0)
}

fn batch(scene: &Enclosure, estimator: &dyn Estimator) -> u32 {
    if estimator.gathers() {
        return GATHERED;
    }
    let samples = u32::try_from(scene.len()).unwrap_or(MOST).saturating_mul(SHOT);
    samples.clamp(LEAST, MOST).next_power_of_two()
}

/// What is wrong with a traced scene is wrong with the input.
pub(crate) fn failure(error: MonteCarloError) -> Failure {
    Failure::new(Ending::Input, error)
}
