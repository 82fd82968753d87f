//! Bodies whose scattered far field is known: from the series of Mie, or from Galerkin boundary
//! elements.

#![allow(dead_code, reason = "every example uses its part")]
#![allow(clippy::unwrap_used, reason = "an example shows the way, not what may go wrong on it")]

use super::common::{WAVELENGTH, solved, wave};
use fredholm_mesh::{Cutting, Lines, MeshBuilder, Shape, Vec3};
use fredholm_moments::meshing::{Grading, cuboid, rectangle};
use fredholm_moments::{Basis, Conductor, Currents, Curve, Equation, Order, Surface};
use fredholm_waves::source::PlaneWave;
use fredholm_waves::surface::{cube, cuboid as cuboid_of_facets, sphere, sphere_segments};
use fredholm_waves::{Complex64, ComplexVector, ConductingSphere, Kind, Scatterer, Source, even_directions};

/// What scatters; lengths in wavelengths.
#[derive(Clone, Debug)]
pub enum Body {
    /// Rectangles: a corner and two sides.
    Plates(Vec<[Vec3; 3]>),
    /// The side of a cube.
    Cube(f64),
    /// The sides of a box.
    Box(Vec3),
    /// The radius of a sphere.
    Sphere(f64),
}

/// A body in a plane wave.
#[derive(Clone, Debug)]
pub struct Case {
    pub name: &'static str,
    pub body: Body,
    pub travel: Vec3,
    pub polarisation: Vec3,
}

impl Case {
    pub fn new(name: &'static str, body: Body, travel: [f64; 3], polarisation: [f64; 3]) -> Self {
        Self { name, body, travel: travel.into(), polarisation: polarisation.into() }
    }

    pub fn source(&self) -> PlaneWave {
        PlaneWave::new(self.travel, self.polarisation, 1.0.into()).unwrap()
    }

    /// The body with edges up to λ over `per`.
    pub fn scatterer(&self, per: f64) -> Scatterer {
        let edge = WAVELENGTH / per;
        match &self.body {
            Body::Plates(plates) => {
                let cutting = Cutting { lines: Lines::LargestEdge(edge), ..Cutting::default() };
                let mut builder = MeshBuilder::default();
                for plate in plates {
                    let [corner, u, v] = plate.map(|x| x * WAVELENGTH);
                    let corners = [corner, corner + u, corner + u + v, corner + v];
                    builder.surface("", 0);
                    builder.add(&Shape::Quad { corners, skip: Vec::new() }, &cutting).unwrap();
                }
                Scatterer::new(&builder.build(), |_| Kind::Sheet).unwrap()
            }
            Body::Cube(side) => cube(side * WAVELENGTH, edge).unwrap(),
            Body::Box(sides) => cuboid_of_facets(*sides * WAVELENGTH, edge).unwrap(),
            Body::Sphere(radius) => sphere(radius * WAVELENGTH, edge).unwrap(),
        }
    }

    /// The far field E·r e^{jkr} (V) in these directions, without approximation but the mesh of
    /// edges up to λ over `per`, halved `halvings` times towards the edges.
    pub fn truth(&self, directions: &[Vec3], per: f64, halvings: usize) -> Vec<ComplexVector> {
        Self::truths(std::slice::from_ref(self), directions, per, halvings).remove(0)
    }

    /// The same for one body in several waves.
    pub fn truths(cases: &[Self], directions: &[Vec3], per: f64, halvings: usize) -> Vec<Vec<ComplexVector>> {
        let surface = match &cases[0].body {
            Body::Sphere(radius) => {
                return cases.iter().map(|case| case.mie(radius * WAVELENGTH, directions)).collect();
            }
            body => surface(body, WAVELENGTH / per, Grading { halvings }),
        };
        Self::far_fields(cases, directions, surface, Order::Lowest)
    }

    fn far_fields(
        cases: &[Self],
        directions: &[Vec3],
        surface: Surface,
        order: Order,
    ) -> Vec<Vec<ComplexVector>> {
        let basis = Basis::of_order(surface, order).unwrap();
        let tolerance = if order == Order::First { 1e-4 } else { 1e-3 };
        let conductor = Conductor::new(&basis, wave(), Equation::Electric, tolerance).unwrap();
        let sources: Vec<PlaneWave> = cases.iter().map(Self::source).collect();
        let excitations: Vec<[&dyn Source; 1]> =
            sources.iter().map(|source| [source as &dyn Source]).collect();
        let excitations: Vec<&[&dyn Source]> = excitations.iter().map(|sources| &sources[..]).collect();
        let x = solved(&conductor.operator().coupling().unwrap(), &conductor.right_hand_side(&excitations));
        let far = |rhs: usize| {
            let currents = Currents::new(&basis, wave(), &x.vector(rhs), None);
            currents.far_field(directions).unwrap().into_iter().map(|far| far.amplitude).collect()
        };
        (0..cases.len()).map(far).collect()
    }

