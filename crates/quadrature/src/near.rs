//! Nearly singular rules: ∫ over a triangle of f(y), f peaked where y comes close to a point x:
//! 1/|x − y| and its like.
//!
//! The triangle is split at p, its point closest to x, and each part collapsed towards p (M. G.
//! Duffy, SIAM J. Numer. Anal. 19 (1982) 1260, doi:10.1137/0719090), y = p + r (e(t) − p). Along a
//! ray |x − y|² ≈ d² + r² ρ(t)² with d = |x − p| and ρ the ray's length, and across the rays ρ² =
//! h² + L² (t − t₀)². In both directions a sinh map spreads the points so that the integrand loses
//! its scale (P. R. Johnston, D. Elliott, Int. J. Numer. Methods Eng. 62 (2005) 564,
//! doi:10.1002/nme.1208).

use crate::{IntervalRule, PairPoint, PlanePoint, gauss_legendre};

type Vector = [f64; 3];

/// Distance over edge length below which x lies on the triangle: closer points are lost in the
/// rounding of x − y.
const TOUCHING_DISTANCE: f64 = 1e-12;

/// The rule with n × n points in each of up to three parts for the triangle with these corners,
/// seen from `x` (any unit of length). Points and weights are in the parameters of the unit
/// triangle, so that the weights sum to about ½: the rule is exact for no polynomial, and converges
/// exponentially in n. No points for a triangle without area.
///
/// ```
/// let corners = [[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]];
/// let rule = fredholm_quadrature::near_triangle(corners, [0.0, 0.0, 0.0], 8);
/// let potential: f64 = rule.iter().map(|p| p.weight / p.u.hypot(p.v)).sum();
/// assert!((potential - 2f64.sqrt() * 1f64.asinh()).abs() < 1e-8);
/// ```
#[must_use]
pub fn near_triangle(corners: [Vector; 3], x: Vector, n: usize) -> Vec<PlanePoint> {
    let rule = gauss_legendre(n);
    let foot = closest(corners, x);
    let p = at(corners, foot);
    let d = length(minus(x, p));
    let parameters = [[0.0, 0.0], [1.0, 0.0], [0.0, 1.0]];
    let mut points = Vec::new();
    for i in 0..3 {
        let k = (i + 1) % 3;
        let part = Part { apex: foot, ends: [parameters[i], parameters[k]] };
        if let Some(rays) = Rays::new(minus(corners[i], p), minus(corners[k], p), d) {
            part.place(&rays, &rule, &mut points);
        }
    }
    points
}

/// The rule for two triangles close to each other: `outer` on the first, and from each of its
/// points [`near_triangle`] on the second. The inner integral still varies over the distance of the
/// two near the edges of the second, so that `outer` must resolve that: compose it, or run
/// [`adaptive_triangle`](crate::adaptive_triangle) over the inner rule.
///
/// ```
/// let a = [[0.0, 0.0, 0.01], [1.0, 0.0, 0.01], [0.0, 1.0, 0.01]];
/// let b = [[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]];
/// let rule = fredholm_quadrature::near_pair(a, b, &fredholm_quadrature::collapsed_triangle(2), 8);
/// assert!((rule.iter().map(|p| p.weight).sum::<f64>() - 0.25).abs() < 1e-4);
/// ```
#[must_use]
pub fn near_pair(a: [Vector; 3], b: [Vector; 3], outer: &[PlanePoint], n: usize) -> Vec<PairPoint> {
    let inner = |p: &PlanePoint| near_triangle(b, at(a, [p.u, p.v]), n);
    let pair = |p: &PlanePoint, q: &PlanePoint| PairPoint {
        x: [p.u, p.v],
        y: [q.u, q.v],
        weight: p.weight * q.weight,
    };
    outer.iter().flat_map(|p| inner(p).into_iter().map(|q| pair(p, &q)).collect::<Vec<_>>()).collect()
}

/// One part of the triangle, in its parameters.
struct Part {
    apex: [f64; 2],
    ends: [[f64; 2]; 2],
}

