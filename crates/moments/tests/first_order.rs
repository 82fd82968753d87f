//! Functions of the first full order on curved triangles, against exact series.

#![allow(clippy::unwrap_used, reason = "a test that cannot go on has failed")]

mod common;

use common::{WAVELENGTH, circle, mie, relative_error, solved, source, vertical, wave};
use fredholm_mesh::Vec3;
use fredholm_moments::meshing::{curved_sphere, sphere};
use fredholm_moments::{
    Basis, Composite, Conductor, Currents, Equation, Filling, MomentsError, Order, Regions,
};
use fredholm_waves::{Complex64, DielectricSphere, Field, Source};

const RADIUS: f64 = 0.5 * WAVELENGTH;

/// Relative error of E_z at 25 m of a conducting sphere.
fn error(edges: f64, equation: Equation) -> f64 {
    let surface = curved_sphere(RADIUS, WAVELENGTH / edges).unwrap();
    let basis = Basis::of_order(surface, Order::First).unwrap();
    let conductor = Conductor::new(&basis, wave(), equation, 1e-4).unwrap();
    let source = source();
    let sources: [&dyn Source; 1] = [&source];
    let x = solved(&conductor.operator().coupling().unwrap(), &conductor.right_hand_side(&[&sources]));
    let currents = Currents::new(&basis, wave(), &x.vector(0), None);
    let balance = currents.radiated_power().unwrap() / currents.extinguished_power(&source).unwrap();
    assert!((balance - 1.0).abs() < 1e-3, "{balance}");
    relative_error(&vertical(&currents.fields(&circle()).unwrap()), &mie(RADIUS))
}

/// 900 and 1,600 unknowns, where the lowest order has 0.24 % with 1,470.
#[test]
fn conducting_spheres_converge_with_the_fourth_order() {
    for equation in [Equation::Electric, Equation::Magnetic, Equation::default()] {
        let [coarse, fine] = [4.0, 5.0].map(|edges| error(edges, equation));
        // Edges of 12 and of 16 to the great circle.
        let order = (coarse / fine).ln() / (4.0_f64 / 3.0).ln();
        println!("{}: {coarse:.6} {fine:.6} order {order:.2}", equation.name());
        assert!(coarse < 1.2e-3 && fine < 4e-4 && order > 3.5, "{coarse} {fine} {order}");
    }
}

#[test]
fn dielectric_spheres_have_the_fields_of_mie_outside_and_inside() {
    for permittivity in [Complex64::from(2.0), Complex64::new(10.0, -5.0)] {
        let surface = curved_sphere(0.25 * WAVELENGTH, WAVELENGTH / 8.0).unwrap();
        let fillings = vec![Filling::Dielectric(0); surface.triangles().len()];
        let regions = Regions::new(&surface, &fillings).unwrap();
        let basis = Basis::between_of_order(regions, Order::First).unwrap();
        let composite = Composite::new(&basis, wave(), &[permittivity], 1e-4).unwrap();
        let source = source();
        let sources: [&dyn Source; 1] = [&source];
        let b = composite.right_hand_side(&[&sources]);
        let x = solved(&composite.operator().coupling().unwrap(), &b);
        let currents = composite.currents(&x.vector(0));
        let ball = DielectricSphere::new(0.25 * WAVELENGTH, permittivity).unwrap();
        let at = |radius: f64| -> Vec<Vec3> { circle().iter().map(|p| *p * (radius / 25.0)).collect() };
        let exact = |points: &[Vec3]| -> Vec<Complex64> {
            points.iter().map(|&p| ball.scattered(&wave(), &source, p).components()[2]).collect()
        };
        let outside = [at(25.0), at(0.4 * WAVELENGTH)]
            .map(|points| relative_error(&vertical(&currents.fields(&points).unwrap()), &exact(&points)));
        let within = at(0.12 * WAVELENGTH);
        let found: Vec<Field> =
            composite.fields_inside(&currents, &within).unwrap().into_iter().flatten().collect();
        let exact: Vec<Complex64> =
            within.iter().map(|&p| ball.inside(&wave(), &source, p).components()[2]).collect();
        let inside = relative_error(&vertical(&found), &exact);
        println!("{permittivity}: {} unknowns, {outside:?}, {inside}", b.dim());
        assert!(outside[0] < 2e-3 && outside[1] < 2e-3 && inside < 2e-3);
    }
}

#[test]
fn curved_triangles_are_refused_where_they_cannot_be() {
    let curved = curved_sphere(1.0, 0.9).unwrap();
    assert!(matches!(Basis::new(curved.clone()), Err(MomentsError::Curved)));
    let far = |_: [u32; 2]| Vec3::splat(100.0);
    assert!(matches!(sphere(1.0, 0.9).unwrap().curved(far), Err(MomentsError::Folded { .. })));
    // Turned over and back, moved and joined they keep their sides.
    let twice = curved.oriented().welded(1e-9).unwrap();
    assert_eq!(twice, curved);
}
