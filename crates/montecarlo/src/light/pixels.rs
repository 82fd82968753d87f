//! Pixels, each estimated by itself: the mean radiosity of what is seen through it, B = M + ρ E,
//! W/m².
//!
//! The places within the pixel and the paths behind them are the samples of one batch; batches are
//! independent, and the standard error comes from them.

use super::{PointEstimator, add};
use crate::points::{Key, PointSet, Samples};
use crate::statistics::Moments;
use crate::{Enclosure, Site};

/// Streams of pixels lie beyond those of patches.
const PIXEL_STREAMS: u32 = 1 << 31;

/// How every pixel is sampled.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct PixelSampling {
    /// Seed of the run.
    pub seed: u64,
    /// Number of batches; without two there is no standard error.
    pub batches: u32,
    /// Samples of a batch.
    pub samples: u32,
}

/// One pixel.
#[derive(Clone, Debug, PartialEq)]
pub struct PixelEstimate {
    /// Radiosity of each band, W/m², the mean over the pixel; what is seen of nothing counts as 0.
    pub radiosity: Vec<f64>,
    /// Its standard error, W/m².
    pub standard_error: Vec<f64>,
    /// Share of the samples that saw something.
    pub covered: f64,
}

/// Estimates pixel `number` (below 2³¹); `see` is what is seen through a place of the unit square
/// of the pixel.
pub fn pixel(
    scene: &Enclosure,
    estimator: &dyn PointEstimator,
    number: u32,
    sampling: PixelSampling,
    see: &dyn Fn([f64; 2]) -> Option<Site>,
) -> PixelEstimate {
    let (bands, PixelSampling { seed, batches, samples }) = (scene.bands(), sampling);
    let (mut moments, mut seen) = (Moments::new(bands), 0_u32);
    let [mut sum, mut irradiance] = [vec![0.0; bands], vec![0.0; bands]];
    for batch in 0..batches {
        sum.fill(0.0);
        let key = Key { seed, batch, stream: PIXEL_STREAMS | number };
        let mut numbers = Samples::new(PointSet::Sobol, key, samples);
        for sample in 0..samples {
            let mut draw = numbers.draw(sample);
            let Some(site) = see(draw.pair()) else { continue };
            seen += 1;
            irradiance.fill(0.0);
            estimator.irradiance(scene, site, &mut draw, &mut irradiance);
            add_radiosity(scene, (site, &irradiance), 1.0 / f64::from(samples), &mut sum);
        }
        moments.push(&sum);
    }
    let covered = f64::from(seen) / f64::from(batches.saturating_mul(samples).max(1));
    PixelEstimate { radiosity: moments.mean().to_vec(), standard_error: moments.standard_errors(), covered }
}

/// Adds the share of one sample of M + ρ E to the mean of a batch.
fn add_radiosity(scene: &Enclosure, (site, irradiance): (Site, &[f64]), share: f64, sum: &mut [f64]) {
    add(sum, scene.reflectance(site.patch), irradiance, share);
    sum.iter_mut().zip(scene.exitance(site.patch)).for_each(|(sum, m)| *sum += m * share);
}
