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
//! Between several regions, each has the currents on its own border, which are on the other side the
//! opposite ones.
//!
//! (C. A. Balanis, Advanced Engineering Electromagnetics, 2nd ed., Wiley 2012, ch. 6 and 7). The
//! charges are taken from the divergence of the functions, so that close to the surface, too, no
//! line charge of a triangle's border is left.

use crate::kernel::{Eights, Medium, Points, Seen, WIDTH};
use crate::rules::{CLASSES, Rules};
use crate::set::Shape;
use crate::{Basis, MomentsError};
use fredholm_mesh::Vec3;
use fredholm_quadrature::{gauss_legendre, symmetric_triangle};
use fredholm_waves::medium::IMPEDANCE;
use fredholm_waves::source::PlaneWave;
use fredholm_waves::{ComplexVector, FarField, Field, Wave};
use num_complex::Complex64;
use pulp::Arch;
use rayon::prelude::*;
use std::f64::consts::{PI, TAU};

/// Relative error of the integral over a triangle for a field.
const TOLERANCE: f64 = 1e-6;
/// Distance over the size of a triangle below which a point is on it.
const ON_SURFACE: f64 = 1e-4;
/// Halvings after which a part of a triangle is taken as it is.
const MOST_HALVINGS: usize = 40;
/// Degree of the rule for the far field: 1e-6 of it at λ/6.
const FAR_DEGREE: usize = 8;

/// J and M of a triangle, a + b r′ with r′ from its centre, times twice its area.
#[derive(Clone, Copy, Debug, Default)]
struct Linear {
    constant: ComplexVector,
    slope: Complex64,
}

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
    electric: Vec<Linear>,
    /// M, where there is any.
    magnetic: Option<Vec<Linear>>,
}

impl Border {
    /// Both currents on a triangle, 0 where it is not of the border.
    fn on(&self, triangle: usize) -> [Linear; 2] {
        let Ok(at) = self.triangles.binary_search(&triangle) else { return Default::default() };
        self.at(at)
    }

