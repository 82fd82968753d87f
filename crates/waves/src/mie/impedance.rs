//! A sphere with a surface impedance.
//!
//! Outside E_tan = Z_s n × H (M. A. Leontovich, Investigations on Radiowave Propagation II, Academy
//! of Sciences, Moscow 1948). With ζ = Z_s/η₀ (the conjugate of ours),
//!
//! ```text
//! a_n = (ψ_n′ + iζ ψ_n)/(ξ_n′ + iζ ξ_n),   b_n = (ψ_n − iζ ψ_n′)/(ξ_n − iζ ξ_n′)
//! ```
//!
//! For ζ = 1 both are the same, and nothing is scattered straight back (V. H. Weston, Theory of
//! absorbers in scattering, IEEE Trans. Antennas Propag. 11 (1963) 578).

use super::{Riccati, Series, check_passive, terms};
use crate::medium::IMPEDANCE;
use crate::source::PlaneWave;
use crate::{ComplexVector, Wave, WaveError};
use fredholm_mesh::Vec3;
use num_complex::Complex64;

/// A sphere around the origin with E_tan = Z_s n × H on its surface.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ImpedanceSphere {
    radius: f64,
    impedance: Complex64,
}

impl ImpedanceSphere {
    /// The sphere of this radius (m) and surface impedance Z_s (Ω).
    ///
    /// # Errors
    /// [`WaveError::Length`] unless the radius is finite and above 0, [`WaveError::Material`]
    /// unless Z_s is finite with a real part of at least 0.
    pub fn new(radius: f64, impedance: Complex64) -> Result<Self, WaveError> {
        let reason = "the surface impedance must be finite with a real part of at least 0";
        check_passive(radius, impedance, ("of the sphere", reason))?;
        Ok(Self { radius, impedance })
    }

    /// The scattered E (V/m) at `p` (m, outside), exact at any distance.
    #[must_use]
    pub fn scattered(&self, wave: &Wave, source: &PlaneWave, p: Vec3) -> ComplexVector {
        self.series(wave).scattered(wave, source, p)
    }

    /// Cross-sections of extinction and of scattering, m²; their difference is what is absorbed.
    #[must_use]
    pub fn cross_sections(&self, wave: &Wave) -> [f64; 2] {
        self.series(wave).cross_sections(wave)
    }

    fn series(&self, wave: &Wave) -> Series {
        let x = wave.wavenumber() * self.radius;
        let at = Riccati::new(x, terms(x));
        // The time factor of the series is the conjugate of ours.
        let turned = Complex64::I * self.impedance.conj() / IMPEDANCE;
        let term = |n: usize| {
            let (psi, slope) = (Complex64::from(at.psi(n)), Complex64::from(at.psi_slope(n)));
            let (xi, xi_slope) = (at.xi(n), at.xi_slope(n));
            [
                (slope + turned * psi) / (xi_slope + turned * xi),
                (psi - turned * slope) / (xi - turned * xi_slope),
            ]
        };
        Series((1..=terms(x)).map(term).collect())
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::ConductingSphere;
    use crate::DielectricSphere;
    use crate::material::surface_impedance;
    use crate::medium::SPEED_OF_LIGHT;
    use std::f64::consts::TAU;

    fn wave() -> Wave {
        Wave::new(3.0 * SPEED_OF_LIGHT / TAU).unwrap()
    }

    fn source() -> PlaneWave {
        PlaneWave::new(Vec3::Y, Vec3::Z, 1.0.into()).unwrap()
    }

    #[test]
    fn without_impedance_it_is_a_conductor_and_with_that_of_free_space_nothing_goes_back() {
        let conductor = ConductingSphere::new(1.0).unwrap();
        let bare = ImpedanceSphere::new(1.0, Complex64::ZERO).unwrap();
        for p in [Vec3::X * 1.5, Vec3::Y * -3.0, Vec3::new(-1.0, 0.5, 2.0)] {
            let [a, b] = [bare.scattered(&wave(), &source(), p), conductor.scattered(&wave(), &source(), p)];
            assert!((a - b).norm() < 1e-12, "{p}");
        }
        let matched = ImpedanceSphere::new(1.0, IMPEDANCE.into()).unwrap();
        // The near parts fall with the square of the distance.
        let of = |way: Vec3| matched.scattered(&wave(), &source(), way * 1e4).norm();
        assert!(of(Vec3::NEG_Y) < 1e-9 * of(Vec3::Y), "{:e} {:e}", of(Vec3::NEG_Y), of(Vec3::Y));
    }

    /// A dense sphere with much loss has the impedance η₀/√ε, the better the denser.
    #[test]
    fn a_dense_sphere_has_a_surface_impedance() {
        let error = |loss: f64| {
            let permittivity = Complex64::new(1.0, -loss);
            let dense = DielectricSphere::new(1.0, permittivity).unwrap();
            let found = ImpedanceSphere::new(1.0, surface_impedance(permittivity)).unwrap();
            let p = Vec3::new(-1.0, 0.5, 2.0);
            let exact = dense.scattered(&wave(), &source(), p);
            (found.scattered(&wave(), &source(), p) - exact).norm() / exact.norm()
        };
        assert!(error(1e4) < 1e-3 && error(1e6) < 0.03 * error(1e4), "{:e} {:e}", error(1e4), error(1e6));
    }

    #[test]
    fn resistance_absorbs_and_reactance_does_not() {
        for z in [Complex64::new(0.0, -300.0), Complex64::new(0.0, 90.0), 20.0.into(), IMPEDANCE.into()] {
            let [extinction, scattering] = ImpedanceSphere::new(1.0, z).unwrap().cross_sections(&wave());
            let absorbed = (extinction - scattering) / extinction;
            assert!(if z.re == 0.0 { absorbed.abs() < 1e-12 } else { absorbed > 0.05 }, "{z}: {absorbed}");
        }
        assert!(ImpedanceSphere::new(1.0, Complex64::new(-1.0, 0.0)).is_err());
        assert!(ImpedanceSphere::new(-1.0, Complex64::ONE).is_err());
    }
}
