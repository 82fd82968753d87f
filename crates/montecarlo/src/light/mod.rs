//! Estimators of the mean irradiance of patches, by random paths.
//!
//! All estimate the same E_i = (1/A_i) ∫ E dA (W/m²), the mean over the *whole* patch, hidden parts
//! counting as 0. An estimator turns a [`Batch`] into one unbiased estimate of all patches; means
//! and standard errors come from many batches, which are independent even where the samples of one
//! are not. Of [`Switches`] each takes what it can use:
//!
//! | method | estimates | roulette | next event | multiple importance | control |
//! |---|---|---|---|---|---|
//! | `path` | the continuous equation, from the patches | yes | yes | yes | [`ResidualShooting`] |
//! | `light` | the continuous equation, from the lamps | yes | | | |
//! | `bidirectional` | the continuous equation, from both | yes | | always | |
//! | `photon` | the continuous equation, with a bias that vanishes with the batches | yes | yes | yes | |
//! | `walk-gathering` | the equation of constants on patches, from the patches | yes | yes | yes | yes |
//! | `walk-shooting` | the same, from the lamps | yes | | | |
//! | `jacobi` | the same, all patches at once | | | | |
//!
//! A patch-wise walk goes on from a new point of the patch that it met, so that its transitions are
//! the form factors: it estimates what the solvers solve, without discretisation error.

mod bidirectional;
mod buried;
mod disc;
mod jacobi;
pub(crate) mod kd_tree;
mod particles;
mod path;
mod photon;
pub mod pixels;
mod registry;
mod residual;

pub use bidirectional::Bidirectional;
pub use jacobi::StochasticJacobi;
pub use particles::ParticleTracing;
pub use path::{Control, PathTracing};
pub use photon::PhotonMap;
pub use registry::{METHODS, PIXEL_METHODS, estimator, point_estimator};
pub use residual::ResidualShooting;

use crate::points::{Draw, Key, PointSet, Samples};
use crate::{Enclosure, Site};

/// What of variance reduction is used.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Switches {
    /// Paths end by chance, the rest weighing more; else when they weigh less than 1e-9.
    pub roulette: bool,
    /// Lamps are sampled at every vertex.
    pub next_event: bool,
    /// Lamps that are met are weighed against lamps that are sampled, by the balance heuristic.
    pub multiple_importance: bool,
    /// Most reflections of a path; `None` for all there are.
    pub bounces: Option<u32>,
}

impl Default for Switches {
    fn default() -> Self {
        Self { roulette: true, next_event: true, multiple_importance: true, bounces: None }
    }
}

/// Weight, relative to the first, at which a path without roulette ends.
const LEAST_WEIGHT: f64 = 1e-9;

impl Switches {
    /// Whether a path goes on, with the probability `survival`; its weight grows accordingly.
    fn goes_on(self, survival: f64, draw: &mut Draw<'_>, weight: &mut [f64], start: f64) -> bool {
        if !self.roulette {
            return weight.iter().any(|&w| w.abs() > LEAST_WEIGHT * start);
        }
        if draw.single() >= survival {
            return false;
        }
        for weight in weight.iter_mut() {
            *weight /= survival;
        }
        true
    }

    /// Whether a path may be reflected after so many reflections.
    fn reflects(self, done: u32) -> bool {
        self.bounces.is_none_or(|most| done < most)
    }
}

/// One batch of samples: everything that its random numbers depend on.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Batch {
    /// Seed of the run.
    pub seed: u64,
    /// Number of the batch.
    pub number: u32,
    /// Samples: of each patch where a method gathers, of all else.
    pub samples: u32,
    /// How the samples share out their numbers.
    pub points: PointSet,
}

impl Batch {
    /// So many samples of a stream.
    pub(crate) fn samples_of(&self, stream: u32, size: u32) -> Samples {
        Samples::new(self.points, Key { seed: self.seed, batch: self.number, stream }, size)
    }
}

/// What a batch has cost.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Work {
    /// Paths begun.
    pub paths: u64,
    /// Rays and segments traced.
    pub rays: u64,
}

impl std::ops::AddAssign for Work {
    fn add_assign(&mut self, other: Self) {
        self.paths += other.paths;
        self.rays += other.rays;
    }
}

/// A way to estimate irradiances.
pub trait Estimator: Sync {
    /// The name it is asked for by.
    fn name(&self) -> &'static str;

    /// Whether the samples of a batch are those of each patch.
    fn gathers(&self) -> bool;

    /// Whether it estimates the equation of constants on patches rather than the continuous one.
    fn patchwise(&self) -> bool {
        false
    }

    /// Writes the estimate of one batch, W/m², patch-major, into `out`, which has patches × bands
    /// places.
    fn batch(&self, scene: &Enclosure, batch: &Batch, out: &mut [f64]) -> Work;
}

/// What estimates the irradiance of a point.
pub trait PointEstimator: Sync {
    /// Adds one sample of the irradiance (W/m²) at a site to `out`, one place a band, and returns
    /// the rays it took.
    fn irradiance(&self, scene: &Enclosure, at: Site, draw: &mut Draw<'_>, out: &mut [f64]) -> u64;
}

/// The batch of an estimator that gathers: means over even points of each patch.
fn gather(scene: &Enclosure, batch: &Batch, estimator: &dyn PointEstimator, out: &mut [f64]) -> Work {
    let mut work = Work::default();
    out.fill(0.0);
    for (patch, row) in out.chunks_mut(scene.bands()).enumerate() {
        let mut samples = batch.samples_of(patch as u32, batch.samples);
        for sample in 0..batch.samples {
            let mut draw = samples.draw(sample);
            let at = scene.point(patch, draw.pair());
            work += Work { paths: 1, rays: estimator.irradiance(scene, at, &mut draw, row) };
        }
        for mean in row.iter_mut() {
            *mean /= f64::from(batch.samples);
        }
    }
    work
}

/// Powers (W) of patches to irradiances (W/m²).
fn per_area(scene: &Enclosure, out: &mut [f64]) {
    for (row, patch) in out.chunks_mut(scene.bands()).zip(scene.patches()) {
        for power in row.iter_mut() {
            *power /= patch.area();
        }
    }
}

/// `out` + factor × a × b, band by band.
fn add(out: &mut [f64], a: &[f64], b: &[f64], factor: f64) {
    out.iter_mut().zip(a).zip(b).for_each(|((out, a), b)| *out += a * b * factor);
}

/// `weight` × values × factor, band by band.
fn scale(weight: &mut [f64], values: &[f64], factor: f64) {
    weight.iter_mut().zip(values).for_each(|(weight, value)| *weight *= value * factor);
}
