//! Surface currents and the fields that they radiate.
//!
//! With J and M on the surface, in a medium with wavenumber k and impedance η (time factor
//! e^{+jωt}):
//!
//! ```text
//! E = −jkη [∫ G J dA + ∇∫ G div J dA/k²] − ∫ ∇G × M dA
//! H = ∫ ∇G × J dA − (jk/η) [∫ G M dA + ∇∫ G div M dA/k²]
//! E → F e^{−jkr}/r,   F(u) = −(jk/4π) ∫ [η (J − u (u·J)) − u × M] e^{jk u·q} dA
//! ```
//!
//! Between several regions, each has the currents on its own border, which are on the other side
//! the opposite ones.
//!
//! (C. A. Balanis, Advanced Engineering Electromagnetics, 2nd ed., Wiley 2012, ch. 6 and 7). The
//! charges are taken from the divergence of the functions, so that close to the surface, too, no
//! line charge of a triangle's border is left.

use crate::element::{Element, Functions, Part, WHOLE, shares, within};
use crate::kernel::{Medium, Seen, Sources, Sums, WIDTH};
use crate::pairs::longest_side;
use crate::rules::{CLASSES, Rule, Rules};
use crate::{Basis, MomentsError, Order};
use fredholm_mesh::Vec3;
use fredholm_quadrature::{gauss_legendre, symmetric_triangle};
use fredholm_waves::medium::IMPEDANCE;
use fredholm_waves::source::PlaneWave;
use fredholm_waves::{ComplexVector, FarField, Field, Wave};
use num_complex::Complex64;
use pulp::Arch;
use rayon::prelude::*;
use std::f64::consts::{PI, TAU};
use std::sync::OnceLock;

/// Relative error of the integral over a triangle for a field.
const TOLERANCE: f64 = 1e-6;
/// Size over that of a triangle of the parts that a point must be away from, else it is on it.
const ON_SURFACE: f64 = 1e-4;
/// Degree of the rule for the far field: 1e-6 of it at λ/6, and at λ/2 of the first full order.
const FAR_DEGREES: [usize; 2] = [8, 12];

/// What every function of a triangle has of J or M, its weight in.
type Coefficients = [Complex64; WIDTH];

/// The medium in which fields are asked for.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Space {
    /// 1/m.
    pub(crate) k: Complex64,
    /// η/η₀.
    pub(crate) impedance: Complex64,
}

/// The currents on the border of a region.
#[derive(Clone, Debug)]
struct Border {
    /// The triangles of the border, in order.
    triangles: Vec<usize>,
    /// η₀ J on each of them.
    electric: Vec<Coefficients>,
    /// M, where there is any.
    magnetic: Option<Vec<Coefficients>>,
}

impl Border {
    /// Both currents on a triangle, 0 where it is not of the border.
    fn on(&self, triangle: usize) -> [Coefficients; 2] {
        let Ok(at) = self.triangles.binary_search(&triangle) else { return Default::default() };
        self.at(at)
    }

    /// Both currents on the triangle at this place of the border.
    fn at(&self, at: usize) -> [Coefficients; 2] {
        [self.electric[at], self.magnetic.as_ref().map_or(Coefficients::default(), |magnetic| magnetic[at])]
    }
}

/// Surface currents as coefficients of the functions of a basis.
#[derive(Clone, Debug)]
pub struct Currents<'a> {
    basis: &'a Basis,
    wave: Wave,
    /// Of every region.
    borders: Vec<Border>,
}

impl<'a> Currents<'a> {
    /// From the coefficients of η₀ J and, on bodies that are no conductors, of M (both in V).
    ///
    /// # Panics
    /// Like a slice, where there are fewer coefficients than functions.
    #[must_use]
    pub fn new(basis: &'a Basis, wave: Wave, electric: &[Complex64], magnetic: Option<&[Complex64]>) -> Self {
        let regions = || basis.faces().iter().flat_map(|face| face.regions).flatten();
        let count = regions().max().map_or(1, |last| last + 1);
        let border = |region: usize| {
            let is_of = |&t: &usize| basis.faces().get(t).is_none_or(|f| f.regions.contains(&Some(region)));
            let triangles: Vec<usize> = (0..basis.surface().triangles().len()).filter(is_of).collect();
            let of = |x: &[Complex64]| on_triangles(basis, region, &triangles, x);
            Border { electric: of(electric), magnetic: magnetic.map(of), triangles }
        };
        Self { basis, wave, borders: (0..count).map(border).collect() }
    }

