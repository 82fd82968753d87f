//! How long the form factors of a unit cube take, and how well its rows sum to 1.
//!
//! cargo run --release -p fredholm-coupling --example enclosure -- N BOX T [THREADS]
//!
//! N × N patches a wall; with BOX = 1 an opaque box of side 0.4 in the middle, 4 × 4 patches a
//! face. T is the tolerance of a form factor.

use fredholm_coupling::form_factor::PairIntegrator;
use fredholm_coupling::{Assembled, assemble};
use fredholm_linop::Quiet;
use fredholm_mesh::{MeshError, Patch, Vec3};
use fredholm_visibility::Occluders;
use std::time::Instant;

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let args: Vec<f64> = std::env::args().skip(1).filter_map(|x| x.parse().ok()).collect();
    let get = |k: usize, otherwise: f64| args.get(k).copied().unwrap_or(otherwise);
    let (n, inner, tolerance) = (get(0, 8.0) as usize, get(1, 0.0) > 0.0, get(2, 1e-3));
    let mut patches = walls(Vec3::ZERO, 1.0, n, true)?;
    if inner {
        patches.extend(walls(Vec3::splat(0.3), 0.4, 4, false)?);
    }
    let pool = rayon::ThreadPoolBuilder::new().num_threads(get(3, 1.0) as usize).build()?;
    let start = Instant::now();
    let assembled: Assembled<f64> = pool
        .install(|| {
            let occluders = Occluders::new(&patches)?;
            let integrator = PairIntegrator::new(&patches, &occluders, tolerance);
            assemble(&integrator, &Quiet).map_err(Box::<dyn std::error::Error + Send + Sync>::from)
        })
        .map_err(|e| e as Box<dyn std::error::Error>)?;
    let seconds = start.elapsed().as_secs_f64();
    let sums = assembled.matrix.row_sums();
    let worst =
        sums.iter().zip(&patches).map(|(sum, patch)| (sum / patch.area() - 1.0).abs()).fold(0.0, f64::max);
    let stated = assembled.error.iter().zip(&patches).map(|(e, patch)| e / patch.area()).fold(0.0, f64::max);
    println!(
        "{} patches, T = {tolerance:e}: {seconds:.3} s, row sums within {worst:.1e}, stated {stated:.1e}",
        patches.len()
    );
    println!("{:?}", assembled.methods);
    Ok(())
}

/// An n × n grid on each side of a cube.
fn walls(low: Vec3, size: f64, n: usize, inward: bool) -> Result<Vec<Patch>, MeshError> {
    let mut patches = Vec::new();
    for axis in 0..3 {
        let [u, v, w] = [axis, axis + 1, axis + 2].map(|k| Vec3::AXES[k % 3] * size);
        for (corner, up) in [(low, true), (low + w, false)] {
            for k in 0..n * n {
                let at = |i: usize, j: usize| corner + (u * i as f64 + v * j as f64) / n as f64;
                let (i, j) = (k / n, k % n);
                let cell = Patch::quad([at(i, j), at(i + 1, j), at(i + 1, j + 1), at(i, j + 1)])?;
                patches.extend(cell.map(|cell| if up == inward { cell } else { cell.flipped() }));
            }
        }
    }
    Ok(patches)
}
