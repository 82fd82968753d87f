//! Spheres against the series of Mie.

#![allow(clippy::unwrap_used, reason = "a test that cannot go on has failed")]

mod common;

use common::{WAVELENGTH, circle, reference, relative_error, source, wave};
use fredholm_mesh::Vec3;
use fredholm_waves::medium::SPEED_OF_LIGHT;
use fredholm_waves::surface::sphere;
use fredholm_waves::{
    Complex64, ConductingSphere, PhysicalOptics, Sampling, Shadow, Source, Wave, cross_section,
};
use std::f64::consts::{PI, TAU};

#[test]
fn the_series_agrees_with_the_stored_one() {
    let ball = ConductingSphere::new(WAVELENGTH).unwrap();
    let ours: Vec<Complex64> =
        circle().iter().map(|&p| ball.scattered(&wave(), &source(), p).components()[2]).collect();
    // Ten digits are stored.
    assert!(relative_error(&ours, &reference("sphere_1lambda.csv", "mie")) < 1e-9);
}

/// σ/(πa²) of one bounce straight back.
fn one_bounce(ka: f64, per_wavelength: f64) -> (Wave, f64) {
    let source = source();
    let sources: [&dyn Source; 1] = [&source];
    let wave = Wave::new(ka * SPEED_OF_LIGHT / TAU).unwrap();
    let scatterer = sphere(1.0, wave.wavelength() / per_wavelength).unwrap();
    let optics = PhysicalOptics::new(&scatterer, wave, &sources, Shadow::Geometric).unwrap();
    let far = optics.radiator(Sampling::Tolerance(1e-3)).far_field(&[Vec3::NEG_Y]).unwrap();
    (wave, cross_section(far[0].amplitude.components()[2], 1.0.into()) / PI)
}

fn decibel(ratio: f64) -> f64 {
    10.0 * ratio.log10()
}

/// Physical optics of a sphere in closed form: 1 − sin(2x)/x + sin²x/x² of a true sphere.
#[test]
fn one_bounce_backscatter_is_that_of_physical_optics_in_closed_form() {
    for x in [5.0_f64, 5.5, 6.0, 6.5, 8.0, 10.0] {
        let closed = 1.0 - (2.0 * x).sin() / x + (x.sin() / x).powi(2);
        let error = decibel(one_bounce(x, 16.0).1 / closed);
        assert!(error.abs() < 0.01, "ka {x}: {error} dB");
    }
}

/// At the ka of the stored table of exact σ/(πa²) (`tests/data/README.md` has its origin). Between
/// them the creeping wave, which physical optics has not, moves the exact value by up to 1.8 dB (ka
/// = 5.5).
#[test]
fn one_bounce_backscatter_is_within_a_tenth_of_a_decibel_of_the_exact_table() {
    for (ka, exact, per_wavelength) in
        [(5.0, 1.1688, 16.0), (10.0, 0.9292, 16.0), (20.0, 0.9664, 12.0), (50.0, 0.9959, 6.0)]
    {
        let (wave, sigma) = one_bounce(ka, per_wavelength);
        let series = ConductingSphere::new(1.0).unwrap().backscatter(&wave);
        assert!((series / exact - 1.0).abs() < 1e-4, "ka {ka}: {series}");
        let error = decibel(sigma / exact);
        eprintln!("ka {ka}: one bounce {sigma:.4}, exact {exact}, {error:+.3} dB");
        assert!(error.abs() < 0.1, "ka {ka}: {error} dB");
    }
}
