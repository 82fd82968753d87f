//! The integrals of pairs of triangles, eight pairs at once.
//!
//! With half functions (r − a) on the observing triangle and (r′ − b) on the source triangle, both
//! without their factors, d = r − r′, R = |d|, g = e^{−jkR}/R and q = (1 + jkR) g/R² d (which is
//! −4π ∇G), this computes
//!
//! ```text
//! electric_ab = jk ∫∫ [(r − a)·(r′ − b) − 4/k²] g,      magnetic_ab = −∫∫ (r − a) · (q × (r′ − b))
//! ```
//!
//! over the unit triangles (each measures ½).
//! Because q is along d and r′ − b = (r − b) − d, the inner integral of the magnetic part is (r −
//! b) × Q with Q = ∫ q: both parts need few sums over the points (the moments), from which all nine
//! pairs of corners follow. Everything is relative to the centres of the triangles, so that nothing
//! cancels far from the origin.
//!
//! The wavenumber k = k′ − jκ may have losses, κ ≥ 0: e^{−κR} is e^{−κR₀} of the distance R₀ of the
//! centres, times a series for the rest.

#![allow(clippy::inline_always, reason = "what is not inlined is compiled for the narrowest vectors")]

use fredholm_mesh::Vec3;
use fredholm_waves::lanes::{Lanes, cos_sin, decay, halvings};
use num_complex::Complex64;
use pulp::{Simd, WithSimd};

/// One value for each axis. (What `array::from_fn` and `map` call may stay a function of its own,
/// compiled for narrow vectors.)
macro_rules! axes {
    ($axis:ident => $value:expr) => {
        [
            {
                let $axis: usize = 0;
                $value
            },
            {
                let $axis: usize = 1;
                $value
            },
            {
                let $axis: usize = 2;
                $value
            },
        ]
    };
}

/// Compiles a kernel for each choice of parts and with or without losses.
macro_rules! by_parts {
    ($kernel:ident) => {
        impl WithSimd for $kernel<'_> {
            type Output = ();

            #[inline(always)]
            fn with_simd<S: Simd>(self, simd: S) {
                match (self.wanted.electric, self.wanted.magnetic, self.medium.lossy) {
                    (true, false, false) => self.run::<S, true, false, false>(simd),
                    (true, false, true) => self.run::<S, true, false, true>(simd),
                    (false, true, false) => self.run::<S, false, true, false>(simd),
                    (false, true, true) => self.run::<S, false, true, true>(simd),
                    (_, _, false) => self.run::<S, true, true, false>(simd),
                    (_, _, true) => self.run::<S, true, true, true>(simd),
                }
            }
        }
    };
}

pub(crate) use {axes, by_parts};

/// Pairs at once, on any instruction set.
pub(crate) const WIDTH: usize = 8;
/// One number for each pair.
pub(crate) type Eight = [f64; WIDTH];

/// Eight triangles: centre, and corners relative to the centre.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct Eights {
    pub(crate) centre: [Eight; 3],
    pub(crate) corners: [[Eight; 3]; 3],
}

impl Eights {
    /// Writes a triangle to a lane; `corners` are relative to the centre.
    pub(crate) fn set(&mut self, lane: usize, centre: Vec3, corners: [Vec3; 3]) {
        for axis in 0..3 {
            self.centre[axis][lane] = centre[axis];
            for (own, corner) in self.corners.iter_mut().zip(corners) {
                own[axis][lane] = corner[axis];
            }
        }
    }

    /// One triangle in all lanes.
    pub(crate) fn splat(centre: Vec3, corners: [Vec3; 3]) -> Self {
        let mut all = Self::default();
        (0..WIDTH).for_each(|lane| all.set(lane, centre, corners));
        all
    }
}

/// Points of eight triangles, relative to their centres, and the weights that all share.
#[derive(Clone, Copy)]
pub(crate) struct Points<'a> {
    pub(crate) triangles: &'a Eights,
    pub(crate) places: &'a [[Eight; 3]],
    pub(crate) weights: &'a [f64],
}

