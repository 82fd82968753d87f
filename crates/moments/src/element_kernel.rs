//! The integrals of pairs of triangles, flat or curved, with all functions of the first full order.
//!
//! With F and D = √g div f of the functions on both triangles (`element`), d = r − r′, g =
//! e^{−jkR}/R and q = (1 + jkR) g/R² d:
//!
//! ```text
//! electric_ab = jk ∫∫ [F_a·F_b′ − D_a D_b′/k²] g,      magnetic_ab = −∫∫ F_a·(q × F_b′)
//! ```
//!
//! over the unit triangles, which is what `kernel` computes of flat ones. Where the tests are
//! turned, F_a × n stands for F_a in the magnetic part. The eight functions of the source are the
//! eight lanes. For pairs apart the sum over its points comes first: g times a table of F and D,
//! and, as q × F′ is (1 + jkR) g/R² (e − r′) × F′ with the observer at e, times one of F′ × r′.

#![allow(clippy::inline_always, reason = "what is not inlined is compiled for the narrowest vectors")]

use crate::element::{Element, Functions, Part, Shares, shares, within};
use crate::kernel::{
    Complex, Eight, Kernel, Medium, PairPoints, WIDTH, Wanted, axes, by_parts, dot, register, splat, sub,
};
use crate::rules::Rule;
use fredholm_mesh::Vec3;
use fredholm_waves::lanes::Lanes;
use num_complex::Complex64;
use pulp::{Simd, WithSimd};

/// What the tests of the magnetic part are.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Tests {
    /// The functions.
    Straight,
    /// f × n.
    Turned,
}

/// A part of a triangle at the points of a rule, the weights in.
#[derive(Clone, Debug, Default)]
pub(crate) struct Table {
    centre: Vec3,
    /// Relative to the centre, eight together, m.
    places: Vec<[Eight; 3]>,
    /// F, one function a lane.
    vectors: Vec<[Eight; 3]>,
    /// D.
    charges: Vec<Eight>,
    /// F × r, where the magnetic part is wanted.
    crossed: Vec<[Eight; 3]>,
    /// F × n, where the tests are turned.
    turned: Vec<[Eight; 3]>,
}

impl Table {
    pub(crate) fn new(element: &Element, part: &Part, rule: &Rule, (wanted, tests): (Wanted, Tests)) -> Self {
        let mut table = Self { centre: part.centre, ..Self::default() };
        let count = rule.points.len();
        table.places = vec![[[0.0; WIDTH]; 3]; count.div_ceil(WIDTH)];
        for lane in 0..table.places.len() * WIDTH {
            let at = within(&part.corners, shares(rule.points[lane.min(count - 1)]));
            let place = element.point(at) - part.centre;
            (0..3).for_each(|c| table.places[lane / WIDTH][c][lane % WIDTH] = place[c]);
        }
        for (&point, &weight) in rule.points.iter().zip(&rule.weights) {
            let at = within(&part.corners, shares(point));
            let functions = Functions::at(at);
            let [u, v] = element.tangents(at).map(|tangent| tangent * weight);
            let vectors = vectors(&functions, [u, v]);
            table.vectors.push(vectors);
            table.charges.push(functions.charges.map(|charge| charge * weight));
            if wanted.magnetic {
                table.crossed.push(crossed(&vectors, element.point(at) - part.centre));
            }
            if tests == Tests::Turned {
                table.turned.push(crossed(&vectors, element.normal(at)));
            }
        }
        table
    }

    fn place(&self, point: usize) -> Vec3 {
        let [x, y, z] = self.places[point / WIDTH].map(|axis| axis[point % WIDTH]);
        Vec3::new(x, y, z)
    }
}

/// F of all functions.
#[inline(always)]
fn vectors(functions: &Functions, [u, v]: [Vec3; 2]) -> [Eight; 3] {
    let [along_u, along_v] = &functions.along;
    let mut vectors = [[0.0; WIDTH]; 3];
    for (c, vectors) in vectors.iter_mut().enumerate() {
        for (i, vector) in vectors.iter_mut().enumerate() {
            *vector = along_u[i] * u[c] + along_v[i] * v[c];
        }
    }
    vectors
}

