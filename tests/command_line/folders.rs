//! One folder for one run: what is there before, beside and after it.

use std::fs;
use std::path::Path;

use fredholm::report::{CHECKPOINT, ResultFolder};

use crate::support::{Bench, furnace};

/// The names of the files of a folder that are not hidden.
fn names(folder: &Path) -> Vec<String> {
    let entries =
        fs::read_dir(folder).unwrap().map(|entry| entry.unwrap().file_name().into_string().unwrap());
    let mut names: Vec<String> = entries.filter(|name| !name.starts_with('.')).collect();
    names.sort();
    names
}

#[test]
fn a_second_run_into_the_same_folder_is_refused() {
    let bench = Bench::new(&furnace(1, &[0.5]));
    let first = ResultFolder::claim(bench.path("here")).unwrap();
    for verb in ["solve", "trace", "spectrum", "export"] {
        let more: &[&str] = if verb == "export" { &["--to", "obj"] } else { &[] };
        let run = bench.run(&[&[verb, "scene.toml", "-o", "here"], more].concat());
        assert_eq!(run.code, 5, "{verb}: {}", run.stderr);
        assert!(run.stderr.contains("another run of Fredholm writes into here"), "{}", run.stderr);
        assert!(
            run.stderr.contains("help: wait until it has ended, or write elsewhere with -o DIR"),
            "{verb}"
        );
    }
    drop(first);
    bench.solve(&["-o", "here", "--quiet"]);
}

#[test]
fn of_runs_of_different_commands_the_last_one_stays() {
    let bench = Bench::new(&furnace(1, &[0.5]));
    let verbs: [(&str, &[&str], &str); 5] = [
        ("solve", &["--no-report"], "field.vtu"),
        ("trace", &["--samples", "64"], "trace.json"),
        ("compare", &["--solvers", "gmres", "--no-report"], "compare.json"),
        ("spectrum", &[], "spectrum.json"),
        ("shoot", &["--no-report"], "shots.json"),
    ];
    for (verb, more, own) in verbs {
        let write = |folder: &str| {
            let run = bench.run(&[&[verb, "scene.toml", "-o", folder, "--quiet"], more].concat());
            assert_eq!(run.code, 0, "{verb}: {}", run.stderr);
            names(&bench.path(folder))
        };
        let (alone, after) = (write(verb), write("shared"));
        assert_eq!(alone, after, "{verb}");
        assert!(alone.iter().any(|name| name == own), "{alone:?}");
    }
    let run = bench.run(&["trace", "scene.toml", "-o", "shared", "--samples", "64", "--quiet"]);
    assert_eq!(run.code, 0, "{}", run.stderr);
    let info = bench.run(&["info", "shared"]).stdout;
    assert!(info.contains("random paths") || info.contains("path"), "{info}");
    assert!(bench.run(&["info", "shared/field.vtu"]).code != 0, "there is none any more");
}

#[test]
fn every_command_has_a_folder_of_its_own() {
    let bench = Bench::new(&furnace(1, &[0.5]));
    bench.solve(&["--quiet"]);
    for verb in ["trace", "spectrum"] {
        assert_eq!(bench.run(&[verb, "scene.toml", "--quiet"]).code, 0);
    }
    assert_eq!(names(&bench.path("out")), ["scene", "scene-spectrum", "scene-trace"]);
    assert!(bench.path("out/scene/field.vtu").exists());
}

#[test]
fn files_that_no_run_has_written_are_not_replaced() {
    let bench = Bench::new(&furnace(1, &[0.5]));
    fs::create_dir(bench.path("mine")).unwrap();
    fs::write(bench.path("mine/faces.csv"), "measured").unwrap();
    let run = bench.run(&["solve", "scene.toml", "-o", "mine"]);
    assert_eq!(run.code, 5, "{}", run.stderr);
    assert!(run.stderr.contains("mine/faces.csv") && run.stderr.contains("move it away"), "{}", run.stderr);
    assert_eq!(fs::read(bench.path("mine/faces.csv")).unwrap(), b"measured");
    // A table in the folder of a matrix is of no concern, one of its name is.
    fs::write(bench.path("F.csv"), "measured").unwrap();
    let matrix = |name: &str| bench.run(&["viewfactors", "scene.toml", "-o", name, "--quiet"]);
    assert_eq!((matrix("mine/F.csv").code, matrix("F.csv").code), (0, 5));
}

#[test]
fn what_a_killed_run_has_left_is_removed() {
    let bench = Bench::new(&furnace(1, &[0.5]));
    bench.solve(&["-o", "here", "--quiet"]);
    let left = bench.path("here/.fredholm-abcdef.tmp");
    fs::write(&left, "half a file").unwrap();
    bench.solve(&["-o", "here", "--quiet"]);
    assert!(!left.exists());
}

#[test]
fn a_damaged_checkpoint_is_refused() {
    let bench = Bench::new(&furnace(1, &[0.5]));
    fs::create_dir(bench.path("here")).unwrap();
    let path = bench.path("here").join(CHECKPOINT);
    let line = "{\"format\":\"fredholm-checkpoint-2\"}\n".repeat(8);
    fs::write(&path, line).unwrap();
    let run = bench.run(&["resume", "here"]);
    assert_eq!(run.code, 2, "{}", run.stderr);
    assert!(run.stderr.contains("its header (bytes 0 to 35)"), "{}", run.stderr);
    assert!(run.stderr.contains("help: solve the scene again"), "{}", run.stderr);
}
