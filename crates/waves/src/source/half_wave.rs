//! The half-wave dipole: the thin wire of length λ/2 with the current I cos(kz), exact at any
//! distance.
//!
//! With z along the wire, ρ from it, and R₁, R₂ the distances from the ends at z = +λ/4, −λ/4 (C.
//! A. Balanis, Antenna Theory, 4th ed., Wiley 2016, § 8.5.2, with cos(kl/2) = 0):
//!
//! ```text
//! E_z = −jη I/(4π) [e^{−jkR₁}/R₁ + e^{−jkR₂}/R₂],   H_φ = jI/(4πρ) [e^{−jkR₁} + e^{−jkR₂}]
//! E_ρ = jη I/(4πρ) [(z − λ/4) e^{−jkR₁}/R₁ + (z + λ/4) e^{−jkR₂}/R₂]
//! ```
//!
//! Far away F = −jη I/(2π) cos(½π cosθ)/sin²θ (ẑ − u cosθ) e^{jk u·c}, and its radiation resistance
//! is η Cin(2π)/(4π), 73.13 Ω.

use super::{Origin, Source, finite, finite_point, unit};
use crate::medium::IMPEDANCE;
use crate::{ComplexVector, Field, Wave, WaveError};
use fredholm_mesh::Vec3;
use fredholm_quadrature::gauss_legendre;
use num_complex::Complex64;
use std::f64::consts::TAU;

/// Distance from the wire's line, over λ, below which a point is on it: beyond the wire the
/// transverse parts are 0 there.
const ON_LINE: f64 = 1e-9;

/// ∫₀^{2π} (1 − cos t)/t dt.
const CIN_2PI: f64 = 2.437_653_392_946_447;
/// Points along the wire where the field of all else is taken.
const POINTS: usize = 12;

/// A wire of half a wavelength with a cosine current.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct HalfWaveDipole {
    centre: Vec3,
    axis: Vec3,
    current: Complex64,
}

impl HalfWaveDipole {
    /// Centred at `centre` (m), along `axis` (any length), with the feed `current` I, A.
    ///
    /// # Errors
    /// [`WaveError::Direction`] for an axis without direction, [`WaveError::NotFinite`] for other
    /// numbers.
    pub fn new(centre: Vec3, axis: Vec3, current: Complex64) -> Result<Self, WaveError> {
        finite(current.re + current.im, "the current of a half-wave dipole")?;
        Ok(Self {
            centre: finite_point(centre, "the centre of a half-wave dipole")?,
            axis: unit(axis, "the axis of a half-wave dipole")?,
            current,
        })
    }
}

impl Source for HalfWaveDipole {
    fn field(&self, wave: &Wave, p: Vec3) -> Field {
        let (k, quarter) = (wave.wavenumber(), 0.25 * wave.wavelength());
        let d = p - self.centre;
        let z = d.dot(self.axis);
        let across = d - self.axis * z;
        let rho = across.length();
        let ends = [z - quarter, z + quarter].map(|height| (height, height.hypot(rho)));
        let waves = ends.map(|(_, r)| Complex64::cis(-k * r));
        let factor = self.current * Complex64::new(0.0, 1.0 / (2.0 * TAU));
        let axial = -factor * (waves[0] / ends[0].1 + waves[1] / ends[1].1);
        let mut e = ComplexVector::along(self.axis, axial);
        let mut h = ComplexVector::ZERO;
        if rho <= ON_LINE * wave.wavelength() && z.abs() <= quarter {
            // On the wire itself the field has no bound.
            e += ComplexVector::along(self.axis, f64::INFINITY.into());
        }
        if rho > ON_LINE * wave.wavelength() {
            let out = across / rho;
            let slopes = waves[0] * (ends[0].0 / ends[0].1) + waves[1] * (ends[1].0 / ends[1].1);
            e += ComplexVector::along(out, factor * slopes / rho);
            h = ComplexVector::along(self.axis.cross(out), factor * (waves[0] + waves[1]) / rho);
        }
        Field { e: e * IMPEDANCE, h }
    }

