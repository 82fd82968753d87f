//! The hot loop: the fields of many elements at several points at once, one point a lane.
//!
//! The equations are those of [`electric_element`](crate::electric_element), split into real and
//! imaginary parts: with i = 1/R, E/η = (across) J + (along) d (d·J) and H = (curl) d × J. Moments
//! are J dA/(4π), A m.

#![allow(clippy::inline_always, reason = "what is not inlined is compiled for the narrowest vectors")]

use crate::coupling::View;
use crate::lanes::{Lanes, cos_sin};
use crate::medium::IMPEDANCE;
use crate::{ComplexVector, Field};
use fredholm_mesh::Vec3;
use pulp::{Simd, WithSimd};
use std::ops::Range;

/// Square of the distance below which an element is not evaluated (it is masked), m².
const LEAST_SQUARED_DISTANCE: f64 = 1e-60;

/// An element: where it is and its moment over 4π.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Element {
    pub(crate) position: [f64; 3],
    pub(crate) re: [f64; 3],
    pub(crate) im: [f64; 3],
}

impl Element {
    /// One without a current.
    pub(crate) const DARK: Self = Self { position: [0.0; 3], re: [0.0; 3], im: [0.0; 3] };

    /// Whether it carries no current.
    pub(crate) fn is_dark(&self) -> bool {
        self.re.iter().chain(&self.im).all(|&part| part == 0.0)
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

impl Group {
    /// Its elements among all.
    #[inline(always)]
    fn of<'a>(&self, elements: &'a [Element]) -> &'a [Element] {
        &elements[self.first..self.first + self.count]
    }

    /// Whether the point `d` from the centre is left out: in the arithmetic of the lanes, so that
    /// none is counted twice.
    pub(crate) fn leaves_out(&self, d: Vec3) -> bool {
        d.z.mul_add(d.z, d.y.mul_add(d.y, d.x * d.x)) <= self.near_squared
    }
}

/// Fields at some points.
pub(crate) struct Evaluate<'a> {
    pub(crate) wavenumber: f64,
    pub(crate) groups: &'a [Group],
    pub(crate) elements: &'a [Element],
    pub(crate) points: &'a [Vec3],
    pub(crate) observers: Option<Observers<'a>>,
    pub(crate) out: &'a mut [Field],
}

/// What it takes where the points are centres of facets themselves.
#[derive(Clone, Copy)]
pub(crate) struct Observers<'a> {
    /// Facet of the first point.
    pub(crate) first: usize,
    /// Normal of every facet.
    pub(crate) normals: &'a [Vec3],
    /// Factor of every facet for sources behind it.
    pub(crate) behind: &'a [f64],
    /// Who sees whom; nobody is blocked where there is none.
    pub(crate) view: Option<&'a View>,
}

/// Most lanes of any instruction set.
const MOST_LANES: usize = 64;

impl WithSimd for Evaluate<'_> {
    type Output = ();

    #[inline(always)]
    fn with_simd<S: Simd>(self, simd: S) {
        let width = S::F64_LANES;
        for start in (0..self.points.len().min(self.out.len())).step_by(width) {
            let end = self.points.len().min(start + width);
            let p = load(simd, &self.points[start..end]);
            let mut sums = Sums::zero(simd);
            if let Some(observers) = &self.observers {
                let (first, last) = (observers.first + start, observers.first + end);
                let normal = load(simd, &observers.normals[first..last]);
                let mut behind = [0.0; MOST_LANES];
                behind[..end - start].copy_from_slice(&observers.behind[first..last]);
                let behind = Lanes::load(simd, &behind[..width]);
                for group in self.groups {
                    let weight = weight(group, p) * facing(group, p, normal, behind);
                    let weight = weight * seen(simd, observers.view, first..last, group.facet);
                    sums.add_all(self.wavenumber, group.of(self.elements), p, weight);
                }
            } else {
                for group in self.groups {
                    let weight = weight(group, p);
                    sums.add_all(self.wavenumber, group.of(self.elements), p, weight);
                }
            }
            sums.store(width, &mut self.out[start..end]);
        }
    }
}