/// The medium: k = k′ − jκ, 1/m.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Medium {
    pub(crate) k: Complex64,
    pub(crate) lossy: bool,
}

impl Medium {
    pub(crate) fn new(k: Complex64) -> Self {
        Self { k, lossy: k.im != 0.0 }
    }
}

/// What is asked of a pair.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct Wanted {
    pub(crate) electric: bool,
    pub(crate) magnetic: bool,
}

/// Both parts of nine pairs of corners (3a + b), real and imaginary, for eight pairs of triangles.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Values {
    pub(crate) electric: [[Eight; 2]; 9],
    pub(crate) magnetic: [[Eight; 2]; 9],
}

impl Default for Values {
    fn default() -> Self {
        Self { electric: [[[0.0; WIDTH]; 2]; 9], magnetic: [[[0.0; WIDTH]; 2]; 9] }
    }
}

/// Eight pairs that do not touch, by products of rules.
pub(crate) struct Apart<'a> {
    pub(crate) medium: Medium,
    pub(crate) wanted: Wanted,
    pub(crate) observers: Points<'a>,
    pub(crate) sources: Points<'a>,
    /// Bound of the distance of points from the distance of their centres, m.
    pub(crate) spread: f64,
    pub(crate) out: &'a mut Values,
}

by_parts!(Apart);

impl Apart<'_> {
    #[inline(always)]
    fn run<S: Simd, const ELECTRIC: bool, const MAGNETIC: bool, const LOSSY: bool>(self, simd: S) {
        let wave = Kernel::<S, LOSSY>::new(simd, self.medium, self.spread);
        for at in 0..WIDTH / S::F64_LANES {
            let (observers, sources) = (self.observers, self.sources);
            let shift = sub(
                register(simd, &observers.triangles.centre, at),
                register(simd, &sources.triangles.centre, at),
            );
            let middle = if LOSSY { dot(shift, shift).sqrt() } else { Lanes::splat(simd, 0.0) };
            let mut moments = Moments::<S, ELECTRIC, MAGNETIC>::zero(simd);
            for (p, &weight) in observers.places.iter().zip(observers.weights) {
                let own = register(simd, p, at);
                let e = add(shift, own);
                let mut inner = Inner::<S>::zero(simd);
                for (s, &weight) in sources.places.iter().zip(sources.weights) {
                    let other = register(simd, s, at);
                    let weight = Lanes::splat(simd, weight);
                    inner.add::<ELECTRIC, MAGNETIC, LOSSY>(&wave, sub(e, other), other, middle, weight);
                }
                let weight = Lanes::splat(simd, weight);
                moments.add(&inner, own, weight);
            }
            let fade = if LOSSY { fade(simd, self.medium, middle) } else { Lanes::splat(simd, 1.0) };
            moments.write(&wave, fade, shift, self.observers.triangles, self.sources.triangles, at, self.out);
        }
    }
}

/// Eight pairs of points of two triangles that touch: positions on both relative to the centres,
/// and weights.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct PairPoints {
    pub(crate) observer: [Eight; 2],
    pub(crate) source: [Eight; 2],
    pub(crate) weight: Eight,
}

/// One pair of triangles by a rule for pairs of points, in lane 0 of the values. The corners in the
/// order of the rule are given apart from those of the triangles.
pub(crate) struct Touching<'a> {
    pub(crate) medium: Medium,
    pub(crate) wanted: Wanted,
    pub(crate) rule: &'a [PairPoints],
    pub(crate) observer: &'a Eights,
    pub(crate) source: &'a Eights,
    /// Corners in the order of the rule, relative to the centres, m.
    pub(crate) corners: [[Vec3; 3]; 2],
    pub(crate) spread: f64,
    pub(crate) out: &'a mut Values,
}

by_parts!(Touching);

