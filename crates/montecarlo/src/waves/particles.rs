//! Field particles: rays from the receiver, dA = R² dω/|cosθ| where they pierce a surface.
//!
//! The second bounce at q takes two partners q′: an even point of all surfaces, and where a ray
//! from q ends, cosine-distributed about the normal or about the mirror image of the direction to
//! the receiver (specular-guided). By the balance heuristic either weighs 1/(1/A + p_ω |cosθ′|/R²),
//! which is at most A: nothing seen edge-on bursts.

use super::aim::{Aim, Directions, shown};
use super::scattering::Spot;
use super::{FieldEstimator, Scattering};
use crate::density::{Cosine, DirectionDensity, Frame, VonMisesFisher};
use crate::light::Batch;
use crate::points::Draw;
use fredholm_mesh::Vec3;
use fredholm_waves::ComplexVector;

/// κ of the lobe about the mirror direction.
const MIRROR_LOBE_KAPPA: f64 = 10.0;

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

impl FieldEstimator for FieldParticles {
    fn name(&self) -> &'static str {
        match self.aim {
            Aim::Facets => "field-particles",
            Aim::Sphere => "field-particles-uniform",
            Aim::Cosine => "field-particles-cosine",
            Aim::Lobe(_) => "field-particles-von-mises-fisher",
        }
    }

    fn batch(&self, problem: &Scattering<'_>, receivers: &[Vec3], batch: &Batch) -> Vec<ComplexVector> {
        let field = |(stream, &receiver): (usize, &Vec3)| {
            let directions = Directions::new(problem, self.aim, receiver);
            let mut sum = ComplexVector::ZERO;
            let mut samples = batch.samples_of(stream as u32, batch.samples);
            for sample in 0..batch.samples {
                let mut draw = samples.draw(sample);
                let (spots, density) = directions.shoot(problem, receiver, draw.pair());
                let angle = 1.0 / (density * f64::from(batch.samples));
                for spot in spots {
                    sum += arrived(problem, spot, receiver, angle, &mut draw);
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
    draw: &mut Draw<'_>,
) -> ComplexVector {
    let Some(area) = shown(problem, spot, receiver, angle) else { return ComplexVector::ZERO };
    let mut current = problem.first(spot);
    if problem.twice() {
        current += Partner { spot, receiver }.sample(problem, draw);
    }
    problem.radiated(current, spot, area, receiver)
}

/// What may light a spot that is looked at from a receiver.
struct Partner {
    spot: Spot,
    receiver: Vec3,
}

impl Partner {
    /// One sample of J₂, A/m.
    fn sample(&self, problem: &Scattering<'_>, draw: &mut Draw<'_>) -> ComplexVector {
        let even = problem.spot(draw.pair());
        let even = Some(even).filter(|&from| problem.sees(self.spot, from));
        let (turned, mirrored) = (draw.single() < 0.5, draw.single() < 0.5);
        let met = self.along_a_ray(problem, turned, mirrored, draw.pair());
        let lit = |from: Spot| problem.second(self.spot, from, 1.0 / self.density(problem, from));
        even.into_iter().chain(met).map(lit).sum()
    }

    /// Where a ray ends; a sheet has two sides for it to leave from, a body one.
    fn along_a_ray(
        &self,
        problem: &Scattering<'_>,
        turned: bool,
        mirrored: bool,
        numbers: [f64; 2],
    ) -> Option<Spot> {
        let facet = problem.facet(self.spot);
        let normal = if turned && problem.two_sided(self.spot) { -facet.normal } else { facet.normal };
        let direction = if mirrored {
            self.lobe(normal).world(VonMisesFisher::new(MIRROR_LOBE_KAPPA).sample(numbers))
        } else {
            Frame::about(normal).world(Cosine.sample(numbers))
        };
        (direction.dot(normal) > 0.0).then(|| problem.met(self.spot.point, direction)).flatten()
    }

    /// The frame about the mirror direction on the side of a normal, or straight on where the
    /// receiver is on the other.
    fn lobe(&self, normal: Vec3) -> Frame {
        let away = (self.receiver - self.spot.point).normalize_or(normal);
        let mirrored = normal * (2.0 * normal.dot(away)) - away;
        Frame::about(if mirrored.dot(normal) > 0.0 { mirrored } else { -away })
    }

    /// Sum of the densities of both partners, 1/m².
    fn density(&self, problem: &Scattering<'_>, from: Spot) -> f64 {
        let facet = problem.facet(self.spot);
        let direction = (from.point - self.spot.point).normalize_or(facet.normal);
        let normal = if direction.dot(facet.normal) < 0.0 { -facet.normal } else { facet.normal };
        let even = Cosine.pdf(Frame::about(normal).local(direction));
        let guided = VonMisesFisher::new(MIRROR_LOBE_KAPPA).pdf(self.lobe(normal).local(direction));
        let sides = if problem.two_sided(self.spot) { 2.0 } else { 1.0 };
        let per_angle = 0.5 * (even + guided) / sides;
        let per_area = shown(problem, from, self.spot.point, 1.0).map_or(0.0, |area| per_angle / area);
        1.0 / problem.area() + per_area
    }
}
