//! Centre to centre: A_i F_ij ≈ A_i A_j cosθ cosθ' V / (π r²) between the centroids.
//!
//! J.-F. Viennot's thesis, eq. 1.42. In m². For small patches far from each other only. The odd
//! terms of the kernel's expansion about the centroids vanish; the stated error is the size of the
//! second ones, a few times (R_i² + R_j²)/r² of A_i A_j / (π r²).

use super::facing::{Facing, Part};
use super::{Evaluated, FormFactorMethod, MethodError, Setting};
use fredholm_mesh::Patch;
use fredholm_quadrature::Estimate;
use fredholm_visibility::Occluders;
use std::f64::consts::FRAC_1_PI;

/// Stated error over (R_i² + R_j²)/r² of the squarely facing exchange.
const SECOND_TERMS: f64 = 1.5;

pub(super) struct Centre;

impl FormFactorMethod for Centre {
    fn name(&self) -> &'static str {
        "centre"
    }

    fn summary(&self) -> &'static str {
        "kernel between the centroids, for small patches far apart"
    }

    fn convergent(&self) -> bool {
        false
    }

    fn default_setting(&self) -> Setting {
        Setting::Fixed
    }

    fn exchange(
        &self,
        a: &Patch,
        b: &Patch,
        occluders: &Occluders,
        setting: Setting,
    ) -> Result<Evaluated, MethodError> {
        setting.fixed(self.name())?;
        let Some(facing) = Facing::new(a, b, occluders) else { return Ok(Evaluated::default()) };
        let kernel = facing.kernel(facing.a.centroid(), facing.b.centroid());
        let value = facing.a.area() * facing.b.area() * kernel;
        Ok(facing.evaluated(Estimate { value, error: second_terms(&facing.a, &facing.b) }, 1))
    }
}

/// Size of the terms that one point pair leaves out, m².
pub(super) fn second_terms(a: &Part, b: &Part) -> f64 {
    let r2 = a.centroid().distance_squared(b.centroid());
    let spread = (a.radius().powi(2) + b.radius().powi(2)) / r2;
    let squarely = FRAC_1_PI * a.area() * b.area() / r2;
    SECOND_TERMS * spread * squarely
}