    fn origin(&self) -> Origin {
        Origin::Point(self.centre)
    }

    fn wire(&self, wave: &Wave) -> Option<[Vec3; 2]> {
        let half = self.axis * (0.25 * wave.wavelength());
        Some([self.centre - half, self.centre + half])
    }

    fn far_amplitude(&self, wave: &Wave, u: Vec3) -> Option<ComplexVector> {
        let cosine = u.dot(self.axis);
        let across = self.axis - u * cosine;
        let sine_squared = across.length_squared();
        if sine_squared < ON_LINE {
            return Some(ComplexVector::ZERO);
        }
        let pattern = (0.25 * TAU * cosine).cos() / sine_squared;
        let phase = Complex64::cis(wave.wavenumber() * u.dot(self.centre));
        let factor = self.current * phase * Complex64::new(0.0, -IMPEDANCE / TAU * pattern);
        Some(ComplexVector::along(across, factor))
    }

    fn supplied(&self, wave: &Wave, other: &dyn Fn(Vec3) -> ComplexVector) -> Option<f64> {
        let own = IMPEDANCE * CIN_2PI / (2.0 * TAU) * 0.5 * self.current.norm_sqr();
        let (rule, length) = (gauss_legendre(POINTS), 0.5 * wave.wavelength());
        let piece = |(&t, &w): (&f64, &f64)| {
            let z = (t - 0.5) * length;
            let weight = w * length * (wave.wavenumber() * z).cos();
            other(self.centre + self.axis * z).dot(self.axis) * weight
        };
        let voltage: Complex64 = rule.points.iter().zip(&rule.weights).map(piece).sum();
        Some(own - 0.5 * (self.current.conj() * voltage).re)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::electric_element;

    #[test]
    fn the_closed_form_is_the_sum_of_hertzian_dipoles() {
        let wave = Wave::new(1e9).unwrap();
        let (centre, axis) = (Vec3::new(0.1, 0.2, -0.3), Vec3::new(0.6, 0.0, 0.8));
        let current = Complex64::new(0.5, -2.0);
        let dipole = HalfWaveDipole::new(centre, axis, current).unwrap();
        let rule = gauss_legendre(80);
        for out in [Vec3::new(0.05, 0.02, 0.0), Vec3::new(0.3, -0.4, 0.6), Vec3::new(4.0, 5.0, -2.0)] {
            let element = |(&t, &w): (&f64, &f64)| {
                let z = (t - 0.5) * 0.5 * wave.wavelength();
                let moment = current * (wave.wavenumber() * z).cos() * (w * 0.5 * wave.wavelength());
                electric_element(&wave, ComplexVector::along(axis, moment), out - axis * z)
            };
            let sum: Field = rule.points.iter().zip(&rule.weights).map(element).sum();
            let error = dipole.field(&wave, centre + out) - sum;
            assert!(error.e.norm() < 1e-11 * sum.e.norm(), "{out}: {}", error.e.norm() / sum.e.norm());
            assert!(error.h.norm() < 1e-11 * sum.h.norm(), "{out}: {}", error.h.norm() / sum.h.norm());
        }
    }

    #[test]
    fn nothing_runs_away_on_the_line_of_the_wire() {
        let wave = Wave::new(1e9).unwrap();
        let dipole = HalfWaveDipole::new(Vec3::ZERO, Vec3::Z, 1.0.into()).unwrap();
        let on = dipole.field(&wave, Vec3::Z * 0.5);
        let beside = dipole.field(&wave, Vec3::new(1e-6, 0.0, 0.5));
        assert!(!dipole.field(&wave, Vec3::Z * 0.05).is_finite());
        assert!((on.e - beside.e).norm() < 1e-4 * on.e.norm() && beside.h.norm() < 1e-4 * on.e.norm());
    }
}