impl Touching<'_> {
    #[inline(always)]
    fn run<S: Simd, const ELECTRIC: bool, const MAGNETIC: bool, const LOSSY: bool>(self, simd: S) {
        let wave = Kernel::<S, LOSSY>::new(simd, self.medium, self.spread);
        let zero = Lanes::splat(simd, 0.0);
        let one = Lanes::splat(simd, 1.0);
        for at in 0..WIDTH / S::F64_LANES {
            let shift =
                sub(register(simd, &self.observer.centre, at), register(simd, &self.source.centre, at));
            let (observer, source) = (frame(simd, self.corners[0]), frame(simd, self.corners[1]));
            let mut moments = Moments::<S, ELECTRIC, MAGNETIC>::zero(simd);
            for points in self.rule {
                let own = place(&observer, &points.observer, at);
                let other = place(&source, &points.source, at);
                let e = add(shift, own);
                let weight = Lanes::register(simd, &points.weight, at);
                let mut inner = Inner::<S>::zero(simd);
                inner.add::<ELECTRIC, MAGNETIC, LOSSY>(&wave, sub(e, other), other, zero, weight);
                moments.add(&inner, own, one);
            }
            moments.write(&wave, one, shift, self.observer, self.source, at, self.out);
        }
        self.out.fold();
    }
}

impl Values {
    /// The sum of all lanes, in lane 0.
    fn fold(&mut self) {
        for part in self.electric.iter_mut().chain(&mut self.magnetic).flatten() {
            part[0] = part.iter().sum();
        }
    }
}

/// Register `at` of eight vectors.
#[inline(always)]
pub(crate) fn register<S: Simd>(simd: S, values: &[Eight; 3], at: usize) -> [Lanes<S>; 3] {
    axes!(c => Lanes::register(simd, &values[c], at))
}

/// A vector in all lanes.
#[inline(always)]
pub(crate) fn splat<S: Simd>(simd: S, v: Vec3) -> [Lanes<S>; 3] {
    axes!(c => Lanes::splat(simd, v[c]))
}

/// Corner 0 and the sides from it to the others.
#[inline(always)]
fn frame<S: Simd>(simd: S, [a, b, c]: [Vec3; 3]) -> [[Lanes<S>; 3]; 3] {
    [splat(simd, a), splat(simd, b - a), splat(simd, c - a)]
}

/// The points with these weights of the sides of a frame.
#[inline(always)]
fn place<S: Simd>(frame: &[[Lanes<S>; 3]; 3], uv: &[Eight; 2], at: usize) -> [Lanes<S>; 3] {
    let simd = frame[0][0].simd();
    let (u, v) = (Lanes::register(simd, &uv[0], at), Lanes::register(simd, &uv[1], at));
    axes!(c => frame[1][c].mul_add(u, frame[2][c].mul_add(v, frame[0][c])))
}

/// e^{−κR₀} of every lane.
#[inline(always)]
fn fade<S: Simd>(simd: S, medium: Medium, middle: Lanes<S>) -> Lanes<S> {
    let mut values = [0.0; WIDTH];
    middle.store(&mut values[..S::F64_LANES]);
    let faded = values.map(|distance| (medium.k.im * distance).exp());
    Lanes::load(simd, &faded[..S::F64_LANES])
}

/// The constants of a medium.
pub(crate) struct Kernel<S: Simd, const LOSSY: bool> {
    real: Lanes<S>,
    loss: Lanes<S>,
    halvings: u32,
    one: Lanes<S>,
    medium: Medium,
}

impl<S: Simd, const LOSSY: bool> Kernel<S, LOSSY> {
    #[inline(always)]
    pub(crate) fn new(simd: S, medium: Medium, spread: f64) -> Self {
        Self {
            real: Lanes::splat(simd, medium.k.re),
            loss: Lanes::splat(simd, -medium.k.im),
            halvings: if LOSSY { halvings(medium.k.im * spread) } else { 0 },
            one: Lanes::splat(simd, 1.0),
            medium,
        }
    }

