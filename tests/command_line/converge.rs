//! `fredholm converge`: orders against theory, stated errors against closer solutions, refusals.

use std::fs;

use serde_json::Value;

use crate::support::{Bench, column, furnace};

/// Two unit squares at distance 1, the lower one a lamp.
const SQUARES: &str = "\
[materials.lamp]
reflectance = 0.5
exitance = 1.0
[materials.wall]
reflectance = 0.5
[[surface]]
name = \"floor\"
material = \"lamp\"
quad = [[0, 0, 0], [1, 0, 0], [1, 1, 0], [0, 1, 0]]
[[surface]]
name = \"ceiling\"
material = \"wall\"
quad = [[0, 0, 1], [0, 1, 1], [1, 1, 1], [1, 0, 1]]
";

/// Studies the scene and returns the record.
fn study(bench: &Bench, arguments: &[&str]) -> Value {
    let run = bench.run(&[&["converge", "scene.toml", "-o", "study"], arguments].concat());
    assert_eq!(run.code, 0, "{}", run.stderr);
    serde_json::from_slice(&fs::read(bench.path("study/converge.json")).unwrap()).unwrap()
}

/// Means of the irradiance of both squares on the finest level.
fn finest(record: &Value) -> [f64; 2] {
    let last = record["levels"].as_array().unwrap().last().unwrap();
    [0, 1].map(|surface| last["irradiance"][surface][0].as_f64().unwrap())
}

const EXACT: [&str; 5] = ["--tolerance", "1e-13", "--form-factor-tolerance", "1e-12", "-q"];

#[test]
fn smooth_scenes_have_the_order_of_theory_and_the_error_that_is_stated() {
    let bench = Bench::new(SQUARES);
    let constants = study(&bench, &[&["--levels", "5"], &EXACT[..]].concat());
    // Means of H B_h: 2k + 2 for polynomials of degree k.
    let order = constants["bands"][0]["order"].as_f64().unwrap();
    assert!((order - 2.0).abs() < 0.1, "{order}");
    let linear = study(&bench, &[&["--levels", "4", "--discretisation", "galerkin-1"], &EXACT[..]].concat());
    let steep = linear["bands"][0]["order"].as_f64().unwrap();
    assert!((steep - 4.0).abs() < 0.1, "{steep}");
    // The linear solution is a hundred times closer than what the constants state.
    let (found, exact) = (finest(&constants), finest(&linear));
    let norm = |v: [f64; 2]| v[0].hypot(v[1]);
    let error = norm([found[0] - exact[0], found[1] - exact[1]]) / norm(exact);
    let stated = constants["bands"][0]["remaining"].as_f64().unwrap();
    assert!(stated < 1e-4 && (error / stated - 1.0).abs() < 0.1, "{error:e}, stated {stated:e}");
    assert!(linear["bands"][0]["remaining"].as_f64().unwrap() < 0.05 * stated);
}

#[test]
fn the_table_and_the_plot_tell_the_levels() {
    let bench = Bench::new(SQUARES);
    let record = study(&bench, &["--levels", "4"]);
    let table = bench.path("study/converge.csv");
    assert_eq!(column(&table, "elements"), [2.0, 8.0, 32.0, 128.0]);
    assert_eq!(column(&table, "unknowns"), [2.0, 8.0, 32.0, 128.0]);
    let h = column(&table, "h");
    assert!(
        h.windows(2).all(|pair| (pair[0] / pair[1] - 2.0).abs() < 1e-12)
            && (h[0] - 2.0_f64.sqrt()).abs() < 1e-12
    );
    let ceiling = column(&table, "irradiance_ceiling_grey");
    assert!((ceiling.last().copied().unwrap() - finest(&record)[1]).abs() < 1e-15);
    assert!(column(&table, "difference_grey")[3].abs() < 1e-15);
    let plot = fs::read_to_string(bench.path("study/converge.svg")).unwrap();
    assert!(plot.contains("polyline") && plot.contains("h²") && plot.contains("order 1.8"));
    assert_eq!(record["format"], "fredholm-converge-1");
    let info = bench.run(&["info", "study"]);
    assert!(info.code == 0 && info.stdout.contains("order"), "{} {}", info.stdout, info.stderr);
}

#[test]
fn a_furnace_is_settled_and_two_levels_have_no_order() {
    let bench = Bench::new(&furnace(2, &[0.5, 0.9]));
    let record = study(&bench, &["--levels", "3", "--form-factor-tolerance", "1e-12"]);
    for band in record["bands"].as_array().unwrap() {
        assert!(band["verdict"].as_str().unwrap().starts_with("settled"), "{band}");
        assert!(band["order"].is_null() && band["differences"][0].as_f64().unwrap() < 1e-9);
    }
    // Undivided squares agree on their first two levels by symmetry.
    for scene in [SQUARES, &SQUARES.replace("quad =", "divide = [2, 2]\nquad =")] {
        let record = study(&Bench::new(scene), &["--levels", "2"]);
        let band = &record["bands"][0];
        assert!(
            band["verdict"].as_str().unwrap().contains("three levels") && band["remaining"].is_null(),
            "{band}"
        );
    }
}

#[test]
fn a_furnace_shows_errors_of_rounding() {
    let bench = Bench::new(&furnace(4, &[0.1, 0.5, 0.9, 0.99]));
    let run = bench.run(&[
        "converge",
        "scene.toml",
        "--levels",
        "2",
        "--form-factor-tolerance",
        "1e-12",
        "--tolerance",
        "1e-13",
        "--solver",
        "gauss-seidel",
        "--max-iterations",
        "5000",
    ]);
    assert_eq!(run.code, 0, "{}", run.stderr);
    // Two levels may agree by symmetry: that they settle takes three.
    assert_eq!(run.stdout.matches("that takes three levels").count(), 4, "{}", run.stdout);
    let record = fs::read(bench.path("out/scene-converge/converge.json")).unwrap();
    let record: Value = serde_json::from_slice(&record).unwrap();
    for band in record["bands"].as_array().unwrap() {
        assert!(band["differences"][0].as_f64().unwrap() < 1e-12, "{band}");
    }
}

#[test]
fn a_level_that_does_not_fit_is_refused_before_anything_is_computed() {
    let bench = Bench::new(&furnace(4, &[0.5]));
    // Level 2 has 1536 elements, with a matrix of 9 MB and about 7 MB of mesh.
    let run = bench.run(&["converge", "scene.toml", "--levels", "4", "--memory", "16MB"]);
    assert_eq!(run.code, 4, "{}", run.stderr);
    assert!(run.stderr.contains("level 2 (fits: --levels 2): this needs"), "{}", run.stderr);
    assert!(!run.stderr.contains("assembly") && !bench.path("out").exists());
    let usage = bench.run(&["converge", "scene.toml", "--levels", "1"]);
    assert_eq!((usage.code, usage.stderr.contains("2..=12")), (2, true), "{}", usage.stderr);
}

#[test]
fn a_level_that_is_not_solved_is_told() {
    let bench = Bench::new(&furnace(1, &[0.9]));
    let run = bench.run(&["converge", "scene.toml", "--levels", "2", "--max-iterations", "1"]);
    assert_eq!(run.code, 3, "{}", run.stderr);
    assert!(run.stdout.contains("a level was not solved"), "{}", run.stdout);
    assert!(bench.path("out/scene-converge/converge.json").is_file());
}
