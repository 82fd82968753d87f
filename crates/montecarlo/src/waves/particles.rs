//! Field particles: rays from the receiver, dA = R² dω/|cosθ| where they pierce a surface.
//!
//! From q the second bounce is looked for along one more ray, half of them cosine-distributed about the normal, half about the mirror image of the
//! direction to the receiver (specular-guided). The weight R²/(|cosθ| pdf) is not bounded where a surface is seen edge-on.

use super::scattering::Spot;
use super::{FieldEstimator, Scattering};
use crate::density::{Cosine, DirectionDensity, Frame, UniformSphere, VonMisesFisher};
use crate::light::Batch;
use crate::points::{Draw, Key};
use fredholm_mesh::Vec3;
use fredholm_waves::ComplexVector;

/// Where rays from a receiver go.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Aim {
    /// Everywhere alike.
    Sphere,
    /// By the cosine about the direction to the scatterer.
    Cosine,
    /// About that direction, with this κ; `None` for one that just covers the scatterer.
    Lobe(Option<f64>),
}

/// κ of the lobe about the mirror direction.
const GUIDED: f64 = 10.0;
/// The density at the rim of the scatterer is that at its middle times e^{−RIM}.
const RIM: f64 = 1.0;

/// Field particles.
#[derive(Clone, Copy, Debug)]
pub struct FieldParticles {
    aim: Aim,
}

impl FieldParticles {
    /// Particles with this density of directions.
    #[must_use]
    pub fn new(aim: Aim) -> Self {
        Self { aim }
    }
}

/// Directions about the scatterer as a receiver sees it.
pub(super) fn aimed(
    problem: &Scattering<'_>,
    aim: Aim,
    receiver: Vec3,
) -> (Frame, Box<dyn DirectionDensity>) {
    let (centre, radius) = problem.ball();
    let towards = centre - receiver;
    let sine = (radius / towards.length()).min(1.0);
    // 1 − cosθ of the rim.
    let rim = 1.0 - (1.0 - sine * sine).sqrt();
    let density: Box<dyn DirectionDensity> = match aim {
        Aim::Sphere => Box::new(UniformSphere),
        Aim::Cosine => Box::new(Cosine),
        Aim::Lobe(kappa) => Box::new(VonMisesFisher::new(kappa.unwrap_or(RIM / rim))),
    };
    (Frame::about(towards.normalize_or(Vec3::Z)), density)
}

impl FieldEstimator for FieldParticles {
    fn name(&self) -> &'static str {
        "field-particles"
    }

    fn batch(&self, problem: &Scattering<'_>, receivers: &[Vec3], batch: &Batch) -> Vec<ComplexVector> {
        let field = |(stream, &receiver): (usize, &Vec3)| {
            let (frame, density) = aimed(problem, self.aim, receiver);
            let mut sum = ComplexVector::ZERO;
            for sample in 0..batch.samples {
                let key = Key { seed: batch.seed, batch: batch.number, stream: stream as u32 };
                let mut draw = Draw::new(batch.points, key, sample, batch.samples);
                let local = density.sample(draw.pair());
                let weight = 1.0 / (density.pdf(local) * f64::from(batch.samples));
                for spot in problem.pierced(receiver, frame.world(local)) {
                    sum += arrived(problem, spot, receiver, weight, &mut draw);
                }
            }
            sum
        };
        receivers.iter().enumerate().map(field).collect()
    }
}

/// The field of the part of a surface that this solid angle (sr) shows.
fn arrived(
    problem: &Scattering<'_>,
    spot: Spot,
    receiver: Vec3,
    angle: f64,
    draw: &mut Draw,
) -> ComplexVector {
    let Some(area) = shown(problem, spot, receiver, angle) else { return ComplexVector::ZERO };
    let mut current = problem.first(spot);
    if problem.twice() {
        current += guided(problem, spot, receiver, draw);
    }
    problem.radiated(current, spot, area, receiver)
}

/// Ω R²/|cosθ|, m²; none where the surface is seen exactly edge-on.
pub(super) fn shown(problem: &Scattering<'_>, spot: Spot, from: Vec3, angle: f64) -> Option<f64> {
    let between = spot.point - from;
    let cosine = problem.facet(spot).normal.dot(between).abs() / between.length();
    (cosine > 0.0).then(|| angle * between.length_squared() / cosine)
}

/// One sample of J₂, A/m.
fn guided(problem: &Scattering<'_>, spot: Spot, receiver: Vec3, draw: &mut Draw) -> ComplexVector {
    let facet = problem.facet(spot);
    let away = receiver - spot.point;
    let side = if draw.single() < 0.5 { 1.0 } else { -1.0 };
    // A sheet has two sides to look from, a body one.
    let (side, sides) = if facet.side(facet.normal * -1.0) == 0.0 { (1.0, 1.0) } else { (side, 2.0) };
    let normal = facet.normal * side;
    let mirrored = (normal * (2.0 * normal.dot(away)) - away).normalize_or(normal);
    let mirrored = if mirrored.dot(normal) > 0.0 { mirrored } else { -away.normalize_or(normal) };
    let (even, lobe) = (Frame::about(normal), Frame::about(mirrored));
    let guide = VonMisesFisher::new(GUIDED);
    let (choice, numbers) = (draw.single(), draw.pair());
    let direction =
        if choice < 0.5 { even.world(Cosine.sample(numbers)) } else { lobe.world(guide.sample(numbers)) };
    if direction.dot(normal) <= 0.0 {
        return ComplexVector::ZERO;
    }
    let pdf = 0.5 * Cosine.pdf(even.local(direction)) + 0.5 * guide.pdf(lobe.local(direction));
    let Some(from) = problem.met(spot.point, direction) else { return ComplexVector::ZERO };
    match shown(problem, from, spot.point, sides / pdf) {
        Some(area) => problem.second(spot, from, area),
        None => ComplexVector::ZERO,
    }
}
