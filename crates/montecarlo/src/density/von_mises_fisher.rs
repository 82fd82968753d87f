//! The density of von Mises and Fisher, κ e^{κ (cosθ − 1)}/(2π (1 − e^{−2κ})) (R. Fisher, Proc. R.
//! Soc. A 217 (1953) 295, doi:10.1098/rspa.1953.0064).
//!
//! 1 − cosθ = −ln(ξ + (1 − ξ) e^{−2κ})/κ, written with log1p and expm1 so that nothing is lost at κ
//! = 1e-8 and nothing overflows at 1e8.

use super::{DirectionDensity, at};
use fredholm_mesh::Vec3;
use std::f64::consts::TAU;

/// A lobe about z; κ = 0 is the uniform sphere.
#[derive(Clone, Copy, Debug)]
pub struct VonMisesFisher {
    kappa: f64,
}

/// Below this κ the density is uniform to rounding.
const UNIFORM_BELOW: f64 = 1e-15;

impl VonMisesFisher {
    /// The lobe of concentration `kappa`, at least 0; a negative one counts as 0.
    #[must_use]
    pub fn new(kappa: f64) -> Self {
        Self { kappa: kappa.max(0.0) }
    }
}

impl DirectionDensity for VonMisesFisher {
    fn sample(&self, [u, turn]: [f64; 2]) -> Vec3 {
        let t = if self.kappa < UNIFORM_BELOW {
            2.0 * (1.0 - u)
        } else {
            -((1.0 - u) * (-2.0 * self.kappa).exp_m1()).ln_1p() / self.kappa
        };
        at(t.clamp(0.0, 2.0), turn)
    }

    fn pdf(&self, direction: Vec3) -> f64 {
        // Near the axis 1 − z has lost its digits; the distance to the pole has not.
        let t = 0.5 * (direction - Vec3::Z).length_squared();
        if self.kappa < UNIFORM_BELOW {
            return 0.5 / TAU;
        }
        self.kappa * (-self.kappa * t).exp() / (TAU * -(-2.0 * self.kappa).exp_m1())
    }
}
