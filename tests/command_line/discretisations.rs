//! `--discretisation` of `solve` and `check`, the `[solve]` table, and their list.

use std::fs;

use fredholm::discretisation::discretisations;

use crate::support::{Bench, column, furnace, room};

#[test]
fn all_discretisations_are_listed_with_a_line_each() {
    let list = Bench::new("").run(&["discretisations"]).stdout;
    assert_eq!(list.lines().count(), discretisations().len());
    for known in discretisations() {
        let line = list.lines().find(|line| line.split_whitespace().next() == Some(known.name())).unwrap();
        assert!(line.ends_with(known.summary()), "{line}");
    }
}

#[test]
fn a_furnace_is_exitance_over_absorptance_by_every_discretisation() {
    let bench = Bench::new(&furnace(1, &[0.3, 0.9]));
    for known in discretisations() {
        for solver in ["gauss-seidel", "lu"] {
            let name = known.name();
            let arguments = [
                "--discretisation",
                name,
                "--solver",
                solver,
                "--tolerance",
                "1e-11",
                "--max-iterations",
                "20000",
                "-q",
            ];
            bench.solve(&[&arguments[..], &["--form-factor-tolerance", "1e-9"]].concat());
            for (band, exact) in [("b0", 1.0 / 0.7), ("b1", 10.0)] {
                let radiosity = column(&bench.path("out/scene/field.csv"), &format!("radiosity_{band}"));
                assert_eq!(radiosity.len(), 6);
                let worst = radiosity.iter().map(|b| (b / exact - 1.0).abs()).fold(0.0, f64::max);
                // Form factors of constants are as exact as their tolerance; the others close
                // exactly at every point.
                let allowed = if name == "galerkin-0" { 1e-4 } else { 1e-8 };
                assert!(worst < allowed, "{name} by {solver}: {worst:e}");
            }
            assert_eq!(bench.record("out/scene")["discretisation"], name);
        }
    }
}

#[test]
fn the_record_tells_unknowns_errors_and_what_the_values_are() {
    let bench = Bench::new(&room(3));
    bench.solve(&["--discretisation", "galerkin-q1", "-q"]);
    let record = bench.record("out/scene");
    assert_eq!(
        (&record["discretisation"], &record["options"]["discretisation"]),
        (&"galerkin-1".into(), &"galerkin-1".into())
    );
    assert_eq!((&record["counts"]["elements"], &record["counts"]["unknowns"]), (&80.into(), &320.into()));
    assert_eq!(record["counts"]["matrix_entries"], 320 * 320);
    assert!(record["means"].as_str().unwrap().starts_with("H B_h"));
    for error in record["field_error"]["relative_l2"].as_array().unwrap() {
        let error = error.as_f64().unwrap();
        assert!(error > 1e-4 && error < 0.2, "{error}");
    }
    // What is emitted in a closed room is absorbed, but for the error of the discretisation.
    for energy in record["energy"].as_array().unwrap() {
        let [emitted, absorbed, escaped] =
            ["emitted", "absorbed", "escaped"].map(|key| energy[key].as_f64().unwrap());
        assert!(
            (absorbed + escaped - emitted).abs() < 0.02 * emitted && escaped.abs() < 1e-6 * emitted,
            "{energy}"
        );
    }
    assert!(record["closure"]["max"].as_f64().unwrap() < 1e-6);
    let info = bench.run(&["info", "out/scene"]).stdout;
    assert!(info.contains("320 unknowns") && info.contains("polynomials"), "{info}");
    let files = fs::read_dir(bench.path("out/scene")).unwrap().count();
    assert_eq!(files, crate::support::usual_files().count() + 1, "the files and their list");
}

