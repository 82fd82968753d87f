//! The shipped scenes against independent references: particle tracing, and a closed form.

// A test that cannot run should panic, in its helpers too.
#![allow(clippy::unwrap_used)]

use std::collections::HashMap;
use std::fs;
use std::path::Path;
use std::process::Command;

use tempfile::TempDir;

/// A table with named columns.
struct Table {
    columns: HashMap<String, usize>,
    rows: Vec<Vec<String>>,
}

impl Table {
    fn read(path: &Path) -> Self {
        let text = fs::read_to_string(path).unwrap();
        let mut lines = text.lines().map(|line| line.split(',').map(str::to_owned).collect::<Vec<_>>());
        let columns = lines.next().unwrap().into_iter().enumerate().map(|(at, name)| (name, at)).collect();
        Self { columns, rows: lines.collect() }
    }

    fn number(&self, row: usize, column: &str) -> f64 {
        self.rows[row][self.columns[column]].parse().unwrap()
    }

    fn text(&self, row: usize, column: &str) -> &str {
        &self.rows[row][self.columns[column]]
    }

    fn centre(&self, row: usize) -> [f64; 3] {
        ["cx", "cy", "cz"].map(|c| self.number(row, c))
    }
}

/// Solves a shipped scene and returns its folder of results.
fn solve(scene: &str, options: &[&str]) -> TempDir {
    let folder = tempfile::tempdir().unwrap();
    let scene = Path::new(env!("CARGO_MANIFEST_DIR")).join("scenes").join(scene);
    let mut command = Command::new(env!("CARGO_BIN_EXE_fredholm"));
    command.arg("solve").arg(scene).args(options).arg("--quiet").arg("-o").arg(folder.path());
    let run = command.output().unwrap();
    assert!(run.status.success(), "{}", String::from_utf8_lossy(&run.stderr));
    folder
}

/// The row of `ours` for row `at` of `reference`: the same surface and the same centre.
fn partner(ours: &Table, reference: &Table, at: usize) -> usize {
    let (surface, centre) = (reference.text(at, "surface"), reference.centre(at));
    let close = |row: &usize| ours.centre(*row).iter().zip(centre).all(|(a, b)| (a - b).abs() < 1e-6);
    let mut found = (0..ours.rows.len()).filter(|row| ours.text(*row, "surface") == surface).filter(close);
    found.next().unwrap()
}

/// √(Σ A (E − E')² / Σ A E'²) in the worst band, and the root mean square of (E − E')/E' over faces
/// and bands.
fn errors(ours: &Table, reference: &Table, bands: &[(&str, &str)]) -> (f64, f64) {
    let (mut worst, mut squares, mut count) = (0.0, 0.0, 0.0);
    for (our_band, their_band) in bands {
        let (mut error, mut norm) = (0.0, 0.0);
        for at in 0..reference.rows.len() {
            let (area, exact) = (reference.number(at, "area"), reference.number(at, their_band));
            let difference = ours.number(partner(ours, reference, at), our_band) - exact;
            error += area * difference * difference;
            norm += area * exact * exact;
            if exact > 0.0 {
                squares += (difference / exact).powi(2);
                count += 1.0;
            }
        }
        worst = f64::max(worst, (error / norm).sqrt());
    }
    (worst, (squares / count).sqrt())
}

fn reference(name: &str) -> Table {
    let data = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/data");
    Table::read(&data.join(format!("{name}_reference.csv")))
}

fn compare(name: &str, bands: &[(&str, &str)], faces: usize) {
    let folder = solve(&format!("{name}.toml"), &[]);
    let ours = Table::read(&folder.path().join("faces.csv"));
    let reference = reference(name);
    assert_eq!((ours.rows.len(), reference.rows.len()), (faces, faces));
    let (l2, rms) = errors(&ours, &reference, bands);
    println!("{name}: L2 {:.3} %, RMS over faces {:.3} %", 100.0 * l2, 100.0 * rms);
    assert!(l2 <= 0.005 && rms <= 0.015, "L2 {l2:e}, RMS {rms:e}");
    // The program's own estimate must not be below what the comparison finds beyond the noise of
    // the reference.
    let run: serde_json::Value =
        serde_json::from_slice(&fs::read(folder.path().join("run.json")).unwrap()).unwrap();
    let stated = run["mesh_error"]["relative_l2"].as_array().unwrap();
    let stated = stated.iter().map(|x| x.as_f64().unwrap()).fold(0.0, f64::max);
    assert!(l2 <= stated + 1e-3, "stated {stated:e}, found {l2:e}");
}

