//! Dielectric spheres against the series of Mie, near and far, and the power that they take.

#![allow(clippy::unwrap_used, reason = "a test that cannot go on has failed")]

mod common;

use common::{WAVELENGTH, circle, relative_error, solved, source, vertical, wave};
use fredholm_mesh::Vec3;
use fredholm_moments::meshing::{Grading, plate, sphere};
use fredholm_moments::{Basis, Dielectric, MomentsError};
use fredholm_waves::{Complex64, DielectricSphere, Field, Source};

/// Errors of the scattered field at 25 m and at 1.5 radii, and radiated over extinguished power.
fn errors(radius: f64, edge: f64, permittivity: Complex64) -> [f64; 3] {
    let basis = Basis::new(sphere(radius, edge).unwrap()).unwrap();
    let body = Dielectric::new(&basis, wave(), permittivity, 1e-3).unwrap();
    let source = source();
    let sources: [&dyn Source; 1] = [&source];
    let b = body.right_hand_side(&[&sources]);
    let x = solved(&body.operator().coupling().unwrap(), &b);
    let currents = body.currents(&x.vector(0));
    let exact = DielectricSphere::new(radius, permittivity).unwrap();
    let error = |points: &[Vec3]| {
        let series: Vec<Complex64> =
            points.iter().map(|&p| exact.scattered(&wave(), &source, p).components()[2]).collect();
        relative_error(&vertical(&currents.fields(points).unwrap()), &series)
    };
    let near: Vec<Vec3> = circle().iter().map(|p| *p * (1.5 * radius / 25.0)).collect();
    inside_and_outside_agree(&body, &currents, radius);
    let power = currents.radiated_power().unwrap() / currents.extinguished_power(&source).unwrap();
    [error(&circle()), error(&near), power]
}

/// Close to the surface the tangential fields of both sides are the same up to what the mesh
/// leaves.
fn inside_and_outside_agree(body: &Dielectric<'_>, currents: &fredholm_moments::Currents<'_>, radius: f64) {
    let (mut difference, mut size) = (0.0, 0.0);
    for p in circle().iter().step_by(15).map(|p| p.normalize()) {
        let outside = currents.fields(&[p * (1.02 * radius)]).unwrap()[0];
        let outside = outside + source().field(&wave(), p * (1.02 * radius));
        let inside = &body.fields_inside(currents, &[p * (0.98 * radius)]).unwrap()[0];
        let tangential = |field: &Field| field.e.crossed_by(p);
        difference += (tangential(&outside) - tangential(inside)).norm_squared();
        size += tangential(&outside).norm_squared();
    }
    assert!((difference / size).sqrt() < 0.25, "{}", (difference / size).sqrt());
}

#[test]
fn spheres_agree_with_the_series_near_and_far() {
    let radius = 0.25 * WAVELENGTH;
    for (permittivity, per_wavelength) in
        [(2.0.into(), 14.0), (4.0.into(), 20.0), (Complex64::new(10.0, -5.0), 20.0)]
    {
        let [far, near, power] = errors(radius, WAVELENGTH / per_wavelength, permittivity);
        println!("{permittivity}: far {far:.5}, near {near:.5}, power {power:.5}");
        assert!(far < 0.01 && near < 0.01, "{permittivity}: {far} {near}");
        let lossless = permittivity.im == 0.0;
        assert!(if lossless { (power - 1.0).abs() < 2e-3 } else { power < 0.9 }, "{permittivity}: {power}");
    }
}

#[test]
fn bodies_that_are_none_are_refused() {
    let open = Basis::new(plate(0.3, 0.05, Grading::default()).unwrap()).unwrap();
    let new = |permittivity: Complex64| Dielectric::new(&open, wave(), permittivity, 1e-3).map(|_| ());
    assert!(matches!(new(1.5.into()), Err(MomentsError::NotClosed { .. })));
    assert!(matches!(new(400.0.into()), Err(MomentsError::Coarse { .. })));
    assert!(matches!(new(Complex64::new(2.0, 0.5)), Err(MomentsError::Parameter { .. })));
    assert!(matches!(new(Complex64::new(0.0, -0.5)), Err(MomentsError::Parameter { .. })));
}
