//! Iterations of every complex solver on a dihedral, two facing plates and a closed cube, with the
//! spectral radius of K: `cargo run --release -p fredholm-waves --example solvers_compared`. Mesh
//! λ/6, residual 1e-6.

use fredholm_linop::{MultiVector, Quiet, SecondKind, Solver, Stop};
use fredholm_mesh::Vec3;
use fredholm_waves::source::PlaneWave;
use fredholm_waves::surface::{cube, dihedral, parallel_plates};
use fredholm_waves::{
    Complex64, Discretisation, PhysicalOptics, Scatterer, Shadow, Source, System, Wave, spectral_radius,
};
use std::error::Error;
use std::f64::consts::FRAC_PI_2;

type Vectors = MultiVector<Complex64>;

fn compare(name: &str, scatterer: &Scatterer, shadow: Shadow, travel: Vec3) -> Result<(), Box<dyn Error>> {
    let wave = Wave::new(1e9)?;
    let source = PlaneWave::new(travel, Vec3::Z, 1.0.into())?;
    let sources: [&dyn Source; 1] = [&source];
    let first = PhysicalOptics::new(scatterer, wave, &sources, shadow)?;
    let system = System::stored(scatterer, wave, shadow, Discretisation::Nystrom)?;
    let b = system.right_hand_side(&[&first]);
    let radius = spectral_radius(system.coupling(), 200, &Quiet);
    println!("{name}: {} unknowns, spectral radius {:.3}", b.dim(), radius.unwrap_or(f64::NAN));
    let mut solvers: Vec<Box<dyn Solver<Complex64>>> = fredholm_iterative::solvers();
    solvers.extend(fredholm_direct::solvers());
    for solver in solvers {
        let a = SecondKind::new(system.coupling(), Vectors::from_fn(b.dim(), 1, |_, _| Complex64::ONE))?;
        let mut x = Vectors::zeros(b.dim(), 1);
        let stop = Stop { tolerance: 1e-6, max_iterations: 1500 };
        match solver.solve(&a, &b, &mut x, &stop, &mut Quiet) {
            Ok(report) => {
                let residual = report.history.last().map_or(f64::NAN, |entry| entry.residuals[0]);
                let iterations = report.history.len().saturating_sub(1);
                println!(
                    "  {:<14} {:?} after {iterations}, residual {residual:.1e}",
                    solver.name(),
                    report.reason
                );
            }
            Err(error) => println!("  {:<14} {error}", solver.name()),
        }
    }
    Ok(())
}

fn main() -> Result<(), Box<dyn Error>> {
    let wavelength = Wave::new(1e9)?.wavelength();
    let (edge, side) = (wavelength / 6.0, 3.0 * wavelength);
    let pair = dihedral(side, side, FRAC_PI_2, edge)?;
    compare("dihedral, 3λ", &pair, Shadow::Geometric, Vec3::new(-1.0, 0.3, 0.2))?;
    let facing = parallel_plates(side, wavelength, edge)?;
    compare("facing plates, 3λ, λ apart", &facing, Shadow::Geometric, Vec3::new(0.9, 0.3, 0.2))?;
    for side in [1.5, 2.1] {
        let body = cube(side * wavelength, edge)?;
        compare(&format!("closed cube, {side}λ"), &body, Shadow::Exact, Vec3::Y)?;
    }
    Ok(())
}
