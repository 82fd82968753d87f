//! The hot loop: the fields of many elements at several points at once, one point a lane.
//!
//! The equations are those of [`electric_element`](crate::electric_element), split into real and imaginary parts:
//! with i = 1/R, E/η = (across) J + (along) d (d·J) and H = (curl) d × J. Moments are J dA/(4π), A m.

#![allow(clippy::inline_always, reason = "what is not inlined is compiled for the narrowest vectors")]

use crate::lanes::{Lanes, cos_sin};
use crate::medium::IMPEDANCE;
use crate::{ComplexVector, Field};
use fredholm_mesh::Vec3;
use pulp::{Simd, WithSimd};

/// Square of the distance below which an element is not evaluated (it is masked), m².
const FLOOR: f64 = 1e-60;

/// An element: where it is and its moment over 4π.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Element {
    pub(crate) position: [f64; 3],
    pub(crate) re: [f64; 3],
    pub(crate) im: [f64; 3],
}

impl Element {
    /// Whether it carries no current.
    pub(crate) fn is_dark(&self) -> bool {
        self.re == [0.0; 3] && self.im == [0.0; 3]
    }
}

/// The elements of one facet, and which points they reach.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Group {
    pub(crate) centre: [f64; 3],
    pub(crate) normal: [f64; 3],
    /// Points closer than the root of this to the centre are left out, m².
    pub(crate) near_squared: f64,
    /// Factor for points behind the facet; in front it is 1.
    pub(crate) behind: f64,
    pub(crate) facet: usize,
    pub(crate) first: usize,
    pub(crate) count: usize,
}

/// Fields at some points.
pub(crate) struct Evaluate<'a> {
    pub(crate) wavenumber: f64,
    pub(crate) groups: &'a [Group],
    pub(crate) elements: &'a [Element],
    pub(crate) points: &'a [Vec3],
    pub(crate) out: &'a mut [Field],
}

/// Most lanes of any instruction set.
const WIDEST: usize = 64;

impl WithSimd for Evaluate<'_> {
    type Output = ();

    #[inline(always)]
    fn with_simd<S: Simd>(self, simd: S) {
        let width = S::F64_LANES;
        for (points, out) in self.points.chunks(width).zip(self.out.chunks_mut(width)) {
            let mut places = [[0.0; WIDEST]; 3];
            for lane in 0..width {
                // The last point stands in for those that are missing.
                let p = points[lane.min(points.len() - 1)];
                (0..3).for_each(|c| places[c][lane] = p[c]);
            }
            let p = [0, 1, 2].map(|c| Lanes::load(simd, &places[c][..width]));
            let mut sums = Sums::zero(simd);
            for group in self.groups {
                let elements = &self.elements[group.first..group.first + group.count];
                sums.add_group(simd, self.wavenumber, group, elements, p);
            }
            sums.store(width, out);
        }
    }
}

/// E/η and H, real and imaginary, x, y, z.
struct Sums<S: Simd> {
    e: [[Lanes<S>; 3]; 2],
    h: [[Lanes<S>; 3]; 2],
}

impl<S: Simd> Sums<S> {
    #[inline(always)]
    fn zero(simd: S) -> Self {
        let zero = [[Lanes::splat(simd, 0.0); 3]; 2];
        Self { e: zero, h: zero }
    }

    #[inline(always)]
    fn add_group(&mut self, simd: S, k: f64, group: &Group, elements: &[Element], p: [Lanes<S>; 3]) {
        let weight = weight(simd, group, p);
        for element in elements {
            let d = [0, 1, 2].map(|c| p[c] - Lanes::splat(simd, element.position[c]));
            let re = [0, 1, 2].map(|c| Lanes::splat(simd, element.re[c]));
            let im = [0, 1, 2].map(|c| Lanes::splat(simd, element.im[c]));
            self.add(k, d, weight, [re, im]);
        }
    }

    #[inline(always)]
    fn add(&mut self, k: f64, d: [Lanes<S>; 3], weight: Lanes<S>, moment: [[Lanes<S>; 3]; 2]) {
        let scalars = Scalars::new(k, dot(d, d), weight);
        let along = times(scalars.along, [dot(d, moment[0]), dot(d, moment[1])]);
        let turned = moment.map(|m| cross(d, m));
        for c in 0..3 {
            accumulate(&mut self.e, c, scalars.across, [moment[0][c], moment[1][c]]);
            self.e[0][c] = along[0].mul_add(d[c], self.e[0][c]);
            self.e[1][c] = along[1].mul_add(d[c], self.e[1][c]);
            accumulate(&mut self.h, c, scalars.curl, [turned[0][c], turned[1][c]]);
        }
    }

