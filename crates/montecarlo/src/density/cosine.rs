//! cosθ/π: what a diffuse surface sends and receives (J. H. Lambert).

use super::{DirectionDensity, at};
use fredholm_mesh::Vec3;
use std::f64::consts::FRAC_1_PI;

/// The cosine density of the half space z > 0.
#[derive(Clone, Copy, Debug, Default)]
pub struct Cosine;

impl DirectionDensity for Cosine {
    fn sample(&self, [u, turn]: [f64; 2]) -> Vec3 {
        at(1.0 - (1.0 - u).sqrt(), turn)
    }

    fn pdf(&self, direction: Vec3) -> f64 {
        direction.z.max(0.0) * FRAC_1_PI
    }
}
