//! Edge currents, measured: one bounce with and without them against the method of moments.

#![allow(clippy::unwrap_used, reason = "a test that cannot go on has failed")]

mod common;

use common::{WAVELENGTH, circle, reference, relative_error, source, wave};
use fredholm_mesh::Vec3;
use fredholm_waves::source::PlaneWave;
use fredholm_waves::surface::{cube, plate};
use fredholm_waves::{Complex64, EdgeCurrents, Field, PhysicalOptics, Sampling, Scatterer, Shadow, Source};

/// Error of one bounce alone and with edge currents.
fn errors(scatterer: &Scatterer, name: &str) -> [f64; 2] {
    let source = source();
    let sources: [&dyn Source; 1] = [&source];
    let optics = PhysicalOptics::new(scatterer, wave(), &sources, Shadow::Geometric).unwrap();
    let fields = optics.radiator(Sampling::Tolerance(1e-3)).fields(&circle()).unwrap();
    let edges = EdgeCurrents::new(scatterer, wave(), &sources).unwrap();
    assert!(!edges.is_empty());
    let extra = edges.fields(&circle());
    let expected = reference(name, "mom");
    let ez = |with: f64| -> Vec<Complex64> {
        let pairs = fields.iter().zip(&extra);
        pairs.map(|(field, extra)| (*field + *extra * with).e.components()[2]).collect()
    };
    [0.0, 1.0].map(|with| relative_error(&ez(with), &expected))
}

#[test]
fn edge_currents_bring_a_plate_closer_to_the_method_of_moments() {
    let [without, with] =
        errors(&plate(5.0 * WAVELENGTH, WAVELENGTH / 5.0).unwrap(), "plate_5lambda_normal.csv");
    assert!((without - 0.111).abs() < 0.003 && with < 0.015, "{without} {with}");
}

/// Lit squarely, every edge of a cube has a face that the wave grazes; turned a little, those in front are lit.
#[test]
fn edges_of_grazed_faces_are_left_out() {
    let cube = cube(WAVELENGTH, WAVELENGTH / 5.0).unwrap();
    let square = source();
    assert!(EdgeCurrents::new(&cube, wave(), &[&square]).unwrap().is_empty());
    let turned = PlaneWave::new(Vec3::new(0.3, 0.8, -0.5), Vec3::Z, 1.0.into()).unwrap();
    let edges = EdgeCurrents::new(&cube, wave(), &[&turned]).unwrap();
    // Nine of twelve edges see the source, with ten elements a wavelength.
    assert_eq!(edges.len(), 90);
    assert!(edges.fields(&circle()).iter().all(Field::is_finite));
}

#[test]
fn the_far_field_of_edges_is_the_limit_of_the_near_one() {
    let plate = plate(2.0 * WAVELENGTH, WAVELENGTH / 4.0).unwrap();
    let turned = PlaneWave::new(Vec3::new(0.3, 0.8, -0.5), Vec3::Z, 1.0.into()).unwrap();
    let edges = EdgeCurrents::new(&plate, wave(), &[&turned]).unwrap();
    let u = Vec3::new(0.48, -0.6, 0.64);
    let r = 1e6;
    let near = edges.fields(&[u * r])[0].e;
    let far = edges.far_amplitude(u) * (Complex64::cis(-wave().wavenumber() * r) / r);
    assert!((near - far).norm() < 1e-4 * near.norm());
}
