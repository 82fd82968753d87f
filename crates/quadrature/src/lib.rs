//! Integration rules on the interval, the triangle and the quadrilateral.
//!
//! A rule of degree d with points xᵢ and weights wᵢ satisfies Σ wᵢ p(xᵢ) = ∫ p for every polynomial
//! p of degree ≤ d. The domains are the unit ones: [0, 1], [0, 1]², and the triangle u, v ≥ 0, u +
//! v ≤ 1. Weights sum to the measure of the domain. Everything is dimensionless.
//!
//! | domain | rules |
//! |---|---|
//! | interval | [`gauss_legendre`], [`gauss_jacobi`], [`newton_cotes_closed`], [`newton_cotes_open`], [`romberg`] |
//! | square | [`tensor_quad`] |
//! | triangle | [`symmetric_triangle`], [`collapsed_triangle`] |
//! | cut up | [`composed_interval`], [`composed_quad`], [`composed_triangle`] |
//! | adaptive | [`integrate_adaptive`], [`adaptive_interval`], [`adaptive_quad`], [`adaptive_triangle`] |
//! | unit cube | Sobol's points, scrambled ([`sobol`]) |
//! | singular | [`triangle_pair`], [`quad_pair`] where patches touch, [`near_triangle`], [`near_pair`] where they are close |

mod adaptive;
#[cfg(test)]
mod closed_forms;
mod composed;
mod error;
#[cfg(test)]
mod exactness;
mod gauss_jacobi;
mod gauss_legendre;
mod interval;
mod near;
mod newton_cotes;
mod pair;
mod quad;
mod refine;
mod richardson;
mod romberg;
pub mod sobol;
mod symmetric;
mod triangle;

pub use adaptive::{Estimate, integrate_adaptive};
pub use composed::{composed_interval, composed_quad, composed_triangle};
pub use error::RuleError;
pub use gauss_jacobi::gauss_jacobi;
pub use gauss_legendre::gauss_legendre;
pub use interval::IntervalRule;
pub use near::{near_pair, near_triangle};
pub use newton_cotes::{newton_cotes_closed, newton_cotes_open};
pub use pair::{PairPoint, quad_pair, triangle_pair};
pub use quad::tensor_quad;
pub use refine::{Goal, adaptive_interval, adaptive_quad, adaptive_triangle};
pub use richardson::richardson;
pub use romberg::romberg;
pub use symmetric::symmetric_triangle;
pub use triangle::collapsed_triangle;

/// A point of a plane rule: parameters (u, v) and weight.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PlanePoint {
    /// First parameter.
    pub u: f64,
    /// Second parameter.
    pub v: f64,
    /// Weight.
    pub weight: f64,
}
