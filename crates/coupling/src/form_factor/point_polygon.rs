//! Point to polygon in closed form: F = (1/2π) Σₑ Θₑ (Γₑ · n).
//!
//! J. H. Lambert 1760; P. Schröder & P. Hanrahan, SIGGRAPH 1993, doi:10.1145/166117.166138, eq. 3. Γₑ is the unit vector along rₑ × rₑ₊₁,
//! Θₑ the angle between rₑ and rₑ₊₁, r the corners seen from the point. Dimensionless. The polygon must lie above the horizon of
//! the point and be counter-clockwise seen from it.

#![allow(clippy::inline_always, reason = "what is not inlined is compiled for the narrowest vectors")]

use super::lanes::{LANES, Lanes, Lanes3, any, ask, dot, each, only};
use fredholm_mesh::Vec3;
use std::f64::consts::FRAC_1_PI;

/// Form factor from a point at the origin with unit normal `n` to the polygon with corners `r` relative to the point.
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
    // Seen from the point, a polygon that faces it runs clockwise about the normal of the point: hence the sign.
    -0.5 * FRAC_1_PI * sum
}

/// Square of the tangent up to which the series of the arc tangent is used.
const NARROW: f64 = 0.04;

/// Terms of the series, which leave 2e-17.
const TERMS: usize = 11;

/// Θ (Γ · n) of one edge. An edge that points at the origin spans no angle.
#[inline]
fn edge_term(n: Vec3, from: Vec3, to: Vec3) -> f64 {
    let (cross, cosine) = (from.cross(to), from.dot(to));
    let sine2 = cross.length_squared();
    if cosine > 0.0 && sine2 < NARROW * cosine * cosine {
        return cross.dot(n) / cosine * arc_over_tangent(sine2 / (cosine * cosine));
    }
    let sine = sine2.sqrt();
    if sine == 0.0 { 0.0 } else { cross.dot(n) * (sine.atan2(cosine) / sine) }
}

/// Θ (Γ · n) of one edge a lane: the same bits as [`edge_term`].
#[inline(always)]
pub(super) fn edge_terms(n: Vec3, from: &Lanes3, to: &Lanes3) -> Lanes {
    let cross = cross(from, to);
    let (cosine, sine2) = (dot(from, to), dot(&cross, &cross));
    let up = dot(&cross, &[[n.x; LANES], [n.y; LANES], [n.z; LANES]]);
    let narrow = ask(|m| cosine[m] > 0.0 && sine2[m] < NARROW * cosine[m] * cosine[m]);
    let shares = arcs_over_tangents(&each(|m| sine2[m] / (cosine[m] * cosine[m])));
    let mut terms = only(&narrow, &each(|m| up[m] / cosine[m] * shares[m]));
    let wide = ask(|m| sine2[m] > 0.0 && (narrow[m] == 0));
    if any(&wide) {
        add_wide(&mut terms, &only(&wide, &sine2), &cosine, &up);
    }
    terms
}

/// Writes the terms of the lanes of which `sine2` is not 0.
#[inline(never)]
fn add_wide(terms: &mut Lanes, sine2: &Lanes, cosine: &Lanes, up: &Lanes) {
    for m in (0..LANES).filter(|&m| sine2[m] > 0.0) {
        let sine = sine2[m].sqrt();
        terms[m] = up[m] * (sine.atan2(cosine[m]) / sine);
    }
}

#[inline(always)]
fn cross(a: &Lanes3, b: &Lanes3) -> Lanes3 {
    [
        each(|m| a[1][m] * b[2][m] - b[1][m] * a[2][m]),
        each(|m| a[2][m] * b[0][m] - b[2][m] * a[0][m]),
        each(|m| a[0][m] * b[1][m] - b[0][m] * a[1][m]),
    ]
}

/// As [`arc_over_tangent`].
#[inline(always)]
fn arcs_over_tangents(t2: &Lanes) -> Lanes {
    let mut sum = [0.0; LANES];
    for k in (0..TERMS).rev() {
        let term = 1.0 / (2 * k + 1) as f64;
        sum = each(|m| term - sum[m] * t2[m]);
    }
    sum
}

/// atan(t)/t = Σ (−t²)^k/(2k + 1) for t² up to [`NARROW`]: eleven terms leave 2e-17.
#[inline(always)]
fn arc_over_tangent(t2: f64) -> f64 {
    (0..TERMS).rev().fold(0.0, |sum: f64, k| 1.0 / (2 * k + 1) as f64 - sum * t2)
}

#[cfg(test)]
mod tests {
    use super::*;

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
    fn nothing_has_zero() {
        assert!(point_to_polygon(Vec3::Z, []) == 0.0);
    }
}