impl Part {
    fn place(&self, rays: &Rays, rule: &IntervalRule, points: &mut Vec<PlanePoint>) {
        let [a, b] = self.ends.map(|end| [end[0] - self.apex[0], end[1] - self.apex[1]]);
        let twice_area = (a[0] * b[1] - a[1] * b[0]).abs();
        for (t, across) in rays.across(rule) {
            let e = [a[0] + t * (b[0] - a[0]), a[1] + t * (b[1] - a[1])];
            for (r, along) in rays.along(t, rule) {
                let weight = twice_area * across * along * r;
                points.push(PlanePoint { u: self.apex[0] + r * e[0], v: self.apex[1] + r * e[1], weight });
            }
        }
    }
}

/// The rays from p to one edge: their scales, relative to the edge's length L.
struct Rays {
    /// Foot of p on the edge, as a parameter t₀ of it.
    centre: f64,
    /// Distance h of p from the edge, over L.
    height: f64,
    /// Distance d of x from p, over L.
    distance: f64,
}

impl Rays {
    /// The rays to the edge from `a` to `b` (both seen from p); `None` where p lies on the edge or
    /// the edge is a point.
    fn new(a: Vector, b: Vector, d: f64) -> Option<Self> {
        let edge = minus(b, a);
        let scale = length(edge);
        let centre = -dot(a, edge) / (scale * scale);
        let height = length([0, 1, 2].map(|k| a[k] + centre * edge[k])) / scale;
        // Rounding leaves p this far from an edge it lies on; the part has no area to speak of.
        (height > 1e-14).then_some(Self { centre, height, distance: d / scale })
    }

    /// Points t and weights on [0, 1], for an integrand with poles at t₀ ± i √(h² + d²).
    fn across(&self, rule: &IntervalRule) -> Vec<(f64, f64)> {
        sinh_points(rule, self.centre, self.height.hypot(self.distance))
    }

    /// Points r and weights on [0, 1], for an integrand with poles at ± i d/ρ(t).
    fn along(&self, t: f64, rule: &IntervalRule) -> Vec<(f64, f64)> {
        let reach = self.height.hypot(t - self.centre);
        if self.distance < TOUCHING_DISTANCE {
            return rule.points.iter().copied().zip(rule.weights.iter().copied()).collect();
        }
        sinh_points(rule, 0.0, self.distance / reach)
    }
}

/// t = c + s sinh τ over [0, 1], Gauss points in τ; dt = s cosh τ dτ.
fn sinh_points(rule: &IntervalRule, c: f64, s: f64) -> Vec<(f64, f64)> {
    let (low, high) = ((-c / s).asinh(), ((1.0 - c) / s).asinh());
    let point = |(&x, &w): (&f64, &f64)| {
        let tau = low + (high - low) * x;
        (c + s * tau.sinh(), w * (high - low) * s * tau.cosh())
    };
    rule.points.iter().zip(&rule.weights).map(point).collect()
}

/// Parameters (u, v) of the point of the triangle that is closest to x.
fn closest(corners: [Vector; 3], x: Vector) -> [f64; 2] {
    let (e, f, g) = (minus(corners[1], corners[0]), minus(corners[2], corners[0]), minus(x, corners[0]));
    let (ee, ef, ff) = (dot(e, e), dot(e, f), dot(f, f));
    let determinant = ee * ff - ef * ef;
    let u = (ff * dot(e, g) - ef * dot(f, g)) / determinant;
    let v = (ee * dot(f, g) - ef * dot(e, g)) / determinant;
    if u >= 0.0 && v >= 0.0 && u + v <= 1.0 {
        return [u, v];
    }
    let on_edges = [[0, 1], [1, 2], [2, 0]].map(|[i, k]| on_edge(corners, i, k, x));
    let distance = |p: &[f64; 2]| length(minus(x, at(corners, *p)));
    on_edges.into_iter().fold(on_edges[0], |best, p| if distance(&p) < distance(&best) { p } else { best })
}

/// Parameters of the point closest to x of the edge from corner i to corner k.
fn on_edge(corners: [Vector; 3], i: usize, k: usize, x: Vector) -> [f64; 2] {
    let edge = minus(corners[k], corners[i]);
    let t = (dot(minus(x, corners[i]), edge) / dot(edge, edge)).clamp(0.0, 1.0);
    let parameters = [[0.0, 0.0], [1.0, 0.0], [0.0, 1.0]];
    [0, 1].map(|c| (1.0 - t) * parameters[i][c] + t * parameters[k][c])
}

