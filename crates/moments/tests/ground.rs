//! Bodies above a ground plane against the same bodies with their mirror images in free space, for
//! every equation; power.

#![allow(clippy::unwrap_used, reason = "a test that cannot go on has failed")]

mod common;

use common::{WAVELENGTH, relative_error, solved, wave};
use fredholm_linop::MultiVector;
use fredholm_mesh::Vec3;
use fredholm_moments::meshing::{Grading, rectangle, sphere};
use fredholm_moments::{
    Basis, Composite, Condition, Conductor, Currents, Equation, Filling, Imperfect, MomentsError, Operator,
    Regions, Surface,
};
use fredholm_waves::source::{HertzianDipole, PlaneWave};
use fredholm_waves::{Complex64, Ground, Grounded, Source};

const TOLERANCE: f64 = 1e-3;
const HEIGHT: f64 = -0.05;

/// What is solved.
#[derive(Clone, Copy, Debug)]
enum Body {
    Conductor(Equation),
    Imperfect(Condition),
    Dielectric(f64),
}

fn moved(surface: &Surface, by: Vec3) -> Surface {
    let vertices = surface.vertices().iter().map(|v| *v + by).collect();
    Surface::new(vertices, surface.triangles().to_vec()).unwrap()
}

/// The surface with its mirror image, whose triangles are turned so that their normals are images.
fn doubled(surface: &Surface, ground: Ground) -> Surface {
    let vertices = surface.vertices().iter().map(|v| ground.image(*v)).collect();
    let triangles = surface.triangles().iter().map(|&[a, b, c]| [a, c, b]).collect();
    surface.clone().with(&Surface::new(vertices, triangles).unwrap()).unwrap()
}

/// All of a surface around one dielectric.
fn solid(surface: &Surface) -> Regions {
    Regions::new(surface, &vec![Filling::Dielectric(0); surface.triangles().len()]).unwrap()
}

/// The functions of a body.
fn basis_of(surface: &Surface, body: Body) -> Basis {
    match body {
        Body::Dielectric(_) => Basis::between(solid(surface)).unwrap(),
        _ => Basis::new(surface.clone()).unwrap(),
    }
}

/// The currents in some sources, and what of power is absorbed.
fn currents<'a>(basis: &'a Basis, body: Body, sources: &[&dyn Source]) -> (Currents<'a>, f64) {
    let solve = |operator: &Operator<'_>, b: &MultiVector<Complex64>| {
        solved(&operator.coupling().unwrap(), b).vector(0)
    };
    match body {
        Body::Conductor(equation) => {
            let body = Conductor::new(basis, wave(), equation, TOLERANCE).unwrap();
            let x = solve(body.operator(), &body.right_hand_side(&[sources]));
            (Currents::new(basis, wave(), &x, None), 0.0)
        }
        Body::Imperfect(condition) => {
            let conditions = vec![condition; basis.surface().triangles().len()];
            let body = Imperfect::new(basis, wave(), conditions, TOLERANCE).unwrap();
            let currents = body.currents(&solve(body.operator(), &body.right_hand_side(&[sources])));
            let absorbed = body.absorbed_power(&currents);
            (currents, absorbed)
        }
        Body::Dielectric(permittivity) => {
            let body = Composite::new(basis, wave(), &[permittivity.into()], TOLERANCE).unwrap();
            (body.currents(&solve(body.operator(), &body.right_hand_side(&[sources]))), 0.0)
        }
    }
}

/// E at points above the ground.
fn field(currents: &Currents<'_>) -> Vec<Complex64> {
    let point = |i: usize| {
        let (sin, cos) = (0.37 * i as f64).sin_cos();
        Vec3::new(cos, sin, 0.1 * i as f64 - 0.04)
    };
    let points: Vec<Vec3> = (0..20).map(point).collect();
    currents.fields(&points).unwrap().iter().flat_map(|field| field.e.components()).collect()
}

