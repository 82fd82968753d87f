//! Point to polygon in closed form: F = (1/2π) Σₑ Θₑ (Γₑ · n).
//!
//! J. H. Lambert 1760; P. Schröder & P. Hanrahan, SIGGRAPH 1993, doi:10.1145/166117.166138, eq. 3.
//! Γₑ is the unit vector along rₑ × rₑ₊₁, Θₑ the angle between rₑ and rₑ₊₁, r the corners seen from
//! the point. Dimensionless. The polygon must lie above the horizon of the point and be
//! counter-clockwise seen from it.

#![allow(clippy::inline_always, reason = "what is not inlined is compiled for the narrowest vectors")]
#![allow(clippy::needless_bitwise_bool, reason = "a jump a lane costs more than to ask both")]

use super::angle::{angle, arc_over_tangent};
use super::lanes::{Lanes, Lanes3, any, ask, cross, dot, each, only, same};
use fredholm_mesh::Vec3;
use std::f64::consts::FRAC_1_PI;

/// Form factor from a point at the origin with unit normal `n` to the polygon with corners `r`
/// relative to the point.
///
/// ```
/// use fredholm_coupling::form_factor::point_to_polygon;
/// use fredholm_mesh::Vec3;
/// // Howell B-3: a rectangle a × b at height 1 above its corner.
/// let r = [Vec3::new(0.0, 0.0, 1.0), Vec3::new(0.0, 1.0, 1.0), Vec3::new(1.0, 1.0, 1.0), Vec3::new(1.0, 0.0, 1.0)];
/// let side = (1.0 / 2f64.sqrt()) * (1.0 / 2f64.sqrt()).atan();
/// assert!((point_to_polygon(Vec3::Z, r) - side / std::f64::consts::PI).abs() < 1e-15);
/// ```
pub fn point_to_polygon(n: Vec3, r: impl IntoIterator<Item = Vec3>) -> f64 {
    let mut corners = r.into_iter();
    let Some(first) = corners.next() else { return 0.0 };
    let (mut sum, mut from) = (0.0, first);
    for to in corners {
        sum += edge_term(n, from, to);
        from = to;
    }
    factor(sum + edge_term(n, from, first))
}

/// The form factor for the sum of the terms of the edges.
pub(super) fn factor(sum: f64) -> f64 {
    // Seen from the point, a polygon that faces it runs clockwise about the normal of the point:
    // hence the sign.
    -0.5 * FRAC_1_PI * sum
}

/// Square of the tangent up to which the angle follows from it, without a root.
const NARROW_SQUARED_TANGENT: f64 = 0.04;

/// Θ (Γ · n) of one edge. An edge that points at the origin spans no angle.
#[inline]
fn edge_term(n: Vec3, from: Vec3, to: Vec3) -> f64 {
    let (cross, cosine) = (from.cross(to), from.dot(to));
    let sine2 = cross.length_squared();
    if cosine > 0.0 && sine2 < NARROW_SQUARED_TANGENT * cosine * cosine {
        let inverse = 1.0 / cosine;
        return cross.dot(n) * inverse * arc_over_tangent(sine2 * inverse * inverse);
    }
    let sine = sine2.sqrt();
    if sine == 0.0 { 0.0 } else { cross.dot(n) * (angle(sine, cosine) / sine) }
}

/// Θ (Γ · n) of one edge a lane: the same bits as [`edge_term`].
#[inline(always)]
pub(super) fn edge_terms(n: Vec3, from: &Lanes3, to: &Lanes3) -> Lanes {
    let cross = cross(from, to);
    let (cosine, sine2) = (dot(from, to), dot(&cross, &cross));
    let up = dot(&cross, &same(n));
    let narrow = ask(|m| (cosine[m] > 0.0) & (sine2[m] < NARROW_SQUARED_TANGENT * cosine[m] * cosine[m]));
    let inverse = each(|m| 1.0 / cosine[m]);
    let shares = each(|m| arc_over_tangent(sine2[m] * inverse[m] * inverse[m]));
    let mut terms = only(&narrow, &each(|m| up[m] * inverse[m] * shares[m]));
    let wide = ask(|m| (sine2[m] > 0.0) & (narrow[m] == 0));
    if any(&wide) {
        let sine = each(|m| sine2[m].sqrt());
        let angles = each(|m| up[m] * (angle(sine[m], cosine[m]) / sine[m]));
        let wide = only(&wide, &angles);
        terms = each(|m| terms[m] + wide[m]);
    }
    terms
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::form_factor::LANES;

    fn disc(radius: f64, height: f64, sides: usize) -> impl Iterator<Item = Vec3> {
        let angle = move |k: usize| -std::f64::consts::TAU * k as f64 / sides as f64;
        (0..sides).map(move |k| Vec3::new(radius * angle(k).cos(), radius * angle(k).sin(), height))
    }

    #[test]
    fn a_coaxial_disc_has_the_sine_squared() {
        let exact = 1.0 / (1.0 + 4.0);
        assert!((point_to_polygon(Vec3::Z, disc(1.0, 2.0, 100_000)) - exact).abs() < 1e-9);
    }

    #[test]
    fn a_polygon_that_fills_the_view_has_one() {
        assert!((point_to_polygon(Vec3::Z, disc(1e9, 1.0, 4)) - 1.0).abs() < 1e-8);
    }

    #[test]
    fn a_small_polygon_has_the_point_kernel() {
        let size = 1e-3;
        let r = disc(size, 1.0, 4).map(|x| x + Vec3::X * 0.5);
        let kernel = crate::kernel::lambert(Vec3::ZERO, Vec3::Z, Vec3::new(0.5, 0.0, 1.0), Vec3::NEG_Z);
        let exact = kernel * 2.0 * size * size;
        assert!((point_to_polygon(Vec3::Z, r) / exact - 1.0).abs() < 1e-5);
    }

    #[test]
    fn lanes_have_the_bits_of_single_edges() {
        let corner = |k: usize| {
            let t = k as f64;
            Vec3::new((0.7 * t).sin(), (1.3 * t).cos(), 0.2 + (0.9 * t).sin().abs())
        };
        let lanes = |of: &dyn Fn(usize) -> Vec3| [each(|m| of(m).x), each(|m| of(m).y), each(|m| of(m).z)];
        for k in 0..100 {
            // Wide and narrow edges in one block.
            let from = |m: usize| corner(LANES * k + m);
            let to = |m: usize| {
                if m.is_multiple_of(2) { corner(LANES * k + m + 1) } else { from(m) + 0.01 * corner(m) }
            };
            let terms = edge_terms(Vec3::Z, &lanes(&from), &lanes(&to));
            for (m, term) in terms.into_iter().enumerate() {
                assert_eq!(term.to_bits(), edge_term(Vec3::Z, from(m), to(m)).to_bits(), "{k} {m}");
            }
        }
    }

    #[test]
    fn nothing_has_zero() {
        assert!(point_to_polygon(Vec3::Z, []) == 0.0);
    }
}
