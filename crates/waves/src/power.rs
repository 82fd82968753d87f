//! Powers: what sources give away, what a body takes from plane waves, and what leaves over the
//! sphere.
//!
//! ```text
//! radiated  P = 1/(2η) ∮ |F|² dΩ
//! extinct   P = −2π/(kη) Im Σ E₀* ê·F(K̂)          (the optical theorem)
//! ```
//!
//! Where nothing is absorbed, what is extinct of plane waves is what the scattered field radiates,
//! and what located sources supply is what they and the scattered field radiate together (R. G.
//! Newton, Am. J. Phys. 44 (1976) 639). Powers in W, F in V.
//!
//! |F|² of a body within a ball of radius a has no more than 2 k a degrees to speak of, so that a rule of that degree, Gauss in
//! cosθ and even in φ, integrates it.

use std::f64::consts::TAU;

use fredholm_mesh::Vec3;
use fredholm_quadrature::gauss_legendre;

use crate::medium::IMPEDANCE;
use crate::source::PlaneWave;
use crate::{ComplexVector, Source, Wave};

/// Degrees beyond k a, for a body of any size: terms of the far field fall below 1e-4 within them.
const DEGREES_BEYOND: f64 = 4.0;

/// Directions over the sphere and their solid angles (sr), which integrate |F|² of what is within a
/// ball of this radius (m).
#[must_use]
pub fn sphere_rule(wave: &Wave, radius: f64) -> Vec<(Vec3, f64)> {
    let ka = wave.wavenumber() * radius;
    let degree = (ka + DEGREES_BEYOND + 2.0 * ka.cbrt()).ceil() as usize;
    let (rings, around) = (gauss_legendre(degree + 1), 2 * degree + 1);
    let ring = |(&t, &w): (&f64, &f64)| {
        let z = 2.0 * t - 1.0;
        let radius = (1.0 - z * z).sqrt();
        (0..around).map(move |i| {
            let (sin, cos) = (TAU * i as f64 / around as f64).sin_cos();
            (Vec3::new(radius * cos, radius * sin, z), 2.0 * w * TAU / around as f64)
        })
    };
    rings.points.iter().zip(&rings.weights).flat_map(ring).collect()
}

/// The mean power of amplitudes in the directions of a [`sphere_rule`], W.
#[must_use]
pub fn radiated(rule: &[(Vec3, f64)], amplitudes: &[ComplexVector]) -> f64 {
    let sum: f64 = rule.iter().zip(amplitudes).map(|((_, angle), f)| angle * f.norm_squared()).sum();
    sum / (2.0 * IMPEDANCE)
}

/// The mean power that plane waves lose, from the scattered amplitude in the direction of travel of
/// each, W.
#[must_use]
pub fn extinct(wave: &Wave, waves: &[(PlaneWave, ComplexVector)]) -> f64 {
    let one = |(wave, forward): &(PlaneWave, ComplexVector)| {
        (wave.amplitude().conj() * forward.dot(wave.polarisation())).im
    };
    -TAU / (wave.wavenumber() * IMPEDANCE) * waves.iter().map(one).sum::<f64>()
}

/// The most that plane waves could lose by amplitudes of this strength, W: what they do lose is a
/// small part of it where the body is small beside the wavelength, and known to as much less.
#[must_use]
pub fn largest_extinct(wave: &Wave, waves: &[(PlaneWave, ComplexVector)]) -> f64 {
    let one = |(wave, forward): &(PlaneWave, ComplexVector)| wave.amplitude().norm() * forward.norm();
    TAU / (wave.wavenumber() * IMPEDANCE) * waves.iter().map(one).sum::<f64>()
}

