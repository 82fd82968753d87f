//! Conductors against exact answers: the error of the scattered field at 25 m, radiated over
//! extinguished power, seconds.
//!
//!     cargo run --release -p fredholm-moments --example conductors -- sphere 0.5 10
//!     cargo run --release -p fredholm-moments --example conductors -- plate 5 10 2
//!
//!     cargo run --release -p fredholm-moments --example conductors -- sphere 0.5 5 0 1 1e-4
//!
//! The arguments are the body (sphere, plate, two-plates), its size (radius or side in
//! wavelengths), cells a wavelength, halvings of the cells towards open edges, the order of the
//! functions (0, or 1 with spheres of curved triangles), and the tolerance of the integrals. Plates
//! are compared with tests/data/wave, which has sides of 5 λ.

#![allow(clippy::unwrap_used, reason = "an example shows the way, not what may go wrong on it")]

#[path = "../tests/common/mod.rs"]
mod common;

use common::{WAVELENGTH, circle, mie, reference, relative_error, solved, source, vertical, wave};
use fredholm_moments::meshing::{Grading, curved_sphere, facing_plates, plate, sphere};
use fredholm_moments::{Basis, Conductor, Currents, Equation, Order, Surface};
use fredholm_waves::{Complex64, Source};
use std::time::Instant;

fn seconds<T>(run: impl FnOnce() -> T) -> (T, f64) {
    let start = Instant::now();
    (run(), start.elapsed().as_secs_f64())
}

fn show(basis: &Basis, equation: Equation, tolerance: f64, exact: &[Complex64]) {
    let source = source();
    let conductor = Conductor::new(basis, wave(), equation, tolerance).unwrap();
    let (coupling, assembly) = seconds(|| conductor.operator().coupling().unwrap());
    let sources: [&dyn Source; 1] = [&source];
    let b = conductor.right_hand_side(&[&sources]);
    let (x, solution) = seconds(|| solved(&coupling, &b));
    let currents = Currents::new(basis, wave(), &x.vector(0), None);
    let (fields, radiation) = seconds(|| currents.fields(&circle()).unwrap());
    let power = currents.radiated_power().unwrap() / currents.extinguished_power(&source).unwrap();
    println!(
        "{}: {} unknowns, error {:.6}, power {power:.7}, assembly {assembly:.2} s, LU {solution:.2} s, fields {radiation:.2} s",
        equation.name(),
        basis.len(),
        relative_error(&vertical(&fields), exact),
    );
}

fn main() {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    let number = |i: usize, usual: f64| arguments.get(i).map_or(usual, |text| text.parse().unwrap());
    let body = arguments.first().map_or("sphere", String::as_str);
    let size = number(1, if body == "sphere" { 0.5 } else { 5.0 }) * WAVELENGTH;
    let edge = WAVELENGTH / number(2, 10.0);
    let grading = Grading { halvings: number(3, 0.0) as usize };
    let (order, tolerance) = match number(4, 0.0) {
        0.0 => (Order::Lowest, 1e-3),
        _ => (Order::First, 1e-4),
    };
    let tolerance = number(5, tolerance);
    let basis = |surface: Surface| Basis::of_order(surface, order).unwrap();
    match body {
        "plate" => {
            let surface = plate(size, edge, grading).unwrap();
            show(&basis(surface), Equation::Electric, tolerance, &reference("plate_5lambda_normal.csv"));
        }
        "two-plates" => {
            let surface = facing_plates(size, 2.0, edge, grading).unwrap();
            show(&basis(surface), Equation::Electric, tolerance, &reference("two_plates_normal.csv"));
        }
        _ => {
            let sphere = if order == Order::First { curved_sphere } else { sphere };
            let basis = basis(sphere(size, edge).unwrap());
            for equation in [Equation::Electric, Equation::Magnetic, Equation::default()] {
                show(&basis, equation, tolerance, &mie(size));
            }
        }
    }
}
