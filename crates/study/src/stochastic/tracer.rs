//! One traced run, with its progress.

use fredholm_linop::Watch;
use fredholm_montecarlo::light::{Control, Estimator, ResidualShooting};
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

/// Particles that carry what a solution has missed, for the means of groups.
pub(crate) fn controlled(
    scene: &Enclosure,
    known: Control,
    groups: &Groups,
    paths: &PathOptions,
    watch: &dyn Watch,
) -> ResidualShooting {
    let shooting = ResidualShooting::new(scene, known, paths.switches());
    shooting.shared_out(scene, groups, (paths.seed, paths.point_set()), watch)
}

/// What is wrong with a traced scene is wrong with the input.
pub(crate) fn failure(error: MonteCarloError) -> Error {
    Error::new(ErrorKind::Input, error)
}
