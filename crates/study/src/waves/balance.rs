//! Checks of a result that need no other one: what is radiated beside what is supplied, and whether
//! a sweep is reciprocal.
//!
//! Of plane waves the scattered power is compared with what they lose by the optical theorem, of
//! located sources what they and the scattered field radiate with what they supply
//! ([`fredholm_waves::supplied`]). With what surfaces absorb, either ratio is 1. S_φθ and S_θφ of a
//! monostatic sweep are the same.

use fredholm_mesh::{Bounds, Vec3};
use fredholm_report::MonostaticRow;
use fredholm_waves::source::PlaneWave;
use fredholm_waves::{ComplexVector, Origin, extinct, largest_extinct, radiated, sphere_rule, supplied};
use serde_json::{Value, json};

use super::Model;
use super::geometry::Geometry;
use super::model::Band;
use crate::error::Error;

/// Power that waves lose over the most that they could, below which it says nothing of the error:
/// it is the small part of the amplitude that is out of phase.
const LEAST_LOST: f64 = 0.01;
/// Elements times directions that are cheap beside anything.
const CHEAP_ELEMENT_DIRECTIONS: f64 = 4e6;

/// The powers of the fields at one frequency.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Balance {
    /// Frequency, Hz.
    pub frequency: f64,
    /// What plane waves lose, or located sources supply, W.
    pub supplied: f64,
    /// What leaves over the sphere, W.
    pub radiated: f64,
    /// What surfaces absorb, W.
    pub absorbed: f64,
}

impl Balance {
    /// Radiated and absorbed over supplied power: 1 for the exact currents.
    #[must_use]
    pub fn ratio(&self) -> f64 {
        (self.radiated + self.absorbed) / self.supplied
    }

    pub(super) fn record(&self) -> Value {
        json!({
            "frequency_hz": self.frequency,
            "supplied_w": self.supplied,
            "radiated_w": self.radiated,
            "absorbed_w": self.absorbed,
            "ratio": self.ratio(),
        })
    }
}

/// How far a monostatic sweep is from being reciprocal.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Reciprocity {
    /// Number of the receiver.
    pub receiver: usize,
    /// Frequency, Hz.
    pub frequency: f64,
    /// ‖S_φθ − S_θφ‖ over ‖S‖.
    pub defect: f64,
}

impl Reciprocity {
    /// Of the rows of a receiver at one frequency; none where nothing goes back.
    pub(super) fn of(rows: &[MonostaticRow]) -> Option<Self> {
        let first = rows.first()?;
        let (mut gap, mut size) = (0.0, 0.0);
        for MonostaticRow { scattering: [tt, pt, tp, pp], .. } in rows {
            gap += (pt[0] - tp[0]).powi(2) + (pt[1] - tp[1]).powi(2);
            size += [tt, pt, tp, pp].into_iter().flatten().map(|x| x * x).sum::<f64>();
        }
        let defect = (gap / size).sqrt();
        defect.is_finite().then_some(Self { receiver: first.receiver, frequency: first.frequency, defect })
    }

    pub(super) fn record(&self, model: &Model) -> Value {
        let name = model.receivers.get(self.receiver).map(|receiver| &receiver.name);
        json!({ "receiver": name, "frequency_hz": self.frequency, "defect": self.defect })
    }
}

/// The power (W) that located sources supply against the scattered E; none of waves from infinity.
pub(super) fn power(
    model: &Model,
    band: &Band,
    scattered: &dyn Fn(Vec3) -> Option<ComplexVector>,
) -> Option<f64> {
    let none = ComplexVector::ZERO * f64::NAN;
    let power = supplied(&model.sources(), &band.wave, &|p| scattered(p).unwrap_or(none))?;
    (power.is_finite() && power > 0.0).then_some(power)
}

/// F of all located sources in a direction, V; none where one is a wave from infinity.
pub(super) fn of_sources(model: &Model, band: &Band, u: Vec3) -> Option<ComplexVector> {
    model.sources().iter().map(|source| source.far_amplitude(&band.wave, u)).sum()
}

