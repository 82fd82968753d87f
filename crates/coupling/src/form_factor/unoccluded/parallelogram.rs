//! Two parallelograms: A_i F_ij = (1/2π) Σ ± (w·w') ∫∫ atanh(z) ds dt over the four pairs of
//! directions.
//!
//! The contour integral (1/4π) ∮∮ ln r² dx·dx' (E. M. Sparrow 1963, doi:10.1115/1.3686055) with
//! opposite sides taken together. With w a side of the first and o the other side, across which the
//! edges along w lie at ±o/2, and D = c' − c + t w' − s w, the four logarithms are one: ln(r₊₊²
//! r₋₋² / (r₊₋² r₋₊²)) = 2 atanh(z), z = 2 (P Q − S q) / (S² + q² − P² − Q²), where P = D·o, Q =
//! D·o', q = o·o'/2 and S = D·D + (o² + o'²)/4. The numerator is of the order of the kernel itself,
//! so nothing cancels between far patches: for these z is the kernel. S, P and Q are polynomials in
//! s and t, so the points are never placed. Directions at right angles add nothing, which leaves
//! one pair of four between perpendicular walls and two between parallel ones.
//!
//! Nodes ±s, ±t share a weight; their sum is one atanh by tanh(x + y) = (tanh x + tanh y)/(1 + tanh
//! x tanh y). Lengths in any unit, exchanges in its square.

use super::logarithm::{SERIES_END, ln_1p, twice_atanh};
use super::patches::Patches;
use super::rules::{Node, rule};
use crate::form_factor::lanes::{LANES, Lanes, Lanes3, Places, difference, dot, each};
use std::f64::consts::TAU;

/// Cosine below which two directions count as perpendicular.
const PERPENDICULAR_COSINE: f64 = 4.0 * f64::EPSILON;

/// A_i F_ij of a block of pairs, with so many points along the sides of the first and of the
/// second.
#[inline(always)]
pub(super) fn parallelograms(patches: &Patches, pair: [&Places; 2], points: [usize; 2]) -> Lanes {
    let [u, v] = &patches.side;
    let sides = [[pair[0].vectors(u), pair[0].vectors(v)], [pair[1].vectors(u), pair[1].vectors(v)]];
    let d = difference(&pair[1].vectors(&patches.centre), &pair[0].vectors(&patches.centre));
    let mut sum = [0.0; LANES];
    for along in 0..2 {
        for beside in 0..2 {
            let weight = weights(&sides[0][along], &sides[1][beside], along == beside);
            if weight.iter().any(|&w| w != 0.0) {
                let first = [&sides[0][along], &sides[0][1 - along]];
                let second = [&sides[1][beside], &sides[1][1 - beside]];
                let field = Field::new(&d, first, second);
                let integral = field.integral(points);
                sum = each(|m| sum[m] + weight[m] * integral[m]);
            }
        }
    }
    sum
}

/// ± w·w' / 4π: opposite signs of the two directions of a contour meet as minus.
#[inline(always)]
fn weights(w: &Lanes3, w2: &Lanes3, same: bool) -> Lanes {
    let scale = if same { 0.5 / TAU } else { -0.5 / TAU };
    let (cosine, one, two) = (dot(w, w2), dot(w, w), dot(w2, w2));
    each(|m| {
        let square = cosine[m] * cosine[m];
        let is_right = square <= PERPENDICULAR_COSINE * PERPENDICULAR_COSINE * (one[m] * two[m]);
        if is_right { 0.0 } else { scale * cosine[m] }
    })
}

/// The coefficients of S, P and Q in s and t.
struct Field {
    s_base: Lanes,
    s_s: Lanes,
    s_t: Lanes,
    s_ss: Lanes,
    s_tt: Lanes,
    s_st: Lanes,
    p_base: Lanes,
    p_s: Lanes,
    p_t: Lanes,
    q_base: Lanes,
    q_s: Lanes,
    q_t: Lanes,
    across: Lanes,
}

