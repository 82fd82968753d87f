//! Runs of sampled fields: batch after batch, until there are enough. V/m.

use super::{FieldEstimator, Scattering};
use crate::MonteCarloError;
use crate::light::Batch;
use crate::points::PointSet;
use crate::run::{BATCHES_AT_ONCE, Stop};
use crate::statistics::Moments;
use fredholm_linop::Watch;
use fredholm_mesh::Vec3;
use fredholm_waves::{Complex64, ComplexVector};
use rayon::prelude::*;
use serde::{Deserialize, Serialize};
use std::time::Instant;

/// Real numbers of a field: three complex components.
const NUMBERS_OF_A_FIELD: usize = 6;

/// Estimates of the scattered E at receivers, V/m: all that a continuation needs.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct FieldEstimate {
    method: String,
    seed: u64,
    samples: u32,
    moments: Moments,
    /// Wall-clock seconds so far.
    pub seconds: f64,
}

impl FieldEstimate {
    /// The mean at each receiver.
    #[must_use]
    pub fn mean(&self) -> Vec<ComplexVector> {
        self.moments.mean().chunks_exact(NUMBERS_OF_A_FIELD).map(vector).collect()
    }

    /// Standard errors of E at each receiver, √ of the sum over its components.
    #[must_use]
    pub fn standard_errors(&self) -> Vec<f64> {
        let errors = self.moments.standard_errors();
        errors
            .chunks_exact(NUMBERS_OF_A_FIELD)
            .map(|row| row.iter().map(|s| s * s).sum::<f64>().sqrt())
            .collect()
    }

    /// Standard errors of the real and the imaginary part of each component at each receiver: x, y,
    /// z, real parts first.
    #[must_use]
    pub fn component_errors(&self) -> Vec<[f64; NUMBERS_OF_A_FIELD]> {
        let errors = self.moments.standard_errors();
        errors.chunks_exact(NUMBERS_OF_A_FIELD).map(|row| std::array::from_fn(|i| row[i])).collect()
    }

    /// √(Σ s²/Σ |E|²) over the receivers: what a target error is compared with. Infinite below two
    /// batches.
    #[must_use]
    pub fn relative_error(&self) -> f64 {
        let square = |values: &[f64]| values.iter().map(|x| x * x).sum::<f64>();
        let (size, error) = (square(self.moments.mean()), square(&self.moments.standard_errors()));
        if size > 0.0 { (error / size).sqrt() } else { f64::INFINITY }
    }

    /// Batches.
    #[must_use]
    pub fn batches(&self) -> u64 {
        self.moments.count()
    }

    /// Samples of a batch.
    #[must_use]
    pub fn samples(&self) -> u32 {
        self.samples
    }
}

/// A method, a problem, and where its field is asked for.
pub struct FieldTracing<'a> {
    problem: &'a Scattering<'a>,
    estimator: &'a dyn FieldEstimator,
    receivers: &'a [Vec3],
    seed: u64,
    samples: u32,
}

impl<'a> FieldTracing<'a> {
    /// So many samples a batch, at least one; receivers in metres.
    #[must_use]
    pub fn new(
        problem: &'a Scattering<'a>,
        estimator: &'a dyn FieldEstimator,
        receivers: &'a [Vec3],
        (seed, samples): (u64, u32),
    ) -> Self {
        Self { problem, estimator, receivers, seed, samples: samples.max(1) }
    }

    /// A run that has not begun.
    #[must_use]
    pub fn start(&self) -> FieldEstimate {
        FieldEstimate {
            method: self.estimator.name().to_owned(),
            seed: self.seed,
            samples: self.samples,
            moments: Moments::new(NUMBERS_OF_A_FIELD * self.receivers.len()),
            seconds: 0.0,
        }
    }

    /// Goes on until the run is to end or `watch`, which is told between waves of batches how far
    /// it is, breaks; the same bits for any number of threads and of continuations.
    ///
    /// # Errors
    /// [`MonteCarloError::Foreign`] for a state of other settings.
    pub fn go_on(
        &self,
        state: &mut FieldEstimate,
        stop: &Stop,
        watch: &dyn Watch,
    ) -> Result<(), MonteCarloError> {
        self.check(state)?;
        let (started, before) = (Instant::now(), state.seconds);
        let wanted = |state: &FieldEstimate| {
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

    fn check(&self, state: &FieldEstimate) -> Result<(), MonteCarloError> {
        let own = self.start();
        let differences = [
            ("the method", own.method != state.method),
            ("the seed", own.seed != state.seed),
            ("the number of samples of a batch", own.samples != state.samples),
            ("the number of receivers", own.moments.len() != state.moments.len()),
        ];
        let found = differences.iter().find(|(_, differs)| *differs);
        found.map_or(Ok(()), |&(what, _)| Err(MonteCarloError::Foreign { what }))
    }

    fn wave(&self, state: &mut FieldEstimate, count: u32) {
        let first = state.batches() as u32;
        let one = |number: u32| {
            let batch = Batch { seed: self.seed, number, samples: self.samples, points: PointSet::Sobol };
            self.estimator.batch(self.problem, self.receivers, &batch)
        };
        let wave: Vec<Vec<ComplexVector>> = (first..first + count).into_par_iter().map(one).collect();
        for fields in wave {
            let numbers: Vec<f64> = fields.iter().flat_map(|e| numbers(*e)).collect();
            state.moments.push(&numbers);
        }
    }
}

/// Runs so many batches of so many samples; the same bits for any number of threads.
#[must_use]
pub fn estimate(
    problem: &Scattering<'_>,
    estimator: &dyn FieldEstimator,
    receivers: &[Vec3],
    (seed, batches, samples): (u64, u32, u32),
) -> FieldEstimate {
    let tracing = FieldTracing::new(problem, estimator, receivers, (seed, samples));
    let mut state = tracing.start();
    while state.batches() < batches.into() {
        let left = batches - state.batches() as u32;
        tracing.wave(&mut state, left.min(BATCHES_AT_ONCE));
    }
    state
}

/// Real and imaginary parts of a vector, component by component.
fn numbers(e: ComplexVector) -> [f64; NUMBERS_OF_A_FIELD] {
    let [x, y, z] = e.components();
    [x.re, x.im, y.re, y.im, z.re, z.im]
}

fn vector(row: &[f64]) -> ComplexVector {
    ComplexVector::from_components([0, 2, 4].map(|i| Complex64::new(row[i], row[i + 1])))
}
