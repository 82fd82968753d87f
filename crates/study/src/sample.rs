//! The time of a solution on elements, before it is computed.
//!
//! What takes most of it is tried on a part: form factors of some panels, the exposure of some
//! elements, and rows of the residual that states the error. A system of n unknowns and b bands
//! takes n² b numbers an iteration, and an elimination n³/3 multiplications (Cholesky) to 2 n³/3.
//! Times are those of one thread that has a core to itself.

use fredholm_coupling::{Constants, DRAWN_SEQUENCES, Extent, assembly_seconds, exposure_seconds};
use fredholm_linop::MultiVector;
use fredholm_mesh::Patch;

use crate::meter::spent;
use crate::problem::{Problem, pixels, prepare};

/// Seconds that each sample may take.
const SECONDS_OF_A_SAMPLE: f64 = 0.4;
/// Seconds for a number of the matrix in a product, in one band; for a multiplication of an
/// elimination; for a value in the files; and for a pixel of the picture. Measured on one core at
/// 2 to 3 GHz (docs/notes/build.md).
const SECONDS_A_NUMBER: f64 = 2.5e-10;
const SECONDS_A_MULTIPLICATION: f64 = 5e-11;
const SECONDS_A_VALUE: f64 = 2e-6;
const SECONDS_A_PIXEL: f64 = 1e-6;
/// Relative residual at which the sources of errors are no longer followed.
const FOLLOWED_RESIDUAL: f64 = 1e-3;

/// Seconds that a solution on the elements takes one thread, with its files and its picture.
pub(crate) fn seconds(problem: &Problem) -> f64 {
    let form_factors = assembly_seconds(&problem.integrator(), SECONDS_OF_A_SAMPLE, &spent);
    let patches = problem.patches();
    let owned: Vec<Patch> = problem.mesh.patches().copied().collect();
    let exposure =
        prepare(&owned).map_or(0.0, |lit| exposure_seconds(&patches, &lit, SECONDS_OF_A_SAMPLE, &spent));
    let values = problem.mesh.len() as f64 * problem.scene.bands().len() as f64;
    let files = SECONDS_A_VALUE * values + SECONDS_A_PIXEL * pixels(&problem.scene) as f64;
    form_factors + exposure + solving(problem) + errors(problem, &patches) + files
}

/// Seconds of the solver.
fn solving(problem: &Problem) -> f64 {
    let (n, bands) = (problem.unknowns as f64, problem.scene.bands().len() as f64);
    if problem.solver.iterative {
        SECONDS_A_NUMBER * n * n * bands * iterations(problem, USUAL_RESIDUAL)
    } else {
        SECONDS_A_MULTIPLICATION * n.powi(3) * bands
    }
}

/// Usual residual.
const USUAL_RESIDUAL: f64 = 1e-10;

/// Iterations to a residual: light that is reflected once loses 1 − ρ of its power, and a sweep
/// follows two reflections.
fn iterations(problem: &Problem, residual: f64) -> f64 {
    let (mesh, bands) = (&problem.mesh, problem.scene.bands().len());
    let reflectance = problem.scene.reflectance(mesh);
    let area: f64 = mesh.patches().map(Patch::area).sum();
    let mean = |band: usize| {
        mesh.patches().enumerate().map(|(i, p)| p.area() * reflectance[i * bands + band]).sum::<f64>() / area
    };
    let rho = (0..bands).map(mean).fold(0.0, f64::max).clamp(0.1, 0.9999);
    (residual.ln() / (2.0 * rho.ln())).max(1.0)
}

/// Seconds of the stated error: its residual, and the sources of errors that are followed.
fn errors(problem: &Problem, patches: &[&Patch]) -> f64 {
    let (n, bands) = (patches.len(), problem.scene.bands().len());
    let elements: Vec<Extent> =
        patches.iter().map(|p| Extent { area: p.area(), exposed: p.area() }).collect();
    let Ok(reflectance) = problem.multivector(problem.scene.reflectance(&problem.mesh)) else { return 0.0 };
    // Any light takes the same time.
    let light = MultiVector::from_fn(n, bands, |i, _| 1.0 + i as f64 / n as f64);
    let constants = Constants {
        patches,
        occluders: &problem.occluders,
        elements: &elements,
        reflectance: &reflectance,
        radiosity: &light,
        irradiance: &light,
    };
    let rhs_count = (DRAWN_SEQUENCES + 2) as f64 * bands as f64;
    let followed = SECONDS_A_NUMBER * (n as f64).powi(2) * rhs_count * iterations(problem, FOLLOWED_RESIDUAL);
    constants.seconds(SECONDS_OF_A_SAMPLE, &spent) + followed
}