/// F × v of all functions.
#[inline(always)]
fn crossed(f: &[Eight; 3], v: Vec3) -> [Eight; 3] {
    let mut crossed = [[0.0; WIDTH]; 3];
    for (c, crossed) in crossed.iter_mut().enumerate() {
        let (d, e) = ((c + 1) % 3, (c + 2) % 3);
        for (i, crossed) in crossed.iter_mut().enumerate() {
            *crossed = f[d][i] * v[e] - f[e][i] * v[d];
        }
    }
    crossed
}

/// Both parts of all pairs of functions, by observer, real and imaginary, one source a lane.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct ElementValues {
    /// ∫∫ g F·F′.
    vectors: [[Eight; 2]; WIDTH],
    /// ∫∫ g D D′.
    charges: [[Eight; 2]; WIDTH],
    magnetic: [[Eight; 2]; WIDTH],
}

/// Both parts of all pairs of functions (8a + b).
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct ElementPair {
    pub(crate) electric: [Complex64; WIDTH * WIDTH],
    pub(crate) magnetic: [Complex64; WIDTH * WIDTH],
}

impl Default for ElementPair {
    fn default() -> Self {
        let zero = [Complex64::ZERO; WIDTH * WIDTH];
        Self { electric: zero, magnetic: zero }
    }
}

impl ElementPair {
    /// Adds a multiple of what a kernel found.
    pub(crate) fn add(&mut self, values: &ElementValues, medium: Medium, factor: f64) {
        let k = medium.k;
        let (jk, charge) = (Complex64::I * k * factor, -(k * k).inv());
        for at in 0..WIDTH * WIDTH {
            let (a, b) = (at / WIDTH, at % WIDTH);
            let read = |part: &[[Eight; 2]; WIDTH]| Complex64::new(part[a][0][b], part[a][1][b]);
            self.electric[at] += jk * (read(&values.vectors) + charge * read(&values.charges));
            self.magnetic[at] += read(&values.magnetic) * factor;
        }
    }

    /// The integrals with observer and source exchanged.
    pub(crate) fn transposed(&self) -> Self {
        let turned = |part: &[Complex64; 64]| std::array::from_fn(|i| part[WIDTH * (i % WIDTH) + i / WIDTH]);
        Self { electric: turned(&self.electric), magnetic: turned(&self.magnetic) }
    }

    /// The electric and magnetic part of two functions.
    pub(crate) fn at(&self, observer: usize, source: usize) -> [Complex64; 2] {
        let at = WIDTH * observer + source;
        [self.electric[at], self.magnetic[at]]
    }
}

/// Two parts that do not touch, by products of rules.
pub(crate) struct ElementsApart<'a> {
    pub(crate) medium: Medium,
    pub(crate) wanted: Wanted,
    pub(crate) tests: Tests,
    pub(crate) observer: &'a Table,
    pub(crate) source: &'a Table,
    /// Bound of the distance of points from the distance of the centres, m.
    pub(crate) spread: f64,
    pub(crate) out: &'a mut ElementValues,
}

by_parts!(ElementsApart);