/// The far fields, V, in some directions.
pub(super) type FarFields<'a> = &'a dyn Fn(&[Vec3]) -> Result<Vec<ComplexVector>, Error>;

/// What is computed of the powers: the body, and how much work a direction is.
pub(super) struct Balancing<'a> {
    pub(super) model: &'a Model,
    pub(super) band: &'a Band,
    pub(super) geometry: &'a Geometry,
    /// Elements that radiate.
    pub(super) elements: f64,
    /// Pairs of elements that the run has gone through at least once.
    pub(super) pairs: f64,
    /// What located sources supply, W.
    pub(super) power: Option<f64>,
    /// What surfaces absorb, W; none where it is not known.
    pub(super) absorbed: Option<f64>,
}

impl Balancing<'_> {
    /// The powers, where it is known what is absorbed, the sources are of one kind, and the work is
    /// small beside that of the run.
    pub(super) fn balance(&self, far: FarFields<'_>) -> Result<Option<Balance>, Error> {
        let Some(absorbed) = self.absorbed.filter(|_| self.model.balanced) else { return Ok(None) };
        let sources = self.model.sources();
        let located = sources.iter().filter_map(|source| match source.origin() {
            Origin::Point(p) => Some(p),
            Origin::Direction(_) => None,
        });
        let ground = self.model.scene.ground();
        let corners = self.geometry.mesh.patches().flat_map(|patch| patch.corners().to_vec());
        let with_image = |p: Vec3| [Some(p), ground.map(|ground| ground.image(p))].into_iter().flatten();
        let places = corners.chain(located).flat_map(with_image);
        let Some(bounds) = Bounds::around(places) else { return Ok(None) };
        // The ends of a half-wave dipole are a quarter of a wavelength from its place.
        let more = if self.power.is_some() { 0.25 * self.band.wave.wavelength() } else { 0.0 };
        let radius = 0.5 * bounds.diagonal() + more;
        // Before the rule is made: it has some 2 (k a)² directions.
        let directions = 2.0 * (self.band.wave.wavenumber() * radius + 10.0).powi(2);
        if directions * self.elements > CHEAP_ELEMENT_DIRECTIONS.max(self.pairs) {
            return Ok(None);
        }
        let waves: Vec<PlaneWave> =
            self.model.scene.sources().iter().filter_map(|placed| placed.plane_wave).collect();
        let all_plane = waves.len() == sources.len() && !waves.is_empty();
        let supplied = if all_plane {
            // Above a ground plane it is the wave that the plane reflects that goes on and is
            // weakened.
            let onward = |source: PlaneWave| match ground {
                Some(ground) => ground.reflected(&self.band.wave, &source),
                None => Ok(source),
            };
            let waves: Vec<PlaneWave> = waves
                .into_iter()
                .map(onward)
                .collect::<Result<_, _>>()
                .map_err(|error| self.model.refused(&error, None))?;
            let forward = far(&waves.iter().map(PlaneWave::travel).collect::<Vec<_>>())?;
            let waves: Vec<_> = waves.into_iter().zip(forward).collect();
            let lost = extinct(&self.band.wave, &waves);
            Some(lost).filter(|lost| *lost > LEAST_LOST * largest_extinct(&self.band.wave, &waves))
        } else {
            self.power
        };
        let Some(supplied) = supplied.filter(|power| *power > 0.0) else { return Ok(None) };
        let rule = sphere_rule(&self.band.wave, radius);
        let directions: Vec<Vec3> = rule.iter().map(|(u, _)| *u).collect();
        let mut amplitudes = far(&directions)?;
        if !all_plane {
            for (amplitude, &u) in amplitudes.iter_mut().zip(&directions) {
                *amplitude += of_sources(self.model, self.band, u).unwrap_or(ComplexVector::ZERO);
            }
        }
        // Of a ground plane the directions downwards have the mirror image.
        let share = if ground.is_some() { 0.5 } else { 1.0 };
        let radiated = share * radiated(&rule, &amplitudes);
        Ok(Some(Balance { frequency: self.band.wave.frequency(), supplied, radiated, absorbed }))
    }
}
