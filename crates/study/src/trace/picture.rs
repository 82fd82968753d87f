//! Pictures of which every pixel is traced by itself.

use fredholm_linop::Watch;
use fredholm_montecarlo::light::pixels::{PixelEstimate, SAMPLES, pixel};
use fredholm_montecarlo::light::{PICTURED, PointEstimator, point_estimator};
use fredholm_montecarlo::{Enclosure, Site};
use fredholm_report::{Camera, Eye, Pixels};
use fredholm_scene::Scene;
use rayon::prelude::*;

use super::TraceOptions;
use crate::error::{Error, ErrorKind};
use crate::prediction::pictured;
use crate::problem::pixels;
use crate::solve::report_failure;
use crate::stochastic::{Drawn, Ground};

/// Rows between looks for Ctrl-C.
const STRIP: u32 = 16;
/// Bytes of a pixel, and of each of its bands.
const PIXEL: u128 = 9;
const BAND: u128 = 16;
/// Bytes of its colour with what the exposure goes by, and of the rest of it in the file.
const COLOUR: u128 = 35;
const FILE: u128 = 8;
/// Fewest batches of a pixel: without two there is no standard error.
const FEWEST: u32 = 2;

/// What is needed to trace pixels.
pub(super) struct Tracer<'a> {
    scene: &'a Enclosure,
    estimator: Box<dyn PointEstimator>,
    eye: Eye,
    seed: u64,
    batches: u32,
}

impl<'a> Tracer<'a> {
    /// `None` where no such picture is asked for.
    pub(super) fn new(
        asked: &TraceOptions,
        ground: &Ground,
        scene: &'a Enclosure,
        camera: &Camera,
    ) -> Result<Option<Self>, Error> {
        let Some(samples) = asked.spp else { return Ok(None) };
        let estimator =
            point_estimator(&asked.method, asked.paths.switches()).ok_or_else(|| refused(asked))?;
        let eye = Eye::new(&ground.mesh, camera).map_err(report_failure)?;
        let batches = samples.div_ceil(SAMPLES).max(FEWEST);
        Ok(Some(Self { scene, estimator, eye, seed: asked.paths.seed, batches }))
    }

    /// All pixels; none where Ctrl-C comes before.
    pub(super) fn trace(&self, watch: &dyn Watch) -> Option<Pixels> {
        let Camera { width, height, .. } = *self.eye.camera();
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
        for first in (0..height).step_by(STRIP as usize) {
            if watch.go_on().is_break() {
                return None;
            }
            let done = f64::from(first) / f64::from(height);
            watch.advance(done, &|| format!("{first} of {height} rows"));
            let last = (first + STRIP).min(height);
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
        let width = self.eye.camera().width;
        let (x, y) = (f64::from(number % width), f64::from(number / width));
        let see = |[u, v]: [f64; 2]| self.eye.hit(x + u, y + v).map(|(patch, point)| Site { patch, point });
        let found = pixel(self.scene, &*self.estimator, (self.seed, number, self.batches), &see);
        let emits = |site: Site| self.scene.exitance(site.patch).iter().any(|&m| m > 0.0);
        (found, see([0.5; 2]).is_some_and(emits))
    }
}

/// Refuses what cannot be traced pixel by pixel, before any path is traced.
pub(super) fn admit(asked: &TraceOptions) -> Result<(), Error> {
    if asked.spp.is_some() && !PICTURED.contains(&asked.method.as_str()) {
        return Err(refused(asked));
    }
    Ok(())
}

/// What is drawn of a scene, and the bytes that it takes: pixel by pixel two numbers a band, and
/// either the colours of the picture or the file of the numbers.
pub(super) fn drawn(asked: &TraceOptions, scene: &Scene) -> Drawn {
    let (pixels, bands) = (pixels(scene), scene.bands().len() as u128);
    if asked.no_pictures {
        return Drawn::Nothing;
    }
    Drawn::Picture(match asked.spp {
        None => pictured(pixels, 1),
        Some(_) => pixels * (PIXEL + BAND * bands + COLOUR.max(FILE + BAND * bands)),
    })
}

fn refused(asked: &TraceOptions) -> Error {
    let help = format!("--spp goes with --method {}", PICTURED.join(" or --method "));
    Error::new(ErrorKind::Input, format!("{} traces no pixels", asked.method)).with_help(help)
}