    /// Both currents on a triangle: of a border between dielectrics those of the side in front, of
    /// conductors the sum of both sides.
    fn on(&self, triangle: usize) -> [Coefficients; 2] {
        let Some(face) = self.basis.faces().get(triangle) else { return self.borders[0].on(triangle) };
        let [front, back] = face.regions;
        let of = |side: Option<usize>| side.map_or_else(Default::default, |r| self.borders[r].on(triangle));
        let [mut electric, magnetic] = of(front);
        if !face.conductor || back == front {
            return [electric, magnetic];
        }
        let [other, _] = of(back);
        electric.iter_mut().zip(other).for_each(|(sum, other)| *sum += other);
        [electric, magnetic]
    }

    /// J (A/m) at the centre of a triangle: on the side of its normal, on sheets of both sides
    /// together.
    ///
    /// # Panics
    /// Like a slice, where there is no such triangle.
    #[must_use]
    pub fn electric(&self, triangle: usize) -> ComplexVector {
        self.at_centre(triangle, &self.on(triangle)[0]) * (1.0 / IMPEDANCE)
    }

    /// M (V/m) at the centre of a triangle, on the side of its normal.
    ///
    /// # Panics
    /// Like a slice, where there is no such triangle.
    #[must_use]
    pub fn magnetic(&self, triangle: usize) -> ComplexVector {
        self.at_centre(triangle, &self.on(triangle)[1])
    }

    fn at_centre(&self, triangle: usize, current: &Coefficients) -> ComplexVector {
        let (element, centre) = (self.basis.surface().element(triangle), [1.0 / 3.0; 3]);
        let (sum, _) = values(&element.vectors(centre), &Functions::at(centre), current);
        sum * (1.0 / element.stretch(centre))
    }

    /// ∫ |J|² dA (A²) and ∫ |M|² dA (V²) over a triangle.
    pub(crate) fn squares(&self, triangle: usize) -> [f64; 2] {
        let products = self.basis.surface().element(triangle).products();
        let square = |current: &Coefficients| -> f64 {
            let row = |(products, a): (&[f64; WIDTH], &Complex64)| -> f64 {
                products.iter().zip(current).map(|(product, b)| product * (a.conj() * b).re).sum()
            };
            products.iter().zip(current).map(row).sum()
        };
        let [electric, magnetic] = self.on(triangle);
        [square(&electric) / (IMPEDANCE * IMPEDANCE), square(&magnetic)]
    }

    /// E and H that the currents radiate into free space, at points (m) away from the surface;
    /// above a ground plane with what their images radiate.
    ///
    /// # Errors
    /// [`MomentsError::OnSurface`] for a point on the surface, [`MomentsError::BelowGround`] for
    /// one below the ground.
    pub fn fields(&self, points: &[Vec3]) -> Result<Vec<Field>, MomentsError> {
        let space = Space { k: self.wave.wavenumber().into(), impedance: Complex64::ONE };
        let mut fields = self.fields_in(points, 0, space)?;
        if let Some(ground) = self.basis.ground() {
            if let Some(index) = points.iter().position(|p| p.z < ground.height()) {
                return Err(MomentsError::BelowGround { what: "receiver point", index });
            }
            let images: Vec<Vec3> = points.iter().map(|&p| ground.image(p)).collect();
            for (field, original) in fields.iter_mut().zip(self.fields_in(&images, 0, space)?) {
                *field += ground.field_of_image(original);
            }
        }
        Ok(fields)
    }