impl ElementsApart<'_> {
    #[inline(always)]
    fn run<S: Simd, const ELECTRIC: bool, const MAGNETIC: bool, const LOSSY: bool>(self, simd: S) {
        let (observer, source) = (self.observer, self.source);
        let wave = Kernel::<S, LOSSY>::new(simd, self.medium, self.spread);
        let shift = observer.centre - source.centre;
        let middle = if LOSSY { shift.length() } else { 0.0 };
        let (observers, sources) = (observer.vectors.len(), source.vectors.len());
        let stride = source.places.len() * WIDTH;
        // g and the slope of all pairs of points.
        let parts = if MAGNETIC { 4 } else { 2 };
        let mut values = vec![0.0; parts * stride * observers];
        let one = Lanes::splat(simd, 1.0);
        for (p, values) in values.chunks_exact_mut(parts * stride).enumerate() {
            let e = splat(simd, shift + observer.place(p));
            for (chunk, places) in source.places.iter().enumerate() {
                for at in 0..WIDTH / S::F64_LANES {
                    let d = sub(e, register(simd, places, at));
                    let (g, slope) = wave.at::<MAGNETIC>(d, Lanes::splat(simd, middle), one);
                    let first = chunk * WIDTH + at * S::F64_LANES;
                    g.re.store(&mut values[first..first + S::F64_LANES]);
                    g.im.store(&mut values[stride + first..][..S::F64_LANES]);
                    if MAGNETIC {
                        slope.re.store(&mut values[2 * stride + first..][..S::F64_LANES]);
                        slope.im.store(&mut values[3 * stride + first..][..S::F64_LANES]);
                    }
                }
            }
        }
        let fade = if LOSSY { (self.medium.k.im * middle).exp() } else { 1.0 };
        let zero = Complex::<S>::zero(simd);
        for at in 0..WIDTH / S::F64_LANES {
            let mut sums = [[zero; 3]; WIDTH];
            for (p, values) in values.chunks_exact(parts * stride).enumerate() {
                let (mut inner, mut charge, mut slopes, mut across) = ([zero; 3], zero, [zero; 3], [zero; 3]);
                let read = |part: usize, q: usize| Lanes::splat(simd, values[part * stride + q]);
                for q in 0..sources {
                    let f = register(simd, &source.vectors[q], at);
                    if ELECTRIC {
                        let g = Complex { re: read(0, q), im: read(1, q) };
                        inner = axes!(c => inner[c].plus(f[c], g));
                        charge = charge.plus(Lanes::register(simd, &source.charges[q], at), g);
                    }
                    if MAGNETIC {
                        let slope = Complex { re: read(2, q), im: read(3, q) };
                        let r = register(simd, &source.crossed[q], at);
                        slopes = axes!(c => slopes[c].plus(f[c], slope));
                        across = axes!(c => across[c].plus(r[c], slope));
                    }
                }
                // Σ slope F′ × d, with d = e − r′.
                let e = splat(simd, shift + observer.place(p));
                let field = axes!(c => {
                    let (u, v) = ((c + 1) % 3, (c + 2) % 3);
                    let minus = Complex { re: -across[c].re, im: -across[c].im };
                    minus.plus(e[v], slopes[u]).plus(-e[u], slopes[v])
                });
                let turned = self.tests == Tests::Turned;
                let tests = if turned { &observer.turned[p] } else { &observer.vectors[p] };
                let (own, own_charges) = (&observer.vectors[p], &observer.charges[p]);
                for (a, sums) in sums.iter_mut().enumerate() {
                    if ELECTRIC {
                        let t: [Lanes<S>; 3] = axes!(c => Lanes::splat(simd, own[c][a]));
                        sums[0] = sums[0].plus(t[0], inner[0]).plus(t[1], inner[1]).plus(t[2], inner[2]);
                        sums[1] = sums[1].plus(Lanes::splat(simd, own_charges[a]), charge);
                    }
                    if MAGNETIC {
                        let t: [Lanes<S>; 3] = axes!(c => Lanes::splat(simd, tests[c][a]));
                        sums[2] = sums[2].plus(t[0], field[0]).plus(t[1], field[1]).plus(t[2], field[2]);
                    }
                }
            }
            self.out.write(&sums, Lanes::splat(simd, fade), at);
        }
    }
}

impl ElementValues {
    #[inline(always)]
    fn write<S: Simd>(&mut self, sums: &[[Complex<S>; 3]; WIDTH], fade: Lanes<S>, at: usize) {
        for (a, [vectors, charges, magnetic]) in sums.iter().enumerate() {
            vectors.scaled(fade).store(&mut self.vectors[a], at);
            charges.scaled(fade).store(&mut self.charges[a], at);
            magnetic.scaled(fade).store(&mut self.magnetic[a], at);
        }
    }
}

