//! The omnidirectional source: the same |E| in all directions, E = A θ̂ e^{−jkr}/r, H = (1/η₀) r̂ ×
//! E, with θ̂ the direction of growing angle from an axis.
//!
//! No true source radiates so: a tangential field of constant length has no direction on the axis
//! itself, where this one is set to 0. It obeys Maxwell's equations up to terms of order 1/(kr), so
//! it belongs many wavelengths away.

use super::{Origin, Source, finite, finite_point, unit};
use crate::medium::IMPEDANCE;
use crate::{ComplexVector, Field, Wave, WaveError};
use fredholm_mesh::Vec3;
use num_complex::Complex64;

/// A point source of the same strength in all directions.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Omnidirectional {
    position: Vec3,
    axis: Vec3,
    amplitude: f64,
}

impl Omnidirectional {
    /// At `position` (m), polarised away from `axis` (any length); `amplitude` is |E| r, V.
    ///
    /// # Errors
    /// [`WaveError::Direction`] for an axis without direction, [`WaveError::NotFinite`] for other
    /// numbers.
    pub fn new(position: Vec3, axis: Vec3, amplitude: f64) -> Result<Self, WaveError> {
        Ok(Self {
            position: finite_point(position, "the position of an omnidirectional source")?,
            axis: unit(axis, "the axis of an omnidirectional source")?,
            amplitude: finite(amplitude, "the amplitude of an omnidirectional source")?,
        })
    }

    /// The source that radiates `power` (W) in all: |E| r = √(η₀ P/(2π)).
    ///
    /// # Errors
    /// Those of [`Self::new`]; a power below 0 is not finite in its root.
    pub fn with_power(position: Vec3, axis: Vec3, power: f64) -> Result<Self, WaveError> {
        Self::new(position, axis, (IMPEDANCE * power / std::f64::consts::TAU).sqrt())
    }
}

impl Source for Omnidirectional {
    fn field(&self, wave: &Wave, p: Vec3) -> Field {
        let d = p - self.position;
        let r = d.length();
        let out = d / r;
        let polar = (out * out.dot(self.axis) - self.axis).normalize_or_zero();
        let value = Complex64::cis(-wave.wavenumber() * r) * (self.amplitude / r);
        let magnetic = out.cross(polar) / IMPEDANCE;
        Field { e: ComplexVector::along(polar, value), h: ComplexVector::along(magnetic, value) }
    }

    fn origin(&self) -> Origin {
        Origin::Point(self.position)
    }

    fn far_amplitude(&self, wave: &Wave, u: Vec3) -> Option<ComplexVector> {
        let polar = (u * u.dot(self.axis) - self.axis).normalize_or_zero();
        let phase = Complex64::cis(wave.wavenumber() * u.dot(self.position));
        Some(ComplexVector::along(polar, phase * self.amplitude))
    }

    fn supplied(&self, _wave: &Wave, _other: &dyn Fn(Vec3) -> ComplexVector) -> Option<f64> {
        Some(std::f64::consts::TAU * self.amplitude.powi(2) / IMPEDANCE)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_direction_has_the_same_power_density() {
        let wave = Wave::new(1e9).unwrap();
        let source = Omnidirectional::with_power(Vec3::ONE, Vec3::Z, 3.0).unwrap();
        let expected = 3.0 / (4.0 * std::f64::consts::PI * 25.0);
        for out in [Vec3::X, Vec3::new(0.6, 0.0, 0.8), Vec3::new(0.0, 0.8, -0.6)] {
            let field = source.field(&wave, Vec3::ONE + out * 5.0);
            assert!((field.power_density().dot(out) / expected - 1.0).abs() < 1e-13);
            assert!(field.e.dot(out).norm() < 1e-13 * field.e.norm());
        }
        assert!(Omnidirectional::with_power(Vec3::ONE, Vec3::Z, -3.0).is_err());
    }
}
