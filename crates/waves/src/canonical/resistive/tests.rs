use super::*;
use crate::canonical::HalfPlane;
use crate::canonical::bessel;
use crate::canonical::tests::{from, wave_of};

fn lossy() -> Medium {
    Medium::of(&wave_of(3.0), Complex64::new(2.5, -1.5)).unwrap()
}

fn free() -> Medium {
    Medium::free_space(&wave_of(3.0))
}

/// From this azimuth, E along the edge or across it.
fn source(degrees: f64, along: bool) -> PlaneWave {
    let (sin, cos) = degrees.to_radians().sin_cos();
    from([-cos, -sin, 0.0], if along { [0.0, 0.0, 1.0] } else { [sin, -cos, 0.0] })
}

#[test]
fn the_factors_multiply_to_the_whole() {
    for s in [1e-4, 0.3, 1.0, 2.5, 1e5] {
        for s in [s.into(), Complex64::from_polar(s, 0.3)] {
            let factor = Factor::new(s);
            for w in [0.01, 0.4, 1.3, 3.0] {
                for w in [w.into(), Complex64::new(w, -0.8), Complex64::new(0.9, -20.0 * w)] {
                    let found = factor.at(w) * factor.at(PI - w);
                    let expected = (s + w.sin()) / (s + 1.0);
                    let error = (found / expected - 1.0).norm();
                    assert!(error < 1e-12, "{s} {w}: {error:e}");
                }
            }
        }
    }
}

#[test]
fn without_resistance_it_is_sommerfelds() {
    let distances = [1e-4, 0.03, 0.7, 5.0];
    for medium in [free(), lossy()] {
        for degrees in [3.0, 60.0, 90.0, 170.0, 180.0, 250.0] {
            for along in [true, false] {
                let source = source(degrees, along);
                for (sheet, tolerance) in [(0.0, 1e-12), (1e-9, 1e-5)] {
                    let sheet = ResistiveHalfPlane::new(sheet).unwrap();
                    let found = sheet.currents(&medium, &source, &distances).unwrap();
                    for (found, x) in found.into_iter().zip(distances) {
                        let expected = HalfPlane.current(&medium, &source, x, 0.0).unwrap();
                        let eta = medium.impedance().norm();
                        let gap = (found - expected).norm() * eta / (1.0 + expected.norm() * eta);
                        assert!(gap < tolerance, "{degrees} {along} {x}: {gap:e}");
                    }
                }
            }
        }
    }
}

/// Nodes and weights on 0 … 1 in panels that halve towards 0.
fn graded() -> Vec<[f64; 2]> {
    let rule = gauss_legendre(12);
    let panel = |i: i32| {
        let size = 0.5_f64.powi(i + 1);
        rule.points
            .iter()
            .zip(&rule.weights)
            .map(move |(x, w)| [size * (1.0 + x), size * w])
            .collect::<Vec<_>>()
    };
    (0..40).flat_map(panel).collect()
}

/// ∫₀^∞ J(x′) H₀⁽²⁾(k|x − x′|) dx′.
fn potential(medium: &Medium, x: f64, reach: f64, current: &dyn Fn(&[f64]) -> Vec<Complex64>) -> Complex64 {
    // Place, distance and weight: from the edge to half way, from there to x, and beyond.
    let mut nodes = vec![];
    for [t, w] in graded() {
        let half = 0.5 * x;
        nodes.push([half * t, x - half * t, half * w]);
        nodes.push([x - half * t, half * t, half * w]);
        nodes.push([x + t, t, w]);
    }
    let rule = gauss_legendre(20);
    for i in 1..reach.ceil() as i32 {
        for (t, w) in rule.points.iter().zip(&rule.weights) {
            nodes.push([x + t + f64::from(i), t + f64::from(i), *w]);
        }
    }
    let places: Vec<f64> = nodes.iter().map(|node| node[0]).collect();
    let kernel = |distance: f64| {
        let z = medium.wavenumber() * distance;
        bessel::outgoing(z, 1).unwrap()[0] * (z * -Complex64::I).exp()
    };
    let values = current(&places);
    nodes.iter().zip(values).map(|([_, distance, weight], j)| j * kernel(*distance) * *weight).sum()
}

