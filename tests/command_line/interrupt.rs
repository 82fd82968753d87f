//! Ctrl-C and the termination signal, sent for real.

use std::fs;
use std::io::{BufRead, BufReader};
use std::process::{Child, Command, Stdio};
use std::thread;
use std::time::{Duration, Instant};

use crate::support::{Bench, column, furnace, program, room};

/// A second, and a little for a busy machine.
const PROMPT: Duration = Duration::from_millis(1500);

/// Starts a solution and waits until it has begun a stage.
fn solving(bench: &Bench, arguments: &[&str], stage: &str) -> Child {
    running(bench, &[&["solve", "scene.toml"], arguments].concat(), stage)
}

/// Starts a run and waits until it has begun a stage.
fn running(bench: &Bench, arguments: &[&str], stage: &str) -> Child {
    let mut command = Command::new(program());
    command.current_dir(bench.folder.path()).args(arguments).args(["--log", "json"]);
    let mut child = command.stdout(Stdio::null()).stderr(Stdio::piped()).spawn().unwrap();
    let mark = format!("\"stage\":\"{stage}\"");
    let mut lines = BufReader::new(child.stderr.take().unwrap()).lines();
    assert!(lines.any(|line| line.unwrap().contains(&mark)), "there is no stage {stage}");
    thread::spawn(move || lines.for_each(drop));
    thread::sleep(Duration::from_millis(100));
    child
}

fn send(child: &Child, signal: &str) {
    assert!(Command::new("kill").args([signal, &child.id().to_string()]).status().unwrap().success());
}

/// Sends a signal and returns the exit code and how long the program took to end.
fn end(mut child: Child, signal: &str) -> (i32, Duration) {
    let started = Instant::now();
    send(&child, signal);
    (child.wait().unwrap().code().unwrap(), started.elapsed())
}

/// A room that takes minutes to assemble on one thread.
fn long_assembly() -> Bench {
    Bench::new(&room(40))
}

const LONG_ASSEMBLY: [&str; 4] = ["--threads", "1", "--form-factor-tolerance", "1e-9"];

/// A room that never comes to the tolerance asked for.
fn long_solution() -> Bench {
    // With a picture of the usual size.
    Bench::new(&furnace(10, &[0.99999]).replace("width = 64\nheight = 48\n", ""))
}

const LONG_SOLUTION: [&str; 4] = ["--tolerance", "1e-300", "--max-iterations", "4000000000"];

#[test]
fn nothing_is_written_during_assembly() {
    for signal in ["-INT", "-TERM"] {
        let bench = long_assembly();
        let (code, time) = end(solving(&bench, &LONG_ASSEMBLY, "assembly"), signal);
        assert_eq!(code, 130);
        assert!(time < PROMPT, "{time:?}");
        assert!(!bench.path("out").exists());
    }
}

#[test]
fn a_second_signal_ends_at_once() {
    let bench = long_assembly();
    let child = solving(&bench, &LONG_ASSEMBLY, "assembly");
    send(&child, "-INT");
    let (code, time) = end(child, "-INT");
    assert_eq!(code, 130);
    assert!(time < PROMPT, "{time:?}");
    assert!(!bench.path("out").exists());
}

#[test]
fn the_iterate_is_written_during_solution() {
    let bench = long_solution();
    let (code, time) = end(solving(&bench, &LONG_SOLUTION, "solution"), "-INT");
    assert_eq!(code, 130);
    assert!(time < PROMPT, "{time:?}");
    assert_eq!(bench.record("out/scene")["partial"], true);
    let names = fs::read_dir(bench.path("out/scene")).unwrap().map(|entry| entry.unwrap().file_name());
    // The folder's own list of its files is hidden.
    let files = names.filter(|name| !name.to_string_lossy().starts_with('.')).count();
    assert_eq!(files, crate::support::usual_files().count());
    let radiosity = column(&bench.path("out/scene/field.csv"), "radiosity_b0");
    assert_eq!(radiosity.len(), 600);
    // Every iterate lies between the exitance and the solution.
    assert!(radiosity.iter().all(|b| (1.0..=1.0001e5).contains(b)));
}

