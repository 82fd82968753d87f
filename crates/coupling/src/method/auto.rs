//! The choice that assemblies make: the cheapest method whose error estimate meets the tolerance.
//!
//! See [`PairIntegrator`]. A_i F_ij in m².

use super::{Evaluated, FormFactorMethod, MethodError, Setting};
use crate::form_factor::{PairIntegrator, Workspace};
use fredholm_mesh::Patch;
use fredholm_quadrature::Estimate;
use fredholm_visibility::Occluders;

pub(super) struct Auto;

impl FormFactorMethod for Auto {
    fn name(&self) -> &'static str {
        "auto"
    }

    fn summary(&self) -> &'static str {
        "the cheapest method whose error estimate meets the tolerance"
    }

    fn convergent(&self) -> bool {
        true
    }

    fn default_setting(&self) -> Setting {
        Setting::Tolerance(1e-3)
    }

    fn exchange(
        &self,
        a: &Patch,
        b: &Patch,
        occluders: &Occluders,
        setting: Setting,
    ) -> Result<Evaluated, MethodError> {
        let tolerance = setting.tolerance(self.name())?;
        let integrator = PairIntegrator::new([a, b], occluders, tolerance);
        let got = integrator.exchange(0, 1, &mut Workspace::default());
        Ok(Evaluated::new(Estimate { value: got.value, error: got.error }, 1))
    }
}