#[test]
fn the_planar_cornell_box_agrees_with_particle_tracing() {
    compare(
        "cornell_planar",
        &[("irradiance_r", "E_r"), ("irradiance_g", "E_g"), ("irradiance_b", "E_b")],
        480,
    );
}

#[test]
fn the_occluder_agrees_with_particle_tracing() {
    compare("occluder", &[("irradiance_grey", "E")], 936);
}

/// The largest error of a face, relative to its own irradiance, of those with more than a thousandth
/// of the area and more than a five-hundredth of the mean irradiance. Two standard errors of the
/// reference are taken off.
fn worst_face(ours: &Table, reference: &Table, bands: &[[&str; 3]]) -> f64 {
    let all = || 0..reference.rows.len();
    let area: f64 = all().map(|at| reference.number(at, "area")).sum();
    let mut worst = 0.0;
    for [our_band, their_band, deviation] in bands {
        let light = |at| reference.number(at, "area") * reference.number(at, their_band);
        let mean = all().map(light).sum::<f64>() / area;
        for at in all().filter(|&at| reference.number(at, "area") > 1e-3 * area) {
            let exact = reference.number(at, their_band);
            if exact > 2e-3 * mean {
                let difference = (ours.number(partner(ours, reference, at), our_band) - exact).abs();
                worst = f64::max(worst, (difference - 2.0 * reference.number(at, deviation)) / exact);
            }
        }
    }
    worst
}

/// Behind a cupboard and under a block there is a hundredth of the light of the room, which counts
/// nothing in the error over all faces.
#[test]
fn dark_and_partly_buried_faces_are_exact_too() {
    let cornell = [
        ["irradiance_r", "E_r", "stderr_r"],
        ["irradiance_g", "E_g", "stderr_g"],
        ["irradiance_b", "E_b", "stderr_b"],
    ];
    let room = [["irradiance_grey", "E", "stderr"]];
    // Links find the faces that are half under a block, and leave those behind cupboards dark.
    let cases: [(&str, &str, &[[&str; 3]]); 3] = [
        ("cornell_planar", "rays", &cornell),
        ("cornell_planar", "links", &cornell),
        ("leblond_furnished", "rays", &room),
    ];
    for (name, way, bands) in cases {
        let reference = reference(name);
        for (accuracy, option) in [(0.05, "5%"), (0.02, "2%")] {
            let options = ["--accuracy", option, "--way", way, "--no-pictures", "--no-report"];
            let folder = solve(&format!("{name}.toml"), &options);
            let worst = worst_face(&Table::read(&folder.path().join("faces.csv")), &reference, bands);
            println!("{name}, {option}, {way}: worst face {:.1} %", 100.0 * worst);
            assert!(worst < 6.0 * accuracy, "{name}, {option}, {way}: {worst}");
        }
    }
}

#[test]
fn the_furnace_is_exitance_over_absorptance() {
    let folder = solve("furnace.toml", &[]);
    let field = Table::read(&folder.path().join("field.csv"));
    for rho in [0.1, 0.5, 0.9, 0.99] {
        let exact = 1.0 / (1.0 - rho);
        let column = format!("radiosity_rho_{rho}");
        let relative = |row| (field.number(row, &column) / exact - 1.0).abs();
        let worst = (0..field.rows.len()).map(relative).fold(0.0, f64::max);
        println!("ρ = {rho}: within {worst:.1e}");
        assert!(worst < 1e-9, "ρ = {rho}: {worst:e}");
    }
    let run: serde_json::Value =
        serde_json::from_slice(&fs::read(folder.path().join("run.json")).unwrap()).unwrap();
    let closure = run["closure"]["max"].as_f64().unwrap();
    println!("row sums within {closure:.1e}");
    assert!(closure < 1e-9, "{closure:e}");
}
