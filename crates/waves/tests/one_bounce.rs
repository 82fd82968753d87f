//! One bounce against stored physical optics of an independent code: the scattered E_z on a circle.

#![allow(clippy::unwrap_used, reason = "a test that cannot go on has failed")]

mod common;

use common::{WAVELENGTH, circle, reference, relative_error, source, wave};
use fredholm_waves::surface::{cube, facing_plates, plate, sphere};
use fredholm_waves::{Complex64, PhysicalOptics, Sampling, Scatterer, Shadow, Source};

fn scattered(scatterer: &Scatterer, shadow: Shadow, sampling: Sampling) -> Vec<Complex64> {
    let source = source();
    let sources: [&dyn Source; 1] = [&source];
    let optics = PhysicalOptics::new(scatterer, wave(), &sources, shadow).unwrap();
    let fields = optics.radiator(sampling).fields(&circle()).unwrap();
    fields.iter().map(|field| field.e.components()[2]).collect()
}

fn compare(name: &str, scatterer: &Scatterer) {
    for (shadow, column) in [(Shadow::Geometric, "poJ"), (Shadow::Thesis, "poM")] {
        let expected = reference(name, column);
        for sampling in [Sampling::Midpoint, Sampling::Tolerance(1e-3)] {
            let error = relative_error(&scattered(scatterer, shadow, sampling), &expected);
            eprintln!("{name} {column} {sampling:?}: {error:.5}");
            assert!(error < 0.01, "{name} {column} {sampling:?}: {error}");
        }
    }
}

#[test]
fn plate_at_a_twentieth() {
    compare("plate_5lambda_normal.csv", &plate(5.0 * WAVELENGTH, WAVELENGTH / 20.0).unwrap());
}

#[test]
fn cube_at_a_twentieth() {
    compare("cube_5lambda_normal.csv", &cube(5.0 * WAVELENGTH, WAVELENGTH / 20.0).unwrap());
}

#[test]
fn sphere_at_a_twentieth() {
    compare("sphere_1lambda.csv", &sphere(WAVELENGTH, WAVELENGTH / 20.0).unwrap());
}

#[test]
fn two_plates_at_a_twentieth() {
    compare("two_plates_normal.csv", &facing_plates(5.0 * WAVELENGTH, 2.0, WAVELENGTH / 20.0).unwrap());
}
