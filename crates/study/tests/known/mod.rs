//! Bodies with known answers as scene files, and what runs give for them.

#![allow(dead_code, reason = "every test file and example uses its part")]
#![allow(clippy::unwrap_used, reason = "a test that cannot go on has failed")]

#[path = "../../../moments/tests/common/mod.rs"]
pub mod common;
#[path = "../../../moments/examples/wave_cases/mod.rs"]
pub mod wave_cases;

use std::fmt::Write;
use std::fs;
use std::path::Path;

use fredholm_mesh::Vec3;
use fredholm_study::{Quiet, SolvedWaves, WaveOptions, waves};
use fredholm_waves::{Complex64, ComplexVector, polar_frame};

use common::WAVELENGTH;
use wave_cases::{Body, Case};

/// Polar angles and azimuths of the directions, each with the same share of the sphere.
const DIRECTIONS: [usize; 2] = [18, 24];

/// θ and φ in degrees, θ outside.
fn angles() -> [Vec<f64>; 2] {
    let [polar, around] = DIRECTIONS.map(|count| count as f64);
    let theta = |i: usize| (1.0 - (2.0 * i as f64 + 1.0) / polar).acos().to_degrees();
    let phi = |i: usize| 360.0 * i as f64 / around;
    [(0..DIRECTIONS[0]).map(theta).collect(), (0..DIRECTIONS[1]).map(phi).collect()]
}

fn unit(theta: f64, phi: f64) -> Vec3 {
    let ((sin, cos), (y, x)) = (theta.to_radians().sin_cos(), phi.to_radians().sin_cos());
    Vec3::new(sin * x, sin * y, cos)
}

/// Directions that cover the sphere evenly: the product of angles, as scene files can say it.
pub fn directions() -> Vec<Vec3> {
    let [theta, phi] = angles();
    theta.iter().flat_map(|&theta| phi.iter().map(move |&phi| unit(theta, phi))).collect()
}

/// The surfaces of a body as tables of a scene file.
pub fn surfaces(body: &Body) -> String {
    let mut text = String::new();
    let list = |p: Vec3| format!("{:?}", (p * WAVELENGTH).to_array());
    match body {
        Body::Plates(plates) => {
            for (i, [corner, u, v]) in plates.iter().enumerate() {
                let corners = [*corner, *corner + *u, *corner + *u + *v, *corner + *v].map(list);
                write!(text, "[[surface]]\nname = \"plate {i}\"\nquad = [{}]\n", corners.join(", ")).unwrap();
            }
        }
        Body::Cube(side) => return surfaces(&Body::Box(Vec3::splat(*side))),
        Body::Box(sides) => {
            let [min, max] = [-0.5, 0.5].map(|half| list(*sides * half));
            write!(text, "[[surface]]\nname = \"box\"\nbox = {{ min = {min}, max = {max} }}\n").unwrap();
        }
        Body::Sphere(radius) => {
            let radius = radius * WAVELENGTH;
            write!(
                text,
                "[[surface]]\nname = \"ball\"\nsphere = {{ centre = [0, 0, 0], radius = {radius:?} }}\n"
            )
            .unwrap();
        }
    }
    text
}

/// The scene of a case, seen from far away in all directions; `settings` are lines of its first
/// table.
pub fn scene(case: &Case, settings: &str) -> String {
    let [theta, phi] = angles();
    let [travel, along] = [case.travel, case.polarisation].map(|v: Vec3| v.to_array());
    format!(
        "[wave]\nfrequencies_hz = [1e9]\n{settings}\n[[source]]\nkind = \"plane-wave\"\ntravel = {travel:?}\n\
         polarisation = {along:?}\n{}[[receiver]]\nname = \"far\"\n\
         far = {{ theta_degrees = {theta:?}, phi_degrees = {phi:?} }}\n",
        surfaces(&case.body)
    )
}

/// Runs a scene.
pub fn solved(folder: &Path, text: &str) -> SolvedWaves<'static> {
    let path = folder.join("scene.toml");
    fs::write(&path, text).unwrap();
    waves(&path, &WaveOptions { no_report: true, ..WaveOptions::default() }, &Quiet)
        .unwrap_or_else(|error| panic!("{error}\n{text}"))
}

/// The far field that a run gives, in [`directions`].
pub fn far(found: &SolvedWaves<'_>) -> Vec<ComplexVector> {
    let amplitude = |(row, u): (&fredholm_report::FarRow, Vec3)| {
        let [theta, phi] = polar_frame(u);
        let a = row.amplitude;
        ComplexVector::along(theta, Complex64::new(a[0], a[1]))
            + ComplexVector::along(phi, Complex64::new(a[2], a[3]))
    };
    found.far().iter().zip(directions()).map(amplitude).collect()
}
