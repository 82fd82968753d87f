//! Pictures of which every pixel is traced by itself.

use fredholm_montecarlo::light::pixels::PixelSampling;
use fredholm_montecarlo::light::{PIXEL_METHODS, point_estimator};
use fredholm_montecarlo::{Enclosure, Site};
use fredholm_report::{Camera, Eye};
use fredholm_scene::Scene;

use super::TraceOptions;
use crate::error::{Error, ErrorKind};
use crate::prediction::pictured;
use crate::problem::pixels;
use crate::solve::report_failure;
use crate::stochastic::{Drawn, Ground, PixelTracer};

/// Bytes of a pixel, and of each of its bands.
const BYTES_OF_A_PIXEL: u128 = 9;
const BYTES_OF_A_BAND: u128 = 16;
/// Bytes of its colour with what the exposure goes by, and of the rest of it in the file.
const BYTES_OF_COLOUR: u128 = 35;
const BYTES_IN_FILE: u128 = 8;
/// Samples of a batch of a pixel.
const SAMPLES_OF_A_BATCH: u32 = 4;
/// Fewest batches of a pixel: without two there is no standard error.
const FEWEST_BATCHES: u32 = 2;

/// What traces the pixels; `None` where no such picture is asked for.
pub(super) fn tracer<'a>(
    asked: &TraceOptions,
    ground: &Ground,
    scene: &'a Enclosure,
    camera: &Camera,
) -> Result<Option<PixelTracer<'a>>, Error> {
    let Some(samples) = asked.spp else { return Ok(None) };
    let estimator = point_estimator(&asked.method, asked.paths.switches()).ok_or_else(|| refused(asked))?;
    let eye = Eye::new(&ground.mesh, camera).map_err(report_failure)?;
    let batches = samples.div_ceil(SAMPLES_OF_A_BATCH).max(FEWEST_BATCHES);
    let sampling = PixelSampling { seed: asked.paths.seed, batches, samples: SAMPLES_OF_A_BATCH };
    let see = move |x, y| eye.hit(x, y).map(|(patch, point)| Site { patch, point });
    let size = [camera.width, camera.height];
    Ok(Some(PixelTracer { scene, estimator, size, sampling, see: Box::new(see) }))
}

/// Refuses what cannot be traced pixel by pixel, before any path is traced.
pub(super) fn admit(asked: &TraceOptions) -> Result<(), Error> {
    if asked.spp.is_some() && !PIXEL_METHODS.contains(&asked.method.as_str()) {
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
        Some(_) => {
            pixels
                * (BYTES_OF_A_PIXEL
                    + BYTES_OF_A_BAND * bands
                    + BYTES_OF_COLOUR.max(BYTES_IN_FILE + BYTES_OF_A_BAND * bands))
        }
    })
}

fn refused(asked: &TraceOptions) -> Error {
    let help = format!("--spp goes with --method {}", PIXEL_METHODS.join(" or --method "));
    Error::new(ErrorKind::Input, format!("{} traces no pixels", asked.method)).with_help(help)
}
