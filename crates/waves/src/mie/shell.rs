//! A thin sheet around a ball of free space.
//!
//! E is continuous across the sheet, and E_tan = Z_s J, where J is the jump of n × H (T. B. A.
//! Senior, J. L. Volakis, Approximate Boundary Conditions in Electromagnetics, IEE 1995, § 2.4).
//! With the waves of the series, ζ = Z_s/η₀ (the conjugate of ours) and ψ_n ξ_n′ − ψ_n′ ξ_n = i,
//!
//! ```text
//! a_n = ψ_n′²/(ζ + ψ_n′ ξ_n′),   b_n = ψ_n²/(ζ + ψ_n ξ_n)
//! ```
//!
//! which are those of a conductor for ζ = 0. Within, the regular waves take the place of the
//! outgoing ones, with a_n ξ_n′/ψ_n′ and b_n ξ_n/ψ_n.

use super::{Riccati, Series, check_passive, terms};
use crate::medium::IMPEDANCE;
use crate::source::PlaneWave;
use crate::{ComplexVector, Wave, WaveError};
use fredholm_mesh::Vec3;
use num_complex::Complex64;

/// A sphere of a thin sheet around the origin, with free space on both sides.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ResistiveShell {
    radius: f64,
    impedance: Complex64,
}

impl ResistiveShell {
    /// The shell of this radius (m) and sheet impedance Z_s (Ω): E_tan = Z_s J.
    ///
    /// # Errors
    /// [`WaveError::Length`] unless the radius is finite and above 0, [`WaveError::Material`]
    /// unless Z_s is finite with a real part of at least 0.
    pub fn new(radius: f64, impedance: Complex64) -> Result<Self, WaveError> {
        let reason = "the sheet impedance must be finite with a real part of at least 0";
        check_passive(radius, impedance, ("of the shell", reason))?;
        Ok(Self { radius, impedance })
    }

    /// The scattered E (V/m) at `p` (m), outside or within, exact at any distance.
    #[must_use]
    pub fn scattered(&self, wave: &Wave, source: &PlaneWave, p: Vec3) -> ComplexVector {
        if p.length() < self.radius {
            self.within(wave).regular(wave, source, p)
        } else {
            self.series(wave).scattered(wave, source, p)
        }
    }

    /// Cross-sections of extinction and of scattering, m²; their difference is what the sheet
    /// absorbs.
    #[must_use]
    pub fn cross_sections(&self, wave: &Wave) -> [f64; 2] {
        self.series(wave).cross_sections(wave)
    }

    /// The waves outside.
    fn series(&self, wave: &Wave) -> Series {
        self.shares(wave, |psi, xi, zeta| psi * psi / (zeta + psi * xi))
    }

    /// The waves within.
    fn within(&self, wave: &Wave) -> Series {
        self.shares(wave, |psi, xi, zeta| psi * xi / (zeta + psi * xi))
    }

    fn shares(&self, wave: &Wave, share: fn(f64, Complex64, Complex64) -> Complex64) -> Series {
        let x = wave.wavenumber() * self.radius;
        let at = Riccati::new(x, terms(x));
        // The time factor of the series is the conjugate of ours.
        let zeta = self.impedance.conj() / IMPEDANCE;
        let term =
            |n: usize| [share(at.psi_slope(n), at.xi_slope(n), zeta), share(at.psi(n), at.xi(n), zeta)];
        Series((1..=terms(x)).map(term).collect())
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::ConductingSphere;
    use crate::Source;
    use crate::medium::SPEED_OF_LIGHT;
    use std::f64::consts::TAU;

    fn wave() -> Wave {
        Wave::new(3.0 * SPEED_OF_LIGHT / TAU).unwrap()
    }

    fn source() -> PlaneWave {
        PlaneWave::new(Vec3::Y, Vec3::Z, 1.0.into()).unwrap()
    }

    fn places() -> [Vec3; 5] {
        [Vec3::X * 1.5, Vec3::Y * -3.0, Vec3::new(-1.0, 0.5, 2.0), Vec3::X * 0.6, Vec3::new(0.1, -0.3, 0.2)]
    }

    #[test]
    fn without_impedance_it_is_a_conductor_and_with_much_of_it_nothing() {
        let conductor = ConductingSphere::new(1.0).unwrap();
        let shell = |z: f64| ResistiveShell::new(1.0, z.into()).unwrap();
        for p in places() {
            let found = shell(0.0).scattered(&wave(), &source(), p);
            let expected = if p.length() > 1.0 {
                conductor.scattered(&wave(), &source(), p)
            } else {
                -source().field(&wave(), p).e
            };
            assert!((found - expected).norm() < 1e-12, "{p}: {found:?}");
            assert!(shell(1e15).scattered(&wave(), &source(), p).norm() < 1e-11);
        }
    }

    /// E_tan on both sides is Z_s times the jump of n × H, by differences across the shell.
    #[test]
    fn the_field_is_continuous_and_the_jump_of_its_curl_is_the_current() {
        let (z, step) = (Complex64::new(150.0, -80.0), 1e-4);
        let shell = ResistiveShell::new(1.0, z).unwrap();
        let total = |p: Vec3| shell.scattered(&wave(), &source(), p) + source().field(&wave(), p).e;
        for out in [Vec3::new(0.6, 0.0, 0.8), Vec3::new(-0.48, 0.64, -0.6)] {
            let across = out.cross(Vec3::new(0.3, 0.5, 0.7)).normalize();
            // n × H = j n × (∇ × E)/(kη), whose component is that of j (∇(n·E) − ∂E/∂n)/(kη).
            let along = |r: f64| total(out * r).dot(across);
            let radial = |r: f64| {
                let [a, b] = [1.0, -1.0].map(|sign| total(out * r + across * (sign * step)).dot(out));
                (a - b) / (2.0 * step)
            };
            let of_side = |sign: f64| {
                let at = |i: f64| along(1.0 + sign * i * step);
                let slope = (at(1.0) * 4.0 - at(2.0) - at(0.001) * 3.0) / (2.0 * sign * step);
                (radial(1.0 + sign * step) - slope) * Complex64::I / (wave().wavenumber() * IMPEDANCE)
            };
            let jump = of_side(1.0) - of_side(-1.0);
            assert!((along(1.0 + 1e-9) - along(1.0 - 1e-9)).norm() < 1e-7);
            assert!((along(1.0) - z * jump).norm() < 5e-3 * along(1.0).norm(), "{} {}", along(1.0), z * jump);
        }
    }

    #[test]
    fn resistance_absorbs_and_reactance_does_not() {
        for z in [Complex64::new(0.0, -300.0), Complex64::new(0.0, 90.0), 20.0.into(), 377.0.into()] {
            let [extinction, scattering] = ResistiveShell::new(1.0, z).unwrap().cross_sections(&wave());
            let absorbed = (extinction - scattering) / extinction;
            assert!(if z.re == 0.0 { absorbed.abs() < 1e-12 } else { absorbed > 0.05 }, "{z}: {absorbed}");
        }
        assert!(ResistiveShell::new(1.0, Complex64::new(-1.0, 0.0)).is_err());
        assert!(ResistiveShell::new(1.0, Complex64::new(f64::NAN, 0.0)).is_err());
    }
}