    /// Both currents on the triangle at this place of the border.
    fn at(&self, at: usize) -> [Linear; 2] {
        [self.electric[at], self.magnetic.as_ref().map_or(Linear::default(), |magnetic| magnetic[at])]
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
            let of = |x: &[Complex64]| linear(basis, region, &triangles, x);
            Border { electric: of(electric), magnetic: magnetic.map(of), triangles }
        };
        Self { basis, wave, borders: (0..count).map(border).collect() }
    }

    /// Both currents on a triangle, twice its area times: of a border between dielectrics those of
    /// the side in front, of conductors the sum of both sides.
    fn on(&self, triangle: usize) -> [Linear; 2] {
        let Some(face) = self.basis.faces().get(triangle) else { return self.borders[0].on(triangle) };
        let [front, back] = face.regions;
        let of = |side: Option<usize>| side.map_or_else(Default::default, |r| self.borders[r].on(triangle));
        let [electric, magnetic] = of(front);
        if !face.conductor || back == front {
            return [electric, magnetic];
        }
        let [other, _] = of(back);
        let sum =
            Linear { constant: electric.constant + other.constant, slope: electric.slope + other.slope };
        [sum, magnetic]
    }

    /// J (A/m) at the centre of a triangle: on the side of its normal, on sheets of both sides
    /// together.
    ///
    /// # Panics
    /// Like a slice, where there is no such triangle.
    #[must_use]
    pub fn electric(&self, triangle: usize) -> ComplexVector {
        let [electric, _] = self.on(triangle);
        electric.constant * (0.5 / (self.basis.surface().area(triangle) * IMPEDANCE))
    }

    /// M (V/m) at the centre of a triangle, on the side of its normal.
    ///
    /// # Panics
    /// Like a slice, where there is no such triangle.
    #[must_use]
    pub fn magnetic(&self, triangle: usize) -> ComplexVector {
        let [_, magnetic] = self.on(triangle);
        magnetic.constant * (0.5 / self.basis.surface().area(triangle))
    }

    /// ∫ |J|² dA (A²) and ∫ |M|² dA (V²) over a triangle.
    pub(crate) fn squares(&self, triangle: usize) -> [f64; 2] {
        let shape = Shape::new(self.basis.surface().corners(triangle));
        let spread = shape.corners.iter().map(|corner| corner.length_squared()).sum::<f64>() / 12.0;
        let area = self.basis.surface().area(triangle);
        let square = |current: &Linear| {
            (current.constant.norm_squared() + spread * current.slope.norm_sqr()) / (4.0 * area)
        };
        let [electric, magnetic] = self.on(triangle);
        [square(&electric) / (IMPEDANCE * IMPEDANCE), square(&magnetic)]
    }

    /// E and H that the currents radiate into free space, at points (m) away from the surface; above
    /// a ground plane with what their images radiate.
    ///
    /// # Errors
    /// [`MomentsError::OnSurface`] for a point on the surface, [`MomentsError::BelowGround`] for one
    /// below the ground.
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
        let rules = Rules::new(TOLERANCE, space.k, true)?;
        let (surface, border) = (self.basis.surface(), &self.borders[region]);
        let shapes: Vec<Shape> = border.triangles.iter().map(|&t| Shape::new(surface.corners(t))).collect();
        let viewer = Viewer { border, space, rules, shapes, arch: Arch::new() };
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
        let rule = symmetric_triangle(FAR_DEGREE).unwrap_or_default();
        let border = &self.borders[0];
        let mut sources = Vec::with_capacity(border.triangles.len() * rule.len());
        for (at, &triangle) in border.triangles.iter().enumerate() {
            let shape = Shape::new(self.basis.surface().corners(triangle));
            let [electric, magnetic] = border.at(at);
            for point in &rule {
                let p = shape.point([point.u, point.v]);
                let at = |current: Linear| current.at(p) * point.weight;
                sources.push((shape.centre + p, at(electric), at(magnetic)));
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

    /// Power (W) that the currents radiate into free space: ∮ |F|²/(2η₀) over all directions, above a
    /// ground plane over those upwards.
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
    /// the far field straight ahead interferes with the wave, above a ground plane with the wave that
    /// the plane reflects.
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

/// The currents on some triangles of the border of a region, from the coefficients.
fn linear(basis: &Basis, region: usize, triangles: &[usize], coefficients: &[Complex64]) -> Vec<Linear> {
    let surface = basis.surface();
    let mut all = vec![Linear::default(); surface.triangles().len()];
    for (function, &x) in basis.functions().iter().zip(coefficients) {
        for half in function.halves.iter().filter(|half| half.region == region) {
            let triangle = half.triangle as usize;
            let corner = surface.corners(triangle)[usize::from(half.corner)] - surface.centre(triangle);
            all[triangle].constant += ComplexVector::along(corner, x * -half.weight);
            all[triangle].slope += x * half.weight;
        }
    }
    triangles.iter().map(|&triangle| all[triangle]).collect()
}

impl Linear {
    /// At a point relative to the centre.
    fn at(&self, p: Vec3) -> ComplexVector {
        self.constant + ComplexVector::along(p, self.slope)
    }
}

/// What computes fields at points.
struct Viewer<'a> {
    border: &'a Border,
    space: Space,
    rules: Rules,
    shapes: Vec<Shape>,
    arch: Arch,
}

/// A part of a triangle that waits for its rule.
#[derive(Clone, Copy)]
struct Part {
    /// Its place in the border.
    triangle: usize,
    shape: Shape,
    share: f64,
}

impl Viewer<'_> {
    fn field(&self, point: usize, p: Vec3) -> Result<Field, MomentsError> {
        let mut waiting: [Vec<Part>; CLASSES] = Default::default();
        let mut field = Field::ZERO;
        for (triangle, &shape) in self.shapes.iter().enumerate() {
            if distance(p, shape.places) < ON_SURFACE * shape.radius {
                let triangle = self.border.triangles[triangle];
                return Err(MomentsError::OnSurface { point, triangle });
            }
            self.add(p, Part { triangle, shape, share: 1.0 }, 0, &mut waiting, &mut field);
        }
        for (class, parts) in waiting.iter_mut().enumerate() {
            self.flush(p, class, parts, &mut field);
        }
        Ok(field)
    }

    fn add(&self, p: Vec3, part: Part, depth: usize, waiting: &mut [Vec<Part>; CLASSES], field: &mut Field) {
        let ratio = p.distance(part.shape.centre) / part.shape.radius;
        let class = self.rules.class(ratio, part.shape.radius);
        if class.is_some() || depth >= MOST_HALVINGS {
            let class = class.unwrap_or(CLASSES - 1);
            waiting[class].push(part);
            if waiting[class].len() == WIDTH {
                self.flush(p, class, &mut waiting[class], field);
            }
            return;
        }
        for half in crate::pairs::halves_of(part.shape.places) {
            let part = Part { shape: Shape::new(half), share: 0.5 * part.share, ..part };
            self.add(p, part, depth + 1, waiting, field);
        }
    }

    /// Adds the fields of the parts that wait for a rule.
    fn flush(&self, p: Vec3, class: usize, parts: &mut Vec<Part>, field: &mut Field) {
        let Some(&last) = parts.last() else { return };
        let rule = &self.rules.classes[class];
        let mut eights = Eights::default();
        let mut points = vec![[[0.0; WIDTH]; 3]; rule.points.len()];
        let mut spread = 0.0_f64;
        for lane in 0..WIDTH {
            let shape = parts.get(lane).unwrap_or(&last).shape;
            spread = spread.max(shape.radius);
            eights.set(lane, shape.centre, shape.corners);
            for (place, &uv) in points.iter_mut().zip(&rule.points) {
                let q = shape.point(uv);
                (0..3).for_each(|axis| place[axis][lane] = q[axis]);
            }
        }
        let sources = Points { triangles: &eights, places: &points, weights: &rule.weights };
        let mut out = [[[0.0; WIDTH]; 2]; 7];
        let medium = Medium::new(self.space.k);
        self.arch.dispatch(Seen { medium, point: p, sources, spread, out: &mut out });
        for (lane, part) in parts.drain(..).enumerate() {
            let read = |i: usize| Complex64::new(out[i][0][lane], out[i][1][lane]) * part.share;
            *field += self.of_part(p, &part, std::array::from_fn(read));
        }
    }

    /// The field of the currents on a part, from the integrals over it.
    fn of_part(&self, p: Vec3, part: &Part, [g, x, y, z, u, v, w]: [Complex64; 7]) -> Field {
        let integrals =
            (g, ComplexVector::from_components([x, y, z]), ComplexVector::from_components([u, v, w]));
        // The currents are known about the centre of the whole triangle.
        let shift = part.shape.centre - self.shapes[part.triangle].centre;
        let at = |current: Linear| Linear { constant: current.at(shift), ..current };
        let e = p - part.shape.centre;
        let Space { k, impedance } = self.space;
        let [e_j, h_j] = element(at(self.border.electric[part.triangle]), k, e, integrals);
        let mut field = Field { e: e_j * impedance, h: h_j };
        if let Some(magnetic) = &self.border.magnetic {
            let [e_m, h_m] = element(at(magnetic[part.triangle]), k, e, integrals);
            field.e = field.e - h_m;
            field.h += e_m * impedance.inv();
        }
        Field { h: field.h * (1.0 / IMPEDANCE), ..field }
    }
}

