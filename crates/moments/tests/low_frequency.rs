//! Bodies that are small beside the wavelength, down to a hundred-thousandth of it: against the series of
//! Mie near and far, and against the static dipoles of a disc. A loop of currents has no charge, and
//! its field is smaller than that of the charges by the size over the wavelength: it is lost first.

#![allow(clippy::unwrap_used, reason = "a test that cannot go on has failed")]

mod common;
#[path = "../examples/wave_cases/mod.rs"]
mod wave_cases;

use common::{relative_error, solved, source, vertical};
use fredholm_compressed::{Factors, Preconditioned, Settings};
use fredholm_iterative::Gmres;
use fredholm_linop::{LinearOperator, MultiVector, Quiet, SecondKind, Solver, Stop, StopReason};
use fredholm_mesh::Vec3;
use fredholm_moments::meshing::sphere;
use fredholm_moments::{
    Basis, Composite, Condition, Conductor, Currents, Equation, Filling, Imperfect, Operator, Regions,
    Surface,
};
use fredholm_waves::medium::SPEED_OF_LIGHT;
use fredholm_waves::source::PlaneWave;
use fredholm_waves::{
    Complex64, ComplexVector, ConductingSphere, DielectricSphere, ImpedanceSphere, ResistiveShell, Source,
    Wave,
};
use std::f64::consts::{FRAC_PI_2, PI, TAU};
use wave_cases::error;

const TOLERANCE: f64 = 1e-3;
const RADIUS: f64 = 1.0;

/// What a sphere is made of.
#[derive(Clone, Copy, Debug)]
enum Made {
    Conductor(Equation),
    Dielectric(Complex64),
    Sheet(Complex64),
    Impedance(Complex64),
}