    /// weight · e^{κ middle} g and, where it is wanted, (1 + jkR)/R² times that, `d` away from the
    /// source.
    #[inline(always)]
    pub(crate) fn at<const MAGNETIC: bool>(
        &self,
        d: [Lanes<S>; 3],
        middle: Lanes<S>,
        weight: Lanes<S>,
    ) -> (Complex<S>, Complex<S>) {
        let square = dot(d, d);
        let inverse = square.sqrt().inverse();
        let distance = square * inverse;
        let phase = self.real * distance;
        let (cos, sin) = cos_sin(phase);
        let mut size = weight * inverse;
        if LOSSY {
            size = size * decay(self.loss * (distance - middle), self.halvings);
        }
        let g = Complex { re: size * cos, im: -(size * sin) };
        if !MAGNETIC {
            return (g, g);
        }
        let second = inverse * inverse;
        let damping = if LOSSY { self.loss.mul_add(distance, self.one) } else { self.one };
        let re = (g.re * damping - g.im * phase) * second;
        let im = g.im.mul_add(damping, g.re * phase) * second;
        (g, Complex { re, im })
    }
}

/// Complex numbers, one a lane.
#[derive(Clone, Copy)]
pub(crate) struct Complex<S: Simd> {
    pub(crate) re: Lanes<S>,
    pub(crate) im: Lanes<S>,
}

impl<S: Simd> Complex<S> {
    #[inline(always)]
    pub(crate) fn zero(simd: S) -> Self {
        let zero = Lanes::splat(simd, 0.0);
        Self { re: zero, im: zero }
    }

    /// self + factor · other.
    #[inline(always)]
    pub(crate) fn plus(self, factor: Lanes<S>, other: Self) -> Self {
        Self { re: factor.mul_add(other.re, self.re), im: factor.mul_add(other.im, self.im) }
    }

    #[inline(always)]
    pub(crate) fn scaled(self, factor: Lanes<S>) -> Self {
        Self { re: self.re * factor, im: self.im * factor }
    }

    #[inline(always)]
    fn sum(self, other: Self) -> Self {
        Self { re: self.re + other.re, im: self.im + other.im }
    }

    #[inline(always)]
    fn product(self, other: Self) -> Self {
        Self {
            re: self.re * other.re - self.im * other.im,
            im: self.re.mul_add(other.im, self.im * other.re),
        }
    }

    /// Times a complex number that is the same in all lanes.
    #[inline(always)]
    fn times(self, factor: Complex64) -> Self {
        let (re, im) = (self.re.constant(factor.re), self.re.constant(factor.im));
        Self { re: re * self.re - im * self.im, im: re.mul_add(self.im, im * self.re) }
    }
}

/// The integrals over the source triangle at one point of the observer: ∫g, ∫g r′, Q.
struct Inner<S: Simd> {
    potential: Complex<S>,
    vector: [Complex<S>; 3],
    gradient: [Complex<S>; 3],
}

impl<S: Simd> Inner<S> {
    #[inline(always)]
    fn zero(simd: S) -> Self {
        let zero = Complex::zero(simd);
        Self { potential: zero, vector: [zero; 3], gradient: [zero; 3] }
    }

    /// Adds the source point at `other`, `d` away.
    #[inline(always)]
    fn add<const ELECTRIC: bool, const MAGNETIC: bool, const LOSSY: bool>(
        &mut self,
        wave: &Kernel<S, LOSSY>,
        d: [Lanes<S>; 3],
        other: [Lanes<S>; 3],
        middle: Lanes<S>,
        weight: Lanes<S>,
    ) {
        let (g, slope) = wave.at::<MAGNETIC>(d, middle, weight);
        if ELECTRIC {
            let one = wave.one;
            self.potential = self.potential.plus(one, g);
            self.vector = axes!(c => self.vector[c].plus(other[c], g));
        }
        if MAGNETIC {
            self.gradient = axes!(c => self.gradient[c].plus(d[c], slope));
        }
    }
}

/// Sums over both triangles from which the entries of all pairs of corners follow.
struct Moments<S: Simd, const ELECTRIC: bool, const MAGNETIC: bool> {
    /// ∫∫ g, ∫∫ g r, ∫∫ g r′, ∫∫ g r·r′.
    potential: Complex<S>,
    own: [Complex<S>; 3],
    other: [Complex<S>; 3],
    product: Complex<S>,
    /// ∫ Q, ∫ r × Q.
    gradient: [Complex<S>; 3],
    tested: [Complex<S>; 3],
}

