//! Oriented edges, and the logarithm integrated along one: ∫ ln |p − q(t)| dt.
//!
//! With r₀, r₁ the distances of the ends of an edge of length L from p, t₀, t₁ = t₀ + L their
//! places along it from the foot of p and h the height of p it is ½ L ln(r₀ r₁) + ½ (t₀ + t₁)
//! ln(r₁/r₀) − L + h θ, θ the angle under which p sees the edge. Every term is of the order of L:
//! nothing cancels where the edge is short and far. Lengths in a typical distance of the pair.

use crate::form_factor::angle::angle;
use fredholm_mesh::Vec3;

/// Rounding of one edge pair, relative to the largest term of its closed form.
pub(crate) const ROUNDING: f64 = 8.0 * f64::EPSILON;

/// An oriented edge: start, unit direction, length.
#[derive(Clone, Copy)]
pub(crate) struct Edge {
    pub start: Vec3,
    pub direction: Vec3,
    pub length: f64,
}

impl Edge {
    pub(crate) fn end(&self) -> Vec3 {
        self.start + self.direction * self.length
    }
}

/// Rounding of ∫∫ ln r ds dt with the outer integral over `e`: that of the terms of the inner
/// integral, and that of a point of `e`, of order 1, times the change of the inner integral with
/// it, the angle under which it sees `f`.
pub(crate) fn rounding(e: Edge, f: Edge) -> f64 {
    let gap = e.start.distance(f.start) - e.length - f.length;
    let angle = f.length / gap.max(f.length);
    ROUNDING * e.length * (f.length + angle)
}

/// ∫ ln |p − q(t)| dt along an edge.
pub(crate) fn log_integral(p: Vec3, f: Edge) -> f64 {
    let d = f.start - p;
    let t0 = d.dot(f.direction);
    let t1 = t0 + f.length;
    let h2 = (d - f.direction * t0).length_squared();
    let (r0, r1) = (t0 * t0 + h2, t1 * t1 + h2);
    let near = r0.min(r1);
    if near == 0.0 {
        return f.length * (f.length.ln() - 1.0);
    }
    let middle = t0 + t1;
    let ratio = 0.5 * (f.length * middle.abs() / near).ln_1p();
    let h = h2.sqrt();
    let angle = angle(h * f.length, h2 + t0 * t1);
    0.25 * f.length * (r0 * r1).ln() + 0.5 * middle.abs() * ratio - f.length + h * angle
}
