//! Power and reciprocity of nine bodies and equations in a plane wave that comes from aside: what
//! is taken from the wave (the optical theorem: the far field straight ahead) is radiated or
//! absorbed, and transmitter and receiver may be exchanged: p₂·F₁(−d₂) = p₁·F₂(−d₁) for two plane
//! waves of directions d and polarisations p.

#![allow(clippy::unwrap_used, reason = "a test that cannot go on has failed")]

mod common;

use common::{WAVELENGTH, solved, wave};
use fredholm_linop::MultiVector;
use fredholm_mesh::Vec3;
use fredholm_moments::meshing::{Grading, cuboid, plate, sphere};
use fredholm_moments::{
    Basis, Composite, Condition, Conductor, Currents, Equation, Filling, Imperfect, Operator, Order, Regions,
    Surface,
};
use fredholm_waves::source::PlaneWave;
use fredholm_waves::{Complex64, Source};

const TOLERANCE: f64 = 1e-3;

fn waves() -> [PlaneWave; 2] {
    let wave = |travel: [f64; 3], across: [f64; 3]| {
        PlaneWave::new(Vec3::from(travel), Vec3::from(across), 1.0.into()).unwrap()
    };
    [wave([1.0, 2.0, -0.5], [0.2, 0.1, 1.0]), wave([-0.7, 0.4, -1.0], [1.0, 0.3, 0.5])]
}

/// |radiated + absorbed − extinguished| over extinguished power, the larger of both waves, and the
/// relative gap of reciprocity.
fn balance<'a>(
    operator: &Operator<'_>,
    right: impl Fn(&[&[&dyn Source]]) -> MultiVector<Complex64>,
    currents: impl Fn(&[Complex64]) -> Currents<'a>,
    absorbed: impl Fn(&Currents<'a>) -> f64,
) -> [f64; 2] {
    let waves = waves();
    let excitations = waves.each_ref().map(|wave| [wave as &dyn Source]);
    let b = right(&[&excitations[0], &excitations[1]]);
    let x = solved(&operator.coupling().unwrap(), &b);
    let found = [0, 1].map(|i| currents(&x.vector(i)));
    let power = [0, 1].map(|i| {
        let extinguished = found[i].extinguished_power(&waves[i]).unwrap();
        ((found[i].radiated_power().unwrap() + absorbed(&found[i])) / extinguished - 1.0).abs()
    });
    let seen = [0, 1].map(|i| {
        let other = &waves[1 - i];
        let far = found[i].far_field(&[-other.travel()]).unwrap();
        far[0].amplitude.dot(other.polarisation())
    });
    [power[0].max(power[1]), (seen[0] - seen[1]).norm() / seen[0].norm()]
}

fn of_conductor(surface: Surface, equation: Equation) -> [f64; 2] {
    of_conductor_in(surface, Order::Lowest, equation)
}

fn of_conductor_in(surface: Surface, order: Order, equation: Equation) -> [f64; 2] {
    let basis = Basis::of_order(surface, order).unwrap();
    let body = Conductor::new(&basis, wave(), equation, TOLERANCE).unwrap();
    balance(
        body.operator(),
        |sources| body.right_hand_side(sources),
        |x| Currents::new(&basis, wave(), x, None),
        |_| 0.0,
    )
}

fn of_imperfect(surface: Surface, condition: Condition) -> [f64; 2] {
    let basis = Basis::new(surface).unwrap();
    let conditions = vec![condition; basis.surface().triangles().len()];
    let body = Imperfect::new(&basis, wave(), conditions, TOLERANCE).unwrap();
    balance(
        body.operator(),
        |sources| body.right_hand_side(sources),
        |x| body.currents(x),
        |currents| body.absorbed_power(currents),
    )
}

fn of_dielectric(parts: &[(Surface, Filling)], permittivity: f64) -> [f64; 2] {
    let mut surface = parts[0].0.clone();
    let mut fillings = vec![parts[0].1; surface.triangles().len()];
    for (other, filling) in &parts[1..] {
        surface = surface.with(other).unwrap();
        fillings.extend(vec![*filling; other.triangles().len()]);
    }
    let basis = Basis::between(Regions::new(&surface, &fillings).unwrap()).unwrap();
    let body = Composite::new(&basis, wave(), &[permittivity.into()], TOLERANCE).unwrap();
    balance(body.operator(), |sources| body.right_hand_side(sources), |x| body.currents(x), |_| 0.0)
}

#[test]
fn what_is_taken_from_the_wave_is_radiated_or_absorbed_and_ways_may_be_reversed() {
    let edge = WAVELENGTH / 10.0;
    let ball = |radius: f64| sphere(radius * WAVELENGTH, edge).unwrap();
    let square = plate(WAVELENGTH, edge, Grading { halvings: 1 }).unwrap();
    let cube = cuboid(Vec3::splat(0.6 * WAVELENGTH), edge, Grading { halvings: 1 }).unwrap();
    let found = [
        ("plate", of_conductor(square, Equation::Electric)),
        ("cube", of_conductor(cube.clone(), Equation::Electric)),
        ("ball, magnetic", of_conductor(ball(0.35), Equation::Magnetic)),
        ("ball, combined", of_conductor(ball(0.35), Equation::default())),
        ("resistive shell", of_imperfect(ball(0.35), Condition::Sheet(Complex64::new(100.0, -300.0)))),
        ("ball with an impedance", of_imperfect(ball(0.35), Condition::Body(Complex64::new(50.0, 50.0)))),
        ("ball of glass", of_dielectric(&[(ball(0.3), Filling::Dielectric(0))], 4.0)),
        ("cube of wax", of_dielectric(&[(cube, Filling::Dielectric(0))], 2.0)),
        (
            "coated conductor",
            of_dielectric(&[(ball(0.2), Filling::Conductor), (ball(0.3), Filling::Dielectric(0))], 2.5),
        ),
    ];
    for (name, [power, reciprocity]) in found {
        println!("{name}: power {power:.1e}, reciprocity {reciprocity:.1e}");
        assert!(power < 1e-3 && reciprocity < 1e-3, "{name}: {power:e} {reciprocity:e}");
    }
}

/// Its two halves have tests of two kinds, so that on edges the balance is that of the mesh: 1e-4
/// on a ball.
#[test]
fn the_combined_equation_keeps_power_up_to_the_error_of_the_mesh() {
    let cube = cuboid(Vec3::splat(0.6 * WAVELENGTH), WAVELENGTH / 10.0, Grading { halvings: 1 }).unwrap();
    let [power, reciprocity] = of_conductor(cube, Equation::default());
    println!("cube, combined: power {power:.1e}, reciprocity {reciprocity:.1e}");
    assert!(power < 6e-3 && reciprocity < 1e-3, "{power:e} {reciprocity:e}");
    let cube = cuboid(Vec3::splat(0.6 * WAVELENGTH), WAVELENGTH / 7.0, Grading { halvings: 1 }).unwrap();
    let [power, reciprocity] = of_conductor_in(cube, Order::First, Equation::default());
    println!("cube, combined, first order: power {power:.1e}, reciprocity {reciprocity:.1e}");
    assert!(power < 1e-3 && reciprocity < 1e-3, "{power:e} {reciprocity:e}");
}
