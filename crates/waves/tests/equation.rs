//! The magnetic field equation, alone and on two surfaces, against the series of Mie.

#![allow(clippy::unwrap_used, reason = "a test that cannot go on has failed")]

mod common;

use common::source;
use fredholm_iterative::Gmres;
use fredholm_linop::{MultiVector, Quiet, SecondKind, Solver, Stop, StopReason};
use fredholm_mesh::Vec3;
use fredholm_waves::medium::SPEED_OF_LIGHT;
use fredholm_waves::surface::sphere;
use fredholm_waves::{
    Complex64, ConductingSphere, FacetCurrents, PhysicalOptics, Scatterer, Shadow, Source, System, Wave,
    cross_section,
};
use std::f64::consts::{PI, TAU};

fn wave_of(ka: f64) -> Wave {
    Wave::new(ka * SPEED_OF_LIGHT / TAU).unwrap()
}

/// The currents on a unit sphere with so many edges a wavelength, by GMRES.
fn solved(ball: &Scatterer, wave: Wave, shadow: Shadow) -> FacetCurrents {
    let source = source();
    let sources: [&dyn Source; 1] = [&source];
    let first = PhysicalOptics::new(ball, wave, &sources, shadow).unwrap();
    let system = System::lazy(ball, wave, shadow).unwrap();
    let b = system.right_hand_side(&[&first]);
    let one = MultiVector::from_fn(b.dim(), 1, |_, _| Complex64::ONE);
    let a = SecondKind::new(system.coupling(), one).unwrap();
    let mut x = MultiVector::zeros(b.dim(), 1);
    let stop = Stop { tolerance: 1e-6, max_iterations: 300 };
    let report = Solver::solve(&Gmres { restart: 100 }, &a, &b, &mut x, &stop, &mut Quiet).unwrap();
    assert_eq!(report.reason, StopReason::Converged, "{shadow:?}");
    system.currents(&x, 0)
}

/// Backscatter over that of the series, dB.
fn backscatter(ka: f64, per_wavelength: f64, shadow: Shadow) -> f64 {
    let wave = wave_of(ka);
    let ball = sphere(1.0, wave.wavelength() / per_wavelength).unwrap();
    let currents = solved(&ball, wave, shadow);
    let system = System::lazy(&ball, wave, shadow).unwrap();
    let far = system.radiator(&currents).far_field(&[Vec3::NEG_Y]).unwrap();
    let sigma = cross_section(far[0].amplitude.components()[2], 1.0.into()) / PI;
    10.0 * (sigma / ConductingSphere::new(1.0).unwrap().backscatter(&wave)).log10()
}

/// Where physical optics is up to 1.8 dB off. ka = 7 is next to a resonance (6.988), where one
/// surface has 0.18 dB.
#[test]
fn backscatter_is_within_a_tenth_of_a_decibel_of_the_series() {
    let dual = [5.0, 5.5, 7.0].map(|ka| (ka, Shadow::ExactDual));
    for (ka, shadow) in dual.into_iter().chain([(5.0, Shadow::Exact), (5.5, Shadow::Exact)]) {
        let error = backscatter(ka, 7.0, shadow);
        eprintln!("ka {ka} {shadow:?}: {error:.3} dB");
        assert!(error.abs() < 0.1, "ka {ka} {shadow:?}: {error} dB");
    }
}

/// The first two resonances of the interior: ka = 2.7437 (TM₁₁) and 4.4934 (TE₁₁).
#[test]
fn the_second_surface_takes_away_the_resonances() {
    for ka in [2.7437, 4.4934] {
        let wave = wave_of(ka);
        let ball = sphere(1.0, wave.wavelength() / 10.0).unwrap();
        let points: Vec<Vec3> = (0..72)
            .map(|i| f64::from(5 * i).to_radians().sin_cos())
            .map(|(sin, cos)| Vec3::new(30.0 * cos, 30.0 * sin, 0.0))
            .collect();
        let mie = ConductingSphere::new(1.0).unwrap();
        let [plain, dual] = [Shadow::Exact, Shadow::ExactDual].map(|shadow| {
            let currents = solved(&ball, wave, shadow);
            let system = System::lazy(&ball, wave, shadow).unwrap();
            let fields = system.radiator(&currents).fields(&points).unwrap();
            let (mut gap, mut size) = (0.0, 0.0);
            for (field, &p) in fields.iter().zip(&points) {
                let expected = mie.scattered(&wave, &source(), p);
                gap += (field.e - expected).norm_squared();
                size += expected.norm_squared();
            }
            (gap / size).sqrt()
        });
        eprintln!("ka {ka}: {plain:.4} alone, {dual:.4} with a second surface");
        assert!(dual < 0.02 && dual < 0.5 * plain, "ka {ka}: {plain} {dual}");
    }
}
