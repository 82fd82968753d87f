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
            console.advance(self.share(state), &|| {
                let (batches, error) = (state.batches(), 100.0 * state.relative_error());
                format!("{batches} batches, standard error {error:.2} %")
            });
            if interrupt.requested() { ControlFlow::Break(()) } else { ControlFlow::Continue(()) }
        };
        self.tracing.go_on(state, &self.stop, &watch).map_err(failure)
    }

    /// How far a run has come.
    fn share(&self, state: &State) -> f64 {
        let done = state.batches() as f64;
        let batches = self.stop.batches.map_or(0.0, |all| done / all as f64);
        // Errors fall with the root of the work.
        let error = self.stop.error.map_or(0.0, |error| {
            (error / state.relative_error()).powi(2).min(done / f64::from(FEWEST)).min(1.0)
        });
        let time = self.stop.seconds.map_or(0.0, |seconds| state.seconds / seconds);
        batches.max(error).max(time).min(1.0)
    }

    /// Why a run has ended, in words.
    pub(crate) fn reason(&self, state: &State) -> String {
        let error = state.relative_error();
        let met = |asked: Option<f64>, found: f64| asked.is_some_and(|asked| found >= asked);
        let what = if self.stop.error.is_some_and(|asked| error <= asked) {
            "converged"
        } else if met(self.stop.batches.map(|all| all as f64), state.batches() as f64) {
            "all samples drawn"
        } else if met(self.stop.seconds, state.seconds) {
            "time spent"
        } else {
            "interrupted"
        };
        format!("{what}, standard error {:.3} % (RMS over the faces)", 100.0 * error)
    }
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