    /// E and H that the currents on the border of a region radiate in a medium.
    pub(crate) fn fields_in(
        &self,
        points: &[Vec3],
        region: usize,
        space: Space,
    ) -> Result<Vec<Field>, MomentsError> {
        let rules = match self.basis.order() {
            Order::Lowest => Rules::new(TOLERANCE, space.k, true)?,
            Order::First => Rules::of_first_order(TOLERANCE, space.k, true)?,
        };
        let (surface, border) = (self.basis.surface(), &self.borders[region]);
        let whole = |&triangle: &usize| {
            let element = surface.element(triangle);
            (element, Part::new(&element, WHOLE))
        };
        let elements = border.triangles.iter().map(whole).collect();
        let viewer = Viewer { border, space, rules, elements, tables: Default::default(), arch: Arch::new() };
        points.par_iter().enumerate().map(|(index, &p)| viewer.field(index, p)).collect()
    }

    /// F in these directions (any length); above a ground plane that of the images in, which is
    /// there in all directions, and means something upwards only.
    ///
    /// # Errors
    /// [`MomentsError::Parameter`] for a direction that is none.
    pub fn far_field(&self, directions: &[Vec3]) -> Result<Vec<FarField>, MomentsError> {
        let sources = self.far_sources();
        let far = |&direction: &Vec3| {
            let unit = direction.normalize_or_zero();
            if unit == Vec3::ZERO || !unit.is_finite() {
                let (what, expected) = ("the length of a direction of the far field", "finite and above 0");
                return Err(MomentsError::Parameter { what, value: direction.length(), expected });
            }
            let bare = |unit: Vec3| self.far_amplitude(unit, &sources);
            let amplitude = match self.basis.ground() {
                Some(ground) => ground.far(&self.wave, unit, bare),
                None => bare(unit),
            };
            Ok(FarField { direction: unit, amplitude })
        };
        directions.par_iter().map(far).collect()
    }

    /// Points with η₀ J dA and M dA, V m.
    fn far_sources(&self) -> Vec<(Vec3, ComplexVector, ComplexVector)> {
        // The degree is one of the table.
        let rule = symmetric_triangle(FAR_DEGREES[self.basis.order() as usize]).unwrap_or_default();
        let border = &self.borders[0];
        let mut sources = Vec::with_capacity(border.triangles.len() * rule.len());
        for (at, &triangle) in border.triangles.iter().enumerate() {
            let element = self.basis.surface().element(triangle);
            let currents = border.at(at);
            for point in &rule {
                let at = shares([point.u, point.v]);
                let (vectors, functions) = (element.vectors(at), Functions::at(at));
                let [j, m] = currents.map(|current| values(&vectors, &functions, &current).0);
                sources.push((element.point(at), j * point.weight, m * point.weight));
            }
        }
        sources
    }

    fn far_amplitude(&self, u: Vec3, sources: &[(Vec3, ComplexVector, ComplexVector)]) -> ComplexVector {
        let k = self.wave.wavenumber();
        let (mut electric, mut magnetic) = (ComplexVector::ZERO, ComplexVector::ZERO);
        for &(q, j, m) in sources {
            let phase = Complex64::cis(k * u.dot(q));
            electric += j * phase;
            magnetic += m * phase;
        }
        let across = electric - ComplexVector::along(u, electric.dot(u)) - magnetic.crossed_by(u);
        across * Complex64::new(0.0, -k / (4.0 * PI))
    }