/// E_z − (kη/4) ∫ J H₀ = Z_s J, and E_x − (η/4k)(k² + d²/dx²) ∫ J H₀ = Z_s J, where losses end the
/// integral.
#[test]
fn it_obeys_the_integral_equations() {
    let medium = lossy();
    let (k, eta) = (medium.wavenumber(), medium.impedance());
    let x = 0.5;
    for (resistance, degrees) in [(3.0, 60.0), (377.0, 60.0), (377.0, 150.0), (5e3, 250.0)] {
        let sheet = ResistiveHalfPlane::new(resistance).unwrap();
        let reach = 32.0 / (-k.im * (1.0 - f64::cos(f64::to_radians(degrees))));
        for (along, axis) in [(true, Vec3::Z), (false, Vec3::X)] {
            let source = source(degrees, along);
            let current = |places: &[f64]| -> Vec<Complex64> {
                let found = sheet.currents(&medium, &source, places).unwrap();
                found.into_iter().map(|j| j.dot(axis)).collect()
            };
            let at = |x: f64| potential(&medium, x, reach, &current);
            let (radiated, tolerance) = if along {
                (at(x) * k * eta * 0.25, 1e-10)
            } else {
                // The second derivative by differences of the sixth order.
                let step = 0.02;
                let curved: Complex64 = [(1.0, 270.0), (2.0, -27.0), (3.0, 2.0)]
                    .map(|(i, weight)| (at(x + i * step) + at(x - i * step)) * weight)
                    .into_iter()
                    .sum();
                let here = at(x);
                let curved = (curved - here * 490.0) / (180.0 * step * step);
                ((here * k * k + curved) * eta / (k * 4.0), 1e-8)
            };
            let incident = medium.incident(&source, Vec3::X * x).e.dot(axis);
            let residual = (incident - radiated - current(&[x])[0] * resistance).norm();
            let error = residual / incident.norm();
            assert!(error < tolerance, "{resistance} {degrees} {along}: {error:e}");
        }
    }
}

/// Far from the edge it is the current of a sheet without one, E/(Z_s + η/(2 sin φ′)) and E/(Z_s +
/// η sin φ′/2), and a weak one is driven by the incident field alone.
#[test]
fn far_away_it_is_an_endless_sheet_and_a_weak_one_changes_nothing() {
    let (medium, half, sin) = (free(), 0.5 * free().impedance(), 60_f64.to_radians().sin());
    for (along, axis, slope) in [(true, Vec3::Z, 1.0 / sin), (false, Vec3::X, sin)] {
        for (resistance, x, tolerance) in [(50.0, 1e5, 1e-6), (1e7, 0.1, 1e-4)] {
            let sheet = ResistiveHalfPlane::new(resistance).unwrap();
            let source = source(60.0, along);
            let found = sheet.currents(&medium, &source, &[x]).unwrap()[0].dot(axis);
            let incident = medium.incident(&source, Vec3::X * x).e.dot(axis);
            let expected = incident / (half * slope + resistance);
            let error = (found / expected - 1.0).norm();
            assert!(error < tolerance, "{along} {resistance}: {error:e}");
        }
    }
}

#[test]
fn what_is_no_sheet_or_no_wave_for_it_is_refused() {
    assert!(ResistiveHalfPlane::new(-1.0).is_err() && ResistiveHalfPlane::new(f64::NAN).is_err());
    let sheet = ResistiveHalfPlane::new(100.0).unwrap();
    let found = sheet.currents(&free(), &crate::canonical::tests::oblique(), &[1.0]);
    assert!(matches!(found, Err(WaveError::Travel { .. })));
    for x in [0.0, -1.0, f64::NAN] {
        let found = sheet.currents(&free(), &source(60.0, true), &[1.0, x]);
        assert!(matches!(found, Err(WaveError::Length { .. })), "{x}");
    }
}
