//! A run: batch after batch, until there are enough.
//!
//! Batches are computed in parallel, [`BATCHES_AT_ONCE`] at a time, and folded in their order: the
//! result of so many batches does not depend on the number of threads, nor on whether the run was
//! continued. W/m².

use crate::light::{Batch, Estimator, Work};
use crate::points::PointSet;
use crate::statistics::{Moments, bits};
use crate::{Enclosure, MonteCarloError};
use fredholm_linop::Watch;
use rayon::prelude::*;
use serde::{Deserialize, Serialize};
use std::time::Instant;

/// Batches that are in memory at once.
pub const BATCHES_AT_ONCE: u32 = 16;
/// Batches without which a standard error is not worth deciding by.
pub const FEWEST_BATCHES: u32 = 32;

/// Patches put together, such as to faces, and those to surfaces: means by area.
#[derive(Clone, Debug, PartialEq)]
pub struct Groups {
    levels: Vec<Level>,
}

/// One way to put patches together.
#[derive(Clone, Debug, PartialEq)]
struct Level {
    of: Vec<usize>,
    share: Vec<f64>,
    areas: Vec<f64>,
}

impl Groups {
    /// `of[i]` is the group of patch i, below `count`.
    ///
    /// # Errors
    /// [`MonteCarloError::Length`] where not every patch has a group.
    pub fn new(scene: &Enclosure, of: Vec<usize>, count: usize) -> Result<Self, MonteCarloError> {
        Self { levels: Vec::new() }.and(scene, of, count)
    }

    /// The same, followed by the groups of another way to put the patches together.
    ///
    /// # Errors
    /// As for [`Groups::new`].
    pub fn and(mut self, scene: &Enclosure, of: Vec<usize>, count: usize) -> Result<Self, MonteCarloError> {
        let what = "the list of groups";
        let valid = of.iter().filter(|&&group| group < count).count();
        if of.len() != scene.len() || valid != scene.len() {
            return Err(MonteCarloError::Length { what, expected: scene.len(), found: valid });
        }
        let mut areas = vec![0.0; count];
        of.iter().zip(scene.patches()).for_each(|(&group, patch)| areas[group] += patch.area());
        let share =
            of.iter().zip(scene.patches()).map(|(&group, patch)| patch.area() / areas[group]).collect();
        self.levels.push(Level { of, share, areas });
        Ok(self)
    }

    /// Area of the group that a patch belongs to on the first level, m².
    pub(crate) fn area_of(&self, patch: usize) -> f64 {
        self.levels[0].areas[self.levels[0].of[patch]]
    }

    /// Mean area of the groups of the first level, m².
    pub(crate) fn mean_area(&self) -> f64 {
        let areas = &self.levels[0].areas;
        areas.iter().sum::<f64>() / areas.len() as f64
    }

    /// Areas of the groups of all levels, m².
    fn areas(&self) -> Vec<f64> {
        self.levels.iter().flat_map(|level| level.areas.iter().copied()).collect()
    }

    fn means(&self, values: &[f64], bands: usize) -> Vec<f64> {
        self.levels.iter().flat_map(|level| level.means(values, bands)).collect()
    }
}

impl Level {
    fn means(&self, values: &[f64], bands: usize) -> Vec<f64> {
        let mut means = vec![0.0; self.areas.len() * bands];
        for ((&group, share), row) in self.of.iter().zip(&self.share).zip(values.chunks(bands)) {
            let mean = &mut means[group * bands..(group + 1) * bands];
            mean.iter_mut().zip(row).for_each(|(mean, value)| *mean += share * value);
        }
        means
    }
}

/// What a run has come to: all that its continuation needs.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct State {
    /// Name of the method.
    pub method: String,
    /// Seed.
    pub seed: u64,
    /// Samples of a batch.
    pub samples: u32,
    /// Order of the samples.
    pub points: PointSet,
    /// Irradiance of the patches over the batches.
    pub patches: Moments,
    /// Irradiance of the groups.
    pub groups: Moments,
    /// Areas of the groups, m².
    #[serde(with = "bits")]
    pub areas: Vec<f64>,
    /// Paths so far.
    pub paths: u64,
    /// Rays and segments so far.
    pub rays: u64,
    /// Wall-clock seconds so far.
    pub seconds: f64,
}

