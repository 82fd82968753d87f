//! Amplitude particles: rays from the receiver, their impacts merged to cells, each evaluated once.
//!
//! The share of the rays that a cell receives estimates its solid angle Ω = Σ 1/(N pdf), its area is Ω R²/|cosθ| at the mean of the impacts, and *fields* multiply along the tree of impacts:
//! from each cell rays go out anew and are merged again. A kd-tree finds the impacts of a cell. (G. Viennot, thesis, Limoges 2012, § 3.2, where particles carry √area and their
//! squares multiply, which fails at the second bounce.)
//!
//! The phase turns within a cell, so that the estimate is biased: of a cell of radius a seen at the angle θ by about (k a sinθ)²/8 of its field.

use super::particles::{Aim, aimed, shown};
use super::scattering::Spot;
use super::{FieldEstimator, Scattering};
use crate::density::{Cosine, DirectionDensity, Frame};
use crate::light::Batch;
use crate::light::kd_tree::KdTree;
use crate::points::{Draw, Key};
use fredholm_mesh::Vec3;
use fredholm_waves::ComplexVector;

/// Amplitude particles.
#[derive(Clone, Copy, Debug)]
pub struct AmplitudeParticles {
    radius: f64,
    second: u32,
}

impl AmplitudeParticles {
    /// Impacts within `radius` (m) are one cell; `second` rays leave each cell for the second bounce.
    #[must_use]
    pub fn new(radius: f64, second: u32) -> Self {
        Self { radius, second: second.max(1) }
    }

    /// Impacts and the solid angles (sr) they stand for, merged.
    fn merged(&self, problem: &Scattering<'_>, impacts: &[(Spot, f64)]) -> Vec<(Spot, f64)> {
        let tree = KdTree::new(impacts.iter().map(|(spot, _)| spot.point));
        let mut taken = vec![false; impacts.len()];
        let mut cells = Vec::new();
        for (number, &(spot, _)) in impacts.iter().enumerate() {
            if taken[number] {
                continue;
            }
            let normal = problem.facet(spot).normal;
            let (mut angle, mut sum) = (0.0, Vec3::ZERO);
            tree.within(spot.point, self.radius, &mut |other| {
                let (at, (near, share)) = (other as usize, impacts[other as usize]);
                // Only what lies on the same side of the same plane is one cell.
                let alike = problem.facet(near).normal.dot(normal) > 1.0 - 1e-9
                    && (near.point - spot.point).dot(normal).abs() < 1e-6 * self.radius;
                if !taken[at] && alike {
                    taken[at] = true;
                    angle += share;
                    sum += near.point * share;
                }
            });
            cells.push((Spot { point: sum / angle, ..spot }, angle));
        }
        cells
    }

    /// J₂ at a cell, A/m, from cells of the second impacts.
    fn lit_by_others(
        &self,
        problem: &Scattering<'_>,
        cell: Spot,
        batch: &Batch,
        stream: u32,
    ) -> ComplexVector {
        let facet = problem.facet(cell);
        let sheet = facet.side(facet.normal * -1.0) != 0.0;
        let sides: &[f64] = if sheet { &[1.0, -1.0] } else { &[1.0] };
        let mut impacts = Vec::new();
        for (turn, &side) in sides.iter().enumerate() {
            let frame = Frame::about(facet.normal * side);
            for ray in 0..self.second {
                let key = Key { seed: batch.seed, batch: batch.number, stream: (1 << 31) | stream };
                let mut draw = Draw::new(batch.points, key, 2 * ray + turn as u32, 2 * self.second);
                let local = Cosine.sample(draw.pair());
                if let Some(spot) = problem.met(cell.point, frame.world(local)) {
                    impacts.push((spot, 1.0 / (Cosine.pdf(local) * f64::from(self.second))));
                }
            }
        }
        let cells = self.merged(problem, &impacts);
        let part = |&(from, angle): &(Spot, f64)| {
            shown(problem, from, cell.point, angle)
                .map_or(ComplexVector::ZERO, |area| problem.second(cell, from, area))
        };
        cells.iter().map(part).sum()
    }

    fn field(&self, problem: &Scattering<'_>, receiver: Vec3, batch: &Batch, stream: u32) -> ComplexVector {
        let (frame, density) = aimed(problem, Aim::Lobe(None), receiver);
        let mut impacts = Vec::new();
        for sample in 0..batch.samples {
            let key = Key { seed: batch.seed, batch: batch.number, stream };
            let local = density.sample(Draw::new(batch.points, key, sample, batch.samples).pair());
            let angle = 1.0 / (density.pdf(local) * f64::from(batch.samples));
            let spots = problem.pierced(receiver, frame.world(local));
            impacts.extend(spots.into_iter().map(|spot| (spot, angle)));
        }
        let cells = self.merged(problem, &impacts);
        let part = |(number, &(cell, angle)): (usize, &(Spot, f64))| {
            let Some(area) = shown(problem, cell, receiver, angle) else { return ComplexVector::ZERO };
            let mut current = problem.first(cell);
            if problem.twice() {
                current += self.lit_by_others(problem, cell, batch, (stream << 16) ^ number as u32);
            }
            problem.radiated(current, cell, area, receiver)
        };
        cells.iter().enumerate().map(part).sum()
    }
}

impl FieldEstimator for AmplitudeParticles {
    fn name(&self) -> &'static str {
        "amplitude-particles"
    }

    fn batch(&self, problem: &Scattering<'_>, receivers: &[Vec3], batch: &Batch) -> Vec<ComplexVector> {
        receivers
            .iter()
            .zip(0..)
            .map(|(&receiver, stream)| self.field(problem, receiver, batch, stream))
            .collect()
    }
}