    /// Power (W) that the currents radiate into free space: ∮ |F|²/(2η₀) over all directions, above
    /// a ground plane over those upwards.
    ///
    /// # Errors
    /// Those of [`Currents::far_field`].
    pub fn radiated_power(&self) -> Result<f64, MomentsError> {
        let vertices = self.basis.surface().vertices();
        let image = |v: &Vec3| self.basis.ground().map_or(*v, |ground| ground.image(*v));
        let extent = vertices.iter().map(|v| v.length().max(image(v).length())).fold(0.0, f64::max);
        // F has the angular bandwidth k times the radius around the origin, |F|² twice that.
        let rings = (self.wave.wavenumber() * extent).ceil() as usize + 12;
        let rule = gauss_legendre(rings);
        let mut directions = Vec::with_capacity(2 * rings * rings);
        for &height in &rule.points {
            let (cos, sin) = (2.0 * height - 1.0, 2.0 * (height * (1.0 - height)).sqrt());
            let around = |i: usize| TAU * i as f64 / (2 * rings) as f64;
            directions
                .extend((0..2 * rings).map(|i| Vec3::new(sin * around(i).cos(), sin * around(i).sin(), cos)));
        }
        let pattern = self.far_field(&directions)?;
        let ring = |(ring, weight): (&[FarField], &f64)| {
            weight * ring.iter().map(|far| far.amplitude.norm_squared()).sum::<f64>()
        };
        let sum: f64 = pattern.chunks(2 * rings).zip(&rule.weights).map(ring).sum();
        // With a ground plane the directions downwards have the mirror image.
        let share = if self.basis.ground().is_some() { 0.5 } else { 1.0 };
        Ok(share * sum * 4.0 * PI / (2 * rings) as f64 / (2.0 * IMPEDANCE))
    }

    /// Power (W) that is taken from a plane wave, scattered or absorbed, by the optical theorem:
    /// the far field straight ahead interferes with the wave, above a ground plane with the wave
    /// that the plane reflects.
    ///
    /// # Errors
    /// Those of [`Currents::far_field`].
    pub fn extinguished_power(&self, source: &PlaneWave) -> Result<f64, MomentsError> {
        let source = match self.basis.ground() {
            Some(ground) => &ground.reflected(&self.wave, source)?,
            None => source,
        };
        let ahead = self.far_field(&[source.travel()])?;
        let forward = ahead[0].amplitude.dot(source.polarisation()) * source.amplitude().conj();
        Ok(-2.0 * PI * forward.im / (self.wave.wavenumber() * IMPEDANCE))
    }
}

/// The currents on some triangles of the border of a region, from the coefficients of functions.
fn on_triangles(
    basis: &Basis,
    region: usize,
    triangles: &[usize],
    coefficients: &[Complex64],
) -> Vec<Coefficients> {
    let mut all = vec![Coefficients::default(); basis.surface().triangles().len()];
    for (function, &x) in basis.functions().iter().zip(coefficients) {
        for half in function.halves.iter().filter(|half| half.region == region) {
            all[half.triangle as usize][usize::from(half.number)] += x * half.weight;
        }
    }
    triangles.iter().map(|&triangle| all[triangle]).collect()
}

/// √g times a current, and times its divergence, at a point.
fn values(
    vectors: &[Vec3; WIDTH],
    functions: &Functions,
    current: &Coefficients,
) -> (ComplexVector, Complex64) {
    let (mut sum, mut charge) = (ComplexVector::ZERO, Complex64::ZERO);
    for ((&vector, own), &x) in vectors.iter().zip(functions.charges).zip(current) {
        sum += ComplexVector::along(vector, x);
        charge += x * own;
    }
    (sum, charge)
}

/// The points of a current on a part of a triangle, which has a share of the unit triangle: in
/// eights, the last filled up with points that have none.
fn points(element: &Element, part: &Part, share: f64, rule: &Rule, current: &Coefficients) -> Vec<Sources> {
    let mut sources = vec![Sources::default(); rule.points.len().div_ceil(WIDTH)];
    for lane in 0..sources.len() * WIDTH {
        let point = lane.min(rule.points.len() - 1);
        let at = within(&part.corners, shares(rule.points[point]));
        let (eight, lane) = (&mut sources[lane / WIDTH], lane % WIDTH);
        let place = element.point(at);
        (0..3).for_each(|c| eight.places[c][lane] = place[c]);
        if lane != point % WIDTH {
            continue;
        }
        let weight = rule.weights[point] * share;
        let (sum, charge) = values(&element.vectors(at), &Functions::at(at), current);
        for (own, value) in eight.current.iter_mut().zip(sum.components()) {
            (own[0][lane], own[1][lane]) = (value.re * weight, value.im * weight);
        }
        let charge = charge * weight;
        (eight.charge[0][lane], eight.charge[1][lane]) = (charge.re, charge.im);
    }
    sources
}

