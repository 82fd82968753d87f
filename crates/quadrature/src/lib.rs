//! Integration rules on the interval, the triangle and the quadrilateral.
//!
//! A rule of degree d with points xᵢ and weights wᵢ satisfies Σ wᵢ p(xᵢ) = ∫ p for every polynomial p of degree ≤ d. The
//! domains are the unit ones: [0, 1], [0, 1]², and the triangle u, v ≥ 0, u + v ≤ 1. Weights sum to the
//! measure of the domain. Everything is dimensionless.

mod adaptive;
mod gauss_legendre;
mod interval;
mod quad;
mod triangle;

pub use adaptive::{Estimate, integrate_adaptive};
pub use gauss_legendre::gauss_legendre;
pub use interval::IntervalRule;
pub use quad::tensor_quad;
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
