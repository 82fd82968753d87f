//! The far fields of the functions on a conductor, for multilevel fast multipoles.
//!
//! With F = ∫ e^{jk k̂·(r − c)} f dA and the same G of the dual function (of the first full order,
//! of f × n), relative to the middle c of a box and across k̂, the entries of the equations
//! (`equation`, `operator`) between far boxes are
//!
//! ```text
//! Z_mn = k²/(4π)² ∮ [α F_m* + (1 − α) G_m* × k̂]·F_n T(k̂) d²k̂
//! ```
//!
//! since ∇ on the wave of a direction is −jk k̂: jk ∫∫ G (f·f′ − div f div f′/k²) leaves the parts
//! of both across k̂, and ∫∫ g·(∇G × f′) leaves −jk k̂ × f′.

#![allow(clippy::inline_always, reason = "what is not inlined is compiled for the narrowest vectors")]

use crate::element::{Part, WHOLE, shares};
use crate::element_kernel::Tests;
use crate::kernel::WIDTH;
use crate::operator::Operator;
use crate::rules::{Rule, Rules};
use crate::{Basis, MomentsError, Order, Set};
use fredholm_compressed::{Direction, Entries, Multipole, MultipoleSettings, MultipoleSummary, Patterns};
use fredholm_linop::{Symmetry, Watch};
use fredholm_mesh::Vec3;
use fredholm_waves::lanes::{Lanes, cos_sin};
use num_complex::Complex64;
use pulp::{Arch, Simd, WithSimd};
use std::f64::consts::PI;

/// Numbers of a pattern for each direction: both components, real and imaginary.
const NUMBERS: usize = 4;

/// A half of a function: triangle, number, place of the function in the group, and weight.
type Placed = (u32, usize, usize, f64);

/// The equation of a conductor with the patterns of its functions.
pub(crate) struct Radiating<'a> {
    operator: &'a Operator<'a>,
    k: f64,
    /// α and 1 − α.
    shares: [f64; 2],
    rules: &'a Rules,
}

impl<'a> Radiating<'a> {
    /// Of a perfect conductor in free space, for the wavenumber k.
    ///
    /// # Errors
    /// [`MomentsError::Grounded`] above a ground plane.
    pub(crate) fn new(operator: &'a Operator<'a>, k: f64, shares: [f64; 2]) -> Result<Self, MomentsError> {
        let dual = operator.dual().map(|dual| &dual.integrator.rules);
        let rules = operator.rules().or(dual).ok_or(MomentsError::Empty)?;
        if operator.basis().ground().is_some() {
            return Err(MomentsError::Grounded);
        }
        Ok(Self { operator, k, shares, rules })
    }

    pub(crate) fn multipole(
        &self,
        settings: MultipoleSettings,
        watch: &dyn Watch,
    ) -> Result<Multipole, MomentsError> {
        Ok(Multipole::new(self, &self.operator.places(), settings, watch)?)
    }

    pub(crate) fn predicted(&self, settings: MultipoleSettings) -> Result<MultipoleSummary, MomentsError> {
        Ok(Multipole::predicted(self, &self.operator.places(), settings)?)
    }

    /// The patterns of some functions of a basis, one after the other.
    fn patterns(
        &self,
        (basis, tests): (&Basis, Tests),
        groups: &[usize],
        centre: Vec3,
        directions: &Directions,
    ) -> Vec<f64> {
        let mut halves = Vec::new();
        for (at, &group) in groups.iter().enumerate() {
            let of = |half: &crate::Half| (half.triangle, usize::from(half.number), at, half.weight);
            halves.extend(basis.functions()[group].halves.iter().map(of));
        }
        halves.sort_by_key(|&(triangle, number, at, _)| (triangle, number, at));
        match basis.order() {
            Order::Lowest => self.of_lowest_order(basis, &halves, (groups.len(), centre), directions),
            Order::First => self.of_first_order((basis, tests), &halves, (groups.len(), centre), directions),
        }
    }