    /// The even mesh with edges up to λ over `per`: of spheres the triangles of
    /// [`Self::scatterer`].
    pub fn surface(&self, per: f64) -> Surface {
        match &self.body {
            Body::Sphere(radius) => {
                let (radius, edge) = (radius * WAVELENGTH, WAVELENGTH / per);
                let segments = sphere_segments(radius, edge).unwrap();
                let shape = Shape::Sphere { centre: Vec3::ZERO, radius, inward: false, segments };
                let mut builder = MeshBuilder::default();
                builder.surface("", 0);
                builder.add(&shape, &Cutting::default()).unwrap();
                Surface::from_mesh(&builder.build()).unwrap()
            }
            body => surface(body, WAVELENGTH / per, Grading::default()),
        }
    }

    /// The mesh of plates and boxes with edges up to λ over `per`, halved towards the edges.
    pub fn finer(&self, per: f64, halvings: usize) -> Surface {
        surface(&self.body, WAVELENGTH / per, Grading { halvings })
    }

    /// The mesh for functions of the first full order: spheres are curved.
    pub fn of_first_order(&self, per: f64) -> Surface {
        let flat = self.surface(per);
        let Body::Sphere(radius) = self.body else { return flat };
        let curve = Curve::Sphere { centre: Vec3::ZERO, radius: radius * WAVELENGTH };
        flat.on_curves(&vec![Some(curve); flat.triangles().len()]).unwrap()
    }

    /// The far fields of one body in several waves by functions of the first full order, with edges
    /// up to λ over `per`, halved `halvings` times towards the edges of the body; of spheres exact.
    pub fn fine_truths(
        cases: &[Self],
        directions: &[Vec3],
        per: f64,
        halvings: usize,
    ) -> Vec<Vec<ComplexVector>> {
        if let Body::Sphere(radius) = cases[0].body {
            return cases.iter().map(|case| case.mie(radius * WAVELENGTH, directions)).collect();
        }
        Self::far_fields(cases, directions, cases[0].finer(per, halvings), Order::First)
    }

    fn mie(&self, radius: f64, directions: &[Vec3]) -> Vec<ComplexVector> {
        let (ball, source) = (ConductingSphere::new(radius).unwrap(), self.source());
        far_series(directions, |p| ball.scattered(&wave(), &source, p))
    }
}

/// The far field of a series, from the field far away; the distance is in it as λ/r, some
/// millionths.
pub fn far_series(directions: &[Vec3], scattered: impl Fn(Vec3) -> ComplexVector) -> Vec<ComplexVector> {
    let far = 1e6 * WAVELENGTH;
    let back = Complex64::cis(wave().wavenumber() * far) * far;
    directions.iter().map(|&u| scattered(u * far) * back).collect()
}

fn surface(body: &Body, edge: f64, grading: Grading) -> Surface {
    match body {
        Body::Plates(plates) => {
            let mut whole: Option<Surface> = None;
            for plate in plates {
                let [corner, u, v] = plate.map(|x| x * WAVELENGTH);
                let next = rectangle(corner, u, v, edge, grading).unwrap();
                whole = Some(match whole {
                    Some(whole) => whole.with(&next).unwrap(),
                    None => next,
                });
            }
            whole.unwrap().welded(1e-6 * WAVELENGTH).unwrap()
        }
        Body::Cube(side) => cuboid(Vec3::splat(side * WAVELENGTH), edge, grading).unwrap(),
        Body::Box(sides) => cuboid(*sides * WAVELENGTH, edge, grading).unwrap(),
        Body::Sphere(_) => unreachable!("spheres have a series"),
    }
}

/// Directions that cover the sphere evenly.
pub fn directions() -> Vec<Vec3> {
    even_directions(600)
}

/// ‖a − b‖₂/‖b‖₂.
pub fn error(a: &[ComplexVector], b: &[ComplexVector]) -> f64 {
    let gap: f64 = a.iter().zip(b).map(|(a, b)| (*a - *b).norm_squared()).sum();
    (gap / b.iter().map(|b| b.norm_squared()).sum::<f64>()).sqrt()
}

fn square(centre: [f64; 3], u: [f64; 3], v: [f64; 3]) -> [Vec3; 3] {
    let [centre, u, v] = [centre, u, v].map(Vec3::from);
    [centre - 0.5 * (u + v), u, v]
}

