//! Bodies with a surface impedance against their series, near and far; power; limits; the
//! resonances of the inside; several bodies together.

#![allow(clippy::unwrap_used, reason = "a test that cannot go on has failed")]

mod common;

use common::{WAVELENGTH, circle, currents_on, relative_error, source, vertical, wave};
use fredholm_mesh::Vec3;
use fredholm_moments::meshing::sphere;
use fredholm_moments::{Basis, Condition, Imperfect, MomentsError, Surface};
use fredholm_waves::medium::IMPEDANCE;
use fredholm_waves::{Complex64, ImpedanceSphere, Source};

const TOLERANCE: f64 = 1e-3;

fn ball(radius: f64, per_wavelength: f64) -> Basis {
    Basis::new(sphere(radius, WAVELENGTH / per_wavelength).unwrap()).unwrap()
}

fn made_of(basis: &Basis, condition: impl Fn(usize) -> Condition) -> Imperfect<'_> {
    let conditions = (0..basis.surface().triangles().len()).map(condition).collect();
    Imperfect::new(basis, wave(), conditions, TOLERANCE).unwrap()
}

/// Errors of E at 25 m and at 1.3 radii, the total field in the middle, and radiated and absorbed
/// over extinguished power.
fn errors(radius: f64, per_wavelength: f64, z: Complex64) -> ([f64; 3], [f64; 2]) {
    let basis = ball(radius, per_wavelength);
    let body = made_of(&basis, |_| Condition::Body(z));
    let currents = currents_on(&body);
    let exact = ImpedanceSphere::new(radius, z).unwrap();
    let error = |distance: f64| {
        let points: Vec<Vec3> = circle().iter().map(|p| p.normalize() * distance).collect();
        let series: Vec<Complex64> =
            points.iter().map(|&p| exact.scattered(&wave(), &source(), p).components()[2]).collect();
        relative_error(&vertical(&currents.fields(&points).unwrap()), &series)
    };
    let middle = Vec3::new(0.1, 0.2, -0.1) * radius;
    let inside = currents.fields(&[middle]).unwrap()[0] + source().field(&wave(), middle);
    let extinguished = currents.extinguished_power(&source()).unwrap();
    let power = [currents.radiated_power().unwrap(), body.absorbed_power(&currents)];
    ([error(25.0), error(1.3 * radius), inside.e.norm()], power.map(|power| power / extinguished))
}

#[test]
fn spheres_agree_with_the_series_and_the_powers_balance() {
    let radius = 0.3 * WAVELENGTH;
    for z in [
        Complex64::new(20.0, 20.0),
        100.0.into(),
        IMPEDANCE.into(),
        Complex64::new(50.0, -150.0),
        1500.0.into(),
    ] {
        let ([coarse, _, _], _) = errors(radius, 6.0, z);
        let ([far, near, inside], [radiated, absorbed]) = errors(radius, 12.0, z);
        let order = (coarse / far).log2();
        println!("{z}: far {far:.5} (order {order:.2}), near {near:.5}, inside {inside:.5}");
        println!("    radiated {radiated:.6}, absorbed {absorbed:.6}");
        assert!(far < 0.015 && near < 0.015 && inside < 0.02 && order > 1.4, "{z}");
        assert!((radiated + absorbed - 1.0).abs() < 1e-3, "{z}: {radiated} {absorbed}");
        let [extinction, scattering] = ImpedanceSphere::new(radius, z).unwrap().cross_sections(&wave());
        assert!((absorbed - (1.0 - scattering / extinction)).abs() < 0.01, "{z}: {absorbed}");
    }
}

#[test]
fn the_impedance_of_free_space_sends_nothing_straight_back() {
    let basis = ball(0.3 * WAVELENGTH, 10.0);
    let field = |z: f64| {
        let body = made_of(&basis, |_| Condition::Body(z.into()));
        let currents = currents_on(&body);
        let far = currents.far_field(&[Vec3::NEG_Y, Vec3::Y]).unwrap();
        far[0].amplitude.norm() / far[1].amplitude.norm()
    };
    let (matched, other) = (field(IMPEDANCE), field(100.0));
    println!("back over ahead: {matched:.2e} for 377 Ω, {other:.2e} for 100 Ω");
    assert!(matched < 2e-3 && other > 0.1);
}

#[test]
fn without_impedance_a_body_is_a_conductor() {
    let basis = ball(0.3 * WAVELENGTH, 7.0);
    let field = |condition: Condition| {
        vertical(&currents_on(&made_of(&basis, |_| condition)).fields(&circle()).unwrap())
    };
    let conductor = field(Condition::Conductor);
    let gap = |z: f64| relative_error(&field(Condition::Body(z.into())), &conductor);
    assert!(gap(0.0) < 1e-4, "{:e}", gap(0.0));
    assert!(gap(1e-3) < 1e-4 && gap(1.0) > gap(1e-3), "{:e} {:e}", gap(1e-3), gap(1.0));
}

/// At ka = 2.744 the inside of a conductor has its first resonance, which the electric equation
/// meets, and a body with losses does not.
#[test]
fn losses_leave_no_resonance_of_the_inside() {
    let radius = 2.744 / std::f64::consts::TAU * WAVELENGTH;
    let ([resonant, ..], _) = errors(radius, 7.0, 100.0.into());
    let ([beside, ..], _) = errors(1.05 * radius, 7.0, 100.0.into());
    println!("at the resonance {resonant:.5}, beside {beside:.5}");
    assert!(resonant < 1.5 * beside, "{resonant} {beside}");
}

#[test]
fn bodies_of_different_impedance_go_together() {
    let one = sphere(0.2 * WAVELENGTH, WAVELENGTH / 7.0).unwrap();
    let count = one.triangles().len();
    let moved = |x: f64| {
        let vertices = one.vertices().iter().map(|v| *v + Vec3::X * x).collect();
        Surface::new(vertices, one.triangles().to_vec()).unwrap()
    };
    let three = one.clone().with(&moved(0.5 * WAVELENGTH)).unwrap().with(&moved(-0.5 * WAVELENGTH)).unwrap();
    let basis = Basis::new(three).unwrap();
    let field = |conditions: [Condition; 3]| {
        let body = made_of(&basis, |triangle| conditions[triangle / count]);
        let currents = currents_on(&body);
        let power = currents.radiated_power().unwrap() + body.absorbed_power(&currents);
        assert!((power / currents.extinguished_power(&source()).unwrap() - 1.0).abs() < 1e-3);
        vertical(&currents.fields(&circle()).unwrap())
    };
    let body = Condition::Body(Complex64::new(200.0, 50.0));
    let film = Condition::Sheet(80.0.into());
    let mixed = field([body, Condition::Conductor, film]);
    let all = field([body, Condition::Body(1e-4.into()), film]);
    let gap = relative_error(&mixed, &all);
    assert!(gap < 1e-3, "{gap:e}");
    let mut conditions = vec![body; 3 * count];
    conditions[1] = Condition::Conductor;
    let refused = Imperfect::new(&basis, wave(), conditions, TOLERANCE).map(|_| ());
    assert_eq!(refused, Err(MomentsError::Patchwork { first: 0, second: 1 }));
}
