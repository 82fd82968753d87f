//! Writes the page of a wavy sheet of some 500,000 triangles: `cargo run --release -p
//! fredholm-report --example large_report
//! -- sheet.html 500`. It shows how large a page becomes, and how fast it is drawn.

use std::error::Error;
use std::path::Path;
use std::time::Instant;

use fredholm_mesh::{Mesh, MeshBuilder, Patch, Vec3};
use fredholm_report::{Field, ReportModel, ReportPage, RunRecord, View, write_atomically};

/// A sheet over the unit square, of 2 n² triangles in four surfaces.
fn sheet(n: usize) -> Result<Mesh, Box<dyn Error>> {
    let point = |i: usize, j: usize| {
        let (x, y) = (i as f64 / n as f64, j as f64 / n as f64);
        Vec3::new(x, y, 0.05 * (9.0 * x).sin() * (7.0 * y).cos())
    };
    let mut builder = MeshBuilder::default();
    for j in 0..n {
        if (4 * j) % n < 4 {
            builder.surface(format!("quarter {}", 4 * j / n), 0);
        }
        for i in 0..n {
            let [a, b, c, d] = [point(i, j), point(i + 1, j), point(i + 1, j + 1), point(i, j + 1)];
            let [low, high] = [Patch::triangle([a, b, c])?, Patch::triangle([a, c, d])?];
            builder.face(&[low])?;
            builder.face(&[high])?;
        }
    }
    Ok(builder.build())
}

/// Irradiance of every element in three bands: smooth, and rough in the last digits as solutions
/// are.
fn irradiance(mesh: &Mesh) -> Vec<f64> {
    let rough = |leaf: usize| 1.0 + 1e-3 * (leaf as f64 * 12.989_8).sin();
    let light = |(leaf, patch): (usize, &Patch)| {
        let p = patch.centroid();
        let level = rough(leaf) / (0.05 + (p - Vec3::new(0.5, 0.5, 0.3)).length_squared());
        [level, 0.8 * level * (1.0 + 0.3 * p.x), 0.6 * level * (1.0 - 0.3 * p.y)]
    };
    mesh.patches().enumerate().flat_map(light).collect()
}

fn main() -> Result<(), Box<dyn Error>> {
    let mut arguments = std::env::args().skip(1);
    let path = arguments.next().unwrap_or_else(|| "sheet.html".to_owned());
    let mesh = sheet(arguments.next().map_or(Ok(500), |n| n.parse())?)?;
    let bands = ["r", "g", "b"].map(String::from);
    let irradiance = irradiance(&mesh);
    let radiosity: Vec<f64> = irradiance.iter().map(|e| 0.5 * e).collect();
    let exitance = vec![0.0; irradiance.len()];
    let field = Field::new(&mesh, &bands, &irradiance, &radiosity)?.with_exitance(&exitance)?;
    let view = View::framing(&field);
    let run = RunRecord { bands: bands.to_vec(), version: "example".to_owned(), ..RunRecord::default() };
    let page = ReportPage::of_run("Sheet", &field, &run, ReportModel::lit(&field, &view), None);
    let started = Instant::now();
    write_atomically(Path::new(&path), |out| page.write(out))?;
    let (size, seconds) = (std::fs::metadata(&path)?.len(), started.elapsed().as_secs_f64());
    println!("{path}: {} triangles, {:.2} MB, written in {seconds:.2} s", mesh.len(), size as f64 / 1e6);
    Ok(())
}
