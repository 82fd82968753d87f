//! Every stochastic method on the shipped scenes, against the deterministic solution and against
//! independent references.

// A test that cannot run should panic, in its helpers too.
#![allow(clippy::unwrap_used)]

use std::collections::BTreeMap;
use std::fs;
use std::path::{Path, PathBuf};
use std::process::Command;

use fredholm_montecarlo::light::METHODS;
use fredholm_montecarlo::statistics::{Comparison, Correction, crosscheck};

/// Chance of a false alarm in the whole table.
const SIGNIFICANCE: f64 = 0.01;
/// Standard error asked of every method.
const TO: &str = "1%";

fn root() -> &'static Path {
    Path::new(env!("CARGO_MANIFEST_DIR"))
}

/// The cells of a table by title, row by row.
fn table(path: &Path) -> Vec<BTreeMap<String, String>> {
    let text = fs::read_to_string(path).unwrap();
    let mut lines = text.lines().map(|line| line.split(',').map(str::to_owned).collect::<Vec<_>>());
    let titles = lines.next().unwrap();
    lines.map(|cells| titles.iter().cloned().zip(cells).collect()).collect()
}

/// Surface and centroid in units of 1 µm, and band.
fn place(row: &BTreeMap<String, String>, band: &str) -> (String, [i64; 3], String) {
    let at = |title: &str| (row[title].parse::<f64>().unwrap() * 1e6).round() as i64;
    (row["surface"].clone(), ["cx", "cy", "cz"].map(at), band.to_owned())
}

/// E and its error of every place.
type Values = BTreeMap<(String, [i64; 3], String), [f64; 2]>;

fn number(row: &BTreeMap<String, String>, title: &str) -> f64 {
    row[title].parse().unwrap()
}

fn reference(scene: &str, bands: &[[&str; 3]]) -> Values {
    let rows = table(&root().join(format!("tests/data/{scene}_reference.csv")));
    let values = rows.iter().flat_map(|row| {
        let value = |[band, e, s]: &[&str; 3]| (place(row, band), [number(row, e), number(row, s)]);
        bands.iter().map(value)
    });
    values.collect()
}

/// The result of `fredholm crosscheck`: whether it agreed, its table and the number of batches.
fn checked(scene: &str, method: &str, to: &str, folder: &Path) -> (bool, PathBuf, u64) {
    let scene = root().join(format!("scenes/{scene}.toml"));
    let mut command = Command::new(env!("CARGO_BIN_EXE_fredholm"));
    let command = command.arg("crosscheck").arg(scene).args(["--quiet", "--method", method, "--to", to]);
    let code = command.arg("-o").arg(folder).output().unwrap().status.code().unwrap();
    assert!(code == 0 || code == 6, "exit code {code}");
    let record: serde_json::Value =
        serde_json::from_slice(&fs::read(folder.join("crosscheck.json")).unwrap()).unwrap();
    (code == 0, folder.join("crosscheck.csv"), record["batches"].as_u64().unwrap())
}

fn values(csv: &Path, value: &str, error: &str) -> Values {
    let rows = table(csv);
    rows.iter().map(|row| (place(row, &row["band"]), [number(row, value), number(row, error)])).collect()
}

/// Probabilities of the differences of an estimate from the reference; of a method that estimates
/// constants on elements, `mesh` is their error.
fn probabilities(
    found: &Values,
    reference: &Values,
    mesh: Option<&Values>,
    batches: u64,
) -> (Vec<f64>, f64, f64) {
    let side = |values: &Values, column: usize| -> Vec<f64> {
        reference.keys().map(|place| values[place][column]).collect()
    };
    let zero = vec![0.0; reference.len()];
    let meshing = mesh.map_or(zero, |mesh| side(mesh, 1));
    let error: Vec<f64> = side(reference, 1).iter().zip(meshing).map(|(a, b)| a.hypot(b)).collect();
    let comparison = Comparison {
        deterministic: &side(reference, 0),
        deterministic_error: &error,
        stochastic: &side(found, 0),
        standard_error: &side(found, 1),
        single: &vec![0.0; reference.len()],
        batches,
    };
    let result = crosscheck(&comparison, Correction::Holm, SIGNIFICANCE).unwrap();
    let worst = result.worst(1)[0].z;
    (result.places.iter().map(|place| place.p).collect(), result.suite.variance, worst)
}

/// All methods on both scenes: `cargo test --release --test stochastic -- --ignored --nocapture`.
#[test]
#[ignore = "all methods to one percent take minutes"]
fn every_method_agrees_with_the_solution_and_with_the_references() {
    let folder = tempfile::tempdir().unwrap();
    let grey: &[[&str; 3]] = &[["grey", "E", "stderr"]];
    let rgb: &[[&str; 3]] = &[["r", "E_r", "stderr_r"], ["g", "E_g", "stderr_g"], ["b", "E_b", "stderr_b"]];
    let mut all = Vec::new();
    println!(
        "| scene | method | verdict | against the solution: mean z² | against the reference: mean z², largest z |"
    );
    for (scene, bands) in [("cornell_planar", rgb), ("occluder", grey)] {
        let reference = reference(scene, bands);
        // Of a continuous method the deterministic error has the one of the mesh in it.
        let (_, csv, _) = checked(scene, "path", "5%", folder.path());
        let mesh = values(&csv, "deterministic", "deterministic_error");
        for method in METHODS {
            let patchwise = ["walk-gathering", "walk-shooting", "jacobi"].contains(&method);
            let (agrees, csv, batches) = checked(scene, method, TO, folder.path());
            let scores = table(&csv);
            let own = scores.iter().map(|row| number(row, "z").powi(2)).sum::<f64>() / scores.len() as f64;
            let found = values(&csv, "stochastic", "standard_error");
            let (p, square, worst) = probabilities(&found, &reference, patchwise.then_some(&mesh), batches);
            let verdict = if agrees { "agree" } else { "disagree" };
            println!("| {scene} | {method} | {verdict} | {own:.2} | {square:.2}, {worst:+.1} |");
            assert!(agrees, "{scene} {method}");
            all.extend(p);
        }
    }
    // One family: with so many methods some place would be at fault by chance.
    let apart = Correction::Holm.significant(&all, SIGNIFICANCE).into_iter().filter(|s| *s).count();
    assert_eq!(apart, 0, "of {} places", all.len());
}
