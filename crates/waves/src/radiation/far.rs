//! The far field: E → F e^{−jkr}/r with
//!
//! ```text
//! F(u) = −(jk/4π) ∫ [η (J − u (u·J)) − u × M] e^{jk u·q} dA,   H = (1/η) u × E
//! ```
//!
//! (C. A. Balanis, Antenna Theory, 4th ed., Wiley 2016, § 3.6). F in V, directions are unit vectors
//! from the origin.

use super::Radiator;
use crate::medium::IMPEDANCE;
use crate::{ComplexVector, WaveError};
use fredholm_mesh::Vec3;
use num_complex::Complex64;
use rayon::prelude::*;

/// F in one direction.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct FarField {
    /// Unit vector u from the origin.
    pub direction: Vec3,
    /// F, V.
    pub amplitude: ComplexVector,
}

impl FarField {
    /// The parts along θ̂ and φ̂, V: θ from +z, φ from +x. On the z axis φ̂ is +y.
    #[must_use]
    pub fn polar(&self) -> [Complex64; 2] {
        polar_frame(self.direction).map(|t| self.amplitude.dot(t))
    }
}

/// Unit directions that cover the sphere evenly, on a spiral that turns by the golden angle.
/// R. Swinbank, R. J. Purser, Q. J. R. Meteorol. Soc. 132 (2006) 1769, doi:10.1256/qj.05.227.
#[must_use]
pub fn even_directions(count: usize) -> Vec<Vec3> {
    let golden = std::f64::consts::PI * (3.0 - 5.0_f64.sqrt());
    let place = |i: usize| {
        let z = (2.0 * i as f64 + 1.0) / count as f64 - 1.0;
        let (sin, cos) = (golden * i as f64).sin_cos();
        Vec3::new(cos * (1.0 - z * z).sqrt(), sin * (1.0 - z * z).sqrt(), z)
    };
    (0..count).map(place).collect()
}

/// θ̂ and φ̂ of a direction.
#[must_use]
pub fn polar_frame(direction: Vec3) -> [Vec3; 2] {
    let azimuth = Vec3::Z.cross(direction).normalize_or(Vec3::Y);
    [azimuth.cross(direction), azimuth]
}

/// Radar cross-section 4π |F|²/|E₀|² (m²) of a far amplitude F (V) along one polarisation, E₀ (V/m)
/// incident.
#[must_use]
pub fn cross_section(amplitude: Complex64, incident: Complex64) -> f64 {
    4.0 * std::f64::consts::PI * amplitude.norm_sqr() / incident.norm_sqr()
}

/// The far field in many directions.
pub type Pattern = Vec<FarField>;

impl Radiator<'_> {
    /// F in these directions (any length), in parallel.
    ///
    /// # Errors
    /// [`WaveError::Direction`] for a direction that is none.
    pub fn far_field(&self, directions: &[Vec3]) -> Result<Pattern, WaveError> {
        let direction = |u: &Vec3| {
            let u = crate::source::unit(*u, "the direction of a far receiver")?;
            Ok(FarField { direction: u, amplitude: self.far_amplitude(u) })
        };
        directions.par_iter().map(direction).collect()
    }

    fn far_amplitude(&self, u: Vec3) -> ComplexVector {
        let (mut j, mut m) = (ComplexVector::ZERO, ComplexVector::ZERO);
        let samples = self.samples();
        for group in &samples.groups {
            let front = u.dot(Vec3::from_array(group.normal)) > 0.0;
            let weight = if front { 1.0 } else { group.behind };
            for (elements, sum) in [(&samples.electric, &mut j), (&samples.magnetic, &mut m)] {
                for element in elements.iter().skip(group.first).take(group.count) {
                    let phase = self.wave.wavenumber() * u.dot(Vec3::from_array(element.position));
                    let moment = ComplexVector { re: element.re.into(), im: element.im.into() };
                    *sum += moment * (Complex64::cis(phase) * weight);
                }
            }
        }
        // The moments are over 4π already.
        let across = j - ComplexVector::along(u, j.dot(u));
        (across * IMPEDANCE - m.crossed_by(u)) * Complex64::new(0.0, -self.wave.wavenumber())
    }
}
