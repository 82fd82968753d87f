//! Form factors: shares of the power that leaves one patch and reaches another.
//!
//! All functions give the symmetric quantity A_i F_ij = ∫_i ∫_j cosθ cosθ' V / (π r²) in m², with
//! an estimated absolute error.

mod angle;
pub(crate) mod contour;
mod critical;
mod error_model;
mod ev_batch;
mod ev_events;
mod facing;
mod hidden;
mod jacobian;
mod lanes;
mod packet;
mod pair;
mod pieces;
mod point_polygon;
mod rung;
mod sampled;
mod segments;
mod shadow;
mod small_receiver;
mod together;
mod unoccluded;
mod visible;

pub use contour::contour_integral;
pub use error_model::ErrorModel;
pub(crate) use facing::{Segment, Side, extent, facing_exchange, flat, front, front_of, to_segments};
pub(crate) use jacobian::jacobian;
pub(crate) use lanes::{LANES, Lanes, Lanes3, any, ask, each, heights, range, same};
pub(crate) use pair::STANDARD_ERRORS;
pub(crate) use pair::blocks;
pub use pair::{Exchange, Method, PairIntegrator, Workspace};
pub use point_polygon::point_to_polygon;
pub(crate) use shadow::Hiding;
pub use unoccluded::{Unoccluded, Work};
pub use visible::VisibleParts;