    #[inline(always)]
    fn store(self, width: usize, out: &mut [Field]) {
        let e = unpack(self.e, width);
        let h = unpack(self.h, width);
        for (lane, out) in out.iter_mut().enumerate() {
            *out = Field { e: vector(&e, lane) * IMPEDANCE, h: vector(&h, lane) };
        }
    }
}

/// 1 where the group reaches the point, 0 where it is left out, `behind` behind it.
#[inline(always)]
fn weight<S: Simd>(simd: S, group: &Group, p: [Lanes<S>; 3]) -> Lanes<S> {
    let [zero, one] = [0.0, 1.0].map(|value| Lanes::splat(simd, value));
    let d = [0, 1, 2].map(|c| p[c] - Lanes::splat(simd, group.centre[c]));
    let reached = dot(d, d).where_above(Lanes::splat(simd, group.near_squared), one, zero);
    let normal = [0, 1, 2].map(|c| Lanes::splat(simd, group.normal[c]));
    reached * dot(d, normal).where_above(zero, one, Lanes::splat(simd, group.behind))
}

/// The three functions of the distance, times the weight: real and imaginary.
struct Scalars<S: Simd> {
    across: [Lanes<S>; 2],
    along: [Lanes<S>; 2],
    curl: [Lanes<S>; 2],
}

impl<S: Simd> Scalars<S> {
    #[inline(always)]
    fn new(k: f64, square: Lanes<S>, weight: Lanes<S>) -> Self {
        let square = square.max(square.constant(FLOOR));
        let wavenumber = square.constant(k);
        let inverse = square.sqrt().inverse();
        let (cos, sin) = cos_sin(wavenumber * square * inverse);
        let (cos, sin) = (cos * weight, sin * weight);
        let inverse_square = inverse * inverse;
        let first = wavenumber * inverse;
        let third = inverse * inverse_square * square.constant(1.0 / k);
        // e^{−jφ} (p + jq) = (p cos φ + q sin φ) + j (q cos φ − p sin φ).
        let turned = |p: Lanes<S>, q: Lanes<S>| [p.mul_add(cos, q * sin), q.mul_add(cos, -(p * sin))];
        let three = square.constant(3.0);
        let across = turned(-inverse_square, third - first);
        let along = turned(three * inverse_square, (-three).mul_add(third, first));
        let curl = turned(-inverse, -wavenumber);
        Self { across, along: along.map(|x| x * inverse_square), curl: curl.map(|x| x * inverse_square) }
    }
}

#[inline(always)]
fn dot<S: Simd>(a: [Lanes<S>; 3], b: [Lanes<S>; 3]) -> Lanes<S> {
    a[2].mul_add(b[2], a[1].mul_add(b[1], a[0] * b[0]))
}

#[inline(always)]
fn cross<S: Simd>(a: [Lanes<S>; 3], b: [Lanes<S>; 3]) -> [Lanes<S>; 3] {
    let component = |i: usize, j: usize| a[i].mul_add(b[j], -(a[j] * b[i]));
    [component(1, 2), component(2, 0), component(0, 1)]
}

#[inline(always)]
fn times<S: Simd>(a: [Lanes<S>; 2], b: [Lanes<S>; 2]) -> [Lanes<S>; 2] {
    [a[0].mul_add(b[0], -(a[1] * b[1])), a[0].mul_add(b[1], a[1] * b[0])]
}

/// Component c of `sum` += a b.
#[inline(always)]
fn accumulate<S: Simd>(sum: &mut [[Lanes<S>; 3]; 2], c: usize, a: [Lanes<S>; 2], b: [Lanes<S>; 2]) {
    sum[0][c] = a[0].mul_add(b[0], (-a[1]).mul_add(b[1], sum[0][c]));
    sum[1][c] = a[0].mul_add(b[1], a[1].mul_add(b[0], sum[1][c]));
}

#[inline(always)]
fn unpack<S: Simd>(sums: [[Lanes<S>; 3]; 2], width: usize) -> [[[f64; WIDEST]; 3]; 2] {
    sums.map(|part| {
        part.map(|lanes| {
            let mut values = [0.0; WIDEST];
            lanes.store(&mut values[..width]);
            values
        })
    })
}

fn vector(values: &[[[f64; WIDEST]; 3]; 2], lane: usize) -> ComplexVector {
    let [re, im] = [0, 1].map(|part| Vec3::from_array([0, 1, 2].map(|c| values[part][c][lane])));
    ComplexVector { re, im }
}