/// A square of `side` in the plane y = `y`, `x` aside.
fn upright(side: f64, x: f64, y: f64) -> [Vec3; 3] {
    square([x, y, 0.0], [side, 0.0, 0.0], [0.0, 0.0, side])
}

/// The bodies of the table of treatments, as the example `treatments` of `fredholm-study` prints
/// it.
pub fn cases() -> Vec<Case> {
    let (y, z, x) = ([0.0, 1.0, 0.0], [0.0, 0.0, 1.0], [1.0, 0.0, 0.0]);
    let shadowed = || Body::Plates(vec![upright(3.0, 0.0, 0.0), upright(3.0, 1.5, 2.0)]);
    let turned = |angle: f64| {
        // Two plates that share the z axis and open towards −y.
        let (sin, cos) = (0.5 * angle).to_radians().sin_cos();
        let plate = |sign: f64| {
            let u = Vec3::new(sign * sin, -cos, 0.0) * 3.0;
            let v = Vec3::Z * 3.0;
            let corner = Vec3::new(0.0, 0.0, -1.5);
            if sign > 0.0 { [corner, v, u] } else { [corner, u, v] }
        };
        Body::Plates(vec![plate(1.0), plate(-1.0)])
    };
    let facing = || {
        let side = |s: f64| {
            let u = [3.0 * 0.5_f64.sqrt(), s * 3.0 * 0.5_f64.sqrt(), 0.0];
            square([-s * 3.0, 0.0, 0.0], u, [0.0, 0.0, 3.0])
        };
        Body::Plates(vec![side(1.0), side(-1.0)])
    };
    let trihedral = || {
        let corner = Vec3::ZERO;
        let [a, b, c] = [Vec3::X, Vec3::Y, Vec3::Z].map(|axis| axis * 2.0);
        Body::Plates(vec![[corner, a, b], [corner, b, c], [corner, c, a]])
    };
    vec![
        Case::new("plate 3", Body::Plates(vec![upright(3.0, 0.0, 0.0)]), y, z),
        Case::new("plate 3 at 60", Body::Plates(vec![upright(3.0, 0.0, 0.0)]), [0.866, 0.5, 0.0], z),
        Case::new(
            "plate 3 at 60 H",
            Body::Plates(vec![upright(3.0, 0.0, 0.0)]),
            [0.866, 0.5, 0.0],
            [0.5, -0.866, 0.0],
        ),
        Case::new(
            "plate 3 at 80 H",
            Body::Plates(vec![upright(3.0, 0.0, 0.0)]),
            [0.985, 0.1736, 0.0],
            [0.1736, -0.985, 0.0],
        ),
        Case::new(
            "plate 3 askew",
            Body::Plates(vec![upright(3.0, 0.0, 0.0)]),
            [0.5, 0.6, 0.4],
            [0.1, 0.3, 1.0],
        ),
        Case::new("shadowed", shadowed(), y, z),
        Case::new("shadowed H", shadowed(), y, x),
        Case::new("shadowed askew", shadowed(), [0.3, 0.9, 0.2], z),
        Case::new("two facing", facing(), y, z),
        Case::new("two facing H", facing(), y, x),
        Case::new("dihedral 90", turned(90.0), y, z),
        Case::new("dihedral 90 H", turned(90.0), y, x),
        Case::new("plates at 60", turned(60.0), y, z),
        Case::new("trihedral 2", trihedral(), [-0.577, -0.577, -0.577], [0.0, -0.5, 0.5]),
        Case::new("cube 1.6", Body::Cube(1.6), y, z),
        Case::new("cube 1.6 askew", Body::Cube(1.6), [0.5, 0.6, 0.4], [0.1, 0.3, 1.0]),
        Case::new("sphere 1", Body::Sphere(1.0), y, z),
        Case::new("sphere 2", Body::Sphere(2.0), y, z),
    ]
}

/// Runs with known answers, one list a body: plates, pairs of plates, a dihedral, cubes and spheres
/// in waves of several angles and polarisations.
pub fn calibration() -> Vec<Vec<Case>> {
    let of = |name, body| in_waves(name, &body);
    let known = cases();
    let named = |name: &str| known.iter().find(|case| case.name == name).unwrap().body.clone();
    vec![
        of("sphere 0.4", Body::Sphere(0.4)).into_iter().take(1).collect(),
        of("sphere 0.7", Body::Sphere(0.7)).into_iter().take(1).collect(),
        of("sphere 1.1", Body::Sphere(1.1)).into_iter().take(1).collect(),
        of("sphere 1.6", Body::Sphere(1.6)).into_iter().take(1).collect(),
        of("sphere 2.1", Body::Sphere(2.1)).into_iter().take(1).collect(),
        of("plate 2", Body::Plates(vec![upright(2.0, 0.0, 0.0)])),
        of("plate 3", Body::Plates(vec![upright(3.0, 0.0, 0.0)])),
        of("plate 4 x 1.5", Body::Plates(vec![square([0.0; 3], [4.0, 0.0, 0.0], [0.0, 0.0, 1.5])])),
        of("cube 1.1", Body::Cube(1.1)),
        of("cube 1.6", Body::Cube(1.6)),
        of("dihedral 90", named("dihedral 90")),
        of("shadowed", named("shadowed")),
        of("two facing", named("two facing")),
    ]
}

