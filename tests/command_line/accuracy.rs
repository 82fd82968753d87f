//! Runs to an accuracy: results as of any other run, an error that is stated and held, the same bits for any number of threads and after a stop.

use std::fs;
use std::process::{Command, Stdio};
use std::thread::sleep;
use std::time::Duration;

use crate::support::{Bench, program, room};

const SAME: [&str; 6] = ["field.csv", "faces.csv", "surfaces.csv", "field.vtu", "field.npz", "image.png"];

fn same(bench: &Bench, one: &str, other: &str) {
    for name in SAME {
        let [a, b] = [one, other].map(|folder| fs::read(bench.path(folder).join(name)).unwrap());
        assert!(a == b, "{name} of {one} and {other}");
    }
    let [a, b] = [one, other].map(|folder| bench.record(folder)["hierarchy"].clone());
    assert!(a == b && a["rounds"].as_array().unwrap().len() >= 2);
}

#[test]
fn an_accuracy_is_reached_and_stated() {
    let bench = Bench::new(&room(8));
    bench.solve(&["--accuracy", "2%", "-o", "out"]);
    let record = bench.record("out");
    let stated = record["hierarchy"]["stated"].as_f64().unwrap();
    assert!(stated > 0.0 && stated <= 0.02, "{stated}");
    assert_eq!(record["discretisation"], "hierarchical");
    assert_eq!(record["options"]["accuracy"], 0.02);
    assert!(!bench.path("out").join("checkpoint.bin").exists());
    for energy in record["energy"].as_array().unwrap() {
        let number = |name: &str| energy[name].as_f64().unwrap();
        let balance = (number("absorbed") + number("escaped")) / number("emitted") - 1.0;
        assert!(balance.abs() < stated, "{energy}");
    }
}

#[test]
fn the_scene_may_ask_for_an_accuracy() {
    let bench = Bench::new(&(room(4) + "[solve]\naccuracy = 0.05\n"));
    bench.solve(&["-o", "out"]);
    assert_eq!(bench.record("out")["hierarchy"]["accuracy"], 0.05);
}

#[test]
fn results_are_the_same_with_1_2_and_4_threads() {
    let bench = Bench::new(&room(8));
    for threads in ["1", "2", "4"] {
        bench.solve(&["--accuracy", "0.02", "--threads", threads, "-o", threads]);
        same(&bench, "1", threads);
    }
}

/// Starts a run and kills it a while after its first checkpoint; whether the run was still under way.
fn killed_after_a_round(bench: &Bench, pause: Duration) -> bool {
    let mut command = Command::new(program());
    command.current_dir(bench.folder.path()).args([
        "solve",
        "scene.toml",
        "--accuracy",
        "1%",
        "-o",
        "killed",
    ]);
    let mut child = command.stdout(Stdio::null()).stderr(Stdio::null()).spawn().unwrap();
    let checkpoint = bench.path("killed").join("checkpoint.bin");
    while !checkpoint.exists() && child.try_wait().unwrap().is_none() {
        sleep(Duration::from_millis(1));
    }
    sleep(pause);
    let _ = child.kill();
    child.wait().unwrap();
    checkpoint.exists()
}

#[test]
fn a_killed_run_is_resumed_to_the_same_bits() {
    let bench = Bench::new(&room(8));
    bench.solve(&["--accuracy", "1%", "-o", "whole"]);
    let mut resumed = 0;
    for pause in [0, 0, 10, 40] {
        if killed_after_a_round(&bench, Duration::from_millis(pause)) {
            assert_eq!(bench.run(&["resume", "killed"]).code, 0);
            same(&bench, "whole", "killed");
            resumed += 1;
        }
        fs::remove_dir_all(bench.path("killed")).unwrap();
    }
    assert!(resumed >= 1, "no run was killed between two rounds");
}

#[test]
fn what_does_not_go_with_an_accuracy_is_refused() {
    let bench = Bench::new(&room(4));
    let run = bench.run(&["solve", "scene.toml", "--accuracy", "0"]);
    assert!(run.code == 2 && run.stderr.contains("such as 1% or 0.01"), "{}", run.stderr);
    for (more, text) in [
        (&["--solver", "lu"][..], "cg-theta"),
        (&["--storage", "f32"][..], "does not go with an accuracy"),
        (&["--discretisation", "nystrom-2"][..], "does not go with an accuracy"),
    ] {
        let run = bench.run(&[&["solve", "scene.toml", "--accuracy", "1%"][..], more].concat());
        assert!(run.code == 2 && run.stderr.contains(text), "{}", run.stderr);
    }
    let run = bench.run(&["resume", "nowhere"]);
    assert!(run.code == 5 && run.stderr.contains("checkpoint"), "{}", run.stderr);
}