#[test]
fn a_body_above_ground_is_half_of_the_body_with_its_mirror_image() {
    let ground = Ground::new(HEIGHT).unwrap();
    let ball = moved(&sphere(0.06, WAVELENGTH / 9.0).unwrap(), Vec3::Z * 0.05);
    let lens = moved(&sphere(0.06, WAVELENGTH / 12.0).unwrap(), Vec3::Z * 0.05);
    let plate =
        rectangle(Vec3::new(-0.1, 0.0, 0.0), Vec3::X * 0.2, Vec3::Z * 0.2, 0.03, Grading::default()).unwrap();
    let wave_from = PlaneWave::new(Vec3::new(0.3, 1.0, -0.8), Vec3::new(1.0, -0.3, 0.0), 1.0.into()).unwrap();
    let dipole = HertzianDipole::new(Vec3::new(0.1, -0.3, 0.02), Vec3::ONE, 0.01.into()).unwrap();
    let (wave_from, dipole) =
        (Grounded::new(Box::new(wave_from), ground), Grounded::new(Box::new(dipole), ground));
    for (surface, body) in [
        (&plate, Body::Conductor(Equation::Electric)),
        (&ball, Body::Conductor(Equation::Electric)),
        (&ball, Body::Conductor(Equation::default())),
        (&plate, Body::Imperfect(Condition::Sheet(Complex64::new(100.0, -50.0)))),
        (&ball, Body::Imperfect(Condition::Body(Complex64::new(100.0, 50.0)))),
        (&lens, Body::Dielectric(3.0)),
    ] {
        let half = basis_of(surface, body).above(ground).unwrap();
        let whole = basis_of(&doubled(surface, ground), body);
        for source in [&wave_from as &dyn Source, &dipole] {
            let [one, both] = [&half, &whole].map(|basis| field(&currents(basis, body, &[source]).0));
            let gap = relative_error(&one, &both);
            println!("{body:?}: {gap:.1e}");
            assert!(gap < 5e-5, "{body:?}: {gap:e}");
        }
    }
}

#[test]
fn what_is_taken_from_the_reflected_wave_is_radiated_upwards_or_absorbed() {
    let ground = Ground::new(HEIGHT).unwrap();
    let source = PlaneWave::new(Vec3::new(0.3, 1.0, -0.8), Vec3::new(1.0, -0.3, 0.0), 1.0.into()).unwrap();
    let grounded = Grounded::new(Box::new(source), ground);
    let ball = moved(&sphere(0.06, WAVELENGTH / 9.0).unwrap(), Vec3::Z * 0.05);
    for body in [
        Body::Conductor(Equation::Electric),
        Body::Imperfect(Condition::Sheet(100.0.into())),
        Body::Imperfect(Condition::Body(100.0.into())),
        Body::Dielectric(2.0),
    ] {
        let basis = basis_of(&ball, body).above(ground).unwrap();
        let (currents, absorbed) = currents(&basis, body, &[&grounded]);
        let power = currents.radiated_power().unwrap() + absorbed;
        let ratio = power / currents.extinguished_power(&source).unwrap();
        println!("{body:?}: {ratio:.5}");
        assert!((ratio - 1.0).abs() < 2e-3, "{body:?}: {ratio}");
    }
}

#[test]
fn what_is_not_above_the_ground_is_refused() {
    let ball = sphere(0.06, WAVELENGTH / 6.0).unwrap();
    let above = |height: f64| Basis::new(ball.clone()).unwrap().above(Ground::new(height).unwrap());
    assert!(matches!(above(-0.05), Err(MomentsError::BelowGround { what: "triangle", .. })));
    let basis = above(-0.1).unwrap();
    let currents = Currents::new(&basis, wave(), &vec![Complex64::ONE; basis.len()], None);
    let refused = currents.fields(&[Vec3::X, Vec3::Z * -0.2]).unwrap_err();
    assert_eq!(refused, MomentsError::BelowGround { what: "receiver point", index: 1 });
    assert!(Ground::new(f64::NAN).is_err());
}
