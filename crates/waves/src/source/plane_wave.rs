//! The plane wave E = E₀ ê e^{−jk K̂·r}, H = (1/η₀) K̂ × E.

use super::{Origin, Source, finite, unit};
use crate::medium::IMPEDANCE;
use crate::{ComplexVector, Field, Wave, WaveError};
use fredholm_mesh::Vec3;
use num_complex::Complex64;

/// Relative length of the part of a polarisation across the travel below which it counts as
/// parallel.
const PARALLEL_LENGTH: f64 = 1e-9;

/// A linearly polarised plane wave.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PlaneWave {
    travel: Vec3,
    polarisation: Vec3,
    amplitude: Complex64,
}

impl PlaneWave {
    /// Travels along `travel` (any length), E along the part of `polarisation` (any length) that is
    /// across it, `amplitude` in V/m at the origin.
    ///
    /// # Errors
    /// [`WaveError::Direction`] for a vector without direction, [`WaveError::Polarisation`] for a
    /// polarisation along the travel, [`WaveError::NotFinite`] for an amplitude that is not finite.
    pub fn new(travel: Vec3, polarisation: Vec3, amplitude: Complex64) -> Result<Self, WaveError> {
        let travel = unit(travel, "the direction of travel of a plane wave")?;
        let polarisation = unit(polarisation, "the polarisation of a plane wave")?;
        let across = polarisation - travel * polarisation.dot(travel);
        if across.length() < PARALLEL_LENGTH {
            return Err(WaveError::Polarisation);
        }
        finite(amplitude.re + amplitude.im, "the amplitude of a plane wave")?;
        Ok(Self { travel, polarisation: across.normalize(), amplitude })
    }

    /// Unit vector K̂.
    #[must_use]
    pub fn travel(&self) -> Vec3 {
        self.travel
    }

    /// Unit vector ê.
    #[must_use]
    pub fn polarisation(&self) -> Vec3 {
        self.polarisation
    }

    /// E₀, V/m.
    #[must_use]
    pub fn amplitude(&self) -> Complex64 {
        self.amplitude
    }
}

impl Source for PlaneWave {
    fn field(&self, wave: &Wave, p: Vec3) -> Field {
        let phase = self.amplitude * Complex64::cis(-wave.wavenumber() * self.travel.dot(p));
        let magnetic = self.travel.cross(self.polarisation) / IMPEDANCE;
        Field { e: ComplexVector::along(self.polarisation, phase), h: ComplexVector::along(magnetic, phase) }
    }

    fn origin(&self) -> Origin {
        Origin::Direction(self.travel)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_polarisation_is_taken_across_the_travel() {
        let wave = Wave::new(1e9).unwrap();
        let source = PlaneWave::new(Vec3::new(0.0, 2.0, 0.0), Vec3::new(0.0, 5.0, 3.0), 2.0.into()).unwrap();
        let field = source.field(&wave, Vec3::Y * (0.25 * wave.wavelength()));
        let [_, y, z] = field.e.components();
        assert!(y.norm() < 1e-15 && (z - Complex64::new(0.0, -2.0)).norm() < 1e-14);
        assert!((field.h.components()[0] - z / IMPEDANCE).norm() < 1e-17);
        assert!((field.power_density() - Vec3::Y * (2.0 / IMPEDANCE)).length() < 1e-17);
    }

    #[test]
    fn directions_that_are_none_are_refused() {
        assert!(matches!(PlaneWave::new(Vec3::ZERO, Vec3::Z, 1.0.into()), Err(WaveError::Direction { .. })));
        assert_eq!(PlaneWave::new(Vec3::Y, -Vec3::Y, 1.0.into()), Err(WaveError::Polarisation));
        let infinite = Complex64::new(f64::INFINITY, 0.0);
        assert!(matches!(PlaneWave::new(Vec3::Y, Vec3::Z, infinite), Err(WaveError::NotFinite { .. })));
    }
}