/// The body in waves of several angles and polarisations.
fn in_waves(name: &'static str, body: &Body) -> Vec<Case> {
    let ways = [
        ([0.0, 1.0, 0.0], [0.0, 0.0, 1.0]),
        ([0.5, 0.866, 0.0], [0.0, 0.0, 1.0]),
        ([0.5, 0.866, 0.0], [0.866, -0.5, 0.0]),
        ([0.766, 0.643, 0.0], [0.0, 0.0, 1.0]),
        ([0.766, 0.643, 0.0], [0.643, -0.766, 0.0]),
        ([0.4, 0.8, 0.45], [0.1, 0.3, 1.0]),
        ([-0.3, 0.7, -0.6], [1.0, 0.2, 0.1]),
    ];
    ways.iter().map(|&(travel, along)| Case::new(name, body.clone(), travel, along)).collect()
}

/// Sheets small enough for a mesh far finer than usual, one list a body.
pub fn small_sheets() -> Vec<Vec<Case>> {
    let of = |name, plates: Vec<[Vec3; 3]>| in_waves(name, &Body::Plates(plates));
    let slope = 0.5_f64.sqrt();
    let (left, right) = (Vec3::new(-slope, -slope, 0.0), Vec3::new(slope, -slope, 0.0));
    vec![
        of("plate 1.5", vec![upright(1.5, 0.0, 0.0)]),
        of("plate 0.7", vec![upright(0.7, 0.0, 0.0)]),
        of("strip 2 x 0.4", vec![square([0.0; 3], [2.0, 0.0, 0.0], [0.0, 0.0, 0.4])]),
        of(
            "dihedral 1.1",
            vec![[Vec3::ZERO, Vec3::Z * 1.1, right * 1.1], [Vec3::ZERO, left * 1.1, Vec3::Z * 1.1]],
        ),
        of("shadowed 1", vec![upright(1.0, 0.0, 0.0), upright(1.0, 0.5, 0.8)]),
        of(
            "askew pair",
            vec![upright(1.0, 0.0, 0.0), square([0.4, 0.7, 0.2], [0.8, 0.3, 0.0], [0.0, 0.2, 0.7])],
        ),
    ]
}

/// Closed conductors that are small beside the wavelength, and how large they are, one list a body.
pub fn tiny_bodies() -> Vec<(f64, Vec<Case>)> {
    let mut all = Vec::new();
    for size in [0.1, 0.01] {
        all.push((size, in_waves("small cube", &Body::Cube(size))));
        all.push((size, in_waves("small box", &Body::Box(Vec3::new(1.0, 0.6, 0.3) * size))));
        all.push((size, in_waves("small ball", &Body::Sphere(0.5 * size)).into_iter().take(1).collect()));
    }
    all
}

/// Sheets that are small beside the wavelength, and how large they are, one list a body.
pub fn tiny_sheets() -> Vec<(f64, Vec<Case>)> {
    let mut all = Vec::new();
    for size in [0.1, 0.01] {
        all.push((size, in_waves("small plate", &Body::Plates(vec![upright(size, 0.0, 0.0)]))));
        let strip = square([0.0; 3], [size, 0.0, 0.0], [0.0, 0.0, 0.3 * size]);
        all.push((size, in_waves("small strip", &Body::Plates(vec![strip]))));
    }
    all
}

/// Closed conductors small enough for a mesh far finer than usual, one list a body.
pub fn small_bodies() -> Vec<Vec<Case>> {
    let of = |name, body: Body| in_waves(name, &body);
    let mut all = vec![
        of("cube 0.5", Body::Cube(0.5)),
        of("cube 0.9", Body::Cube(0.9)),
        of("box 1 x 0.5 x 0.2", Body::Box(Vec3::new(1.0, 0.5, 0.2))),
        of("box 0.9 x 0.7 x 0.1", Body::Box(Vec3::new(0.9, 0.7, 0.1))),
    ];
    for radius in [0.2, 0.4, 0.6] {
        all.push(of("ball", Body::Sphere(radius)).into_iter().take(1).collect());
    }
    all
}
