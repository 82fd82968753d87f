//! The inside of the unit sphere, with ρ = 0.8.
//!
//! Lambert's kernel is the constant 1/(4π) there and H x the mean of x: x = e^z with mean sinh 1.
//! And the kernel e^{p·q}/(4π sinh 1), which is smooth and lies in no basis: by the formula of Funk
//! and Hecke a spherical harmonic of degree l is multiplied by λ_l = ∫ e^t P_l(t) dt/(2 sinh 1)
//! over [−1, 1]; C. Müller, *Spherical Harmonics*, Springer 1966, doi:10.1007/BFb0094775.

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

/// The unit sphere with the kernel e^{p·q}/(4π sinh 1): x = 2 + z + P₂(x), closed and smooth,
/// without an edge.
#[must_use]
pub fn smooth_kernel_on_a_sphere() -> Manufactured {
    let unit = 4.0 * PI * 1f64.sinh();
    let (first, second) = (1f64.tanh().recip() - 1.0, 4.0 - 3.0 / 1f64.tanh());
    Manufactured {
        name: "smooth kernel on a sphere",
        curved: true,
        reflectance: 0.8,
        pieces: 1,
        kernel: Box::new(move |p: Vec3, _: Vec3, q: Vec3, _: Vec3| p.dot(q).exp() / unit),
        charts: patches,
        exact: |p| 2.0 + p.z + legendre(p.x),
        irradiance: Box::new(move |p| 2.0 + first * p.z + second * legendre(p.x)),
        peak: None,
    }
}

/// P₂.
fn legendre(t: f64) -> f64 {
    1.5 * t * t - 0.5
}

fn patches(n: usize) -> Vec<Box<dyn Chart>> {
    let part = |i: usize| [i as f64 / n as f64, (i + 1) as f64 / n as f64];
    let patch =
        |face, k: usize| SpherePatch { radius: 1.0, face, u: part(k / n), v: part(k % n), inward: true };
    let all = (0..6).flat_map(|face| (0..n * n).map(move |k| (face, k)));
    all.map(|(face, k)| Box::new(patch(face, k)) as Box<dyn Chart>).collect()
}
