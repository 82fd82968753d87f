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

#[test]
fn the_verbs_explain_themselves() {
    for verb in ["trace", "crosscheck", "reference"] {
        let run = fredholm_in(std::path::Path::new("."), &[verb, "--help"]);
        assert_eq!(run.code, 0);
        insta::assert_snapshot!(format!("help-{verb}"), run.stdout);
    }
}
