//! Contour integral: A_i F_ij = (1/2π) ∮∮ ln r dx·dy over the outlines of the parts that face each
//! other.
//!
//! Stokes' theorem twice; E. M. Sparrow 1963, doi:10.1115/1.3686055; J.-F. Viennot's thesis, eq.
//! 1.41. In m². See [`contour_integral`]. It knows no visibility.

use super::facing::Facing;
use super::{Evaluated, FormFactorMethod, MethodError, Setting};
use crate::form_factor::{contour_integral, facing_exchange};
use fredholm_mesh::Patch;
use fredholm_visibility::Occluders;

pub(super) struct Contour;

impl FormFactorMethod for Contour {
    fn name(&self) -> &'static str {
        "contour"
    }

    fn summary(&self) -> &'static str {
        "double contour integral, closed along one edge, adaptive along the other"
    }

    fn convergent(&self) -> bool {
        true
    }

    fn default_setting(&self) -> Setting {
        Setting::Tolerance(1e-12)
    }

    fn exchange(
        &self,
        a: &Patch,
        b: &Patch,
        occluders: &Occluders,
        setting: Setting,
    ) -> Result<Evaluated, MethodError> {
        let tolerance = setting.tolerance(self.name())? * facing_exchange(a, b);
        let Some(facing) = Facing::new(a, b, occluders) else { return Ok(Evaluated::default()) };
        if facing.between() > 0 {
            return Err(MethodError::Occluded { method: self.name() });
        }
        let pairs = (facing.a.corners.len() * facing.b.corners.len()) as u64;
        Ok(Evaluated::new(contour_integral(&facing.a.corners, &facing.b.corners, tolerance), pairs))
    }
}