fn at(corners: [Vector; 3], [u, v]: [f64; 2]) -> Vector {
    [0, 1, 2].map(|k| (1.0 - u - v) * corners[0][k] + u * corners[1][k] + v * corners[2][k])
}

fn minus(a: Vector, b: Vector) -> Vector {
    [0, 1, 2].map(|k| a[k] - b[k])
}

fn dot(a: Vector, b: Vector) -> f64 {
    a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
}

fn length(a: Vector) -> f64 {
    dot(a, a).sqrt()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::closed_forms::{coplanar, square_potential};
    use crate::{Goal, adaptive_triangle, symmetric_triangle};

    /// The unit square as two triangles, and the potential of 1/r from both.
    const HALVES: [[Vector; 3]; 2] = [
        [[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [1.0, 1.0, 0.0]],
        [[0.0, 0.0, 0.0], [1.0, 1.0, 0.0], [0.0, 1.0, 0.0]],
    ];

    fn potential(x: Vector, n: usize) -> f64 {
        let half = |corners: [Vector; 3]| -> f64 {
            let term = |p: &PlanePoint| p.weight / length(minus(x, at(corners, [p.u, p.v])));
            near_triangle(corners, x, n).iter().map(term).sum()
        };
        half(HALVES[0]) + half(HALVES[1])
    }

    #[test]
    fn the_potential_of_a_square_is_met_at_any_distance() {
        for z in [1.0, 0.1, 1e-2, 1e-3, 1e-6, 0.0] {
            for [x, y] in [
                [0.3, 0.2],
                [0.5, 0.5],
                [0.01, 0.4],
                [1e-5, 1e-4],
                [0.0, 0.0],
                [1.0, 0.3],
                [1.02, 0.4],
                [-0.1, 1.3],
            ] {
                let exact = square_potential(x, y, z);
                let error = |n| (potential([x, y, z], n) - exact).abs() / exact;
                assert!(
                    error(16) < 1e-8 && error(24) < 1e-10,
                    "({x}, {y}, {z}): {:e} {:e} {:e}",
                    error(8),
                    error(16),
                    error(24)
                );
            }
        }
    }

    #[test]
    fn parallel_squares_a_hundredth_apart() {
        let inner = |x: Vector| potential(x, 16);
        let goal = Goal { tolerance: 1e-6, cuts: 1000 };
        let rule = symmetric_triangle(8).unwrap();
        let half = |i: usize| {
            let lifted = HALVES[i].map(|c| [c[0], c[1], 0.01]);
            adaptive_triangle(&rule, goal, |u, v| inner(at(lifted, [u, v])))
        };
        let got = half(0) + half(1);
        let exact = coplanar([0.0, 1.0, 0.0, 1.0], [0.0, 1.0, 0.0, 1.0], 0.01);
        assert!((got.value - exact).abs() < 2e-6 && got.error <= 2e-6, "{got:?} against {exact}");
    }

    #[test]
    fn a_pair_far_enough_apart_needs_no_more_than_the_outer_rule() {
        let lifted = HALVES.map(|half| half.map(|c| [c[0], c[1], 0.5]));
        let rule = symmetric_triangle(20).unwrap();
        let mut sum = 0.0;
        for (a, b) in lifted.iter().flat_map(|a| HALVES.iter().map(move |b| (a, b))) {
            let apart = |p: &PairPoint| length(minus(at(*a, p.x), at(*b, p.y)));
            sum += near_pair(*a, *b, &rule, 12).iter().map(|p| p.weight / apart(p)).sum::<f64>();
        }
        let exact = coplanar([0.0, 1.0, 0.0, 1.0], [0.0, 1.0, 0.0, 1.0], 0.5);
        assert!((sum - exact).abs() < 1e-7, "{sum} against {exact}");
    }

    #[test]
    fn a_triangle_without_area_has_no_points() {
        assert!(near_triangle([[0.0; 3]; 3], [1.0, 0.0, 0.0], 4).is_empty());
    }
}