impl<S: Simd, const ELECTRIC: bool, const MAGNETIC: bool> Moments<S, ELECTRIC, MAGNETIC> {
    #[inline(always)]
    fn zero(simd: S) -> Self {
        let zero = Complex::zero(simd);
        Self {
            potential: zero,
            own: [zero; 3],
            other: [zero; 3],
            product: zero,
            gradient: [zero; 3],
            tested: [zero; 3],
        }
    }

    #[inline(always)]
    fn add(&mut self, inner: &Inner<S>, own: [Lanes<S>; 3], weight: Lanes<S>) {
        if ELECTRIC {
            let g = inner.potential.scaled(weight);
            let one = weight.constant(1.0);
            self.potential = self.potential.plus(one, g);
            for (c, &along) in own.iter().enumerate() {
                let vector = inner.vector[c].scaled(weight);
                self.own[c] = self.own[c].plus(along, g);
                self.other[c] = self.other[c].plus(one, vector);
                self.product = self.product.plus(along, vector);
            }
        }
        if MAGNETIC {
            let one = weight.constant(1.0);
            let q: [Complex<S>; 3] = axes!(c => inner.gradient[c].scaled(weight));
            let tested = crossed(own, q);
            for c in 0..3 {
                self.gradient[c] = self.gradient[c].plus(one, q[c]);
                self.tested[c] = self.tested[c].plus(one, tested[c]);
            }
        }
    }

    /// Adds the entries of all pairs of corners to register `at` of the values; `shift` goes from
    /// the centre of the sources to that of the observers.
    #[inline(always)]
    #[allow(clippy::too_many_arguments, reason = "two triangles, one medium and where to write")]
    fn write<const LOSSY: bool>(
        &self,
        wave: &Kernel<S, LOSSY>,
        fade: Lanes<S>,
        shift: [Lanes<S>; 3],
        observers: &Eights,
        sources: &Eights,
        at: usize,
        out: &mut Values,
    ) {
        let simd = fade.simd();
        // With e = s + r from the sources' centre to the point, and the shift s: ∫ e × Q = s × ∫ Q
        // + ∫ r × Q, and ∫ r·(e × Q) = −s·∫ r × Q.
        let zero = Complex::zero(simd);
        let (mut outer, mut triple) = ([zero; 3], zero);
        if MAGNETIC {
            let across = crossed(shift, self.gradient);
            outer = axes!(c => across[c].plus(fade.constant(1.0), self.tested[c]));
            triple = sub_dot(zero, shift, &self.tested);
        }
        for a in 0..3 {
            let corner = register(simd, &observers.corners[a], at);
            if ELECTRIC {
                let k = wave.medium.k;
                let charge = self.potential.times(-4.0 / (k * k));
                let rest = sub_dot(self.product, corner, &self.other);
                let rest = Complex { re: rest.re + charge.re, im: rest.im + charge.im };
                let slope: [Complex<S>; 3] = axes!(c => self.own[c].plus(-corner[c], self.potential));
                for b in 0..3 {
                    let value = sub_dot(rest, register(simd, &sources.corners[b], at), &slope);
                    let value = value.times(Complex64::I * k).scaled(fade);
                    value.store(&mut out.electric[3 * a + b], at);
                }
            }
            if MAGNETIC {
                let rest = sub_dot(triple, corner, &outer);
                let across = crossed(corner, self.gradient);
                let slope: [Complex<S>; 3] = axes!(c => across[c].plus(-fade.constant(1.0), self.tested[c]));
                for b in 0..3 {
                    let value = sub_dot(rest, register(simd, &sources.corners[b], at), &slope);
                    value.scaled(fade).store(&mut out.magnetic[3 * a + b], at);
                }
            }
        }
    }
}

impl<S: Simd> Complex<S> {
    /// Writes to register `at`.
    #[inline(always)]
    pub(crate) fn store(self, out: &mut [Eight; 2], at: usize) {
        let lanes = at * S::F64_LANES..(at + 1) * S::F64_LANES;
        self.re.store(&mut out[0][lanes.clone()]);
        self.im.store(&mut out[1][lanes]);
    }
}

