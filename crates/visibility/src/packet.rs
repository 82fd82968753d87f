//! Which of eight facets may a segment cross, and which does it cross for sure?
//!
//! The heights and coordinates of a [facet](crate::facet), all in f32 and for eight facets at once.
//! With the heights s_p and s_q of the ends, signed, and their difference D = s_p − s_q, the
//! crossing of the plane is inside where
//!
//! ```text
//! U = s_p u_q − s_q u_p,   V = s_p v_q − s_q v_p,   D − U − V   (for a parallelogram D − max(U, V) and min(U, V))
//! ```
//!
//! have no two different signs. With ε = 2⁻²³ the heights err by less than H = 4 ε M, where M
//! bounds all distances, and u by less than 4 ε |∇u| M; so U errs by less than 4 ε |∇u| M (|D| + 2
//! M), and the three of them by less than g M ε (8 |D| + 32 M), where g = |∇u| + |∇v|, plus what a
//! parallelogram that is not quite one adds. What is farther from zero is sure. The rest, and all
//! that lies within H of a plane, is left to [`Facet`].
//!
//! A ray counts up to a fraction e < 1 of its length only, where its height is s_e = s_p − e D. With
//! s_p beyond the tolerance on one side and s_e on the other, so is s_q, of the sign of s_e and
//! farther from the plane, as far as roundings go: they move s_q by less than H, and what is sure is
//! farther off than H and the tolerance. So what is sure to be crossed before e is so by the exact
//! test of the whole ray, too.

#![allow(clippy::inline_always, reason = "what is not inlined is compiled for the narrowest vectors")]

use std::ops::Range;

use crate::eight::{Eight, WIDTH};
use crate::facet::{Facet, Slopes};
use crate::probe::Probe;

/// Errors of heights over ε M.
const HEIGHT_ERROR: f32 = 4.0;
/// Errors of U, V and D over g M ε: the factors of |D| and of M.
const INSIDE_ERRORS: [f32; 2] = [8.0, 32.0];
/// The height of any point over the plane of a facet that is not there.
const HEIGHT_OF_NO_FACET: f32 = 1e30;

/// Up to eight facets.
#[derive(Clone, Debug)]
#[repr(C, align(64))]
pub(crate) struct Packet {
    normal: [[f32; WIDTH]; 3],
    offset: [f32; WIDTH],
    u: [[f32; WIDTH]; 4],
    v: [[f32; WIDTH]; 4],
    /// 1 for a triangle, 0 for a parallelogram.
    triangle: [f32; WIDTH],
    /// The largest errors of U, V and D of a facet, over M D and over M².
    doubt: [f32; 2],
    first: u32,
    count: u32,
}

/// The facets that a segment may cross, a bit each, and those of them that it crosses for sure.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Crossed {
    pub may: u32,
    pub does: u32,
}

/// A segment as the tests of all packets need it.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Ends<E: Eight> {
    p: [E::Vector; 3],
    q: [E::Vector; 3],
    reach: f32,
    /// Heights that are surely of one sign, and surely farther from the plane than the tolerance.
    apart: [f32; 2],
}

impl<E: Eight> Ends<E> {
    #[inline(always)]
    pub(crate) fn new(eight: E, probe: &Probe) -> Self {
        let doubt = HEIGHT_ERROR * f32::EPSILON * probe.reach;
        let near = probe.near[0].max(probe.near[1]) as f32;
        let [[p_x, q_x], [p_y, q_y], [p_z, q_z]] = probe.axes;
        Self {
            p: [eight.splat(p_x as f32), eight.splat(p_y as f32), eight.splat(p_z as f32)],
            q: [eight.splat(q_x as f32), eight.splat(q_y as f32), eight.splat(q_z as f32)],
            reach: probe.reach,
            apart: [doubt, doubt + 1.01 * near],
        }
    }
}