#[test]
fn discretisations_agree_within_their_stated_errors() {
    let bench = Bench::new(&room(3));
    let irradiance = |name| {
        bench.solve(&["--discretisation", name, "-q"]);
        let stated = bench.record("out/scene")["field_error"]["relative_l2"][1].as_f64();
        (column(&bench.path("out/scene/surfaces.csv"), "irradiance_g"), stated)
    };
    let (reference, own) = irradiance("galerkin-2");
    let area = column(&bench.path("out/scene/surfaces.csv"), "area");
    let norm = |values: &[f64]| values.iter().zip(&area).map(|(v, a)| a * v * v).sum::<f64>().sqrt();
    assert!(norm(&reference) > 1.0);
    for name in ["galerkin-0", "galerkin-1-conforming", "collocation-1", "nystrom-2", "degenerate-kernel-1"] {
        let (found, stated) = irradiance(name);
        // Constants state no error of their own here: that takes several elements a face.
        let stated = stated.unwrap_or(0.02) + own.unwrap();
        let difference: Vec<f64> = found.iter().zip(&reference).map(|(a, b)| a - b).collect();
        let difference = norm(&difference) / norm(&reference);
        assert!(difference > 0.0 && difference < stated, "{name}: {difference:e}, stated {stated:e}");
    }
}

#[test]
fn the_scene_chooses_and_the_command_line_goes_before_it() {
    let scene = format!("{}[solve]\ndiscretisation = \"nystrom-2\"\n", furnace(1, &[0.5]));
    let bench = Bench::new(&scene);
    bench.solve(&["-q"]);
    assert_eq!(bench.record("out/scene")["discretisation"], "nystrom-2");
    bench.solve(&["-q", "--discretisation", "galerkin-0"]);
    assert_eq!(bench.record("out/scene")["discretisation"], "galerkin-0");
    let check = bench.run(&["check", "scene.toml"]);
    assert!(check.stdout.contains("24 in each band, by nystrom-2"), "{}", check.stdout);
    fs::write(bench.path("scene.toml"), scene.replace("nystrom-2", "nystrom-4")).unwrap();
    for verb in ["solve", "check"] {
        let run = bench.run(&[verb, "scene.toml"]);
        let line = scene.lines().count();
        assert_eq!(run.code, 2);
        let message = format!("scene.toml:{line}:18: there is no discretisation `nystrom-4`");
        assert!(run.stderr.contains(&message) && run.stderr.contains("did you mean"), "{}", run.stderr);
    }
    let schema = bench.run(&["schema"]).stdout;
    assert!(schema.contains("\"discretisation\""));
}

#[test]
fn what_does_not_fit_is_refused() {
    let bench = Bench::new(&furnace(4, &[0.5]));
    let refused = |arguments: &[&str], code: i32, hint: &str| {
        for verb in ["solve", "check"] {
            let run = bench.run(&[&[verb, "scene.toml"], arguments].concat());
            assert_eq!(run.code, code, "{}", run.stderr);
            assert!(run.stderr.contains(hint), "no {hint}: {}", run.stderr);
        }
    };
    refused(&["--discretisation", "galerkin-9"], 2, "galerkin-2-conforming");
    refused(&["--discretisation", "galerkin-1", "--storage", "f32"], 2, "stores f64 only");
    // 864 unknowns have a matrix of 6 MB, 96 elements one of 37 kB.
    let limit = ["--memory", "14MB", "--discretisation"];
    let large = [&["solve", "scene.toml"], &limit[..], &["collocation-2"]].concat();
    let run = bench.run(&large);
    assert!(run.code == 4 && run.stderr.contains("864 unknowns on 96 elements"), "{}", run.stderr);
    let run = bench.run(&[&["check"], &large[1..]].concat());
    assert!(run.code == 0 && run.stdout.contains("864 unknowns on 96 elements"), "{}", run.stdout);
    assert_eq!(bench.run(&[&["check", "scene.toml"], &limit[..], &["galerkin-0"]].concat()).code, 0);
    assert!(!bench.path("out").exists());
}

#[test]
fn the_number_of_threads_changes_no_bit() {
    let bench = Bench::new(&room(2));
    let files = |threads: &str| {
        bench.solve(&["--discretisation", "galerkin-1", "--threads", threads, "-q"]);
        ["field.csv", "surfaces.csv", "field.npz", "image.png"]
            .map(|name| fs::read(bench.path("out/scene").join(name)).unwrap())
    };
    assert!(files("1") == files("3"));
}