    /// Those of the first full order.
    fn of_first_order(
        &self,
        (basis, tests): (&Basis, Tests),
        halves: &[Placed],
        (count, centre): (usize, Vec3),
        directions: &Directions,
    ) -> Vec<f64> {
        let size = NUMBERS * directions.len;
        let mut all = vec![0.0; count * size];
        let mut wave = vec![0.0; 2 * directions.len];
        let arch = Arch::new();
        for halves in halves.chunk_by(|a, b| a.0 == b.0) {
            let element = basis.surface().element(halves[0].0 as usize).moved(|place| place - centre);
            let rule = self.rules.of_far(Part::new(&element, WHOLE).radius);
            for (&point, &weight) in rule.points.iter().zip(&rule.weights) {
                let at = shares(point);
                let (place, mut vectors) = (element.point(at), element.vectors(at));
                if tests == Tests::Turned {
                    let normal = element.normal(at);
                    vectors = vectors.map(|vector| vector.cross(normal));
                }
                arch.dispatch(Waved { k: self.k, directions, place, out: &mut wave });
                arch.dispatch(|| {
                    for &(_, number, at, own) in halves {
                        let pattern = &mut all[at * size..(at + 1) * size];
                        add_vector(directions, vectors[number] * (own * weight), &wave, pattern);
                    }
                });
            }
        }
        all
    }

    /// Those of the lowest order, from three integrals over each triangle.
    fn of_lowest_order(
        &self,
        basis: &Basis,
        halves: &[Placed],
        (count, centre): (usize, Vec3),
        directions: &Directions,
    ) -> Vec<f64> {
        let size = NUMBERS * directions.len;
        let mut all = vec![0.0; count * size];
        let mut seen = vec![0.0; (2 + NUMBERS) * directions.len];
        let arch = Arch::new();
        for halves in halves.chunk_by(|a, b| a.0 == b.0) {
            let corners = basis.surface().corners(halves[0].0 as usize).map(|corner| corner - centre);
            let middle = (corners[0] + corners[1] + corners[2]) / 3.0;
            let radius = corners.iter().map(|corner| corner.distance(middle)).fold(0.0, f64::max);
            arch.dispatch(Seen {
                k: self.k,
                directions,
                corners,
                rule: self.rules.of_far(radius),
                out: &mut seen,
            });
            arch.dispatch(|| {
                for &(_, corner, at, weight) in halves {
                    let pattern = &mut all[at * size..(at + 1) * size];
                    add_half(directions, corners[corner], weight, &seen, pattern);
                }
            });
        }
        all
    }
}

/// Directions, one array for each coordinate, filled up to whole registers.
struct Directions {
    len: usize,
    along: [Vec<f64>; 3],
    across: [[Vec<f64>; 3]; 2],
}

impl Directions {
    fn new(directions: &[Direction]) -> Self {
        let len = directions.len().next_multiple_of(WIDTH);
        let coordinate = |of: fn(&Direction) -> Vec3, axis: usize| -> Vec<f64> {
            let values = directions.iter().map(|direction| of(direction)[axis]);
            values.chain(std::iter::repeat(0.0)).take(len).collect()
        };
        let vector = |of: fn(&Direction) -> Vec3| std::array::from_fn(|axis| coordinate(of, axis));
        Self { len, along: vector(|d| d.along), across: [vector(|d| d.theta), vector(|d| d.phi)] }
    }
}

/// ∫ e^{jk k̂·r} and both components of ∫ e^{jk k̂·r} r over the unit triangle, real and imaginary.
struct Seen<'a> {
    k: f64,
    directions: &'a Directions,
    corners: [Vec3; 3],
    rule: &'a Rule,
    out: &'a mut [f64],
}