/// One point a lane; the last stands in for those that are missing.
#[inline(always)]
fn load<S: Simd>(simd: S, points: &[Vec3]) -> Lanes3<S> {
    let width = S::F64_LANES;
    let mut places = [[0.0; MOST_LANES]; 3];
    for lane in 0..width {
        let p = points[lane.min(points.len() - 1)];
        (places[0][lane], places[1][lane], places[2][lane]) = (p.x, p.y, p.z);
    }
    Lanes3 {
        x: Lanes::load(simd, &places[0][..width]),
        y: Lanes::load(simd, &places[1][..width]),
        z: Lanes::load(simd, &places[2][..width]),
    }
}

/// 1 where the observer faces the group, else its factor.
#[inline(always)]
fn facing<S: Simd>(group: &Group, p: Lanes3<S>, normal: Lanes3<S>, behind: Lanes<S>) -> Lanes<S> {
    let one = behind.constant(1.0);
    let front = p.same(&group.centre).minus(p).dot(normal).step();
    front.mul_add(one - behind, behind)
}

/// 1 where the observers see the source, else 0.
#[inline(always)]
fn seen<S: Simd>(simd: S, view: Option<&View>, observers: Range<usize>, source: usize) -> Lanes<S> {
    let Some(view) = view else { return Lanes::splat(simd, 1.0) };
    let mut seen = [0.0; MOST_LANES];
    // The view is symmetric: the bits of the observers are neighbours in the row of the source.
    for (lane, p) in observers.enumerate() {
        seen[lane] = f64::from(u8::from(view.sees(source, p)));
    }
    Lanes::load(simd, &seen[..S::F64_LANES])
}

/// A real vector a lane.
#[derive(Clone, Copy)]
struct Lanes3<S: Simd> {
    x: Lanes<S>,
    y: Lanes<S>,
    z: Lanes<S>,
}

// No closures and no `map` from here on: what they call is compiled for the narrowest vectors.
impl<S: Simd> Lanes3<S> {
    #[inline(always)]
    fn splat(simd: S, v: &[f64; 3]) -> Self {
        Self { x: Lanes::splat(simd, v[0]), y: Lanes::splat(simd, v[1]), z: Lanes::splat(simd, v[2]) }
    }

    /// The same vector in all lanes, of the same instruction set.
    #[inline(always)]
    fn same(self, v: &[f64; 3]) -> Self {
        Self { x: self.x.constant(v[0]), y: self.x.constant(v[1]), z: self.x.constant(v[2]) }
    }

    #[inline(always)]
    fn minus(self, other: Self) -> Self {
        Self { x: self.x - other.x, y: self.y - other.y, z: self.z - other.z }
    }

    #[inline(always)]
    fn dot(self, other: Self) -> Lanes<S> {
        self.z.mul_add(other.z, self.y.mul_add(other.y, self.x * other.x))
    }

    #[inline(always)]
    fn cross(self, other: Self) -> Self {
        Self {
            x: self.y.mul_add(other.z, -(self.z * other.y)),
            y: self.z.mul_add(other.x, -(self.x * other.z)),
            z: self.x.mul_add(other.y, -(self.y * other.x)),
        }
    }

    /// self + factor · other.
    #[inline(always)]
    fn plus(self, factor: Lanes<S>, other: Self) -> Self {
        Self {
            x: factor.mul_add(other.x, self.x),
            y: factor.mul_add(other.y, self.y),
            z: factor.mul_add(other.z, self.z),
        }
    }
}

/// A complex number a lane.
#[derive(Clone, Copy)]
struct Complex<S: Simd> {
    re: Lanes<S>,
    im: Lanes<S>,
}

impl<S: Simd> Complex<S> {
    #[inline(always)]
    fn times(self, other: Self) -> Self {
        Self {
            re: self.re.mul_add(other.re, -(self.im * other.im)),
            im: self.re.mul_add(other.im, self.im * other.re),
        }
    }

    /// (p + jq) e^{−jφ} of this cos φ + j sin φ.
    #[inline(always)]
    fn turn(self, p: Lanes<S>, q: Lanes<S>) -> Self {
        Self { re: p.mul_add(self.re, q * self.im), im: q.mul_add(self.re, -(p * self.im)) }
    }

    #[inline(always)]
    fn scale(self, factor: Lanes<S>) -> Self {
        Self { re: self.re * factor, im: self.im * factor }
    }
}

