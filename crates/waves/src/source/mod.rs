//! Sources of the incident field. Each is a solution of Maxwell's equations away from itself, save
//! the [`Omnidirectional`] one, of which that holds far away only.
//!
//! Amplitudes are peak values; E in V/m, H in A/m, lengths in metres, time factor e^{+jωt}.

mod half_wave;
mod hertzian;
mod omnidirectional;
mod plane_wave;

pub use half_wave::HalfWaveDipole;
pub use hertzian::HertzianDipole;
pub use omnidirectional::Omnidirectional;
pub use plane_wave::PlaneWave;

use crate::{ComplexVector, Field, Wave, WaveError};
use fredholm_mesh::Vec3;

/// Where a wave comes from.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Origin {
    /// From infinity, travelling this way (unit vector).
    Direction(Vec3),
    /// From this point, m.
    Point(Vec3),
}

impl Origin {
    /// From `p` towards the source (unit vector, or 0 at the source itself).
    #[must_use]
    pub fn seen_from(&self, p: Vec3) -> Vec3 {
        match *self {
            Self::Direction(travel) => -travel,
            Self::Point(origin) => (origin - p).normalize_or_zero(),
        }
    }
}

/// A source of an incident field.
pub trait Source: Send + Sync {
    /// The field at `p` (m) as if the scatterer were not there. At the source itself it is not
    /// finite.
    fn field(&self, wave: &Wave, p: Vec3) -> Field;

    /// Where it comes from: decides what is lit.
    fn origin(&self) -> Origin;

    /// The ends (m) of the wire that its current runs along, where it has a length.
    fn wire(&self, _wave: &Wave) -> Option<[Vec3; 2]> {
        None
    }

    /// F (V) of its own far field F e^{−jkr}/r in the direction of the unit vector u; none of a
    /// wave from infinity.
    fn far_amplitude(&self, _wave: &Wave, _u: Vec3) -> Option<ComplexVector> {
        None
    }

    /// The mean power (W) that it gives away against the field E (V/m) of all else: its own in free
    /// space and −½ Re ∫ I* E·dl along it, none of a wave from infinity. Of an omnidirectional one,
    /// which has no current, the first part only.
    fn supplied(&self, _wave: &Wave, _other: &dyn Fn(Vec3) -> ComplexVector) -> Option<f64> {
        None
    }
}

/// The field of all sources together at `p`.
#[must_use]
pub fn incident(sources: &[&dyn Source], wave: &Wave, p: Vec3) -> Field {
    sources.iter().map(|source| source.field(wave, p)).sum()
}

/// A unit vector along `direction`.
pub(crate) fn unit(direction: Vec3, what: &'static str) -> Result<Vec3, WaveError> {
    let scaled = direction / direction.abs().max_element();
    if scaled.is_finite() { Ok(scaled.normalize()) } else { Err(WaveError::Direction { what }) }
}

fn finite(value: f64, what: &'static str) -> Result<f64, WaveError> {
    if value.is_finite() { Ok(value) } else { Err(WaveError::NotFinite { what }) }
}

fn finite_point(p: Vec3, what: &'static str) -> Result<Vec3, WaveError> {
    if p.is_finite() { Ok(p) } else { Err(WaveError::NotFinite { what }) }
}
