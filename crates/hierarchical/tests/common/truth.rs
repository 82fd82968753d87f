//! What a solution should be: closed forms, particle tracing from files, and solutions refined much
//! further.

use super::common::Bench;
use std::collections::HashMap;
use std::path::Path;

/// Centre of a face and its irradiance in each band.
type Row = ([f64; 3], Vec<f64>);

/// Rows of a reference by surface.
fn rows(name: &str, columns: &[&str]) -> HashMap<String, Vec<Row>> {
    let data = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../tests/data");
    let text = std::fs::read_to_string(data.join(format!("{name}_reference.csv"))).unwrap();
    let mut lines = text.lines().map(|line| line.split(',').collect::<Vec<_>>());
    let head = lines.next().unwrap();
    let at = |column: &str| head.iter().position(|name| *name == column).unwrap();
    let mut found: HashMap<String, Vec<Row>> = HashMap::new();
    for line in lines {
        let number = |column: &str| line[at(column)].parse::<f64>().unwrap();
        let row = (["cx", "cy", "cz"].map(number), columns.iter().map(|band| number(band)).collect());
        found.entry(line[at("surface")].to_owned()).or_default().push(row);
    }
    found
}

/// Irradiance of the faces by particle tracing, faces × bands, W/m².
pub fn traced(bench: &Bench, name: &str, columns: &[&str]) -> Vec<f64> {
    let reference = rows(name, columns);
    let mut exact = Vec::new();
    for face in bench.mesh.faces() {
        let rows = &reference[&bench.mesh.surfaces()[face.surface].name];
        let close =
            |row: &&Row| face.centroid.to_array().iter().zip(row.0).all(|(a, b)| (a - b).abs() < 1e-6);
        exact.extend(&rows.iter().find(close).unwrap().1);
    }
    exact
}

/// Irradiance where every surface has the same reflectance and exitance and nothing leaves: E =
/// M/(1 − ρ).
#[allow(dead_code, reason = "not every test needs it")]
pub fn furnace(bench: &Bench) -> Vec<f64> {
    let (rho, m) = (bench.surfaces.reflectance.row(0), bench.surfaces.exitance.row(0));
    let row: Vec<f64> = rho.iter().zip(m).map(|(rho, m)| m / (1.0 - rho)).collect();
    row.repeat(bench.mesh.faces().len())
}

/// Relative area-weighted L2 error of the irradiance of the faces in the worst band.
pub fn error(bench: &Bench, found: &[f64], exact: &[f64]) -> f64 {
    let bands = bench.scene.bands().len();
    let (mut squares, mut norms) = (vec![0.0; bands], vec![0.0; bands]);
    for (k, face) in bench.mesh.faces().iter().enumerate() {
        for band in 0..bands {
            let (e, x) = (found[k * bands + band], exact[k * bands + band]);
            squares[band] += face.area * (e - x) * (e - x);
            norms[band] += face.area * x * x;
        }
    }
    squares.iter().zip(norms).map(|(s, n)| (s / n).sqrt()).fold(0.0, f64::max)
}
