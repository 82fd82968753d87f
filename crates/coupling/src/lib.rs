//! Form factors: kernels, occlusion and the operators assembled from them.
//!
//! The operator of diffuse light is K = R F with A_i F_ij = ∫_i ∫_j cosθ cosθ' V / (π r²) dA dA'
//! (m²).

pub mod form_factor;
pub mod kernel;
pub mod method;
pub mod polygon;
pub mod rays;

mod aggregate;
mod assembly;
mod closure;
mod emitters;
mod error;
mod exposure;
mod occlusion;
mod pair_sample;
mod radiosity;
mod receiver;
mod reciprocity;
mod residual;

pub use aggregate::aggregate;
pub use assembly::{
    Assembled, MethodCounts, assemble, assemble_with_errors, assembly_seconds, waiting_bytes,
};
pub use closure::{Closed, ClosureError, enforce_closure};
pub use emitters::{Emitters, Groups};
pub use error::CouplingError;
pub use exposure::{exposed_share, exposed_shares, exposure_seconds, extents};
pub use pair_sample::sample_pairs;
pub use radiosity::{Energy, Extent, Means, Radiosity};
pub use receiver::{Receiver, Targets, sky, sky_exchanges, with_sky};
pub use reciprocity::reciprocity;
pub use residual::{Constants, DRAWN_SEQUENCES, MeshError, Residual};
