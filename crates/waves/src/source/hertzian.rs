//! The Hertzian dipole: a current I over a length l ≪ λ, exact at any distance; see
//! [`electric_element`](crate::electric_element) for the equations.

use super::{Origin, Source, finite, finite_point, unit};
use crate::medium::IMPEDANCE;
use crate::{ComplexVector, Field, Wave, WaveError, electric_element};
use fredholm_mesh::Vec3;
use num_complex::Complex64;
use std::f64::consts::PI;

/// A point current.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct HertzianDipole {
    position: Vec3,
    axis: Vec3,
    moment: Complex64,
}

impl HertzianDipole {
    /// At `position` (m), the current along `axis` (any length); `moment` is I l, A m.
    ///
    /// # Errors
    /// [`WaveError::Direction`] for an axis without direction, [`WaveError::NotFinite`] for other
    /// numbers.
    pub fn new(position: Vec3, axis: Vec3, moment: Complex64) -> Result<Self, WaveError> {
        finite(moment.re + moment.im, "the moment of a Hertzian dipole")?;
        Ok(Self {
            position: finite_point(position, "the position of a Hertzian dipole")?,
            axis: unit(axis, "the axis of a Hertzian dipole")?,
            moment,
        })
    }
}

impl Source for HertzianDipole {
    fn field(&self, wave: &Wave, p: Vec3) -> Field {
        electric_element(wave, ComplexVector::along(self.axis, self.moment), p - self.position)
    }

    fn origin(&self) -> Origin {
        Origin::Point(self.position)
    }

    fn far_amplitude(&self, wave: &Wave, u: Vec3) -> Option<ComplexVector> {
        let across = self.axis - u * u.dot(self.axis);
        let factor = Complex64::new(0.0, -wave.wavenumber() * IMPEDANCE / (4.0 * PI));
        let phase = Complex64::cis(wave.wavenumber() * u.dot(self.position));
        Some(ComplexVector::along(across, factor * self.moment * phase))
    }

    fn supplied(&self, wave: &Wave, other: &dyn Fn(Vec3) -> ComplexVector) -> Option<f64> {
        let own = IMPEDANCE * wave.wavenumber().powi(2) * self.moment.norm_sqr() / (12.0 * PI);
        Some(own - 0.5 * (self.moment.conj() * other(self.position).dot(self.axis)).re)
    }
}