/// Two parts that touch, by a rule for pairs of points.
pub(crate) struct ElementsTouching<'a> {
    pub(crate) medium: Medium,
    pub(crate) wanted: Wanted,
    pub(crate) tests: Tests,
    pub(crate) rule: &'a [PairPoints],
    /// Both triangles, relative to a point close to them.
    pub(crate) elements: [Element; 2],
    /// Corners of the parts in their unit triangles, in the order of the rule.
    pub(crate) parts: [[Shares; 3]; 2],
    pub(crate) spread: f64,
    pub(crate) out: &'a mut ElementValues,
}

by_parts!(ElementsTouching);

impl ElementsTouching<'_> {
    #[inline(always)]
    fn run<S: Simd, const ELECTRIC: bool, const MAGNETIC: bool, const LOSSY: bool>(self, simd: S) {
        let wave = Kernel::<S, LOSSY>::new(simd, self.medium, self.spread);
        let none = Lanes::splat(simd, 0.0);
        let zero = Complex::<S>::zero(simd);
        // With the narrowest registers there are eight parts.
        let mut sums = [[[zero; 3]; WIDTH]; WIDTH];
        for points in self.rule {
            let (mut own, mut other) = ([[0.0; WIDTH]; 3], [[0.0; WIDTH]; 3]);
            let (mut ways, mut g, mut s) = ([[0.0; WIDTH]; 3], [[0.0; WIDTH]; 2], [[0.0; WIDTH]; 2]);
            for at in 0..WIDTH / S::F64_LANES {
                let lanes = at * S::F64_LANES..(at + 1) * S::F64_LANES;
                let here = place(simd, &self.parts[0], &points.observer, at);
                let there = place(simd, &self.parts[1], &points.source, at);
                let d = sub(point(simd, &self.elements[0], here), point(simd, &self.elements[1], there));
                let weight = Lanes::register(simd, &points.weight, at);
                let (green, slope) = wave.at::<MAGNETIC>(d, none, weight);
                for c in 0..3 {
                    here[c].store(&mut own[c][lanes.clone()]);
                    there[c].store(&mut other[c][lanes.clone()]);
                    d[c].store(&mut ways[c][lanes.clone()]);
                }
                green.store(&mut g, at);
                slope.store(&mut s, at);
            }
            for lane in 0..WIDTH {
                // The last eight of a rule may be filled up.
                if points.weight[lane] == 0.0 {
                    continue;
                }
                let here = Side::new(simd, &self.elements[0], [own[0][lane], own[1][lane], own[2][lane]]);
                let there =
                    Side::new(simd, &self.elements[1], [other[0][lane], other[1][lane], other[2][lane]]);
                let d = Vec3::new(ways[0][lane], ways[1][lane], ways[2][lane]);
                let f = here.vectors(simd);
                let b = there.vectors(simd);
                let across = if MAGNETIC { crossed_lanes(simd, &b, d) } else { [[0.0; WIDTH]; 3] };
                let tests = if MAGNETIC && self.tests == Tests::Turned {
                    crossed_lanes(simd, &f, here.normal())
                } else {
                    f
                };
                let green =
                    Complex { re: Lanes::splat(simd, g[0][lane]), im: Lanes::splat(simd, g[1][lane]) };
                let slope =
                    Complex { re: Lanes::splat(simd, s[0][lane]), im: Lanes::splat(simd, s[1][lane]) };
                for at in 0..WIDTH / S::F64_LANES {
                    let b = register(simd, &b, at);
                    let across = register(simd, &across, at);
                    let other = Lanes::register(simd, &there.functions.charges, at);
                    let sums = &mut sums[at];
                    for a in 0..WIDTH {
                        if ELECTRIC {
                            let t = axes!(c => Lanes::splat(simd, f[c][a]));
                            sums[a][0] = sums[a][0].plus(dot(t, b), green);
                            let charges = Lanes::splat(simd, here.functions.charges[a]) * other;
                            sums[a][1] = sums[a][1].plus(charges, green);
                        }
                        if MAGNETIC {
                            let t = axes!(c => Lanes::splat(simd, tests[c][a]));
                            sums[a][2] = sums[a][2].plus(dot(t, across), slope);
                        }
                    }
                }
            }
        }
        let one = Lanes::splat(simd, 1.0);
        for (at, sums) in sums.iter().take(WIDTH / S::F64_LANES).enumerate() {
            self.out.write(sums, one, at);
        }
    }
}

