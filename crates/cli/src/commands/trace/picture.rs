//! Pictures of which every pixel is traced by itself.

use fredholm_montecarlo::light::pixels::{PixelEstimate, SAMPLES, pixel};
use fredholm_montecarlo::light::{PICTURED, PointEstimator, point_estimator};
use fredholm_montecarlo::{Enclosure, Site};
use fredholm_report::{Camera, Eye, FRAMED, Pixels};
use rayon::prelude::*;

use super::TraceArgs;
use crate::commands::solve::report_failure;
use crate::failure::{Ending, Failure};
use crate::memory::{self, Plan};
use crate::stages::Stages;
use crate::stochastic::Ground;

/// Rows between looks for Ctrl-C.
const STRIP: u32 = 16;
/// Bytes of a pixel, and of each of its bands, while it is traced and written.
const PIXEL: u128 = 40;
const BAND: u128 = 32;
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
        args: &TraceArgs,
        ground: &Ground,
        scene: &'a Enclosure,
        camera: &Camera,
    ) -> Result<Option<Self>, Failure> {
        let Some(samples) = args.spp else { return Ok(None) };
        let estimator = point_estimator(&args.method, args.paths.switches()).ok_or_else(|| refused(args))?;
        let eye = Eye::new(&ground.mesh, camera).map_err(report_failure)?;
        let batches = samples.div_ceil(SAMPLES).max(FEWEST);
        Ok(Some(Self { scene, estimator, eye, seed: args.paths.seed, batches }))
    }

    /// All pixels; none where Ctrl-C comes before.
    pub(super) fn trace(&self, stages: &Stages) -> Option<Pixels> {
        let Camera { width, height, .. } = *self.eye.camera();
        let mut pixels = Pixels { width, height, ..Pixels::default() };
        for first in (0..height).step_by(STRIP as usize) {
            if stages.interrupt.requested() {
                return None;
            }
            let done = f64::from(first) / f64::from(height);
            stages.console.advance(done, &|| format!("{first} of {height} rows"));
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
pub(super) fn admit(args: &TraceArgs, ground: &Ground, stages: &Stages) -> Result<(), Failure> {
    if args.spp.is_none() {
        return Ok(());
    }
    if !PICTURED.contains(&args.method.as_str()) {
        return Err(refused(args));
    }
    let size = ground.scene.camera().map_or(FRAMED, |camera| [camera.width, camera.height]);
    fits(args, size, ground.scene.bands().len(), stages)
}

fn refused(args: &TraceArgs) -> Failure {
    let text = format!(
        "{} traces no pixels\n  help: --spp goes with --method {}",
        args.method,
        PICTURED.join(" or --method ")
    );
    Failure::new(Ending::Input, text)
}

/// Refuses a picture that does not fit in memory: two numbers a pixel and band while it is traced, as many in the file, and what holds them.
fn fits(args: &TraceArgs, [width, height]: [u32; 2], bands: usize, stages: &Stages) -> Result<(), Failure> {
    let pixels = u128::from(width) * u128::from(height);
    let plan = Plan::default().hold("the picture and its errors", pixels * (BAND * bands as u128 + PIXEL));
    stages.admit(&plan, memory::limit(args.problem.memory), "make the camera's width and height smaller")
}
