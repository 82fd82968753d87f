//! The inside of the unit sphere, where Lambert's kernel is the constant 1/(4π) and H x the mean of x: x = e^z with mean sinh 1, ρ = 0.8.

use super::Manufactured;
use crate::{Chart, SpherePatch};
use fredholm_mesh::Vec3;
use std::f64::consts::PI;

/// The inside of the unit sphere.
#[must_use]
pub fn inside_of_a_sphere() -> Manufactured {
    Manufactured {
        name: "inside of a sphere",
        curved: true,
        reflectance: 0.8,
        pieces: 1,
        kernel: Box::new(|_: Vec3, _: Vec3, _: Vec3, _: Vec3| 0.25 / PI),
        charts: patches,
        exact: |p| p.z.exp(),
        irradiance: Box::new(|_| 1f64.sinh()),
        peak: None,
    }
}

fn patches(n: usize) -> Vec<Box<dyn Chart>> {
    let part = |i: usize| [i as f64 / n as f64, (i + 1) as f64 / n as f64];
    let patch =
        |face, k: usize| SpherePatch { radius: 1.0, face, u: part(k / n), v: part(k % n), inward: true };
    let all = (0..6).flat_map(|face| (0..n * n).map(move |k| (face, k)));
    all.map(|(face, k)| Box::new(patch(face, k)) as Box<dyn Chart>).collect()
}
