//! Scattered fields by random sampling: one and two bounces of physical optics on conductors.
//!
//! E(r) = ∫ 𝒢(r, q) J₁(q) dA + ∫∫ 𝒢(r, q) J₂(q ← q′) dA dA′, with 𝒢 the field of a current element,
//! J₁ = 2 n × H_i on what is lit and J₂(q ← q′) = 2 n × H(q) of the element J₁(q′) dA′ where q and
//! q′ face and see each other (G. Viennot, thesis, Limoges 2012, ch. 3 and 4, in the electric
//! form). Fields add with their phases, so that errors fall as N^(−1/2) of the *whole* surface, not
//! of what a specular zone leaves of it.
//!
//! | method | samples | weight |
//! |---|---|---|
//! | [`FieldParticles`] | directions from the receiver, and from each hit | R²/(cosθ pdf): of lobes unbounded where a surface is seen edge-on, of facets not |
//! | [`SurfaceSampling`] | points of the surface, for all receivers at once | the area |
//! | [`AmplitudeParticles`] | directions, hits merged to cells | the cell's Ω R²/cosθ; biased by its size |
//!
//! *More than two bounces are not offered:* a random walk over bounces needs a spectral radius of
//! |K| below 1, and a dihedral of 1.5λ has 1.10, one of 4.5λ 3.13, where K itself has 0.40.
//!
//! Lengths in metres, E in V/m, e^{+jωt}.

mod aim;
mod amplitude;
mod particles;
mod scattering;
mod surface;
mod tracing;

pub use aim::Aim;
pub use amplitude::AmplitudeParticles;
pub use particles::FieldParticles;
pub use scattering::{Bounces, Scattering};
pub use surface::SurfaceSampling;
pub use tracing::{FieldEstimate, FieldTracing, estimate};

use crate::light::Batch;
use fredholm_mesh::Vec3;
use fredholm_waves::ComplexVector;

/// A way to estimate the scattered field.
pub trait FieldEstimator: Sync {
    /// The name it is asked for by.
    fn name(&self) -> &'static str;

    /// One estimate of the scattered E (V/m) at every receiver (m).
    fn batch(&self, problem: &Scattering<'_>, receivers: &[Vec3], batch: &Batch) -> Vec<ComplexVector>;
}
