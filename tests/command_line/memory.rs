//! A scene that does not fit is refused before memory is taken.

use std::process::Command;
use std::time::{Duration, Instant};

use crate::support::{Bench, Run, furnace, program};

/// Runs a verb with at most 1 GiB of address space.
fn confined(bench: &Bench, verb: &str) -> Run {
    let script = format!(
        "ulimit -v 1048576; exec '{}' {verb} scene.toml --threads 1 --memory 100GiB",
        program().display()
    );
    Command::new("sh").args(["-c", &script]).current_dir(bench.folder.path()).output().unwrap().into()
}

#[test]
fn a_hundred_gibibytes_are_refused_at_once() {
    // 6 · 170² = 173,400 elements; the lower triangle of their matrix takes 112 GiB.
    let bench = Bench::new(&furnace(170, &[0.5]));
    for verb in ["solve", "check"] {
        let started = Instant::now();
        let run = confined(&bench, verb);
        assert!(started.elapsed() < Duration::from_secs(1));
        // What only predicts has done what it was asked for.
        let (code, told) = if verb == "check" { (0, &run.stdout) } else { (4, &run.stderr) };
        assert_eq!(run.code, code, "{}", run.stderr);
        for hint in ["173400 elements", "11", "GiB", "divide", "ulimit -v", "--accuracy 5%"] {
            assert!(told.contains(hint), "no {hint}: {told}");
        }
        assert!(run.stderr.contains("--memory 100 GiB is more than there may be"), "{}", run.stderr);
    }
    assert!(!bench.path("out").exists());
}

#[test]
fn what_fits_in_single_precision_is_not_refused_there() {
    // 864 elements: a matrix of 3.0 MB in double, 1.5 MB in single precision, 4.5 or 3.0 MB that
    // wait for it, and 11.8 MB for all the rest.
    let bench = Bench::new(&furnace(12, &[0.5]));
    let limit = ["--memory", "18MB"];
    let run =
        |storage| bench.run(&[&["solve", "scene.toml", "--storage", storage], &limit[..]].concat()).code;
    assert_eq!((run("f64"), run("f32")), (4, 0));
}

/// A plane wave on a cube of a wavelength, seen from afar.
const LIT_CUBE: &str = r#"
[wave]
frequencies_hz = [1e9]
METHOD
[[source]]
kind = "plane-wave"
travel = [0, 1, 0]
polarisation = [0, 0, 1]
[[surface]]
name = "cube"
box = { min = [0, 0, 0], max = [0.3, 0.3, 0.3] }
edge = "lambda/8"
[[receiver]]
name = "rcs"
far = { theta_degrees = 90, phi_degrees = { from = 0, to = 180, points = 19 } }
"#;

/// Bytes that `check` says.
fn memory_said(bench: &Bench) -> f64 {
    let checked = bench.run(&["check", "scene.toml", "--threads", "1"]).stdout;
    let line = checked.lines().find_map(|line| line.trim().strip_prefix("memory  ")).unwrap();
    let said: Vec<&str> = line.split_once(':').unwrap().0.split_whitespace().collect();
    let unit = if said[1] == "GiB" { 30 } else { 20 };
    said[0].parse::<f64>().unwrap() * f64::from(1 << unit)
}

#[test]
fn the_memory_that_check_says_of_waves_is_what_the_run_asks_for() {
    // One bounce, stored matrices and products computed anew, each with what its solver takes.
    for method in [
        "method = \"physical-optics\"\nbounces = 1",
        "method = \"mfie\"\nsolver = \"lu\"",
        "method = \"dual-surface-mfie\"",
        "method = \"cfie\"\nsolver = \"lu\"",
    ] {
        let bench = Bench::new(&LIT_CUBE.replace("METHOD", method));
        let said = memory_said(&bench);
        let run = |share: f64| {
            let limit = format!("{}B", (said * share) as u64);
            bench.run(&["waves", "scene.toml", "--threads", "1", "--no-report", "--memory", &limit]).code
        };
        // What is said is rounded to three digits.
        assert_eq!((run(0.98), run(1.02)), (4, 0), "{method}: {said}");
    }
}
