//! How long the form factors of a room with the fifty boxes of `scenes/fifty_boxes.toml` take, and
//! how well its rows sum to 1.
//!
//! cargo run --release -p fredholm-coupling --example fifty_boxes -- T [THREADS] [SCALE] [SHIFT]
//!
//! T is the tolerance of a form factor; the room is scaled and then moved by SHIFT (m) along each
//! axis. Rows of patches on which a box stands, and of what stands on them, are left out.

use fredholm_coupling::form_factor::PairIntegrator;
use fredholm_coupling::{Assembled, assemble};
use fredholm_linop::Quiet;
use fredholm_mesh::{MeshError, Patch, Vec3};
use fredholm_visibility::Occluders;
use std::error::Error;
use std::time::Instant;

fn main() -> Result<(), Box<dyn Error>> {
    let args: Vec<f64> = std::env::args().skip(1).filter_map(|x| x.parse().ok()).collect();
    let get = |k: usize, otherwise: f64| args.get(k).copied().unwrap_or(otherwise);
    let (tolerance, threads, scale, shift) =
        (get(0, 1e-2), get(1, 1.0), get(2, 1.0), Vec3::splat(get(3, 0.0)));
    let (patches, exposed) = room(|x| x * scale + shift)?;
    let pool = rayon::ThreadPoolBuilder::new().num_threads(threads as usize).build()?;
    let start = Instant::now();
    let assembled = pool.install(|| all(&patches, tolerance)).map_err(|e| e as Box<dyn Error>)?;
    let seconds = start.elapsed().as_secs_f64();
    let sums = assembled.matrix.row_sums();
    let defect = |k: &usize| (sums[*k] / patches[*k].area() - 1.0).abs();
    let worst = exposed.iter().map(defect).fold(0.0, f64::max);
    let (n, seen) = (patches.len(), exposed.len());
    println!("{n} patches, {seen} exposed, T = {tolerance:e}: {seconds:.3} s, row sums within {worst:.1e}");
    println!("{:?}", assembled.methods);
    Ok(())
}

fn all(patches: &[Patch], tolerance: f64) -> Result<Assembled<f64>, Box<dyn Error + Send + Sync>> {
    let occluders = Occluders::new(patches)?;
    let integrator = PairIntegrator::new(patches, &occluders, tolerance);
    Ok(assemble(&integrator, &Quiet)?)
}

/// The room in squares of half a metre and the boxes with 2 × 2 patches a face, put in their place,
/// and the numbers of the patches that nothing covers.
fn room(place: impl Fn(Vec3) -> Vec3) -> Result<(Vec<Patch>, Vec<usize>), Box<dyn Error>> {
    let walls = [Vec3::ZERO, Vec3::new(10.0, 10.0, 3.5)];
    let boxes = boxes()?;
    let mut cells = faces(walls, [20, 20, 7], true)?;
    for &body in &boxes {
        cells.extend(faces(body, [2; 3], false)?);
    }
    let holds = |[min, max]: [Vec3; 2], x: Vec3| x.cmpgt(min).all() && x.cmplt(max).all();
    let exposed = |cell: &Patch| {
        let before = cell.centroid() + cell.normal() * 1e-3;
        holds(walls, before) && !boxes.iter().any(|&body| holds(body, before))
    };
    let seen = (0..cells.len()).filter(|&k| exposed(&cells[k])).collect();
    let put = |cell: &Patch| Patch::quad([0, 1, 2, 3].map(|k| place(cell.corner(k))));
    let patches: Result<Vec<_>, _> = cells.iter().map(put).collect();
    Ok((patches?.into_iter().flatten().collect(), seen))
}

/// The lowest and highest corners of the boxes of the scene.
fn boxes() -> Result<Vec<[Vec3; 2]>, Box<dyn Error>> {
    let file = concat!(env!("CARGO_MANIFEST_DIR"), "/../../scenes/fifty_boxes.toml");
    let scene: toml::Table = std::fs::read_to_string(file)?.parse()?;
    let surfaces = scene.get("surface").and_then(toml::Value::as_array).ok_or("the scene has no surfaces")?;
    let number = |x: &toml::Value| x.as_float().or_else(|| x.as_integer().map(|x| x as f64));
    let corner = |body: &toml::Value, key: &str| {
        let numbers: Option<Vec<f64>> = body.get(key)?.as_array()?.iter().map(number).collect();
        Some(Vec3::from_array(numbers?.try_into().ok()?))
    };
    let ends = |body| Some([corner(body, "min")?, corner(body, "max")?]);
    let boxes: Option<Vec<_>> = surfaces.iter().filter_map(|surface| surface.get("box")).map(ends).collect();
    boxes.ok_or_else(|| "a box lacks a corner".into())
}

/// The faces of a box, cut into so many parts along each axis.
fn faces([min, max]: [Vec3; 2], parts: [usize; 3], inward: bool) -> Result<Vec<Patch>, MeshError> {
    let along = |axis: usize, k: usize| min[axis] + (max[axis] - min[axis]) * (k as f64 / parts[axis] as f64);
    let mut patches = Vec::new();
    for (axis, far) in (0..3).flat_map(|axis| [(axis, false), (axis, true)]) {
        let (u, v) = ((axis + 1) % 3, (axis + 2) % 3);
        for k in 0..parts[u] * parts[v] {
            let corner = |i: usize, j: usize| {
                let mut x = if far { max } else { min };
                (x[u], x[v]) = (along(u, k / parts[v] + i), along(v, k % parts[v] + j));
                x
            };
            let cell = Patch::quad([corner(0, 0), corner(1, 0), corner(1, 1), corner(0, 1)])?;
            patches.extend(cell.map(|cell| if far == inward { cell.flipped() } else { cell }));
        }
    }
    Ok(patches)
}
