//! The current near the edge of a plate against that of a half-plane, perfectly conducting
//! (Sommerfeld) and resistive (Wiener and Hopf).
//!
//! A plate has three more edges. What comes from the opposite one is a wave along the sheet with E
//! along the edges, which a conductor shorts: below a hundredth at three wavelengths. What comes
//! from the ends travels along the edge with e^{∓jkz}, and vanishes in a mean over whole wavelengths
//! that fades out smoothly.

#![allow(clippy::unwrap_used, reason = "a test that cannot go on has failed")]

mod common;

use common::{WAVELENGTH, currents, currents_on, source, wave};
use fredholm_mesh::Vec3;
use fredholm_moments::meshing::{Grading, rectangle};
use fredholm_moments::{Basis, Condition, Conductor, Currents, Equation, Imperfect};
use fredholm_quadrature::gauss_legendre;
use fredholm_waves::Complex64;
use fredholm_waves::canonical::{HalfPlane, Medium, ResistiveHalfPlane};
use std::f64::consts::PI;

/// Across and along the edge, wavelengths.
const SIDES: [f64; 2] = [3.0, 4.0];
/// Half the length along the edge over which currents are averaged, wavelengths.
const FADED: f64 = 1.5;
/// How far from the edge they are compared, wavelengths.
const FARTHEST: f64 = 0.75;
/// Points of the means of the exact current.
const POINTS: usize = 8;

/// The plate in y = 0 whose edge is the axis z.
fn basis(halvings: usize) -> Basis {
    let [across, along] = SIDES.map(|side| side * WAVELENGTH);
    let corner = Vec3::Z * (-0.5 * along);
    let [u, v] = [Vec3::X * across, Vec3::Z * along];
    Basis::new(rectangle(corner, u, v, WAVELENGTH / 10.0, Grading { halvings }).unwrap()).unwrap()
}

/// A strip of cells along the edge: where it begins and ends (m), and the mean of J_z in it.
struct Strip {
    from: f64,
    to: f64,
    mean: Complex64,
}

/// The strips from the edge on.
fn strips(basis: &Basis, currents: &Currents<'_>) -> Vec<Strip> {
    let surface = basis.surface();
    let mut strips: Vec<(Strip, f64)> = Vec::new();
    for (triangle, corners) in surface.triangles().iter().enumerate() {
        let corners = corners.map(|vertex| surface.vertices()[vertex as usize]);
        let places = corners.map(|corner| corner.x);
        let [from, to] =
            [places.iter().fold(f64::MAX, |a, b| a.min(*b)), places.iter().fold(0.0, |a: f64, b| a.max(*b))];
        let centre = (corners[0] + corners[1] + corners[2]) / 3.0;
        if centre.z.abs() > FADED * WAVELENGTH || to > FARTHEST * WAVELENGTH {
            continue;
        }
        let area = 0.5 * (corners[1] - corners[0]).cross(corners[2] - corners[0]).length();
        let weight = area * (0.5 * PI * centre.z / (FADED * WAVELENGTH)).cos().powi(2);
        let value = currents.electric(triangle).components()[2] * weight;
        match strips.iter_mut().find(|(strip, _)| (strip.from - from).abs() < 1e-9) {
            Some((strip, weights)) => (strip.mean, *weights) = (strip.mean + value, *weights + weight),
            None => strips.push((Strip { from, to, mean: value }, weight)),
        }
    }
    let strips = strips.into_iter();
    strips.map(|(strip, weights)| Strip { mean: strip.mean / weights, ..strip }).collect()
}

/// Relative errors of the means, of a current J_z at distances from the edge (m). With
/// x = from + (to − from) s² the singularity of the edge is none.
fn errors(strips: &[Strip], exact: impl Fn(&[f64]) -> Vec<Complex64>) -> Vec<f64> {
    let rule = gauss_legendre(POINTS);
    let error = |strip: &Strip| {
        let places: Vec<f64> =
            rule.points.iter().map(|s| strip.from + (strip.to - strip.from) * s * s).collect();
        let terms = exact(&places).into_iter().zip(rule.points.iter().zip(&rule.weights));
        let mean: Complex64 = terms.map(|(j, (s, weight))| j * (2.0 * s * weight)).sum();
        let error = (strip.mean - mean).norm() / mean.norm();
        println!("    {:.4} … {:.4} λ: {error:.4}", strip.from / WAVELENGTH, strip.to / WAVELENGTH);
        error
    };
    strips.iter().map(error).collect()
}

#[test]
fn the_current_of_a_conductor_grows_towards_its_edge_as_that_of_a_half_plane() {
    let medium = Medium::free_space(&wave());
    let exact = |places: &[f64]| {
        let current = |&x: &f64| HalfPlane.current(&medium, &source(), x, 0.0).unwrap().components()[2];
        places.iter().map(current).collect()
    };
    for (halvings, at_edge) in [(0, 0.06), (2, 0.02)] {
        let basis = basis(halvings);
        let conductor = Conductor::new(&basis, wave(), Equation::Electric, 1e-3).unwrap();
        println!("conductor, {halvings} halvings");
        let errors = errors(&strips(&basis, &currents(&conductor, &basis)), exact);
        // The functions do not follow the singularity within a cell: the first has its whole
        // current, and the second pays for it on any mesh.
        assert!(errors[0] < at_edge && errors[1] < 0.12, "{errors:?}");
        assert!(errors[2..].iter().all(|error| *error < 0.05), "{errors:?}");
        // From the fourth on, what is left is the opposite edge.
        assert!(errors[3..].iter().all(|error| *error < 0.015), "{errors:?}");
    }
}

#[test]
fn the_current_of_a_resistive_sheet_is_that_of_a_half_plane() {
    let medium = Medium::free_space(&wave());
    for resistance in [50.0, 377.0] {
        let basis = basis(2);
        let conditions = vec![Condition::Sheet(resistance.into()); basis.surface().triangles().len()];
        let sheet = Imperfect::new(&basis, wave(), conditions, 1e-3).unwrap();
        let half_plane = ResistiveHalfPlane::new(resistance).unwrap();
        let exact = |places: &[f64]| {
            let currents = half_plane.currents(&medium, &source(), places).unwrap();
            currents.into_iter().map(|current| current.components()[2]).collect()
        };
        println!("{resistance} Ω");
        let errors = errors(&strips(&basis, &currents_on(&sheet)), exact);
        assert!(errors.iter().all(|error| *error < 0.03), "{errors:?}");
    }
}
