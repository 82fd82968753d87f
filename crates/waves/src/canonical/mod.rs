//! Exact fields of bodies that are the same all along z, in a plane wave from anywhere.
//!
//! Where everything varies with z as e^{−jk_z z}, E_z and H_z obey (∇² + κ²) u = 0 across it, with
//! κ² = k² − k_z², and the rest follows from them (C. A. Balanis, Advanced Engineering
//! Electromagnetics, 2nd ed., Wiley 2012, § 6.5):
//!
//! ```text
//! E_t = −(j/κ²)(k_z ∇E_z − ωμ ẑ × ∇H_z),   H_t = −(j/κ²)(k_z ∇H_z + ωε ẑ × ∇E_z)
//! ```
//!
//! with ωμ = kη and ωε = k/η. A conductor along z asks for E_z = 0 and ∂H_z/∂n = 0 however the wave
//! comes, so that both are those of a wave across z with κ for k; only dielectrics couple them.
//!
//! | body | solution |
//! |---|---|
//! | [`ConductingCylinder`], [`LayeredCylinder`] | series of J_n and H_n⁽²⁾ |
//! | [`ConductingWedge`] | series of J_{m/n} |
//! | [`HalfPlane`] | Fresnel integrals |
//! | [`ResistiveHalfPlane`] | factors of Wiener and Hopf |
//!
//! Lengths in metres, angles in radians.

mod bessel;
mod cylinder;
mod half_plane;
mod layers;
mod resistive;
mod wedge;

pub use cylinder::{ConductingCylinder, LayeredCylinder};
pub use half_plane::HalfPlane;
pub use resistive::ResistiveHalfPlane;
pub use wedge::ConductingWedge;

use crate::medium::IMPEDANCE;
use crate::source::PlaneWave;
use crate::{ComplexVector, Field, Wave, WaveError};
use fredholm_mesh::Vec3;
use num_complex::Complex64;

/// Sine of the angle between travel and axis below which a wave counts as travelling along it.
const LEAST_SINE: f64 = 1e-6;

/// What fills space around a body: its wavenumber k = k′ − jk″ and impedance η. Where there are
/// losses, a plane wave keeps its real direction, and its amplitude is that at the origin.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Medium {
    k: Complex64,
    eta: Complex64,
}

impl Medium {
    /// The medium of this wavenumber (rad/m) and impedance (Ω).
    ///
    /// # Errors
    /// [`WaveError::Material`] unless k is finite with k′ > 0 and k″ ≥ 0, and η finite with a real
    /// part above 0.
    pub fn new(wavenumber: Complex64, impedance: Complex64) -> Result<Self, WaveError> {
        let passive = wavenumber.re > 0.0 && wavenumber.im <= 0.0 && impedance.re > 0.0;
        if passive && wavenumber.is_finite() && impedance.is_finite() {
            return Ok(Self { k: wavenumber, eta: impedance });
        }
        let reason = "k′ − jk″ must be finite with k′ > 0 and k″ ≥ 0, η with a real part above 0";
        Err(WaveError::Material { what: "around the body".into(), reason })
    }

    /// Free space.
    #[must_use]
    pub fn free_space(wave: &Wave) -> Self {
        Self { k: wave.wavenumber().into(), eta: IMPEDANCE.into() }
    }

    /// The material of relative permittivity ε′ − jε″ and no magnetism.
    ///
    /// # Errors
    /// [`WaveError::Material`] unless ε is finite with ε″ ≥ 0 and √ε has a real part above 0.
    pub fn of(wave: &Wave, permittivity: Complex64) -> Result<Self, WaveError> {
        let index = permittivity.sqrt();
        Self::new(index * wave.wavenumber(), index.inv() * IMPEDANCE)
    }

    /// k, rad/m.
    #[must_use]
    pub fn wavenumber(&self) -> Complex64 {
        self.k
    }

    /// η, Ω.
    #[must_use]
    pub fn impedance(&self) -> Complex64 {
        self.eta
    }

    /// The field of a plane wave alone at `p` (m).
    #[must_use]
    pub fn incident(&self, source: &PlaneWave, p: Vec3) -> Field {
        let phase = (self.k * Complex64::new(0.0, -source.travel().dot(p))).exp() * source.amplitude();
        let magnetic = source.travel().cross(source.polarisation());
        Field {
            e: ComplexVector::along(source.polarisation(), phase),
            h: ComplexVector::along(magnetic, phase / self.eta),
        }
    }

    /// E and H from E_z and H_z, each with its derivatives along x and y, of a wave with these k_z
    /// and κ.
    fn field(&self, [kz, kappa]: [Complex64; 2], ez: [Complex64; 3], hz: [Complex64; 3]) -> Field {
        let factor = -Complex64::I / (kappa * kappa);
        let across = |own: [Complex64; 3], other: [Complex64; 3], turn: Complex64| {
            // ẑ × ∇u = (−∂u/∂y, ∂u/∂x).
            ComplexVector::from_components([
                factor * (kz * own[1] - turn * other[2]),
                factor * (kz * own[2] + turn * other[1]),
                own[0],
            ])
        };
        Field { e: across(ez, hz, -self.k * self.eta), h: across(hz, ez, self.k / self.eta) }
    }
}

/// A plane wave as seen along z.
struct Oblique {
    /// k_z.
    kz: Complex64,
    /// k times the sine of the angle to the axis.
    kappa: Complex64,
    /// Azimuth of the travel.
    azimuth: f64,
    /// E_z and H_z at the origin.
    axial: [Complex64; 2],
}

impl Oblique {
    fn new(medium: &Medium, source: &PlaneWave) -> Result<Self, WaveError> {
        let travel = source.travel();
        let sine = travel.x.hypot(travel.y);
        if sine < LEAST_SINE {
            return Err(WaveError::Travel { what: "is along the axis, where E_z and H_z vanish" });
        }
        let field = medium.incident(source, Vec3::ZERO);
        Ok(Self {
            kz: medium.k * travel.z,
            kappa: medium.k * sine,
            azimuth: travel.y.atan2(travel.x),
            axial: [field.e.dot(Vec3::Z), field.h.dot(Vec3::Z)],
        })
    }

    /// e^{−jk_z z}.
    fn along(&self, z: f64) -> Complex64 {
        (self.kz * Complex64::new(0.0, -z)).exp()
    }
}

/// The field at a place, if it is one.
fn finite(field: Field) -> Result<Field, WaveError> {
    if field.is_finite() { Ok(field) } else { Err(WaveError::NotFinite { what: "the field at this place" }) }
}

#[cfg(test)]
mod tests;
