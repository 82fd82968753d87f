//! A run: batch after batch, until there are enough.
//!
//! Batches are computed in parallel, [`BATCHES_AT_ONCE`] at a time, and folded in their order: the
//! result of so many batches does not depend on the number of threads, nor on whether the run was
//! continued. W/m².

use crate::light::{Batch, Estimator, Work};
use crate::points::PointSet;
use crate::statistics::Moments;
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
    count: usize,
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
        self.levels.push(Level { of, share, count });
        Ok(self)
    }

    /// Number of groups of all levels.
    fn count(&self) -> usize {
        self.levels.iter().map(|level| level.count).sum()
    }

    fn means(&self, values: &[f64], bands: usize) -> Vec<f64> {
        self.levels.iter().flat_map(|level| level.means(values, bands)).collect()
    }
}

impl Level {
    fn means(&self, values: &[f64], bands: usize) -> Vec<f64> {
        let mut means = vec![0.0; self.count * bands];
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

    /// √ of the mean of (s/x)² over the groups and bands with x ≠ 0: what a target error is
    /// compared with. Infinite below two batches.
    #[must_use]
    pub fn relative_error(&self) -> f64 {
        let errors = self.groups.standard_errors();
        let shares = self.groups.mean().iter().zip(&errors).filter(|(mean, _)| **mean != 0.0);
        let (sum, count) = shares.fold((0.0, 0.0), |(sum, n), (mean, s)| (sum + (s / mean).powi(2), n + 1.0));
        if count > 0.0 { f64::sqrt(sum / count) } else { f64::INFINITY }
    }
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
        let bands = self.scene.bands();
        State {
            method: self.estimator.name().to_owned(),
            seed: self.seed,
            samples: self.samples,
            points: self.points,
            patches: Moments::new(self.scene.len() * bands),
            groups: Moments::new(self.groups.count() * bands),
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
            ("the mesh", own.patches.len() != state.patches.len() || own.groups.len() != state.groups.len()),
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