impl WithSimd for Seen<'_> {
    type Output = ();

    #[inline(always)]
    fn with_simd<S: Simd>(self, simd: S) {
        let Self { k, directions, corners: [a, b, c], rule, out } = self;
        out.fill(0.0);
        let len = directions.len;
        for (&[u, v], &weight) in rule.points.iter().zip(&rule.weights) {
            let p = (a + u * (b - a) + v * (c - a)).to_array();
            let place = [Lanes::splat(simd, p[0]), Lanes::splat(simd, p[1]), Lanes::splat(simd, p[2])];
            let (k, weight) = (Lanes::splat(simd, k), Lanes::splat(simd, weight));
            for at in 0..len / S::F64_LANES {
                let first = at * S::F64_LANES;
                let phase = k * along(simd, &directions.along, at, &place);
                let (cos, sin) = cos_sin(phase);
                let (cos, sin) = (weight * cos, weight * sin);
                let one = along(simd, &directions.across[0], at, &place);
                let other = along(simd, &directions.across[1], at, &place);
                let mut add = |line: usize, value: Lanes<S>| {
                    let sum = &mut out[line * len + first..line * len + first + S::F64_LANES];
                    (Lanes::load(simd, sum) + value).store(sum);
                };
                add(0, cos);
                add(1, sin);
                add(2, one * cos);
                add(3, one * sin);
                add(4, other * cos);
                add(5, other * sin);
            }
        }
    }
}

/// e^{jk k̂·r} at a point, real and imaginary.
struct Waved<'a> {
    k: f64,
    directions: &'a Directions,
    place: Vec3,
    out: &'a mut [f64],
}

impl WithSimd for Waved<'_> {
    type Output = ();

    #[inline(always)]
    fn with_simd<S: Simd>(self, simd: S) {
        let Self { k, directions, place, out } = self;
        let place = [Lanes::splat(simd, place.x), Lanes::splat(simd, place.y), Lanes::splat(simd, place.z)];
        let (re, im) = out.split_at_mut(directions.len);
        let k = Lanes::splat(simd, k);
        for at in 0..directions.len / S::F64_LANES {
            let lanes = at * S::F64_LANES..(at + 1) * S::F64_LANES;
            let (cos, sin) = cos_sin(k * along(simd, &directions.along, at, &place));
            cos.store(&mut re[lanes.clone()]);
            sin.store(&mut im[lanes]);
        }
    }
}

/// Adds the components of a vector across the directions times a wave.
#[inline(always)]
fn add_vector(directions: &Directions, vector: Vec3, wave: &[f64], pattern: &mut [f64]) {
    let len = directions.len;
    let (re, im) = wave.split_at(len);
    for component in 0..2 {
        let [x, y, z] = &directions.across[component];
        let (x, y, z) = (&x[..len], &y[..len], &z[..len]);
        let pattern = &mut pattern[2 * component * len..][..2 * len];
        let (out_re, out_im) = pattern.split_at_mut(len);
        for k in 0..len {
            let across = vector.x * x[k] + vector.y * y[k] + vector.z * z[k];
            out_re[k] += across * re[k];
            out_im[k] += across * im[k];
        }
    }
}

/// The product of a vector with those of a register of directions.
#[inline(always)]
fn along<S: Simd>(simd: S, vectors: &[Vec<f64>; 3], at: usize, place: &[Lanes<S>; 3]) -> Lanes<S> {
    let [x, y, z] = vectors;
    let x = Lanes::register(simd, x, at) * place[0];
    let xy = Lanes::register(simd, y, at).mul_add(place[1], x);
    Lanes::register(simd, z, at).mul_add(place[2], xy)
}

