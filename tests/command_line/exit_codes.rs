//! Exit codes of every class, each with a message that says what to do.

use std::fs;

use crate::support::{Bench, furnace};

/// Expects an exit code, a message on standard error that contains `hint`, and nothing on standard
/// output.
fn refused(bench: &Bench, arguments: &[&str], code: i32, hint: &str) {
    let run = bench.run(arguments);
    assert_eq!(run.code, code, "{arguments:?}: {}", run.stderr);
    assert!(run.stderr.contains(hint), "{arguments:?}: {}", run.stderr);
    assert!(run.stderr.contains("error: ") || run.stderr.contains("Usage:"), "{}", run.stderr);
    assert_eq!(run.stdout, "", "{arguments:?}");
}

#[test]
fn usage_is_2() {
    let bench = Bench::new(&furnace(1, &[0.5]));
    refused(&bench, &[], 2, "Usage:");
    refused(&bench, &["render", "scene.toml"], 2, "unrecognized subcommand");
    refused(&bench, &["solve", "scene.toml", "--solver", "magic"], 2, "possible values: gauss-seidel");
    refused(&bench, &["solve", "scene.toml", "--threads", "0"], 2, "1..=1024");
    refused(&bench, &["solve", "scene.toml", "--tolerance", "2"], 2, "such as 1e-6");
    refused(&bench, &["solve", "scene.toml", "--memory", "lots"], 2, "4GiB");
}

#[test]
fn bad_input_is_2() {
    let bench = Bench::new(&format!("{}[solve]\nsolver = \"southwel\"\n", furnace(1, &[0.5])));
    let line = fs::read_to_string(bench.path("scene.toml")).unwrap().lines().count();
    let message = format!("scene.toml:{line}:10: there is no solver `southwel`");
    for verb in ["solve", "check"] {
        refused(&bench, &[verb, "scene.toml"], 2, &message);
        refused(&bench, &[verb, "scene.toml"], 2, "did you mean `southwell`?");
    }
    fs::write(bench.path("notes.json"), "{}").unwrap();
    refused(&bench, &["info", "notes.json"], 2, "is no record of a result");
    refused(&bench, &["info", "scene.toml"], 2, "none of the files of a result");
}

#[test]
fn not_converged_is_3_and_writes_the_results() {
    let bench = Bench::new(&furnace(2, &[0.9]));
    let run = bench.run(&["solve", "scene.toml", "--max-iterations", "1"]);
    assert_eq!(run.code, 3, "{}", run.stderr);
    let record = bench.record("out/scene");
    assert_eq!(record["partial"], false);
    assert!(record["warnings"][0].as_str().unwrap().contains("tolerance was not met"));
    assert!(record["history"]["residual"][0].as_array().unwrap().last().unwrap().as_f64().unwrap() > 1e-10);
    assert!(bench.path("out/scene/field.csv").is_file());
}

#[test]
fn too_little_memory_is_4() {
    let bench = Bench::new(&furnace(4, &[0.5]));
    refused(&bench, &["solve", "scene.toml", "--memory", "10kB"], 4, "--memory");
    // To predict that is what `check` is for: what the mesh is, and the way without a matrix, are
    // told all the same.
    let run = bench.run(&["check", "scene.toml", "--memory", "10kB"]);
    assert!(run.code == 0 && run.stdout.contains("--memory"), "{}{}", run.stdout, run.stderr);
    assert!(run.stdout.contains("6 flat pieces") && run.stdout.contains("--accuracy 5%"), "{}", run.stdout);
    assert!(!bench.path("out").exists());
}

#[test]
fn files_are_5() {
    let bench = Bench::new(&furnace(1, &[0.5]));
    refused(&bench, &["solve", "missing.toml"], 5, "missing.toml");
    refused(&bench, &["check", "."], 5, "cannot");
    refused(&bench, &["solve", "scene.toml", "-o", "scene.toml"], 5, "it is a file");
    refused(&bench, &["solve", "scene.toml", "-o", "scene.toml/below"], 5, "-o DIR");
    #[cfg(unix)]
    refused(&bench, &["solve", "scene.toml", "-o", "/dev/null"], 5, "it is a file");
    refused(&bench, &["info", "missing"], 5, "missing");
    fs::create_dir(bench.path("empty")).unwrap();
    refused(&bench, &["info", "empty"], 5, "no complete result");
}

#[test]
fn errors_are_json_where_asked_for() {
    let bench = Bench::new("titel = 3\n");
    let run = bench.run(&["solve", "scene.toml", "--log", "json"]);
    let lines: Vec<serde_json::Value> =
        run.stderr.lines().map(|line| serde_json::from_str(line).unwrap()).collect();
    assert!(lines.iter().all(|line| line["event"].is_string() && line["time"].is_number()));
    let last = lines.last().unwrap();
    assert_eq!((run.code, &last["event"], &last["code"]), (2, &"error".into(), &2.into()));
    assert!(last["message"].as_str().unwrap().starts_with("scene.toml:1:1: "));
}

#[test]
#[cfg(target_os = "linux")]
fn a_full_standard_error_changes_nothing_but_the_silence() {
    let bench = Bench::new(&furnace(1, &[0.5]));
    for (arguments, code) in [(["check", "scene.toml"], 0), (["check", "missing.toml"], 5)] {
        for log in ["plain", "json"] {
            let full = fs::File::options().write(true).open("/dev/full").unwrap();
            let mut command = std::process::Command::new(crate::support::program());
            command.current_dir(bench.folder.path()).args(arguments).args(["--log", log]).stderr(full);
            assert_eq!(command.output().unwrap().status.code(), Some(code), "{arguments:?} {log}");
        }
    }
}