impl Field {
    #[inline(always)]
    fn new(d: &Lanes3, [w, o]: [&Lanes3; 2], [w2, o2]: [&Lanes3; 2]) -> Self {
        let (base, one, two) = (dot(d, d), dot(o, o), dot(o2, o2));
        let (s_s, s_t, s_st, across) = (dot(d, w), dot(d, w2), dot(w, w2), dot(o, o2));
        Self {
            s_base: each(|m| base[m] + 0.25 * (one[m] + two[m])),
            s_s: each(|m| -2.0 * s_s[m]),
            s_t: each(|m| 2.0 * s_t[m]),
            s_ss: dot(w, w),
            s_tt: dot(w2, w2),
            s_st: each(|m| -2.0 * s_st[m]),
            p_base: dot(d, o),
            p_s: dot(w, o),
            p_t: dot(w2, o),
            q_base: dot(d, o2),
            q_s: dot(w, o2),
            q_t: dot(w2, o2),
            across: each(|m| 0.5 * across[m]),
        }
    }

    /// Σ w_s w_t 2 atanh(z).
    #[inline(always)]
    fn integral(&self, points: [usize; 2]) -> Lanes {
        let mut sum = [0.0; LANES];
        for &s in rule(points[0]) {
            for &t in rule(points[1]) {
                self.add(s, t, &mut sum);
            }
        }
        sum
    }

    /// Adds the nodes ±s, ±t.
    #[inline(always)]
    fn add(&self, s: Node, t: Node, sum: &mut Lanes) {
        let (x, y, weight) = (s.place, t.place, s.weight * t.weight);
        match (x == 0.0, y == 0.0) {
            (true, true) => self.add_nodes([[x, y]], weight, sum),
            (true, false) => self.add_nodes([[x, y], [x, -y]], weight, sum),
            (false, true) => self.add_nodes([[x, y], [-x, y]], weight, sum),
            (false, false) => self.add_nodes([[x, y], [-x, -y], [x, -y], [-x, y]], weight, sum),
        }
    }

    #[inline(always)]
    fn add_nodes<const N: usize>(&self, nodes: [[f64; 2]; N], weight: f64, sum: &mut Lanes) {
        let (mut above, mut below) = ([0.0; LANES], [0.0; LANES]);
        let mut series = true;
        for m in 0..LANES {
            let first = self.ratio(m, nodes[0]);
            let [a, b] = nodes[1..].iter().fold(first, |z, &node| join(z, self.ratio(m, node)));
            (above[m], below[m]) = (a, b);
            series &= a.abs() <= SERIES_END * b;
        }
        if series {
            for m in 0..LANES {
                sum[m] += weight * twice_atanh(above[m] / below[m]);
            }
        } else {
            for m in 0..LANES {
                sum[m] += weight * twice_atanh_of(above[m], below[m]);
            }
        }
    }

    /// Numerator and denominator of z.
    #[inline(always)]
    fn ratio(&self, m: usize, [s, t]: [f64; 2]) -> [f64; 2] {
        let square = (self.s_base[m] + s * s * self.s_ss[m] + t * t * self.s_tt[m])
            + (s * self.s_s[m] + t * self.s_t[m] + s * t * self.s_st[m]);
        let p = self.p_base[m] - s * self.p_s[m] + t * self.p_t[m];
        let q = self.q_base[m] - s * self.q_s[m] + t * self.q_t[m];
        let c = self.across[m];
        [2.0 * (p * q - square * c), (square * square + c * c) - (p * p + q * q)]
    }
}

/// The fraction tanh(x + y) of two fractions tanh x and tanh y.
#[inline(always)]
fn join([a, b]: [f64; 2], [c, d]: [f64; 2]) -> [f64; 2] {
    [a * d + c * b, b * d + a * c]
}

/// 2 atanh(a/b) for any |a| < b.
#[inline(always)]
fn twice_atanh_of(a: f64, b: f64) -> f64 {
    let (series, logarithm) = (twice_atanh(a / b), ln_1p(2.0 * a / (b - a)));
    if a.abs() <= SERIES_END * b { series } else { logarithm }
}
