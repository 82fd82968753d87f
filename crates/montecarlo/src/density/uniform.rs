//! Constant densities: 1/(4π) of all directions, 1/(2π) of the half space.

use super::{DirectionDensity, at};
use fredholm_mesh::Vec3;
use std::f64::consts::TAU;

/// Every direction alike.
#[derive(Clone, Copy, Debug, Default)]
pub struct UniformSphere;

/// Every direction with z > 0 alike.
#[derive(Clone, Copy, Debug, Default)]
pub struct UniformHemisphere;

impl DirectionDensity for UniformSphere {
    fn sample(&self, [u, turn]: [f64; 2]) -> Vec3 {
        at(2.0 * u, turn)
    }

    fn pdf(&self, _: Vec3) -> f64 {
        0.5 / TAU
    }
}

impl DirectionDensity for UniformHemisphere {
    fn sample(&self, [u, turn]: [f64; 2]) -> Vec3 {
        at(u, turn)
    }

    fn pdf(&self, direction: Vec3) -> f64 {
        if direction.z >= 0.0 { 1.0 / TAU } else { 0.0 }
    }
}
