//! A sphere by a compressed matrix or by multipoles, against the series of Mie: unknowns, CPU
//! seconds, memory, iterations and error.
//!
//! ```text
//! cargo run --release -p fredholm-moments --example compressed -- \
//!     RADIUS EDGES TOLERANCE BODY FACTORS
//! ```
//!
//! RADIUS is in wavelengths, EDGES are counted to a wavelength, BODY is `combined` (usual),
//! `magnetic` or `electric` for a conductor by one of these equations, or a permittivity such as 4
//! or 10-5j. `multipole-combined` and so on take multilevel fast multipoles in place of compressed
//! blocks. FACTORS is the tolerance of the factors that precondition the system; without it the
//! blocks on the diagonal do. The errors are those of E_z at 25 m, at 1.5 radii and, in
//! dielectrics, at half a radius.

#![allow(clippy::unwrap_used, reason = "an example that cannot go on has failed")]
#![allow(clippy::print_stdout, reason = "it prints its table")]

#[path = "../tests/common/mod.rs"]
mod common;

use common::{WAVELENGTH, circle, relative_error, source, vertical, wave};
use fredholm_compressed::{BlockDiagonal, Factors, MultipoleSettings, Preconditioned, Settings};
use fredholm_iterative::Gmres;
use fredholm_linop::{LinearOperator, MultiVector, Quiet, SecondKind, Solver, Stop};
use fredholm_mesh::Vec3;
use fredholm_moments::meshing::sphere;
use fredholm_moments::{Basis, Composite, Conductor, Currents, Equation, Filling, Operator, Regions};
use fredholm_waves::{Complex64, ComplexVector, ConductingSphere, DielectricSphere, Field, Source};
use std::time::Instant;

/// Steps of GMRES before it starts anew.
const RESTART: usize = 100;

fn main() {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    let number = |i: usize, usual: f64| arguments.get(i).map_or(usual, |text| text.parse().unwrap());
    let (radius, edge) = (number(0, 1.0) * WAVELENGTH, WAVELENGTH / number(1, 10.0));
    let body = arguments.get(3).map_or("combined", String::as_str);
    let run = Run { tolerance: number(2, 1e-3), factors: arguments.get(4).map(|text| text.parse().unwrap()) };
    let (surface, source) = (sphere(radius, edge).unwrap(), source());
    let sources: [&dyn Source; 1] = [&source];
    let at = |radii: f64| -> Vec<Vec3> { circle().iter().map(|p| *p * (radii * radius / 25.0)).collect() };
    let (far, near, within) = (circle(), at(1.5), at(0.5));
    let show = |currents: &Currents<'_>, scattered: &dyn Fn(Vec3) -> ComplexVector| {
        let error = |points: &[Vec3]| {
            let exact: Vec<Complex64> = points.iter().map(|&p| scattered(p).components()[2]).collect();
            relative_error(&vertical(&currents.fields(points).unwrap()), &exact)
        };
        println!("error {:.5} far, {:.5} near", error(&far), error(&near));
    };
    let (by_multipoles, body) = body.strip_prefix("multipole-").map_or((false, body), |body| (true, body));
    match body {
        "combined" | "magnetic" | "electric" => {
            let equation = match body {
                "electric" => Equation::Electric,
                "magnetic" => Equation::Magnetic,
                _ => Equation::default(),
            };
            let basis = Basis::new(surface).unwrap();
            let conductor = Conductor::new(&basis, wave(), equation, 1e-3).unwrap();
            let b = conductor.right_hand_side(&[&sources]);
            let x = if by_multipoles {
                run.solve_by_multipoles(&conductor, &b)
            } else {
                run.solve(conductor.operator(), &b)
            };
            let ball = ConductingSphere::new(radius).unwrap();
            show(&Currents::new(&basis, wave(), &x, None), &|p| ball.scattered(&wave(), &source, p));
        }
        permittivity => {
            let Ok(permittivity) = permittivity.parse::<Complex64>() else {
                println!("BODY is combined, magnetic, electric or a permittivity, not {permittivity}");
                std::process::exit(2);
            };
            let fillings = vec![Filling::Dielectric(0); surface.triangles().len()];
            let regions = Regions::new(&surface, &fillings).unwrap();
            let basis = Basis::between(regions).unwrap();
            let composite = Composite::new(&basis, wave(), &[permittivity], 1e-3).unwrap();
            let x = run.solve(composite.operator(), &composite.right_hand_side(&[&sources]));
            let ball = DielectricSphere::new(radius, permittivity).unwrap();
            let currents = composite.currents(&x);
            show(&currents, &|p| ball.scattered(&wave(), &source, p));
            let inside: Vec<Field> =
                composite.fields_inside(&currents, &within).unwrap().into_iter().flatten().collect();
            let exact = |&p: &Vec3| ball.inside(&wave(), &source, p).components()[2];
            let exact: Vec<Complex64> = within.iter().map(exact).collect();
            println!("      {:.5} inside", relative_error(&vertical(&inside), &exact));
        }
    }
}

