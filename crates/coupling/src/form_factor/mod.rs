//! Form factors: shares of the power that leaves one patch and reaches another.
//!
//! All functions give the symmetric quantity A_i F_ij = ∫_i ∫_j cosθ cosθ' V / (π r²) in m², with an estimated absolute error.

mod area_gauss;
mod contour;
mod critical;
mod hidden;
mod pair;
mod pieces;
mod point_polygon;
mod sampled;
mod shadow;
mod unoccluded;

pub use area_gauss::{MAX_ORDER, PatchPoints, area_gauss, double_area};
pub use contour::contour_integral;
pub(crate) use pair::blocks;
pub use pair::{Exchange, Method, PairIntegrator, Workspace};
pub use point_polygon::point_to_polygon;
pub(crate) use shadow::Hiding;
pub use unoccluded::{Unoccluded, Ways, Work};