/// value − x·v.
#[inline(always)]
fn sub_dot<S: Simd>(value: Complex<S>, x: [Lanes<S>; 3], v: &[Complex<S>; 3]) -> Complex<S> {
    value.plus(-x[0], v[0]).plus(-x[1], v[1]).plus(-x[2], v[2])
}

#[inline(always)]
fn add<S: Simd>(a: [Lanes<S>; 3], b: [Lanes<S>; 3]) -> [Lanes<S>; 3] {
    axes!(c => a[c] + b[c])
}

#[inline(always)]
pub(crate) fn sub<S: Simd>(a: [Lanes<S>; 3], b: [Lanes<S>; 3]) -> [Lanes<S>; 3] {
    axes!(c => a[c] - b[c])
}

#[inline(always)]
pub(crate) fn dot<S: Simd>(a: [Lanes<S>; 3], b: [Lanes<S>; 3]) -> Lanes<S> {
    a[2].mul_add(b[2], a[1].mul_add(b[1], a[0] * b[0]))
}

/// Real a × complex b.
#[inline(always)]
fn crossed<S: Simd>(a: [Lanes<S>; 3], b: [Complex<S>; 3]) -> [Complex<S>; 3] {
    axes!(c => {
        let (d, e) = ((c + 1) % 3, (c + 2) % 3);
        b[e].scaled(a[d]).plus(-a[e], b[d])
    })
}

/// Eight points of a current: places (m), J dA, and div J dA, real and imaginary.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct Sources {
    pub(crate) places: [Eight; 3],
    pub(crate) current: [[Eight; 2]; 3],
    pub(crate) charge: [Eight; 2],
}

/// What is seen of currents from a point, with q = (1 + jkR) g/R² d: Σ g J, Σ q div J and Σ J × q,
/// one sum a lane.
pub(crate) type Sums = [[Eight; 2]; 9];

/// Adds what a point sees of some sources.
pub(crate) struct Seen<'a> {
    pub(crate) medium: Medium,
    pub(crate) point: Vec3,
    pub(crate) sources: &'a [Sources],
    /// Bound of the distance, m.
    pub(crate) reach: f64,
    pub(crate) sums: &'a mut Sums,
}

impl WithSimd for Seen<'_> {
    type Output = ();

    #[inline(always)]
    fn with_simd<S: Simd>(self, simd: S) {
        if self.medium.lossy { self.run::<S, true>(simd) } else { self.run::<S, false>(simd) }
    }
}

impl Seen<'_> {
    #[inline(always)]
    fn run<S: Simd, const LOSSY: bool>(self, simd: S) {
        let wave = Kernel::<S, LOSSY>::new(simd, self.medium, self.reach);
        let point = splat(simd, self.point);
        let (zero, one) = (Lanes::splat(simd, 0.0), Lanes::splat(simd, 1.0));
        for at in 0..WIDTH / S::F64_LANES {
            let read = |part: &[Eight; 2]| Complex {
                re: Lanes::register(simd, &part[0], at),
                im: Lanes::register(simd, &part[1], at),
            };
            let mut potential = axes!(c => read(&self.sums[c]));
            let mut gradient = axes!(c => read(&self.sums[3 + c]));
            let mut curl = axes!(c => read(&self.sums[6 + c]));
            for sources in self.sources {
                let d = sub(point, register(simd, &sources.places, at));
                let (g, slope) = wave.at::<true>(d, zero, one);
                let current = axes!(c => read(&sources.current[c]));
                let charge = slope.product(read(&sources.charge));
                potential = axes!(c => potential[c].sum(g.product(current[c])));
                gradient = axes!(c => gradient[c].plus(d[c], charge));
                let bent = axes!(c => slope.product(current[c]));
                curl = axes!(c => {
                    let (u, v) = ((c + 1) % 3, (c + 2) % 3);
                    curl[c].plus(d[v], bent[u]).plus(-d[u], bent[v])
                });
            }
            for c in 0..3 {
                potential[c].store(&mut self.sums[c], at);
                gradient[c].store(&mut self.sums[3 + c], at);
                curl[c].store(&mut self.sums[6 + c], at);
            }
        }
    }
}
