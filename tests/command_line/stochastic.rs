//! Random paths: traced, checked against solutions, and as references.

use std::fs;

use serde_json::Value;

use crate::support::{Bench, fredholm_in, furnace, room};

fn text(bench: &Bench, path: &str) -> String {
    fs::read_to_string(bench.path(path)).unwrap()
}

fn trace(bench: &Bench, arguments: &[&str]) {
    let run = bench.run(&[&["trace", "scene.toml", "--quiet"], arguments].concat());
    assert_eq!(run.code, 0, "{}", run.stderr);
}

#[test]
fn traced_results_are_the_same_with_any_number_of_threads_and_in_two_goes() {
    let bench = Bench::new(&room(3));
    for (method, batch, some, all) in [("path", "4", "64", "144"), ("jacobi", "1250", "16000", "40000")] {
        let go = |samples: &str, folder: &str, more: &[&str]| {
            let wanted = ["--method", method, "--samples", samples, "--batch", batch, "-o", folder];
            trace(&bench, &[&wanted, more].concat());
        };
        for threads in ["1", "2", "4"] {
            go(all, threads, &["--threads", threads]);
            for name in ["faces.csv", "image.png"] {
                let [one, many] =
                    ["1", threads].map(|folder| fs::read(bench.path(folder).join(name)).unwrap());
                assert!(one == many, "{name} differs with {threads} threads and {method}");
            }
        }
        go(some, "twice", &[]);
        assert!(text(&bench, "twice/faces.csv") != text(&bench, "1/faces.csv"));
        go(all, "twice", &["--continue"]);
        assert!(text(&bench, "twice/faces.csv") == text(&bench, "1/faces.csv"), "{method}");
    }
    // Another method cannot go on with it.
    let run = bench.run(&[
        "trace",
        "scene.toml",
        "--method",
        "light",
        "--batch",
        "1250",
        "-o",
        "twice",
        "--continue",
    ]);
    assert!(run.code == 2 && run.stderr.contains("the method differs"), "{}", run.stderr);
}

#[test]
fn every_method_finds_the_furnace_within_its_errors() {
    let bench = Bench::new(&furnace(1, &[0.5, 0.8]));
    for method in ["path", "light", "bidirectional", "photon", "walk-gathering", "walk-shooting", "jacobi"] {
        trace(&bench, &["--method", method, "--to", "3%", "-o", method]);
        for row in text(&bench, &format!("{method}/faces.csv")).lines().skip(1) {
            let numbers: Vec<f64> = row.split(',').skip(6).map(|x| x.parse().unwrap()).collect();
            for (found, exact) in numbers.chunks(2).zip([2.0, 5.0]) {
                assert!((found[0] - exact).abs() < 5.0 * found[1] && found[1] > 0.0, "{method}: {row}");
            }
        }
        assert_eq!(bench.record(method)["solver"], method);
    }
}

#[test]
fn a_right_scene_agrees_and_one_without_an_estimated_mesh_error_does_not() {
    let bench = Bench::new(&room(4));
    let check =
        |arguments: &[&str]| bench.run(&[&["crosscheck", "scene.toml", "-o", "checked"], arguments].concat());
    let right = check(&["--to", "2%"]);
    assert_eq!(right.code, 0, "{}{}", right.stdout, right.stderr);
    assert!(right.stdout.contains("they agree: 0 of"), "{}", right.stdout);
    let record: Value = serde_json::from_str(&text(&bench, "checked/crosscheck.json")).unwrap();
    assert_eq!((&record["verdict"], &record["significant"]), (&"agree".into(), &0.into()));
    assert!(text(&bench, "checked/crosscheck.csv").lines().count() > 10);
    assert!(fs::read(bench.path("checked/crosscheck.png")).unwrap().starts_with(b"\x89PNG"));
    // Coarse constants are not what continuous light is.
    let bench = Bench::new(&room(1));
    let coarse =
        bench.run(&["crosscheck", "scene.toml", "--method", "path", "--to", "0.5%", "-o", "checked"]);
    assert_eq!(coarse.code, 6, "{}{}", coarse.stdout, coarse.stderr);
    assert!(coarse.stderr.contains("the error of the mesh is not estimated"), "{}", coarse.stderr);
}

