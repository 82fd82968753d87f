//! Form factors: shares of the power that leaves one patch and reaches another.
//!
//! All functions give the symmetric quantity A_i F_ij = ∫_i ∫_j cosθ cosθ' V / (π r²) in m², with an estimated absolute error.

mod area_gauss;
mod clipped;
mod contour;
mod pair;
mod point_polygon;
mod sampled;
mod shadow;
mod visible;

pub use area_gauss::{MAX_ORDER, PatchPoints, area_gauss, double_area};
pub use contour::contour_integral;
pub use pair::{Exchange, Method, PairIntegrator, Workspace};
pub use point_polygon::point_to_polygon;
pub use visible::VisibleParts;
