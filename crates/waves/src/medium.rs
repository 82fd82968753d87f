//! Constants of free space and the wave in it: k = 2πf/c, η₀ = μ₀ c, λ = c/f.
//!
//! c is exact; μ₀ is the CODATA 2022 value (P. J. Mohr et al., Rev. Mod. Phys. 97 (2025) 025002,
//! doi:10.1103/RevModPhys.97.025002). SI units; time factor e^{+jωt}.

use crate::WaveError;
use std::f64::consts::TAU;

/// Speed of light in free space, m/s.
pub const SPEED_OF_LIGHT: f64 = 299_792_458.0;
/// Permeability of free space, H/m.
pub const PERMEABILITY: f64 = 1.256_637_061_27e-6;
/// Permittivity of free space, F/m.
pub const PERMITTIVITY: f64 = 1.0 / (PERMEABILITY * SPEED_OF_LIGHT * SPEED_OF_LIGHT);
/// Impedance of free space, Ω.
pub const IMPEDANCE: f64 = PERMEABILITY * SPEED_OF_LIGHT;

/// A time-harmonic wave in free space.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Wave {
    frequency: f64,
    wavenumber: f64,
}

impl Wave {
    /// The wave of this frequency, Hz.
    ///
    /// # Errors
    /// [`WaveError::Frequency`] unless the frequency is finite and above 0, and so are k and λ.
    pub fn new(frequency: f64) -> Result<Self, WaveError> {
        let wavenumber = TAU * frequency / SPEED_OF_LIGHT;
        if wavenumber.is_normal() && wavenumber > 0.0 && (SPEED_OF_LIGHT / frequency).is_normal() {
            Ok(Self { frequency, wavenumber })
        } else {
            Err(WaveError::Frequency { value: frequency })
        }
    }

    /// f, Hz.
    #[must_use]
    pub fn frequency(&self) -> f64 {
        self.frequency
    }

    /// k, rad/m.
    #[must_use]
    pub fn wavenumber(&self) -> f64 {
        self.wavenumber
    }

    /// λ, m.
    #[must_use]
    pub fn wavelength(&self) -> f64 {
        SPEED_OF_LIGHT / self.frequency
    }

    /// ω, rad/s.
    #[must_use]
    pub fn angular_frequency(&self) -> f64 {
        TAU * self.frequency
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_gigahertz_has_thirty_centimetres() {
        let wave = Wave::new(1e9).unwrap();
        assert!((wave.wavelength() - 0.299_792_458).abs() < 1e-16);
        assert!((wave.wavenumber() * wave.wavelength() - TAU).abs() < 1e-14);
        assert!((IMPEDANCE - 376.730_313).abs() < 1e-6);
        assert!((PERMITTIVITY - 8.854_187_8e-12).abs() < 1e-19);
    }

    #[test]
    fn frequencies_that_are_none_are_refused() {
        for value in [0.0, -1e9, f64::NAN, f64::INFINITY, 1e-320] {
            assert!(matches!(Wave::new(value), Err(WaveError::Frequency { .. })), "{value}");
        }
    }
}