/// Adds weight ∫ e^{jk k̂·r} (r − v).
#[inline(always)]
fn add_half(directions: &Directions, corner: Vec3, weight: f64, seen: &[f64], pattern: &mut [f64]) {
    let len = directions.len;
    let (re, im) = (&seen[..len], &seen[len..2 * len]);
    for component in 0..2 {
        let [x, y, z] = &directions.across[component];
        let (x, y, z) = (&x[..len], &y[..len], &z[..len]);
        let own = &seen[(2 + 2 * component) * len..][..2 * len];
        let (own_re, own_im) = own.split_at(len);
        let pattern = &mut pattern[2 * component * len..][..2 * len];
        let (out_re, out_im) = pattern.split_at_mut(len);
        for k in 0..len {
            let back = corner.x * x[k] + corner.y * y[k] + corner.z * z[k];
            out_re[k] += weight * (own_re[k] - back * re[k]);
            out_im[k] += weight * (own_im[k] - back * im[k]);
        }
    }
}

impl Entries<Complex64> for Radiating<'_> {
    type Set = Set;

    fn groups(&self) -> usize {
        self.operator.groups()
    }

    fn width(&self, group: usize) -> usize {
        self.operator.width(group)
    }

    fn symmetry(&self) -> Symmetry {
        self.operator.symmetry()
    }

    fn prepare(&self, groups: &[usize]) -> Set {
        Operator::prepare(self.operator, groups.iter().copied())
    }

    fn fill(&self, rows: &Set, columns: &Set, out: &mut [Complex64]) {
        self.operator.fill(rows, columns, out);
    }
}

impl Patterns for Radiating<'_> {
    fn wavenumber(&self) -> f64 {
        self.k
    }

    fn factor(&self) -> Complex64 {
        (self.k / (4.0 * PI)).powi(2).into()
    }

    fn share(&self) -> f64 {
        self.shares[0]
    }

    fn has_magnetic(&self) -> bool {
        self.shares[1] != 0.0
    }

    fn radius(&self, group: usize) -> f64 {
        let place = self.operator.basis().centre(group);
        let of = |basis: &Basis| {
            let triangles = basis.functions()[group].halves.iter().map(|half| half.triangle as usize);
            let reach = |triangle| basis.surface().element(triangle).reach(place);
            triangles.map(reach).fold(0.0, f64::max)
        };
        of(self.operator.basis()).max(self.operator.dual().map_or(0.0, |dual| of(&dual.basis)))
    }

    fn write(&self, groups: &[usize], centre: Vec3, directions: &[Direction], out: &mut [f32]) {
        let count = directions.len();
        let directions = Directions::new(directions);
        let basis = self.operator.basis();
        let own = self.patterns((basis, Tests::Straight), groups, centre, &directions);
        let size = NUMBERS * if self.has_magnetic() { 2 } else { 1 } * count;
        let len = directions.len;
        for (pattern, out) in own.chunks_exact(NUMBERS * len).zip(out.chunks_exact_mut(size)) {
            for (line, out) in pattern.chunks_exact(len).zip(out.chunks_exact_mut(count)) {
                out.iter_mut().zip(line).for_each(|(out, &value)| *out = value as f32);
            }
        }
        if !self.has_magnetic() {
            return;
        }
        let tests = match self.operator.dual() {
            Some(dual) => (&*dual.basis, Tests::Straight),
            None => (basis, Tests::Turned),
        };
        let tests = self.patterns(tests, groups, centre, &directions);
        // (1 − α) G* × k̂ has the components G_φ* and −G_θ*; the factor of the part is −(1 − α).
        let lines =
            [(2, -1.0), (3, 1.0), (0, 1.0), (1, -1.0)].map(|(line, sign)| (line, -sign * self.shares[1]));
        for (pattern, out) in tests.chunks_exact(NUMBERS * len).zip(out.chunks_exact_mut(size)) {
            let out = &mut out[NUMBERS * count..];
            for ((line, factor), out) in lines.into_iter().zip(out.chunks_exact_mut(count)) {
                let line = &pattern[line * len..];
                out.iter_mut().zip(line).for_each(|(out, &value)| *out = (factor * value) as f32);
            }
        }
    }
}
