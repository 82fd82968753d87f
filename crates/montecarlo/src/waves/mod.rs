//! Scattered fields by random sampling: one and two bounces of physical optics on conductors.
//!
//! E(r) = ∫ 𝒢(r, q) J₁(q) dA + ∫∫ 𝒢(r, q) J₂(q ← q′) dA dA′, with 𝒢 the field of a current element, J₁ = 2 n × H_i on what is lit and
//! J₂(q ← q′) = 2 n × H(q) of the element J₁(q′) dA′ where q and q′ face and see each other (G. Viennot, thesis, Limoges 2012, ch. 3 and 4, in the electric form).
//! Fields add with their phases, so that errors fall as N^(−1/2) of the *whole* surface, not of what a specular zone leaves of it.
//!
//! | method | samples | weight |
//! |---|---|---|
//! | [`FieldParticles`] | directions from the receiver, and from each hit | R²/(cosθ pdf): unbounded where a surface is seen edge-on |
//! | [`SurfaceSampling`] | points of the surface, for all receivers at once | the area |
//! | [`AmplitudeParticles`] | directions, hits merged to cells | the cell's Ω R²/cosθ; biased by its size |
//!
//! *More than two bounces are not offered:* a random walk over bounces needs a spectral radius of |K| below 1, and a dihedral of 1.5λ has 1.10, one of 4.5λ 3.13, where K itself has 0.40.
//!
//! Lengths in metres, E in V/m, e^{+jωt}.

mod amplitude;
mod particles;
mod scattering;
mod surface;

pub use amplitude::AmplitudeParticles;
pub use particles::{Aim, FieldParticles};
pub use scattering::{Bounces, Scattering};
pub use surface::SurfaceSampling;

use crate::light::Batch;
use crate::points::PointSet;
use crate::statistics::Moments;
use fredholm_mesh::Vec3;
use fredholm_waves::{Complex64, ComplexVector};
use rayon::prelude::*;

/// Real numbers of a field: three complex components.
const NUMBERS: usize = 6;
/// Batches that are in memory at once.
const WAVE: u32 = 16;

/// A way to estimate the scattered field.
pub trait FieldEstimator: Sync {
    /// The name it is asked for by.
    fn name(&self) -> &'static str;

    /// One estimate of the scattered E (V/m) at every receiver (m).
    fn batch(&self, problem: &Scattering<'_>, receivers: &[Vec3], batch: &Batch) -> Vec<ComplexVector>;
}

/// Estimates of the scattered E at receivers, V/m.
#[derive(Clone, Debug, PartialEq)]
pub struct FieldEstimate {
    moments: Moments,
}

impl FieldEstimate {
    /// The mean at each receiver.
    #[must_use]
    pub fn mean(&self) -> Vec<ComplexVector> {
        self.moments.mean().chunks_exact(NUMBERS).map(vector).collect()
    }

    /// Standard errors of E at each receiver, √ of the sum over its components.
    #[must_use]
    pub fn standard_errors(&self) -> Vec<f64> {
        let errors = self.moments.standard_errors();
        errors.chunks_exact(NUMBERS).map(|row| row.iter().map(|s| s * s).sum::<f64>().sqrt()).collect()
    }

    /// Standard errors of the real and the imaginary part of one component (0, 1, 2) at each receiver.
    #[must_use]
    pub fn component_errors(&self, component: usize) -> Vec<[f64; 2]> {
        let errors = self.moments.standard_errors();
        let pair = |row: &[f64]| [row[2 * component], row[2 * component + 1]];
        errors.chunks_exact(NUMBERS).map(pair).collect()
    }

    /// Batches.
    #[must_use]
    pub fn batches(&self) -> u64 {
        self.moments.count()
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
    let mut moments = Moments::new(NUMBERS * receivers.len());
    let one = |number: u32| {
        let batch = Batch { seed, number, samples, points: PointSet::Sobol };
        estimator.batch(problem, receivers, &batch)
    };
    for first in (0..batches).step_by(WAVE as usize) {
        let last = (first + WAVE).min(batches);
        let wave: Vec<Vec<ComplexVector>> = (first..last).into_par_iter().map(one).collect();
        for fields in wave {
            let numbers: Vec<f64> = fields.iter().flat_map(|e| numbers(*e)).collect();
            moments.push(&numbers);
        }
    }
    FieldEstimate { moments }
}

fn numbers(e: ComplexVector) -> [f64; NUMBERS] {
    let [x, y, z] = e.components();
    [x.re, x.im, y.re, y.im, z.re, z.im]
}

fn vector(row: &[f64]) -> ComplexVector {
    ComplexVector::from_components([0, 2, 4].map(|i| Complex64::new(row[i], row[i + 1])))
}
