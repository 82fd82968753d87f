//! ∫∫ ln r ds dt by Gauss points on one edge and the closed inner integral along the other.
//!
//! On an edge of length L, ln r from a point at distances r₀, r₁ from its ends is analytic inside
//! the ellipse about the ends with ρ + 1/ρ = 2 (r₀ + r₁)/L, and its Chebyshev coefficients are at
//! most 2 ρ⁻ᵏ/k. So n ≥ 2 points err by at most 1.07 L L' ρ⁻²ⁿ/(n (1 − ρ⁻²)) (L. N. Trefethen, SIAM
//! Rev. 50(1) 67, 2008, doi:10.1137/060659831), with ρ at the point of the other edge, of length
//! L', where r₀ + r₁ is least. Edges that come too close are bisected, which makes ρ grow; where
//! they are nearly parallel too, until values agree.

use super::edge::{Edge, log_integral};
use fredholm_mesh::Vec3;
use fredholm_quadrature::{Estimate, IntervalRule, gauss_legendre, integrate_adaptive};
use std::sync::LazyLock;

/// Most points along an edge; beyond, two halves are cheaper.
const MAX_POINTS: usize = 16;
/// Points of the rule that is bisected until it agrees with its halves.
const ADAPTIVE_POINTS: usize = 10;
/// Squared sine of the angle between edges above which few parts of one are close to the other.
/// Edges that run along each other would be bisected everywhere by the bound, which does not know
/// that the inner integral is smooth there.
const STEEP_SQUARED_SINE: f64 = 0.04;
/// Bisections towards a point that touches: 2⁻⁵⁰ of the edge is below rounding.
const MOST_BISECTIONS: u32 = 50;

static RULES: LazyLock<Vec<IntervalRule>> = LazyLock::new(|| (0..=MAX_POINTS).map(gauss_legendre).collect());

/// Integration over an edge of the closed integral over another.
#[derive(Clone, Copy)]
pub(super) struct Outer {
    along: Edge,
    other: Edge,
    /// Points along the first edge; more than there are rules for where it is to be bisected.
    pub points: usize,
    error: f64,
}

impl Outer {
    /// The points on `along` that leave an absolute error of `goal`.
    pub(super) fn new(along: Edge, other: Edge, goal: f64) -> Self {
        let decay = ellipse(along, other).powi(-2);
        let mut points = 2;
        let mut error = 0.5 * 1.07 * along.length * other.length * decay * decay / (1.0 - decay);
        while error > goal && points <= MAX_POINTS {
            error *= decay * points as f64 / (points + 1) as f64;
            points += 1;
        }
        Self { along, other, points, error }
    }

    /// The integral to an absolute error of `goal`; `sine2` is the squared sine of the angle
    /// between the edges.
    pub(super) fn integrate(&self, goal: f64, sine2: f64) -> Estimate {
        if self.points <= MAX_POINTS || sine2 > STEEP_SQUARED_SINE {
            return self.bisect(goal, MOST_BISECTIONS);
        }
        integrate_adaptive(&RULES[ADAPTIVE_POINTS], 0.0, self.along.length, goal, MOST_BISECTIONS, &|s| {
            self.inner(s)
        })
    }

    fn bisect(&self, goal: f64, depth: u32) -> Estimate {
        if let Some(rule) = RULES.get(self.points) {
            return Estimate { value: self.apply(rule), error: self.error };
        }
        if depth == 0 {
            let value = self.apply(&RULES[MAX_POINTS]);
            return Estimate { value, error: value.abs() + self.along.length * self.other.length };
        }
        let half = Edge { length: 0.5 * self.along.length, ..self.along };
        let rest = Edge { start: half.end(), ..half };
        let part = |edge: Edge| Self::new(edge, self.other, 0.5 * goal).bisect(0.5 * goal, depth - 1);
        part(half) + part(rest)
    }

    fn apply(&self, rule: &IntervalRule) -> f64 {
        rule.integrate(0.0, self.along.length, |s| self.inner(s))
    }

    fn inner(&self, s: f64) -> f64 {
        log_integral(self.along.start + self.along.direction * s, self.other)
    }
}

/// ρ of the smallest ellipse about the ends of `e` that touches `f`.
fn ellipse(e: Edge, f: Edge) -> f64 {
    let x = (nearest_sum(e, f) / e.length).max(1.0);
    x + (x * x - 1.0).sqrt()
}

/// Least r₀ + r₁ over the points of `f`: on its line, where the ray between the ends of `e` is
/// reflected.
fn nearest_sum(e: Edge, f: Edge) -> f64 {
    let foot = |p: Vec3| {
        let d = p - f.start;
        let along = d.dot(f.direction);
        (along, (d - f.direction * along).length_squared())
    };
    let ((x0, h0), (x1, h1)) = (foot(e.start), foot(e.end()));
    let (height0, height1) = (h0.sqrt(), h1.sqrt());
    let sum = height0 + height1;
    let mirror = if sum > 0.0 { (x0 * height1 + x1 * height0) / sum } else { x0 };
    let x = mirror.clamp(0.0, f.length);
    ((x - x0).powi(2) + h0).sqrt() + ((x - x1).powi(2) + h1).sqrt()
}
