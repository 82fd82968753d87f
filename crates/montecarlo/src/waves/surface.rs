//! Direct sampling of the surface: q even on the surfaces, weight A; of the second bounce q and q′,
//! weight A².
//!
//! The weight has no cosine: nothing bursts in the plane of a plate. Samples serve all receivers at
//! once, so that this is the light tracer with receivers too.

use super::{FieldEstimator, Scattering};
use crate::light::Batch;
use fredholm_mesh::Vec3;
use fredholm_waves::ComplexVector;

/// Direct surface sampling.
#[derive(Clone, Copy, Debug, Default)]
pub struct SurfaceSampling;

impl FieldEstimator for SurfaceSampling {
    fn name(&self) -> &'static str {
        "surface-sampling"
    }

    fn batch(&self, problem: &Scattering<'_>, receivers: &[Vec3], batch: &Batch) -> Vec<ComplexVector> {
        let mut fields = vec![ComplexVector::ZERO; receivers.len()];
        let area = problem.area();
        let share = area / f64::from(batch.samples);
        let mut samples = batch.samples_of(0, batch.samples);
        for sample in 0..batch.samples {
            let mut draw = samples.draw(sample);
            let spot = problem.spot(draw.pair());
            let mut current = problem.first(spot);
            if problem.twice() {
                let from = problem.spot(draw.pair());
                let second = problem.second(spot, from, area);
                if second != ComplexVector::ZERO && problem.sees(spot, from) {
                    current += second;
                }
            }
            if current != ComplexVector::ZERO {
                for (field, &receiver) in fields.iter_mut().zip(receivers) {
                    *field += problem.radiated(current, spot, share, receiver);
                }
            }
        }
        fields
    }
}
