//! Pictures of which every pixel is traced by itself.

use fredholm_linop::Watch;
use fredholm_montecarlo::light::PointEstimator;
use fredholm_montecarlo::light::pixels::{PixelEstimate, PixelSampling, pixel};
use fredholm_montecarlo::{Enclosure, Site};
use fredholm_report::Pixels;
use rayon::prelude::*;

/// Rows between looks for Ctrl-C.
const ROWS_BETWEEN_LOOKS: u32 = 16;

/// What is needed to trace pixels.
pub(crate) struct PixelTracer<'a> {
    pub(crate) scene: &'a Enclosure,
    pub(crate) estimator: Box<dyn PointEstimator>,
    /// Width and height of the picture, pixels.
    pub(crate) size: [u32; 2],
    pub(crate) sampling: PixelSampling,
    /// What is seen through a place of the picture, in pixels from the upper left.
    pub(crate) see: Box<dyn Fn(f64, f64) -> Option<Site> + Sync + 'a>,
}

impl PixelTracer<'_> {
    /// All pixels; none where Ctrl-C comes before.
    pub(crate) fn trace(&self, watch: &dyn Watch) -> Option<Pixels> {
        let [width, height] = self.size;
        // Lists that grow would be held twice over.
        let count = width as usize * height as usize;
        let values = count * self.scene.bands();
        let mut pixels = Pixels {
            width,
            height,
            radiosity: Vec::with_capacity(values),
            standard_error: Vec::with_capacity(values),
            covered: Vec::with_capacity(count),
            lamp: Vec::with_capacity(count),
        };
        for first in (0..height).step_by(ROWS_BETWEEN_LOOKS as usize) {
            if watch.go_on().is_break() {
                return None;
            }
            let done = f64::from(first) / f64::from(height);
            watch.advance(done, &|| format!("{first} of {height} rows"));
            let last = (first + ROWS_BETWEEN_LOOKS).min(height);
            let strip: Vec<(PixelEstimate, bool)> =
                (first * width..last * width).into_par_iter().map(|number| self.pixel(number)).collect();
            for (found, lamp) in strip {
                pixels.radiosity.extend(found.radiosity);
                pixels.standard_error.extend(found.standard_error);
                pixels.covered.push(found.covered);
                pixels.lamp.push(lamp);
            }
        }
        Some(pixels)
    }

    fn pixel(&self, number: u32) -> (PixelEstimate, bool) {
        let [width, _] = self.size;
        let (x, y) = (f64::from(number % width), f64::from(number / width));
        let see = |[u, v]: [f64; 2]| (self.see)(x + u, y + v);
        let found = pixel(self.scene, &*self.estimator, number, self.sampling, &see);
        let emits = |site: Site| self.scene.exitance(site.patch).iter().any(|&m| m > 0.0);
        (found, see([0.5; 2]).is_some_and(emits))
    }
}
