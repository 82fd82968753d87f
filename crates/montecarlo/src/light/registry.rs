//! The methods by name.

use super::{
    Bidirectional, Estimator, ParticleTracing, PathTracing, PhotonMap, PointEstimator, StochasticJacobi,
    Switches,
};
use crate::Enclosure;

/// Names of all methods.
pub const METHODS: [&str; 7] =
    ["path", "light", "bidirectional", "photon", "walk-gathering", "walk-shooting", "jacobi"];

/// Photons of a batch of the photon map.
const PHOTONS_OF_A_BATCH: u32 = 8192;

/// The method of this name, without a control variate.
#[must_use]
pub fn estimator(name: &str, scene: &Enclosure, switches: Switches) -> Option<Box<dyn Estimator>> {
    Some(match name {
        "path" => Box::new(PathTracing::continuous(switches)),
        "light" => Box::new(ParticleTracing::continuous(switches)),
        "bidirectional" => Box::new(Bidirectional::new(switches)),
        "photon" => Box::new(PhotonMap::new(scene, switches, PHOTONS_OF_A_BATCH)),
        "walk-gathering" => Box::new(PathTracing::patchwise(switches)),
        "walk-shooting" => Box::new(ParticleTracing::patchwise(switches)),
        "jacobi" => Box::new(StochasticJacobi),
        _ => return None,
    })
}

/// Names of the methods that estimate the light at a point, so that pictures can be traced pixel by
/// pixel.
pub const PIXEL_METHODS: [&str; 2] = ["path", "bidirectional"];

/// The method of this name as it estimates the irradiance of points.
#[must_use]
pub fn point_estimator(name: &str, switches: Switches) -> Option<Box<dyn PointEstimator>> {
    Some(match name {
        "path" => Box::new(PathTracing::continuous(switches)),
        "bidirectional" => Box::new(Bidirectional::new(switches)),
        _ => return None,
    })
}