/// The points of all triangles by one rule, of η₀ J and M.
type Tables = [Vec<Vec<Sources>>; 2];

/// What computes fields at points.
struct Viewer<'a> {
    border: &'a Border,
    space: Space,
    rules: Rules,
    elements: Vec<(Element, Part)>,
    /// By rule.
    tables: [OnceLock<Tables>; CLASSES],
    arch: Arch,
}

impl Viewer<'_> {
    fn field(&self, point: usize, p: Vec3) -> Result<Field, MomentsError> {
        let mut sums = [[[[0.0; WIDTH]; 2]; 9]; 2];
        for (triangle, (_, part)) in self.elements.iter().enumerate() {
            if let Some(class) = self.class(p, part) {
                let tables = self.tables[class].get_or_init(|| self.tables(class));
                for (table, sums) in tables.iter().zip(&mut sums).filter(|(table, _)| !table.is_empty()) {
                    self.see(p, &table[triangle], part, sums);
                }
            } else if !self.add_close(p, triangle, part, 1.0, &mut sums) {
                let triangle = self.border.triangles[triangle];
                return Err(MomentsError::OnSurface { point, triangle });
            }
        }
        let [electric, magnetic] = sums.map(|sums| radiated(&sums, self.space.k));
        let impedance = self.space.impedance;
        let e = electric.e * impedance - magnetic.h;
        let h = electric.h + magnetic.e * impedance.inv();
        Ok(Field { e, h: h * (1.0 / IMPEDANCE) })
    }

    fn class(&self, p: Vec3, part: &Part) -> Option<usize> {
        self.rules.class(p.distance(part.centre) / part.radius, part.radius)
    }

    fn tables(&self, class: usize) -> Tables {
        let rule = &self.rules.classes[class];
        let of = |currents: &Vec<Coefficients>| {
            let elements = self.elements.iter().zip(currents);
            elements.map(|((element, part), current)| points(element, part, 1.0, rule, current)).collect()
        };
        [of(&self.border.electric), self.border.magnetic.as_ref().map_or_else(Vec::new, of)]
    }

    fn see(&self, p: Vec3, sources: &[Sources], part: &Part, sums: &mut Sums) {
        let medium = Medium::new(self.space.k);
        let reach = p.distance(part.centre) + part.radius;
        self.arch.dispatch(Seen { medium, point: p, sources, reach, sums });
    }

    /// Adds what a point sees of a part of a triangle that is close, halved until a rule suits;
    /// false where it is on it.
    fn add_close(&self, p: Vec3, triangle: usize, part: &Part, share: f64, sums: &mut [Sums; 2]) -> bool {
        let (element, whole) = &self.elements[triangle];
        if let Some(class) = self.class(p, part) {
            let rule = &self.rules.classes[class];
            let magnetic = self.border.magnetic.as_ref();
            let currents = std::iter::once(&self.border.electric).chain(magnetic);
            for (currents, sums) in currents.zip(sums) {
                self.see(p, &points(element, part, share, rule, &currents[triangle]), part, sums);
            }
            return true;
        }
        part.radius > ON_SURFACE * whole.radius
            && part
                .halves(element, longest_side(part.places))
                .iter()
                .all(|half| self.add_close(p, triangle, half, 0.5 * share, sums))
    }
}

/// E and H of an electric current in a medium of impedance 1: −jk/4π (Σ g J − Σ q div J/k²) and Σ J
/// × q/4π.
fn radiated(sums: &Sums, k: Complex64) -> Field {
    let total = |part: &[[f64; WIDTH]; 2]| {
        let [re, im] = part.map(|lanes| lanes.iter().sum());
        Complex64::new(re, im)
    };
    let vector = |first: usize| ComplexVector::from_components([0, 1, 2].map(|c| total(&sums[first + c])));
    let e = (vector(0) - vector(3) * (k * k).inv()) * (-Complex64::I * k / (4.0 * PI));
    Field { e, h: vector(6) * (0.25 / PI) }
}