/// How systems are solved.
type Solve = fn(&Operator<'_>, &MultiVector<Complex64>) -> MultiVector<Complex64>;

impl Made {
    /// E_z at two sets of points, in the wave of the references at a wavelength.
    fn found(self, ball: &Surface, wave: Wave, places: &[Vec<Vec3>; 2], solve: Solve) -> [Vec<Complex64>; 2] {
        let source = source();
        let sources: [&dyn Source; 1] = [&source];
        let fields =
            |currents: &Currents<'_>| places.each_ref().map(|p| vertical(&currents.fields(p).unwrap()));
        let imperfect = |condition: Condition| {
            let basis = Basis::new(ball.clone()).unwrap();
            let conditions = vec![condition; ball.triangles().len()];
            let body = Imperfect::new(&basis, wave, conditions, TOLERANCE).unwrap();
            let x = solve(body.operator(), &body.right_hand_side(&[&sources]));
            fields(&body.currents(&x.vector(0)))
        };
        match self {
            Self::Conductor(equation) => {
                let basis = Basis::new(ball.clone()).unwrap();
                let body = Conductor::new(&basis, wave, equation, TOLERANCE).unwrap();
                let x = solve(body.operator(), &body.right_hand_side(&[&sources]));
                fields(&Currents::new(&basis, wave, &x.vector(0), None))
            }
            Self::Dielectric(permittivity) => {
                let solid = vec![Filling::Dielectric(0); ball.triangles().len()];
                let basis = Basis::between(Regions::new(ball, &solid).unwrap()).unwrap();
                let body = Composite::new(&basis, wave, &[permittivity], TOLERANCE).unwrap();
                let x = solve(body.operator(), &body.right_hand_side(&[&sources]));
                fields(&body.currents(&x.vector(0)))
            }
            Self::Sheet(z) => imperfect(Condition::Sheet(z)),
            Self::Impedance(z) => imperfect(Condition::Body(z)),
        }
    }

    fn exact(self, wave: &Wave, p: Vec3) -> Complex64 {
        let source = source();
        let e = match self {
            Self::Conductor(_) => ConductingSphere::new(RADIUS).unwrap().scattered(wave, &source, p),
            Self::Dielectric(epsilon) => {
                DielectricSphere::new(RADIUS, epsilon).unwrap().scattered(wave, &source, p)
            }
            Self::Sheet(z) => ResistiveShell::new(RADIUS, z).unwrap().scattered(wave, &source, p),
            Self::Impedance(z) => ImpedanceSphere::new(RADIUS, z).unwrap().scattered(wave, &source, p),
        };
        e.components()[2]
    }

    /// Errors at 1.5 radii and at 25 wavelengths.
    fn errors(self, ball: &Surface, wavelength: f64, solve: Solve) -> [f64; 2] {
        let wave = Wave::new(SPEED_OF_LIGHT / wavelength).unwrap();
        let places = [points(1.5 * RADIUS), points(25.0 * wavelength)];
        let found = self.found(ball, wave, &places, solve);
        let exact = places.each_ref().map(|p| p.iter().map(|&p| self.exact(&wave, p)).collect::<Vec<_>>());
        [0, 1].map(|i| relative_error(&found[i], &exact[i]))
    }
}

fn whole(operator: &Operator<'_>, b: &MultiVector<Complex64>) -> MultiVector<Complex64> {
    solved(&operator.coupling().unwrap(), b)
}

/// By the compressed matrix and its factors, as scenes do.
fn compressed(operator: &Operator<'_>, b: &MultiVector<Complex64>) -> MultiVector<Complex64> {
    let settings = Settings { tolerance: 1e-3, leaf: 24, ..Settings::default() };
    let matrix = operator.compressed(settings, &Quiet).unwrap();
    let factors = Factors::new(&matrix, 1e-2, u64::MAX, &Quiet).unwrap();
    let system = Preconditioned::new(&matrix, &factors);
    let one = MultiVector::from_fn(matrix.dim(), 1, |_, _| Complex64::ONE);
    let a = SecondKind::new(&system, one).unwrap();
    let mut x = MultiVector::zeros(matrix.dim(), 1);
    let stop = Stop { tolerance: 1e-5, max_iterations: 300 };
    let report =
        Gmres { restart: 100 }.solve(&a, &system.right_hand_side(b), &mut x, &stop, &mut Quiet).unwrap();
    assert_eq!(report.reason, StopReason::Converged);
    x
}

fn points(distance: f64) -> Vec<Vec3> {
    let point = |i: u32| {
        let (sin, cos) = (0.175 * f64::from(i)).sin_cos();
        Vec3::new(distance * cos, distance * sin, 0.3 * distance * (3.0 * f64::from(i)).sin())
    };
    (0..36).map(point).collect()
}

#[test]
fn small_spheres_agree_with_the_series_at_any_frequency() {
    let ball = sphere(RADIUS, 0.35).unwrap();
    for (made, bound) in [
        (Made::Conductor(Equation::Electric), 0.007),
        (Made::Conductor(Equation::default()), 0.007),
        (Made::Dielectric(4.0.into()), 0.007),
        (Made::Dielectric(Complex64::new(10.0, -5.0)), 0.01),
        (Made::Sheet(Complex64::from(50.0)), 0.007),
        (Made::Impedance(Complex64::new(20.0, 20.0)), 0.01),
    ] {
        for wavelength in [1e1, 1e2, 1e3, 1e4, 1e5] {
            let [near, far] = made.errors(&ball, wavelength, whole);
            println!("{made:?} {wavelength:e}: near {near:.5}, far {far:.5}");
            assert!(near < bound && far < bound, "{made:?} {wavelength}: {near} {far}");
        }
    }
}

#[test]
fn compressed_matrices_keep_loops_of_edges_down_to_a_two_hundredth_of_a_wavelength() {
    let ball = sphere(RADIUS, 0.2).unwrap();
    for made in [
        Made::Conductor(Equation::Electric),
        Made::Conductor(Equation::default()),
        Made::Dielectric(4.0.into()),
    ] {
        for wavelength in [1e1, 4e1] {
            let [near, far] = made.errors(&ball, wavelength, compressed);
            println!("{made:?} {wavelength:e}: near {near:.5}, far {far:.5}");
            assert!(near < 0.0025 && far < 0.0025, "{made:?} {wavelength}: {near} {far}");
        }
    }
}

/// The part of a disc of radius 1 beyond ring `first` of `rings`, about y, with finer rings towards
/// the rim.
fn disc(rings: u32, first: u32) -> Surface {
    let start = |ring: u32| if ring == 0 { 0 } else { 1 + 3 * ring * (ring - 1) };
    let mut vertices = Vec::new();
    for ring in 0..=rings {
        let radius = (FRAC_PI_2 * f64::from(ring) / f64::from(rings)).sin();
        for i in 0..(6 * ring).max(1) {
            let (sin, cos) = (TAU * f64::from(i) / f64::from((6 * ring).max(1))).sin_cos();
            vertices.push(Vec3::new(radius * sin, 0.0, radius * cos));
        }
    }
    let mut triangles = Vec::new();
    for ring in first..rings {
        let inner = |i: u32| start(ring) + if ring == 0 { 0 } else { i % (6 * ring) };
        let outer = |i: u32| start(ring + 1) + i % (6 * (ring + 1));
        for sector in 0..6 {
            for i in 0..=ring {
                let (a, b) = (sector * ring + i, sector * (ring + 1) + i);
                triangles.push([inner(a), outer(b), outer(b + 1)]);
                if i < ring {
                    triangles.push([inner(a), outer(b + 1), inner(a + 1)]);
                }
            }
        }
    }
    // Corners that no triangle has are left out.
    let mut names = vec![None; vertices.len()];
    let mut kept = Vec::new();
    let triangles = triangles.into_iter().map(|triangle| {
        triangle.map(|at| {
            *names[at as usize].get_or_insert_with(|| {
                kept.push(vertices[at as usize]);
                kept.len() as u32 - 1
            })
        })
    });
    let triangles: Vec<[u32; 3]> = triangles.collect();
    Surface::new(kept, triangles).unwrap()
}

fn directions() -> Vec<Vec3> {
    points(1.0).into_iter().map(Vec3::normalize).collect()
}

/// The far field over k² of a sheet in a wave.
fn far_over_square(sheet: Surface, source: &PlaneWave, wavelength: f64) -> Vec<ComplexVector> {
    let wave = Wave::new(SPEED_OF_LIGHT / wavelength).unwrap();
    let basis = Basis::new(sheet).unwrap();
    let body = Conductor::new(&basis, wave, Equation::Electric, TOLERANCE).unwrap();
    let x = whole(body.operator(), &body.right_hand_side(&[&[source as &dyn Source]]));
    let far = Currents::new(&basis, wave, &x.vector(0), None).far_field(&directions()).unwrap();
    far.into_iter().map(|far| far.amplitude * wave.wavenumber().powi(-2)).collect()
}

/// A conducting disc of radius a has the moments p = 16/3 ε₀ a³ E along it and m = −8/3 a³ H across
/// (C. J. Bouwkamp, Rep. Prog. Phys. 17 (1954) 35, by Babinet's principle).
#[test]
fn a_disc_has_its_static_moments() {
    for (travel, along) in [(Vec3::Y, Vec3::Z), (Vec3::X, Vec3::Z)] {
        let source = PlaneWave::new(travel, along, 1.0.into()).unwrap();
        // Both over 4π ε₀; E is 1 V/m.
        let electric = along * (16.0 / 3.0 / (4.0 * PI));
        let magnetic = Vec3::Y * (-8.0 / 3.0 / (4.0 * PI) * travel.cross(along).y);
        let moments: Vec<ComplexVector> = directions()
            .into_iter()
            .map(|u| u.cross(electric).cross(u) - u.cross(magnetic))
            .map(|f| ComplexVector::from_components(f.to_array().map(Complex64::from)))
            .collect();
        for wavelength in [1e3, 1e5] {
            let error = |rings| error(&far_over_square(disc(rings, 0), &source, wavelength), &moments);
            let (coarse, fine) = (error(5), error(10));
            println!("{travel} {wavelength:e}: {coarse:.5} {fine:.5}");
            assert!(fine < 0.01 && (coarse / fine).log2() > 1.5, "{travel} {wavelength}: {coarse} {fine}");
        }
    }
}

/// The current around a hole is no loop around a corner, and has no charge either.
#[test]
fn a_ring_keeps_the_current_around_its_hole() {
    let source = PlaneWave::new(Vec3::X, Vec3::Z, 1.0.into()).unwrap();
    let ring = |wavelength| far_over_square(disc(8, 5), &source, wavelength);
    let slow = ring(1e3);
    for wavelength in [1e4, 1e5] {
        // What is left is the size over the wavelength, squared.
        let change = error(&ring(wavelength), &slow);
        println!("{wavelength:e}: {change:e}");
        assert!(change < 1e-4, "{wavelength}: {change:e}");
    }
}
