//! Amplitude particles: rays from the receiver, their impacts merged to cells, each evaluated once.
//!
//! The share of the rays that a cell receives estimates its solid angle Ω = Σ 1/(N pdf), its area
//! is Ω R²/|cosθ| at the mean of the impacts, and *fields* multiply along the tree of impacts: from
//! each cell rays go out anew and are merged again. A kd-tree finds the impacts of a cell. (G.
//! Viennot, thesis, Limoges 2012, § 3.2, where particles carry √area and their squares multiply,
//! which fails at the second bounce.)
//!
//! The phase turns within a cell, so that the estimate is biased: of a cell of radius a seen at the
//! angle θ by about (k a sinθ)²/8 of its field.

use super::aim::{Aim, Directions, SolidAngles, shown};
use super::scattering::Spot;
use super::{FieldEstimator, Scattering};
use crate::light::Batch;
use crate::light::kd_tree::KdTree;
use fredholm_mesh::Vec3;
use fredholm_waves::ComplexVector;

/// Amplitude particles.
#[derive(Clone, Copy, Debug)]
pub struct AmplitudeParticles {
    radius: f64,
    second: u32,
}

impl AmplitudeParticles {
    /// Impacts within `radius` (m) are one cell; `second` rays leave each cell for the second
    /// bounce.
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
        let angles =
            SolidAngles::new(problem, cell.point, |number, facet| problem.lights(number, facet, cell));
        let mut samples = batch.samples_of((1 << 31) | stream, self.second);
        let impact = |ray: u32| {
            let (spots, density) = angles.shoot(problem, cell.point, samples.draw(ray).pair());
            // What lies behind the first is hidden.
            let first = spots.first().filter(|_| density > 0.0);
            first.map(|&spot| (spot, 1.0 / (density * f64::from(self.second))))
        };
        let impacts: Vec<(Spot, f64)> = (0..self.second).filter_map(impact).collect();
        let cells = self.merged(problem, &impacts);
        let part = |&(from, angle): &(Spot, f64)| {
            shown(problem, from, cell.point, angle)
                .map_or(ComplexVector::ZERO, |area| problem.second(cell, from, area))
        };
        cells.iter().map(part).sum()
    }

    fn field(&self, problem: &Scattering<'_>, receiver: Vec3, batch: &Batch, stream: u32) -> ComplexVector {
        let directions = Directions::new(problem, Aim::Facets, receiver);
        let mut impacts = Vec::new();
        let mut samples = batch.samples_of(stream, batch.samples);
        for sample in 0..batch.samples {
            let (spots, density) = directions.shoot(problem, receiver, samples.draw(sample).pair());
            let angle = 1.0 / (density * f64::from(batch.samples));
            impacts.extend(spots.into_iter().filter(|_| density > 0.0).map(|spot| (spot, angle)));
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
