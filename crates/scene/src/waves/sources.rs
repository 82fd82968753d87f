//! Sources of a scene.

use std::fmt;
use std::ops::Range;

use fredholm_mesh::Vec3;
use fredholm_waves::source::{HalfWaveDipole, HertzianDipole, Omnidirectional, PlaneWave};
use fredholm_waves::{Complex64, Ground, Grounded, Source as Sends, WaveError, polar_frame};

use super::choices::PolarisationEntry;
use super::format::SourceEntry;
use super::receiver::direction;
use super::scene::refused;
use crate::error::{ErrorKind, SceneError};
use crate::format::At;
use crate::source::Source;
use crate::suggest::among;

/// A source, and the plane wave that it is, if it is one.
pub struct Placed {
    /// The source.
    pub source: Box<dyn Sends + Send>,
    /// The plane wave that it is, without what a ground plane reflects of it.
    pub plane_wave: Option<PlaneWave>,
}

impl Placed {
    /// The same above a ground plane.
    pub(super) fn above(self, ground: Option<Ground>) -> Self {
        match ground {
            Some(ground) => Self { source: Box::new(Grounded::new(self.source, ground)), ..self },
            None => self,
        }
    }
}

impl fmt::Debug for Placed {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "Placed({:?})", self.source.origin())
    }
}

/// The source of an entry.
pub(super) fn placed(source: &Source, entry: &At<SourceEntry>) -> Result<Placed, SceneError> {
    let refused = |error: WaveError| refused(source, entry.span(), &error);
    let found: Box<dyn Sends + Send> = match &**entry {
        SourceEntry::PlaneWave { polarisation, amplitude_v_per_m, phase_degrees, .. } => {
            let travel = travel(source, entry)?;
            let along = self::polarisation(source, entry.span(), polarisation, travel)?;
            let amplitude = phasor(*amplitude_v_per_m, *phase_degrees);
            let wave = PlaneWave::new(travel, along, amplitude).map_err(refused)?;
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
    Ok(Placed { source: found, plane_wave: None })
}

pub(super) fn vector(v: &[f64; 3]) -> Vec3 {
    Vec3::from_array(*v)
}

fn phasor(amplitude: f64, phase_degrees: f64) -> Complex64 {
    Complex64::from_polar(amplitude, phase_degrees.to_radians())
}

fn travel(source: &Source, entry: &At<SourceEntry>) -> Result<Vec3, SceneError> {
    let SourceEntry::PlaneWave { travel, from_theta_degrees, from_phi_degrees, .. } = &**entry else {
        return Ok(Vec3::ZERO);
    };
    match (travel, from_theta_degrees, from_phi_degrees) {
        (Some(travel), None, None) => Ok(vector(travel)),
        (None, Some(theta), Some(phi)) => Ok(-direction(*theta, *phi)),
        _ => {
            let what = "a plane wave needs one direction";
            let help = "give travel = [x, y, z], or from_theta_degrees and from_phi_degrees, and not both";
            Err(source.error(ErrorKind::Value, entry.span(), what, help))
        }
    }
}

fn polarisation(
    source: &Source,
    span: Range<usize>,
    entry: &PolarisationEntry,
    travel: Vec3,
) -> Result<Vec3, SceneError> {
    let [theta, phi] = polar_frame(-travel.normalize_or_zero());
    match entry {
        PolarisationEntry::Vector(along) => Ok(vector(along)),
        PolarisationEntry::Name(name) if name == "theta" => Ok(theta),
        PolarisationEntry::Name(name) if name == "phi" => Ok(phi),
        PolarisationEntry::Name(name) => {
            let what = format!("unknown polarisation `{name}`");
            let known = among(name, ["theta", "phi"], "polarisations");
            Err(source.error(ErrorKind::Value, span, what, format!("{known}; or a vector such as [0, 0, 1]")))
        }
    }
}
