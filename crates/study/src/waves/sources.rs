//! Sources of a scene.

use std::ops::Range;

use fredholm_mesh::Vec3;
use fredholm_waves::source::{HalfWaveDipole, HertzianDipole, Omnidirectional, PlaneWave};
use fredholm_waves::{Complex64, Source, WaveError, polar_frame};
use toml::Spanned;

use super::format::{PolarisationEntry, SourceEntry};
use super::located::SceneText;
use crate::error::Error;

/// A source, and the plane wave that it is, if it is one.
pub(super) struct Placed {
    pub(super) source: Box<dyn Source>,
    pub(super) plane_wave: Option<PlaneWave>,
}

/// The source of an entry.
pub(super) fn placed(scene: &SceneText, entry: &Spanned<SourceEntry>) -> Result<Placed, Error> {
    let refused = |error: WaveError| scene.refused(entry.span(), &error);
    let source: Box<dyn Source> = match entry.get_ref() {
        SourceEntry::PlaneWave { polarisation, amplitude_v_per_m, phase_degrees, .. } => {
            let travel = travel(scene, entry)?;
            let polarisation = self::polarisation(scene, entry.span(), polarisation, travel)?;
            let amplitude = phasor(*amplitude_v_per_m, *phase_degrees);
            let wave = PlaneWave::new(travel, polarisation, amplitude).map_err(refused)?;
            return Ok(Placed { source: Box::new(wave), plane_wave: Some(wave) });
        }
        SourceEntry::Omnidirectional { position, axis, power_w } => {
            Box::new(Omnidirectional::with_power(vector(position), vector(axis), *power_w).map_err(refused)?)
        }
        SourceEntry::HertzianDipole { position, axis, moment_a_m, phase_degrees } => {
            let moment = phasor(*moment_a_m, *phase_degrees);
            Box::new(HertzianDipole::new(vector(position), vector(axis), moment).map_err(refused)?)
        }
        SourceEntry::HalfWaveDipole { position, axis, current_a, phase_degrees } => {
            let current = phasor(*current_a, *phase_degrees);
            Box::new(HalfWaveDipole::new(vector(position), vector(axis), current).map_err(refused)?)
        }
    };
    Ok(Placed { source, plane_wave: None })
}

pub(super) fn vector(v: &[f64; 3]) -> Vec3 {
    Vec3::from_array(*v)
}

/// The unit vector with the angles θ from +z and φ from +x about z.
pub(super) fn direction(theta_degrees: f64, phi_degrees: f64) -> Vec3 {
    let (sin_theta, cos_theta) = theta_degrees.to_radians().sin_cos();
    let (sin_phi, cos_phi) = phi_degrees.to_radians().sin_cos();
    Vec3::new(sin_theta * cos_phi, sin_theta * sin_phi, cos_theta)
}

fn phasor(amplitude: f64, phase_degrees: f64) -> Complex64 {
    Complex64::from_polar(amplitude, phase_degrees.to_radians())
}

fn travel(scene: &SceneText, entry: &Spanned<SourceEntry>) -> Result<Vec3, Error> {
    let SourceEntry::PlaneWave { travel, from_theta_degrees, from_phi_degrees, .. } = entry.get_ref() else {
        return Ok(Vec3::ZERO);
    };
    match (travel, from_theta_degrees, from_phi_degrees) {
        (Some(travel), None, None) => Ok(vector(travel)),
        (None, Some(theta), Some(phi)) => Ok(-direction(*theta, *phi)),
        _ => {
            let what = "a plane wave needs one direction";
            let help = "give travel = [x, y, z], or from_theta_degrees and from_phi_degrees, and not both";
            Err(scene.fault(entry.span(), what, help))
        }
    }
}

fn polarisation(
    scene: &SceneText,
    span: Range<usize>,
    entry: &PolarisationEntry,
    travel: Vec3,
) -> Result<Vec3, Error> {
    let [theta, phi] = polar_frame(-travel.normalize_or_zero());
    match entry {
        PolarisationEntry::Vector(along) => Ok(vector(along)),
        PolarisationEntry::Name(name) if name == "theta" => Ok(theta),
        PolarisationEntry::Name(name) if name == "phi" => Ok(phi),
        PolarisationEntry::Name(name) => {
            let what = format!("unknown polarisation `{name}`");
            Err(scene.fault(span, what, "write \"theta\", \"phi\" or a vector such as [0, 0, 1]"))
        }
    }
}