/// A complex vector a lane.
#[derive(Clone, Copy)]
struct Complex3<S: Simd> {
    re: Lanes3<S>,
    im: Lanes3<S>,
}

impl<S: Simd> Complex3<S> {
    /// self + a b.
    #[inline(always)]
    fn plus(self, a: Complex<S>, b: Self) -> Self {
        Self { re: self.re.plus(a.re, b.re).plus(-a.im, b.im), im: self.im.plus(a.re, b.im).plus(a.im, b.re) }
    }
}

/// E/η and H.
struct Sums<S: Simd> {
    e: Complex3<S>,
    h: Complex3<S>,
}

impl<S: Simd> Sums<S> {
    #[inline(always)]
    fn zero(simd: S) -> Self {
        let zero = Lanes3::splat(simd, &[0.0; 3]);
        Self { e: Complex3 { re: zero, im: zero }, h: Complex3 { re: zero, im: zero } }
    }

    #[inline(always)]
    fn add_all(&mut self, k: f64, elements: &[Element], p: Lanes3<S>, weight: Lanes<S>) {
        for element in elements {
            let d = p.minus(p.same(&element.position));
            let (re, im) = (p.same(&element.re), p.same(&element.im));
            self.add(k, d, weight, Complex3 { re, im });
        }
    }

    #[inline(always)]
    fn add(&mut self, k: f64, d: Lanes3<S>, weight: Lanes<S>, moment: Complex3<S>) {
        let scalars = Scalars::new(k, d.dot(d), weight);
        let along = scalars.along.times(Complex { re: d.dot(moment.re), im: d.dot(moment.im) });
        let e = self.e.plus(scalars.across, moment);
        self.e = Complex3 { re: e.re.plus(along.re, d), im: e.im.plus(along.im, d) };
        let turned = Complex3 { re: d.cross(moment.re), im: d.cross(moment.im) };
        self.h = self.h.plus(scalars.curl, turned);
    }

    #[inline(always)]
    fn store(self, width: usize, out: &mut [Field]) {
        let parts = [self.e.re, self.e.im, self.h.re, self.h.im];
        let mut values = [[[0.0; MOST_LANES]; 3]; 4];
        for (part, values) in parts.iter().zip(&mut values) {
            part.x.store(&mut values[0][..width]);
            part.y.store(&mut values[1][..width]);
            part.z.store(&mut values[2][..width]);
        }
        for (lane, out) in out.iter_mut().enumerate() {
            let vector = |part: usize| Vec3::from_array([0, 1, 2].map(|c| values[part][c][lane]));
            let [e, h] = [0, 2].map(|part| ComplexVector { re: vector(part), im: vector(part + 1) });
            *out = Field { e: e * IMPEDANCE, h };
        }
    }
}

/// 1 where the group reaches the point, 0 where it is left out, `behind` behind it.
#[inline(always)]
fn weight<S: Simd>(group: &Group, p: Lanes3<S>) -> Lanes<S> {
    let d = p.minus(p.same(&group.centre));
    let reached = (d.dot(d) - p.x.constant(group.near_squared)).step();
    let front = d.dot(p.same(&group.normal)).step();
    let behind = p.x.constant(group.behind);
    reached * front.mul_add(p.x.constant(1.0) - behind, behind)
}

/// The three functions of the distance, times the weight.
struct Scalars<S: Simd> {
    across: Complex<S>,
    along: Complex<S>,
    curl: Complex<S>,
}

impl<S: Simd> Scalars<S> {
    #[inline(always)]
    fn new(k: f64, square: Lanes<S>, weight: Lanes<S>) -> Self {
        let square = square.max(square.constant(LEAST_SQUARED_DISTANCE));
        let wavenumber = square.constant(k);
        let inverse = square.sqrt().inverse();
        let (cos, sin) = cos_sin(wavenumber * square * inverse);
        let phase = Complex { re: cos * weight, im: sin * weight };
        let inverse_square = inverse * inverse;
        let first = wavenumber * inverse;
        let third = inverse * inverse_square * square.constant(1.0 / k);
        let three = square.constant(3.0);
        Self {
            across: phase.turn(-inverse_square, third - first),
            along: phase.turn(three * inverse_square, (-three).mul_add(third, first)).scale(inverse_square),
            curl: phase.turn(-inverse, -wavenumber).scale(inverse_square),
        }
    }
}