/// The mean power that located sources give away together against the scattered E at a point, W;
/// none where one of them is a wave from infinity.
#[must_use]
pub fn supplied(
    sources: &[&dyn Source],
    wave: &Wave,
    scattered: &dyn Fn(Vec3) -> ComplexVector,
) -> Option<f64> {
    let one = |(i, source): (usize, &&dyn Source)| {
        let other = |p: Vec3| {
            let others = sources.iter().enumerate().filter(|(j, _)| *j != i);
            others.fold(scattered(p), |sum, (_, other)| sum + other.field(wave, p).e)
        };
        source.supplied(wave, &other)
    };
    if sources.is_empty() { None } else { sources.iter().enumerate().map(one).sum() }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::source::{HalfWaveDipole, HertzianDipole, Omnidirectional};
    use crate::{Complex64, ConductingSphere};

    fn wave() -> Wave {
        Wave::new(1e9).unwrap()
    }

    fn sources() -> Vec<Box<dyn Source>> {
        let (p, axis) = (Vec3::new(0.1, -0.2, 0.3), Vec3::new(1.0, 2.0, -0.5));
        vec![
            Box::new(HertzianDipole::new(p, axis, Complex64::new(0.3, 0.4)).unwrap()),
            Box::new(HalfWaveDipole::new(p, axis, Complex64::new(-0.3, 0.4)).unwrap()),
            Box::new(Omnidirectional::with_power(p, axis, 2.0).unwrap()),
        ]
    }

    #[test]
    fn amplitudes_are_those_of_the_field_far_away() {
        let far = 1e5;
        for source in sources() {
            for u in [Vec3::X, Vec3::new(0.36, 0.48, 0.8), Vec3::new(-0.6, 0.0, -0.8)] {
                let e = source.field(&wave(), u * far).e;
                let expected = source.far_amplitude(&wave(), u).unwrap();
                let found = e * (Complex64::cis(wave().wavenumber() * far) * far);
                assert!((found - expected).norm() < 1e-4 * expected.norm(), "{u}");
            }
        }
    }

    #[test]
    fn sources_alone_radiate_what_they_supply() {
        let alone = sources();
        for (i, source) in alone.iter().enumerate() {
            let rule = sphere_rule(&wave(), 0.4);
            let amplitudes: Vec<ComplexVector> =
                rule.iter().map(|&(u, _)| source.far_amplitude(&wave(), u).unwrap()).collect();
            let found = supplied(&[&**source], &wave(), &|_| ComplexVector::ZERO).unwrap();
            let expected = radiated(&rule, &amplitudes);
            // The omnidirectional source is not smooth on its axis, where the rule has few points.
            let bound = if i == 2 { 1e-2 } else { 1e-9 };
            assert!((found / expected - 1.0).abs() < bound, "{i}: {found} {expected}");
        }
    }

    /// Two dipoles side by side help or hinder each other; together they radiate what they supply.
    #[test]
    fn dipoles_supply_what_they_radiate_together() {
        let one = HertzianDipole::new(Vec3::ZERO, Vec3::Z, 1.0.into()).unwrap();
        let other = HalfWaveDipole::new(Vec3::X * 0.11, Vec3::Z, Complex64::new(1.0, -2.0)).unwrap();
        let both: [&dyn Source; 2] = [&one, &other];
        let rule = sphere_rule(&wave(), 0.15);
        let sum = |&(u, _): &(Vec3, f64)| {
            both.iter().map(|source| source.far_amplitude(&wave(), u).unwrap()).sum::<ComplexVector>()
        };
        let expected = radiated(&rule, &rule.iter().map(sum).collect::<Vec<_>>());
        let found = supplied(&both, &wave(), &|_| ComplexVector::ZERO).unwrap();
        assert!((found / expected - 1.0).abs() < 1e-9, "{found} {expected}");
    }

    /// By the exact series a conducting sphere scatters what it takes from the wave.
    #[test]
    fn a_sphere_scatters_what_is_extinct() {
        let (ball, far) = (ConductingSphere::new(0.2).unwrap(), 1e6);
        let source = PlaneWave::new(Vec3::Y, Vec3::Z, Complex64::new(0.6, 0.8)).unwrap();
        let back = Complex64::cis(wave().wavenumber() * far) * far;
        let amplitude = |u: Vec3| ball.scattered(&wave(), &source, u * far) * back;
        let rule = sphere_rule(&wave(), 0.2);
        let scattered = radiated(&rule, &rule.iter().map(|&(u, _)| amplitude(u)).collect::<Vec<_>>());
        let lost = extinct(&wave(), &[(source, amplitude(Vec3::Y))]);
        assert!((scattered / lost - 1.0).abs() < 1e-5, "{scattered} {lost}");
    }
}