#[test]
fn the_iterate_of_another_discretisation_is_written_during_solution() {
    let bench = Bench::new(&furnace(4, &[0.99999]));
    let arguments = [&LONG_SOLUTION[..], &["--discretisation", "nystrom-2"]].concat();
    let (code, time) = end(solving(&bench, &arguments, "solution"), "-INT");
    assert_eq!(code, 130);
    assert!(time < PROMPT, "{time:?}");
    let record = bench.record("out/scene");
    assert_eq!((&record["partial"], &record["counts"]["unknowns"]), (&true.into(), &384.into()));
    assert_eq!(record["means"], "the irradiance as polynomials");
    let radiosity = column(&bench.path("out/scene/field.csv"), "radiosity_b0");
    assert!(radiosity.len() == 96 && radiosity.iter().all(|b| (1.0..=1.0001e5).contains(b)));
}

#[test]
fn nothing_is_written_by_a_study_cut_short() {
    let bench = long_solution();
    let study = [&["converge", "scene.toml", "--levels", "2"], &LONG_SOLUTION[..]].concat();
    for stage in ["level 0, assembly", "level 0, solution"] {
        let (code, time) = end(running(&bench, &study, stage), "-INT");
        assert_eq!(code, 130);
        assert!(time < PROMPT, "{stage}: {time:?}");
        assert!(!bench.path("out").exists());
    }
}

/// Runs with a limit of time of half a second.
fn limited(bench: &Bench, arguments: &[&str]) -> (i32, String, Duration) {
    let started = Instant::now();
    let line = [&["solve", "scene.toml", "--time-limit", "0.5s"], arguments].concat();
    let run = bench.run(&line);
    (run.code, run.stderr, started.elapsed())
}

#[test]
fn the_limit_of_time_does_what_a_signal_does() {
    let bench = long_assembly();
    let (code, stderr, time) = limited(&bench, &LONG_ASSEMBLY);
    assert_eq!(code, 3);
    assert!(stderr.contains("time limit of 0.5 s has passed") && stderr.contains("help: "), "{stderr}");
    assert!(time < 2 * PROMPT && !bench.path("out").exists(), "{time:?}");
    let bench = long_solution();
    let (code, stderr, time) = limited(&bench, &LONG_SOLUTION);
    assert_eq!(code, 3);
    assert!(stderr.contains("time limit of 0.5 s has passed: the results are those until then"), "{stderr}");
    assert!(time < 2 * PROMPT, "{time:?}");
    let record = bench.record("out/scene");
    assert_eq!((&record["partial"], &record["options"]["time_limit_s"]), (&true.into(), &0.5.into()));
}

#[test]
fn what_is_drawn_is_left_out_of_a_run_cut_short() {
    // A picture of many pixels, walls of many faces, and many points are several seconds of work
    // each.
    let drawn = room(8).replace("width = 64\nheight = 48\n", "width = 4000\nheight = 3000\n");
    let plane = "--plane=0.1,0.1,0.5,0.8,0,0,0,0.8,0,400,400";
    let large = room(8).replace("width = 64\nheight = 48\n", "width = 8000\nheight = 6000\n");
    let cases = [
        ("--no-report", "image.png", large),
        ("--final-gather", "pixels.npz", drawn),
        ("--discontinuity", "shadows.vtu", room(16)),
        (plane, "points.csv", room(8)),
    ];
    for (switch, file, scene) in cases {
        let bench = Bench::new(&scene);
        let arguments = [switch, "--threads", "1", "--form-factor-tolerance", "0.1"];
        let (code, time) = end(solving(&bench, &arguments, "results"), "-INT");
        assert_eq!(code, 130, "{switch}");
        assert!(time < 2 * PROMPT, "{switch}: {time:?}");
        let record = bench.record("out/scene");
        let has = |name: &str| record["files"].as_array().unwrap().iter().any(|file| file == name);
        assert!(has("field.npz") && !has(file), "{}", record["files"]);
        assert!(!bench.path(&format!("out/scene/{file}")).exists());
        assert!(record["warnings"].to_string().contains(file) && record["partial"] != true);
    }
}

#[test]
fn elimination_has_no_iterate_to_write() {
    // A factorisation for every band: several seconds.
    let reflectance: Vec<f64> = (0..40).map(|band| 0.5 + 0.01 * f64::from(band)).collect();
    let bench = Bench::new(&furnace(18, &reflectance));
    let (code, time) = end(solving(&bench, &["--solver", "lu"], "solution"), "-INT");
    assert_eq!(code, 130);
    assert!(time < PROMPT, "{time:?}");
    assert!(!bench.path("out").exists());
}