impl State {
    /// Batches so far.
    #[must_use]
    pub fn batches(&self) -> u64 {
        self.patches.count()
    }

    /// Error in L² over the groups, as [`relative_l2`] has it: what a target error is compared with.
    /// Infinite below two batches, and where nothing is lit.
    #[must_use]
    pub fn relative_error(&self) -> f64 {
        let (means, errors) = (self.groups.mean(), self.groups.standard_errors());
        relative_l2(&self.areas, means, &errors).unwrap_or(f64::INFINITY)
    }
}

/// √(Σ A s²/Σ A x²) with the values x of places, their standard deviations s and the areas A of the
/// places, in the worst band that is lit. Values and deviations place by place, the bands of each
/// together. None where nothing is lit.
///
/// Faces that are almost dark count for what they send on, which is little: relative to their own
/// values they would need most of the samples, and those that are covered would need them for ever.
#[must_use]
pub fn relative_l2(areas: &[f64], values: &[f64], errors: &[f64]) -> Option<f64> {
    let bands = values.len().checked_div(areas.len())?;
    let squares = |of: &[f64], band: usize| -> f64 {
        of.iter().skip(band).step_by(bands).zip(areas).map(|(x, area)| area * x * x).sum()
    };
    let shares = (0..bands).map(|band| (squares(errors, band), squares(values, band)));
    shares.filter(|(_, size)| *size > 0.0).map(|(error, size)| f64::sqrt(error / size)).reduce(f64::max)
}

/// When a run ends: at the first that is met.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Stop {
    /// Batches in all.
    pub batches: Option<u64>,
    /// Seconds from now.
    pub seconds: Option<f64>,
    /// Relative error, as [`State::relative_error`] has it.
    pub error: Option<f64>,
}

impl Stop {
    /// Whether a run that began at `started` is to end after so many batches.
    pub(crate) fn is_met(&self, done: u64, error: &dyn Fn() -> f64, started: Instant) -> bool {
        let enough = self.batches.is_some_and(|all| done >= all);
        let late = self.seconds.is_some_and(|seconds| started.elapsed().as_secs_f64() >= seconds);
        let exact = self.error.is_some_and(|wanted| done >= FEWEST_BATCHES.into() && error() <= wanted);
        enough || late || exact || done >= u64::from(u32::MAX - BATCHES_AT_ONCE)
    }

    /// Which end a run has met after so many batches, with this error, after so many seconds.
    #[must_use]
    pub fn ended(&self, batches: u64, error: f64, seconds: f64) -> &'static str {
        if self.error.is_some_and(|asked| error <= asked) {
            "converged"
        } else if self.batches.is_some_and(|all| batches >= all) {
            "all samples drawn"
        } else if self.seconds.is_some_and(|asked| seconds >= asked) {
            "time spent"
        } else {
            "interrupted"
        }
    }

    /// Tells how far a run has come.
    pub(crate) fn tell(&self, watch: &dyn Watch, batches: u64, error: f64, seconds: f64) {
        let done = batches as f64;
        let drawn = self.batches.map_or(0.0, |all| done / all as f64);
        // Errors fall with the root of the work.
        let exact = |asked: f64| (asked / error).powi(2).min(done / f64::from(FEWEST_BATCHES)).min(1.0);
        let exact = self.error.map_or(0.0, exact);
        let time = self.seconds.map_or(0.0, |asked| seconds / asked);
        watch.advance(drawn.max(exact).max(time).min(1.0), &|| {
            format!("{batches} batches, standard error {:.2} %", 100.0 * error)
        });
    }
}

/// A method on a scene.
pub struct Tracing<'a> {
    scene: &'a Enclosure,
    estimator: &'a dyn Estimator,
    groups: Groups,
    seed: u64,
    samples: u32,
    points: PointSet,
}

impl<'a> Tracing<'a> {
    /// So many samples a batch; `groups` are what errors are asked of.
    ///
    /// # Errors
    /// [`MonteCarloError::TooMany`] where the random numbers of patches could not be told apart.
    pub fn new(
        scene: &'a Enclosure,
        estimator: &'a dyn Estimator,
        groups: Groups,
        seed: u64,
        samples: u32,
    ) -> Result<Self, MonteCarloError> {
        let streams = scene.len() as u64;
        if streams >= 1 << 30 || samples == 0 {
            return Err(MonteCarloError::TooMany { samples: samples.into(), streams });
        }
        Ok(Self { scene, estimator, groups, seed, samples, points: PointSet::default() })
    }