impl Packet {
    /// The packet of some facets, at most eight, of which the first has the place `first`.
    pub(crate) fn new(facets: &[Facet], slopes: &[Slopes], first: u32) -> Self {
        let mut packet = Self {
            normal: [[0.0; WIDTH]; 3],
            offset: [HEIGHT_OF_NO_FACET; WIDTH],
            u: [[0.0; WIDTH]; 4],
            v: [[0.0; WIDTH]; 4],
            triangle: [1.0; WIDTH],
            doubt: [0.0; 2],
            first,
            count: facets.len() as u32,
        };
        for (i, (facet, slopes)) in facets.iter().zip(slopes).enumerate() {
            let [n_x, n_y, n_z, offset] = facet.plane().map(|c| c as f32);
            (packet.normal[0][i], packet.normal[1][i], packet.normal[2][i]) = (n_x, n_y, n_z);
            packet.offset[i] = offset;
            let [u, v] = slopes.rows();
            for k in 0..4 {
                (packet.u[k][i], packet.v[k][i]) = (u[k], v[k]);
            }
            packet.triangle[i] = facet.triangle;
            let (gradient, blur) = facet.doubts();
            let wide = INSIDE_ERRORS.map(|factor| factor * f32::EPSILON * gradient);
            packet.doubt[0] = packet.doubt[0].max(wide[0]);
            packet.doubt[1] = packet.doubt[1].max(wide[1] + blur);
        }
        packet
    }

    /// The places of the facets.
    pub(crate) fn places(&self) -> Range<usize> {
        self.first as usize..(self.first + self.count) as usize
    }

    /// The place of the facet of a lane.
    #[inline(always)]
    pub(crate) fn place(&self, lane: u32) -> usize {
        self.first as usize + lane as usize
    }

    /// What the segment crosses up to the fraction `end` of its length, or a little farther.
    #[inline(always)]
    pub(crate) fn crossed<E: Eight>(&self, e: E, ends: &Ends<E>, end: f32) -> Crossed {
        let [n_x, n_y, n_z] = &self.normal;
        let [s_p, s_q] = linear(e, [n_x, n_y, n_z, &self.offset], ends);
        let d = e.sub(s_p, s_q);
        // Where the part that counts ends.
        let s_e = if end < 1.0 { e.sub(s_p, e.mul(e.splat(end), d)) } else { s_q };
        let (low, high) = (e.min(s_p, s_e), e.max(s_p, s_e));
        let [near, far] = ends.apart;
        // `end` may have been rounded down, and the height there errs by more than that of an end.
        let near = if end < 1.0 { 4.0 * near } else { near };
        let aside = e.less(e.splat(near), low) | e.less(high, e.splat(-near));
        if aside == (1 << WIDTH) - 1 {
            return Crossed { may: 0, does: 0 };
        }
        let [u, v] = [across(e, &self.u, ends, [s_p, s_q]), across(e, &self.v, ends, [s_p, s_q])];
        let triangle = e.load(&self.triangle);
        // For a parallelogram D − U and D − V, for a triangle D − U − V twice.
        let rest_u = e.sub(e.sub(d, u), e.mul(triangle, v));
        let rest_v = e.sub(e.sub(d, v), e.mul(triangle, u));
        let least = e.min(e.min(u, v), e.min(rest_u, rest_v));
        let most = e.max(e.max(u, v), e.max(rest_u, rest_v));
        let size = e.max(d, e.sub(e.splat(0.0), d));
        let [slope, fixed] = [self.doubt[0] * ends.reach, self.doubt[1] * ends.reach * ends.reach];
        let doubt = e.mul_add(size, e.splat(slope), e.splat(fixed));
        let negative = e.sub(e.splat(0.0), doubt);
        let outside = e.less(least, negative) & e.less(doubt, most);
        let apart = e.less(low, e.splat(-far)) & e.less(e.splat(far), high);
        let inside = e.less(doubt, least) | e.less(most, negative);
        let may = !(aside | outside) & ((1 << self.count) - 1);
        Crossed { may, does: apart & inside & may }
    }
}

/// What four rows of coefficients make of the two ends.
#[inline(always)]
fn linear<E: Eight>(e: E, rows: [&[f32; WIDTH]; 4], ends: &Ends<E>) -> [E::Vector; 2] {
    let (x, y, z, o) = (e.load(rows[0]), e.load(rows[1]), e.load(rows[2]), e.load(rows[3]));
    let (p, q) = (&ends.p, &ends.q);
    [
        e.mul_add(x, p[0], e.mul_add(y, p[1], e.mul_add(z, p[2], o))),
        e.mul_add(x, q[0], e.mul_add(y, q[1], e.mul_add(z, q[2], o))),
    ]
}

/// The coordinate of the crossing, times D.
#[inline(always)]
fn across<E: Eight>(e: E, rows: &[[f32; WIDTH]; 4], ends: &Ends<E>, s: [E::Vector; 2]) -> E::Vector {
    let [x, y, z, o] = rows;
    let [at_p, at_q] = linear(e, [x, y, z, o], ends);
    e.mul_sub(s[0], at_q, e.mul(s[1], at_p))
}
