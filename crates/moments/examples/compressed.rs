//! The combined equation of a sphere, compressed, against the series of Mie: unknowns, CPU seconds,
//! memory and error.
//!
//! ```text
//! cargo run --release -p fredholm-moments --example compressed -- RADIUS EDGES TOLERANCE
//! ```
//!
//! RADIUS is in wavelengths, EDGES are counted to a wavelength.

#![allow(clippy::unwrap_used, reason = "an example that cannot go on has failed")]
#![allow(clippy::print_stdout, reason = "it prints its table")]

#[path = "../tests/common/mod.rs"]
mod common;

use common::{WAVELENGTH, circle, mie, relative_error, source, vertical, wave};
use fredholm_compressed::{BlockDiagonal, Preconditioned, Settings};
use fredholm_iterative::Gmres;
use fredholm_linop::{MultiVector, Quiet, SecondKind, Solver, Stop};
use fredholm_moments::meshing::sphere;
use fredholm_moments::{Basis, Conductor, Currents, Equation};
use fredholm_waves::{Complex64, Source};
use std::time::Instant;

fn main() {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    let number = |i: usize, usual: f64| arguments.get(i).map_or(usual, |text| text.parse().unwrap());
    let (radius, edge) = (number(0, 1.0) * WAVELENGTH, WAVELENGTH / number(1, 10.0));
    let tolerance = number(2, 1e-3);
    let basis = Basis::new(sphere(radius, edge).unwrap()).unwrap();
    let conductor = Conductor::new(&basis, wave(), Equation::default(), 1e-3).unwrap();
    let settings = Settings { tolerance, ..Settings::default() };
    let (matrix, assembly) = timed(|| conductor.operator().compressed(settings, &Quiet).unwrap());
    let summary = matrix.summary();
    let source = source();
    let sources: [&dyn Source; 1] = [&source];
    let b = conductor.right_hand_side(&[&sources]);
    let inverse = BlockDiagonal::new(&matrix).unwrap();
    let system = Preconditioned::new(&matrix, &inverse);
    let right = system.right_hand_side(&b);
    let a = SecondKind::new(&system, MultiVector::from_fn(b.dim(), 1, |_, _| Complex64::ONE)).unwrap();
    let mut x = MultiVector::zeros(b.dim(), 1);
    let stop = Stop { tolerance: 1e-4, max_iterations: 300 };
    let (report, solution) =
        timed(|| Gmres { restart: 100 }.solve(&a, &right, &mut x, &stop, &mut Quiet).unwrap());
    let currents = Currents::new(&basis, wave(), &x.vector(0), None);
    let error = relative_error(&vertical(&currents.fields(&circle()).unwrap()), &mie(radius));
    println!(
        "{} unknowns: assembly {assembly:.1} CPU s, {:.3} GB ({:.3} predicted, {:.3} of the whole), largest rank {}; {:?} \
         after {} iterations, {solution:.1} CPU s; error {error:.5}",
        basis.len(),
        summary.bytes as f64 / 1e9,
        summary.predicted as f64 / 1e9,
        summary.share,
        summary.largest_rank,
        report.reason,
        report.history.len() - 1,
    );
}

/// Seconds of the processor on all threads, user and system, as Linux counts them; of the clock
/// elsewhere.
fn timed<T>(run: impl FnOnce() -> T) -> (T, f64) {
    let spent = || {
        let text = std::fs::read_to_string("/proc/self/stat").ok()?;
        let fields: Vec<&str> = text.rsplit(')').next()?.split_whitespace().collect();
        let ticks = |at: usize| fields.get(at)?.parse::<f64>().ok();
        Some((ticks(11)? + ticks(12)?) / 100.0)
    };
    let (clock, before) = (Instant::now(), spent());
    let result = run();
    let clock = clock.elapsed().as_secs_f64();
    (result, before.zip(spent()).map_or(clock, |(before, after)| after - before))
}