    /// The same with another order of the samples.
    #[must_use]
    pub fn with_points(self, points: PointSet) -> Self {
        Self { points, ..self }
    }

    /// A run that has not begun.
    #[must_use]
    pub fn start(&self) -> State {
        let (bands, areas) = (self.scene.bands(), self.groups.areas());
        State {
            method: self.estimator.name().to_owned(),
            seed: self.seed,
            samples: self.samples,
            points: self.points,
            patches: Moments::new(self.scene.len() * bands),
            groups: Moments::new(areas.len() * bands),
            areas,
            paths: 0,
            rays: 0,
            seconds: 0.0,
        }
    }

    /// Goes on until the run is to end or `watch`, which is told between waves how far it is,
    /// breaks.
    ///
    /// # Errors
    /// [`MonteCarloError::Foreign`] for a state of other settings.
    pub fn go_on(&self, state: &mut State, stop: &Stop, watch: &dyn Watch) -> Result<(), MonteCarloError> {
        self.check(state)?;
        let (started, before) = (Instant::now(), state.seconds);
        let wanted = |state: &State| {
            stop.tell(watch, state.batches(), state.relative_error(), state.seconds);
            watch.go_on().is_continue()
        };
        while !stop.is_met(state.batches(), &|| state.relative_error(), started) && wanted(state) {
            let left = stop.batches.map_or(u64::from(BATCHES_AT_ONCE), |all| all - state.batches());
            self.wave(state, left.min(BATCHES_AT_ONCE.into()) as u32);
            state.seconds = before + started.elapsed().as_secs_f64();
        }
        Ok(())
    }

    fn check(&self, state: &State) -> Result<(), MonteCarloError> {
        let own = self.start();
        let differences = [
            ("the method", own.method != state.method),
            ("the seed", own.seed != state.seed),
            ("the number of samples of a batch", own.samples != state.samples),
            ("the point set", own.points != state.points),
            ("the mesh", own.patches.len() != state.patches.len() || own.areas != state.areas),
        ];
        let found = differences.iter().find(|(_, differs)| *differs);
        found.map_or(Ok(()), |&(what, _)| Err(MonteCarloError::Foreign { what }))
    }

    fn wave(&self, state: &mut State, count: u32) {
        let first = state.batches() as u32;
        let batches: Vec<(Vec<f64>, Work)> =
            (first..first + count).into_par_iter().map(|number| self.batch(number)).collect();
        for (values, work) in batches {
            state.groups.push(&self.groups.means(&values, self.scene.bands()));
            state.patches.push(&values);
            state.paths += work.paths;
            state.rays += work.rays;
        }
    }

    fn batch(&self, number: u32) -> (Vec<f64>, Work) {
        let batch = Batch { seed: self.seed, number, samples: self.samples, points: self.points };
        let mut values = vec![0.0; self.scene.len() * self.scene.bands()];
        let work = self.estimator.batch(self.scene, &batch, &mut values);
        (values, work)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn an_error_in_l2_is_that_of_the_worst_band_weighted_by_area() {
        // Two places of 1 m² and 3 m², two bands: 4/(16 + 3 · 16), and 4/4.
        let (areas, values, errors) = ([1.0, 3.0], [4.0, 2.0, 4.0, 0.0], [2.0, 2.0, 0.0, 0.0]);
        assert_eq!(relative_l2(&areas, &values, &errors), Some(1.0));
        let quiet = [2.0, 0.0, 0.0, 0.0];
        assert_eq!(relative_l2(&areas, &values, &quiet), Some(0.25));
        // A place that is dark but for its noise hardly counts; a band that is dark does not.
        let dark = [4.0, 0.0, 1e-9, 0.0];
        assert_eq!(relative_l2(&[1.0; 2], &dark, &[0.0, 0.0, 1e-6, 5.0]), Some(1e-6 / 4.0));
        assert_eq!(relative_l2(&areas, &[0.0; 4], &errors), None);
        assert_eq!(relative_l2(&[], &[], &[]), None);
    }
}