#[test]
fn a_reference_holds_the_exact_values_of_a_furnace() {
    let bench = Bench::new(&furnace(2, &[0.5]));
    let run = bench.run(&["reference", "scene.toml", "-o", "bundle", "--quiet"]);
    assert_eq!(run.code, 0, "{}", run.stderr);
    let rows = text(&bench, "bundle/reference.csv");
    assert!(
        rows.starts_with("face,surface,cx,cy,cz,area,E_b0,E_error_b0,E_deterministic_b0,B_b0,rho_b0,M_b0\n")
    );
    for row in rows.lines().skip(1) {
        let numbers: Vec<f64> = row.split(',').skip(6).map(|x| x.parse().unwrap()).collect();
        assert!((numbers[0] - 2.0).abs() <= 5.0 * numbers[1] && numbers[1] < 0.01, "{row}");
    }
    assert!(text(&bench, "bundle/patches.obj").lines().filter(|line| line.starts_with("f ")).count() == 24);
    let record: Value = serde_json::from_str(&text(&bench, "bundle/reference.json")).unwrap();
    assert_eq!(record["format"], "fredholm-reference-1");
}

const PLATE: &str = r#"
[wave]
frequencies_hz = [1e9]

[[source]]
kind = "plane-wave"
travel = [0, 1, 0]
polarisation = [0, 0, 1]

[[surface]]
name = "plate"
quad = [[-0.3, 0, -0.3], [0.3, 0, -0.3], [0.3, 0, 0.3], [-0.3, 0, 0.3]]

[[receiver]]
name = "points"
points = [[0, -2, 0], [1, -2, 0.5], [0, 2, 1]]
"#;

/// The numbers of the columns whose titles begin with `sca_e` or are the standard error.
fn fields(table: &str) -> Vec<Vec<f64>> {
    let titles: Vec<&str> = table.lines().next().unwrap().split(',').collect();
    let wanted = |at: usize| titles[at].starts_with("sca_e") || titles[at] == "standard_error";
    let row = |line: &str| {
        let cells = line.split(',').enumerate().filter(|(at, _)| wanted(*at));
        cells.map(|(_, cell)| cell.parse().unwrap()).collect()
    };
    table.lines().skip(1).map(row).collect()
}

#[test]
fn sampled_waves_agree_with_the_radiation_integral() {
    let bench = Bench::new(PLATE);
    let run = bench.run(&["waves", "scene.toml", "-o", "solved", "--quiet"]);
    assert_eq!(run.code, 0, "{}", run.stderr);
    let exact = fields(&text(&bench, "solved/receivers.csv"));
    for method in ["surface-sampling", "field-particles", "amplitude-particles"] {
        trace(&bench, &["--method", method, "--samples", "131072", "--batch", "4096", "-o", method]);
        for (found, exact) in fields(&text(&bench, &format!("{method}/receivers.csv"))).iter().zip(&exact) {
            let gap = found.iter().zip(exact).take(6).map(|(a, b)| (a - b).powi(2)).sum::<f64>().sqrt();
            let size = exact.iter().take(6).map(|x| x * x).sum::<f64>().sqrt();
            // The radiation integral is asked for to 1e-3; cells have a bias.
            let allowed = if method == "amplitude-particles" { 0.03 } else { 2e-3 } * size;
            assert!(gap < 4.0 * found[6] + allowed && found[6] < 0.1 * size, "{method}: {gap:e} {found:?}");
        }
    }
    let refused = bench.run(&["trace", "scene.toml", "--method", "surface-sampling", "--to", "1%"]);
    assert!(refused.code == 2 && refused.stderr.contains("--samples"), "{}", refused.stderr);
}

#[test]
fn the_verbs_explain_themselves() {
    for verb in ["trace", "crosscheck", "reference"] {
        let run = fredholm_in(std::path::Path::new("."), &[verb, "--help"]);
        assert_eq!(run.code, 0);
        insta::assert_snapshot!(format!("help-{verb}"), run.stdout);
    }
}
