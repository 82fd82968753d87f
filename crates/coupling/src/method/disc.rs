//! Point to disc: A_i F_ij ≈ A_i A_j cosθ cosθ' V / (π r² + A_j), j the larger patch.
//!
//! J. R. Wallace, K. A. Elmquist, E. A. Haines, SIGGRAPH 1989, doi:10.1145/74333.74366, after the
//! exact factor of a coaxial disc, A_j / (π r² + A_j). In m². It stays below the area where the
//! patches are close, but knows neither the shape of j nor the extent of i. The larger patch is the
//! disc, so that A_i F_ij = A_j F_ji.

use super::centre::second_terms;
use super::facing::Facing;
use super::{Evaluated, FormFactorMethod, MethodError, Setting};
use fredholm_mesh::Patch;
use fredholm_quadrature::Estimate;
use fredholm_visibility::Occluders;
use std::f64::consts::PI;

pub(super) struct Disc;

impl FormFactorMethod for Disc {
    fn name(&self) -> &'static str {
        "disc"
    }

    fn summary(&self) -> &'static str {
        "kernel between the centroids, the larger patch taken as a disc"
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
        let (p, q) = (facing.a.centroid(), facing.b.centroid());
        let (small, large) = ordered(facing.a.area(), facing.b.area());
        let circle = PI * p.distance_squared(q);
        let value = small * large * facing.kernel(p, q) * circle / (circle + large);
        Ok(facing.evaluated(Estimate { value, error: second_terms(&facing.a, &facing.b) }, 1))
    }
}

fn ordered(a: f64, b: f64) -> (f64, f64) {
    (a.min(b), a.max(b))
}