struct Run {
    tolerance: f64,
    factors: Option<f64>,
}

impl Run {
    /// Compresses and solves, and says what that took.
    fn solve(&self, operator: &Operator<'_>, b: &MultiVector<Complex64>) -> Vec<Complex64> {
        let settings = Settings { tolerance: self.tolerance, ..Settings::default() };
        let (matrix, assembly) = timed(|| operator.compressed(settings, &Quiet).unwrap());
        let summary = matrix.summary();
        println!(
            "{} unknowns: assembly {assembly:.1} CPU s, {:.3} GB ({:.3} predicted, {:.3} of the whole), largest rank {}",
            operator.dim(),
            summary.bytes as f64 / 1e9,
            summary.predicted as f64 / 1e9,
            summary.share,
            summary.largest_rank,
        );
        let (inverse, seconds): (Box<dyn LinearOperator<Complex64>>, f64) = match self.factors {
            Some(tolerance) => {
                let (factors, seconds) =
                    timed(|| Factors::new(&matrix, tolerance, u64::MAX, &Quiet).unwrap());
                println!(
                    "factors to {tolerance}: {seconds:.1} CPU s, {:.3} GB",
                    factors.bytes() as f64 / 1e9
                );
                (Box::new(factors), seconds)
            }
            None => (Box::new(BlockDiagonal::new(&matrix).unwrap()), 0.0),
        };
        finish((&matrix, &*inverse), b, seconds)
    }

    /// The same by multipoles.
    fn solve_by_multipoles(&self, conductor: &Conductor<'_>, b: &MultiVector<Complex64>) -> Vec<Complex64> {
        let settings = MultipoleSettings { tolerance: self.tolerance, ..MultipoleSettings::default() };
        let (matrix, assembly) = timed(|| conductor.multipole(settings, &Quiet).unwrap());
        let summary = matrix.summary();
        println!(
            "{} unknowns: assembly {assembly:.1} CPU s, {:.3} GB ({:.4} of the whole): near {:.3}, patterns {:.3}, tables {:.3}, fields {:.3}; {} leaves, {} levels, {:?} directions",
            b.dim(),
            summary.bytes as f64 / 1e9,
            summary.share,
            summary.near as f64 / 1e9,
            summary.patterns as f64 / 1e9,
            summary.tables as f64 / 1e9,
            summary.fields as f64 / 1e9,
            summary.leaves,
            summary.levels,
            summary.directions,
        );
        let (inverse, seconds) = timed(|| BlockDiagonal::new(&matrix).unwrap());
        let mut y = MultiVector::zeros(b.dim(), 1);
        let ((), product) = timed(|| matrix.apply(b, &mut y));
        println!("a product {product:.2} CPU s");
        finish((&matrix, &inverse), b, seconds)
    }
}

/// Solves with a matrix and what preconditions it, which took some seconds.
fn finish(
    (matrix, inverse): (&dyn LinearOperator<Complex64>, &dyn LinearOperator<Complex64>),
    b: &MultiVector<Complex64>,
    seconds: f64,
) -> Vec<Complex64> {
    let system = Preconditioned::new(matrix, inverse);
    let right = system.right_hand_side(b);
    let ones = MultiVector::from_fn(b.dim(), 1, |_, _| Complex64::ONE);
    let a = SecondKind::new(&system, ones).unwrap();
    let mut x = MultiVector::zeros(b.dim(), 1);
    let stop = Stop { tolerance: 1e-4, max_iterations: 3000 };
    let (report, solution) =
        timed(|| Gmres { restart: RESTART }.solve(&a, &right, &mut x, &stop, &mut Quiet).unwrap());
    println!(
        "{:?} after {} iterations, {solution:.1} CPU s; {:.1} with what preconditions",
        report.reason,
        report.history.len() - 1,
        solution + seconds,
    );
    x.vector(0)
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
