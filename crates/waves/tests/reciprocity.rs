//! Reciprocity: which method has it, and how far the others are from it.
//!
//! The current 2 n × H of a wave i, tested by a wave s, gives ∫ n·(E_s × H_i), and so does 2 n × E
//! of s, tested by i: what the electric form sends from i to s the magnetic form sends from s to i,
//! bounce by bounce, exactly where no integral of a near pair comes in. Neither is reciprocal
//! alone; their mean is. The equations of closed bodies are in the limit of fine meshes.

#![allow(clippy::unwrap_used, reason = "a test that cannot go on has failed")]

mod common;

use common::{WAVELENGTH, wave};
use fredholm_linop::{MultiVector, Quiet, SecondKind, Stop};
use fredholm_mesh::Vec3;
use fredholm_waves::source::{HertzianDipole, PlaneWave};
use fredholm_waves::surface::{cube, facing_plates, plate, sphere};
use fredholm_waves::{
    Bounces, Complex64, Discretisation, PhysicalOptics, Scatterer, Shadow, Source, System, electric_element,
};

/// A direction and a polarisation.
type Port = (Vec3, Vec3);

/// The far field along the polarisation of `to`, of the wave that comes from `from`, after so many
/// bounces.
fn scattered(body: &Scatterer, shadow: Shadow, bounces: usize, from: Port, to: Port) -> Complex64 {
    let source = PlaneWave::new(-from.0, from.1, 1.0.into()).unwrap();
    let sources: [&dyn Source; 1] = [&source];
    let first = PhysicalOptics::new(body, wave(), &sources, shadow).unwrap();
    assert!(first.lit(0).iter().all(|&side| side > 0.0));
    let system = System::lazy(body, wave(), shadow).unwrap();
    let b = system.right_hand_side(&[&first]);
    let x = Bounces::sum(system.coupling(), &b, bounces, &Quiet).unwrap().x;
    let currents = system.currents(&x, 0);
    received(&system, &currents, to)
}

fn received(system: &System<'_>, currents: &fredholm_waves::FacetCurrents, (to, along): Port) -> Complex64 {
    let across = PlaneWave::new(-to, along, 1.0.into()).unwrap().polarisation();
    system.radiator(currents).far_field(&[to]).unwrap()[0].amplitude.dot(across)
}

fn ports() -> [Port; 2] {
    [
        (Vec3::new(0.1, -1.0, 0.2).normalize(), Vec3::new(0.3, 0.1, 1.0)),
        (Vec3::new(-0.35, -1.0, -0.15).normalize(), Vec3::new(1.0, 0.2, 0.4)),
    ]
}

#[test]
fn the_forms_are_reciprocal_to_each_other_and_so_is_their_mean() {
    let [i, s] = ports();
    let bodies = [
        (plate(2.0 * WAVELENGTH, WAVELENGTH / 6.0).unwrap(), vec![1]),
        (facing_plates(3.0 * WAVELENGTH, 1.5, WAVELENGTH / 5.0).unwrap(), vec![1, 2, 3, 5]),
    ];
    for (body, counts) in &bodies {
        for &bounces in counts {
            let go = |shadow, from, to| scattered(body, shadow, bounces, from, to);
            let (electric, magnetic) = (go(Shadow::Geometric, i, s), go(Shadow::Thesis, s, i));
            let back = (go(Shadow::Geometric, s, i), go(Shadow::Thesis, i, s));
            let scale = electric.norm().max(back.0.norm());
            assert!((electric - magnetic).norm() < 1e-10 * scale, "{bounces}: {electric} {magnetic}");
            let (there, here) = (electric + back.1, back.0 + magnetic);
            assert!((there - here).norm() < 1e-10 * scale, "{bounces}: {there} {here}");
            // Alone, neither is: the test says something.
            assert!((electric - back.0).norm() > 1e-3 * scale, "{bounces}: {electric} {}", back.0);
        }
    }
}

/// The field of an element at another, tested by it, is the same the other way round.
#[test]
fn free_space_is_reciprocal() {
    let (p, q) = (Vec3::new(0.1, 0.2, -0.3), Vec3::new(-0.4, 0.5, 0.6));
    let (a, b) = (Vec3::new(1.0, 2.0, -0.5), Vec3::new(0.3, -1.0, 0.7));
    let field = |from: Vec3, moment: Vec3, at: Vec3| {
        let current = fredholm_waves::ComplexVector::along(moment, 1.0.into());
        electric_element(&wave(), current, at - from).e
    };
    let (there, here) = (field(p, a, q).dot(b), field(q, b, p).dot(a));
    assert!((there - here).norm() < 1e-14 * there.norm());
    let dipole = HertzianDipole::new(p, a, a.length().into()).unwrap();
    assert!((dipole.field(&wave(), q).e.dot(b) - there).norm() < 1e-12 * there.norm());
}

/// Two ports, by the equation of a closed body solved by LU: the difference between there and back
/// over the larger of both.
fn defect(body: &Scatterer) -> f64 {
    let (lu, [i, s]) = (fredholm_direct::solvers().remove(0), ports());
    let system = System::stored(body, wave(), Shadow::ExactDual, Discretisation::Nystrom).unwrap();
    let go = |(from, along): Port, to: Port| {
        let source = PlaneWave::new(-from, along, 1.0.into()).unwrap();
        let sources: [&dyn Source; 1] = [&source];
        let first = PhysicalOptics::new(body, wave(), &sources, Shadow::ExactDual).unwrap();
        let b = system.right_hand_side(&[&first]);
        let one = MultiVector::from_fn(b.dim(), 1, |_, _| Complex64::ONE);
        let a = SecondKind::new(system.coupling(), one).unwrap();
        let mut x = MultiVector::zeros(b.dim(), 1);
        let stop = Stop { tolerance: 1e-10, max_iterations: 1 };
        lu.solve(&a, &b, &mut x, &stop, &mut Quiet).unwrap();
        received(&system, &system.currents(&x, 0), to)
    };
    let (there, here) = (go(i, s), go(s, i));
    (there - here).norm() / there.norm().max(here.norm())
}

/// The equation is made discrete at points, which is not symmetric: its defect goes with the error
/// of the mesh.
#[test]
fn the_equation_of_a_cube_is_reciprocal_in_the_limit() {
    let of = |per_wavelength: f64| defect(&cube(0.8 * WAVELENGTH, WAVELENGTH / per_wavelength).unwrap());
    let [coarse, fine] = [6.0, 12.0].map(of);
    eprintln!("defect of a cube of 0.8λ: {coarse:.4} at λ/6, {fine:.4} at λ/12");
    assert!(fine < 0.7 * coarse && fine < 0.05, "{coarse} {fine}");
}

/// Without edges half a per cent is reached at λ/8.
#[test]
fn the_equation_of_a_sphere_is_reciprocal_to_half_a_per_cent() {
    for radius in [0.3, 0.5] {
        let found = defect(&sphere(radius * WAVELENGTH, WAVELENGTH / 8.0).unwrap());
        eprintln!("defect of a sphere of radius {radius}λ at λ/8: {found:.5}");
        assert!(found < 5e-3, "{radius}: {found}");
    }
}
