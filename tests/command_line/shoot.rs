//! `fredholm shoot`: files, agreement with `solve`, the same results for any number of threads,
//! endings.

use std::fs;

use serde_json::Value;

use crate::support::{Bench, column, room};

fn record(bench: &Bench, folder: &str) -> Value {
    serde_json::from_slice(&fs::read(bench.path(folder).join("shots.json")).unwrap()).unwrap()
}

#[test]
fn shooting_comes_to_what_solve_finds_and_leaves_its_files() {
    let bench = Bench::new(&room(6));
    bench.solve(&["-o", "solved", "--form-factor-tolerance", "1e-4"]);
    let options =
        ["shoot", "scene.toml", "-o", "shot", "--share", "99.9999%", "--form-factor-tolerance", "1e-4"];
    let run = bench.run(&options);
    assert_eq!(run.code, 0, "{}", run.stderr);
    for name in ["irradiance_r", "irradiance_g"] {
        let [solved, shot] =
            ["solved", "shot"].map(|folder| column(&bench.path(folder).join("faces.csv"), name));
        let largest = solved.iter().copied().fold(0.0, f64::max);
        for (a, b) in solved.iter().zip(&shot) {
            assert!((a - b).abs() < 1e-3 * largest, "{a} {b}");
        }
    }
    let names =
        ["field.npz", "field.vtu", "image.png", "shots.csv", "shots.svg", "shot_00001.png", "shot_00100.png"];
    for name in names {
        assert!(bench.path("shot").join(name).is_file(), "{name}");
    }
    let record = record(&bench, "shot");
    let shots = record["shots"].as_array().unwrap();
    assert!(record["reached"].as_bool().unwrap() && shots.len() > 100);
    assert!(shots.iter().any(|shot| shot["elements"].as_u64().unwrap() > 1));
    assert!(shots.last().unwrap()["columns"].as_u64().unwrap() < shots.len() as u64);
}

#[test]
fn the_number_of_threads_and_the_memory_for_columns_change_nothing() {
    let bench = Bench::new(&room(4));
    for (folder, threads, keep) in [("one", "1", "32MiB"), ("two", "2", "1B"), ("four", "4", "4KiB")] {
        let options =
            ["shoot", "scene.toml", "-o", folder, "--threads", threads, "--keep", keep, "--share", "0.95"];
        assert_eq!(bench.run(&options).code, 0);
    }
    for name in ["faces.csv", "field.npz", "field.vtu", "image.png"] {
        let [one, two, four] =
            ["one", "two", "four"].map(|folder| fs::read(bench.path(folder).join(name)).unwrap());
        assert!(one == two && one == four, "{name}");
    }
}

#[test]
fn too_few_shots_leave_a_marked_result() {
    let bench = Bench::new(&room(4));
    let run = bench.run(&["shoot", "scene.toml", "--max-shots", "3", "-o", "out"]);
    assert_eq!(run.code, 3, "{}", run.stderr);
    let record = record(&bench, "out");
    assert_eq!((record["reached"].as_bool(), record["shots"].as_array().unwrap().len()), (Some(false), 3));
}

#[test]
fn what_does_not_fit_is_refused_before_it_is_taken() {
    let bench = Bench::new(&room(4));
    let run = bench.run(&["shoot", "scene.toml", "--keep", "1TiB", "--memory", "1GiB"]);
    assert_eq!(run.code, 4, "{}", run.stderr);
    assert!(run.stderr.contains("--keep"), "{}", run.stderr);
    let run = bench.run(&["shoot", "scene.toml", "--share", "120%"]);
    assert_eq!(run.code, 2, "{}", run.stderr);
}