/// One triangle at a point.
struct Side {
    functions: Functions,
    tangents: [Vec3; 2],
}

impl Side {
    #[inline(always)]
    fn new<S: Simd>(_: S, element: &Element, at: Shares) -> Self {
        Self { functions: Functions::at(at), tangents: element.tangents(at) }
    }

    /// F of all functions.
    #[inline(always)]
    fn vectors<S: Simd>(&self, simd: S) -> [Eight; 3] {
        let mut vectors = [[0.0; WIDTH]; 3];
        let (u, v) = (splat(simd, self.tangents[0]), splat(simd, self.tangents[1]));
        for at in 0..WIDTH / S::F64_LANES {
            let along_u = Lanes::register(simd, &self.functions.along[0], at);
            let along_v = Lanes::register(simd, &self.functions.along[1], at);
            let lanes = at * S::F64_LANES..(at + 1) * S::F64_LANES;
            for c in 0..3 {
                along_u.mul_add(u[c], along_v * v[c]).store(&mut vectors[c][lanes.clone()]);
            }
        }
        vectors
    }

    #[inline(always)]
    fn normal(&self) -> Vec3 {
        let across = self.tangents[0].cross(self.tangents[1]);
        across / across.length()
    }
}

/// F × v of all functions.
#[inline(always)]
fn crossed_lanes<S: Simd>(simd: S, f: &[Eight; 3], v: Vec3) -> [Eight; 3] {
    let mut crossed = [[0.0; WIDTH]; 3];
    let v = splat(simd, v);
    for at in 0..WIDTH / S::F64_LANES {
        let f = register(simd, f, at);
        let lanes = at * S::F64_LANES..(at + 1) * S::F64_LANES;
        for (c, crossed) in crossed.iter_mut().enumerate() {
            let (d, e) = ((c + 1) % 3, (c + 2) % 3);
            f[d].mul_add(v[e], -(f[e] * v[d])).store(&mut crossed[lanes.clone()]);
        }
    }
    crossed
}

/// Coordinates in the unit triangle of points with these weights of corners 1 and 2 of a part.
#[inline(always)]
fn place<S: Simd>(simd: S, part: &[Shares; 3], uv: &[Eight; 2], at: usize) -> [Lanes<S>; 3] {
    let (u, v) = (Lanes::register(simd, &uv[0], at), Lanes::register(simd, &uv[1], at));
    axes!(c => {
        let [a, b, d] = [part[0][c], part[1][c], part[2][c]];
        let first = Lanes::splat(simd, a);
        Lanes::splat(simd, b - a).mul_add(u, Lanes::splat(simd, d - a).mul_add(v, first))
    })
}

/// r at these coordinates.
#[inline(always)]
fn point<S: Simd>(simd: S, element: &Element, l: [Lanes<S>; 3]) -> [Lanes<S>; 3] {
    let [a, b, c] = axes!(i => splat(simd, element.corners[i]));
    let [d, e, f] = axes!(i => splat(simd, element.bulges[i]));
    let products = [l[1] * l[2], l[2] * l[0], l[0] * l[1]];
    axes!(i => {
        let straight = a[i].mul_add(l[0], b[i].mul_add(l[1], c[i] * l[2]));
        d[i].mul_add(products[0], e[i].mul_add(products[1], f[i].mul_add(products[2], straight)))
    })
}