/// E and H of an electric current in a medium of impedance 1, `e` from the centre: −jk (A − Q
/// div/k²) and J(e) × Q.
fn element(
    current: Linear,
    k: Complex64,
    e: Vec3,
    (g, vector, q): (Complex64, ComplexVector, ComplexVector),
) -> [ComplexVector; 2] {
    let potential = current.constant * g + vector * current.slope;
    let charge = q * (2.0 * current.slope / (k * k));
    let electric = (potential - charge) * (-Complex64::I * k / (4.0 * PI));
    let [a, b] = [current.at(e), q].map(ComplexVector::components);
    let cross = [0, 1, 2].map(|c| {
        let (d, f) = ((c + 1) % 3, (c + 2) % 3);
        (a[d] * b[f] - a[f] * b[d]) / (4.0 * PI)
    });
    [electric, ComplexVector::from_components(cross)]
}

/// Distance of a point from a triangle, m.
fn distance(p: Vec3, [a, b, c]: [Vec3; 3]) -> f64 {
    let normal = (b - a).cross(c - a);
    let inside =
        [[a, b], [b, c], [c, a]].iter().all(|&[from, to]| (to - from).cross(p - from).dot(normal) >= 0.0);
    if inside {
        return ((p - a).dot(normal) / normal.length()).abs();
    }
    let to_side = |[from, to]: [Vec3; 2]| {
        let along = ((p - from).dot(to - from) / from.distance_squared(to)).clamp(0.0, 1.0);
        p.distance(from + along * (to - from))
    };
    [[a, b], [b, c], [c, a]].into_iter().map(to_side).fold(f64::INFINITY, f64::min)
}
