//! What `info` tells of every kind of result, and what is said where a scene of light and one of
//! waves are mistaken for each other.

use std::fs;

use crate::support::{Bench, PLATE, room};

/// Every command that writes a folder or a matrix, where it writes, and words that tell its result.
const RESULTS: [(&str, &str, &[&str]); 15] = [
    ("solve room.toml -o r", "r", &["mean irradiance r ", "stated error", "converged after", "80 elements"]),
    ("solve room.toml --accuracy 20% -o a", "a", &["20 % was asked for", "hierarchical"]),
    ("trace room.toml --samples 64 -o t", "t", &["standard error, L2", "by path", "paths"]),
    (
        "trace plate.toml --method surface-sampling --samples 64 -o f",
        "f",
        &["of the fields (standard error, L2)"],
    ),
    ("shoot room.toml -o s", "s", &["of the power distributed", "stated error"]),
    ("compare room.toml --solvers gauss-seidel,lu -o c", "c", &["gauss-seidel", "outcome", "errors against"]),
    ("spectrum room.toml -o e", "e", &["ρ(RF)", "dense methods"]),
    ("converge room.toml --levels 2 -o l", "l", &["level 1", "no order"]),
    ("crosscheck room.toml --samples 64 -o x", "x", &["verdict", "standard error"]),
    ("reference room.toml --samples 64 --size 16x12 -o b", "b", &["stated error", "80 faces, 2 bands"]),
    ("judge b b/reference.csv -o j", "j", &["verdict", "irradiance of faces"]),
    ("viewfactors room.toml -o F.npz", "F.npz", &["80 rows", "closure"]),
    ("viewfactors room.toml -o F.csv", "F.csv", &["80 rows of 80 elements", "closure"]),
    ("waves plate.toml -o w", "w", &["efie", "stated error", "at point, 1000 MHz"]),
    ("waves plate.toml --compare neumann,gmres -o v", "v", &["spectral radius", "gmres"]),
];

fn bench() -> Bench {
    let bench = Bench::new("");
    fs::write(bench.path("room.toml"), room(3)).unwrap();
    fs::write(bench.path("plate.toml"), PLATE).unwrap();
    bench
}

#[test]
fn every_kind_of_result_is_told_and_so_is_every_file_of_it() {
    let bench = bench();
    for (line, place, words) in RESULTS {
        let run = bench.run(&line.split(' ').collect::<Vec<_>>());
        assert!([0, 3, 6].contains(&run.code), "{line}: {} {}", run.code, run.stderr);
        let told = bench.run(&["info", place]);
        assert_eq!(told.code, 0, "{line}: {}", told.stderr);
        let scene = if line.contains("plate") { "plate.toml" } else { "room.toml" };
        let scene = if line.starts_with("judge") { "b" } else { scene };
        // The arrays of a matrix do not say what they were made of.
        let made = if place == "F.npz" { "rows" } else { scene };
        for word in words.iter().chain(&[made]) {
            assert!(told.stdout.contains(word), "{line}: no {word} in {}", told.stdout);
        }
        let folder = bench.path(place);
        for entry in fs::read_dir(&folder).into_iter().flatten().flatten() {
            let name = entry.file_name().into_string().unwrap();
            if name.starts_with('.') || entry.path().is_dir() || name.starts_with("mitsuba") {
                continue;
            }
            let of_file = bench.run(&["info", &format!("{place}/{name}")]);
            assert_eq!(of_file.stdout, told.stdout, "{line}, {name}: {}", of_file.stderr);
        }
    }
}

#[test]
fn what_is_no_result_is_refused_with_a_way_out() {
    let bench = bench();
    fs::create_dir(bench.path("empty")).unwrap();
    fs::create_dir(bench.path("foreign")).unwrap();
    fs::write(bench.path("foreign/run.json"), "{\"format\": \"other-1\"}").unwrap();
    fs::create_dir(bench.path("cut")).unwrap();
    fs::write(bench.path("cut/run.json"), "{\"format\": \"fredholm-ru").unwrap();
    for (path, code, words) in [
        ("empty", 5, "holds no complete result"),
        ("none", 5, "cannot read none"),
        ("foreign", 2, "\"format\" is \"other-1\""),
        ("cut", 2, "is damaged"),
        ("room.toml", 2, "none of the files of a result"),
    ] {
        let told = bench.run(&["info", path]);
        assert_eq!(told.code, code, "{path}: {}", told.stderr);
        assert!(told.stderr.contains(words) && told.stderr.contains("help: "), "{path}: {}", told.stderr);
    }
}

#[test]
fn the_command_for_a_scene_is_named_where_another_was_taken() {
    let bench = bench();
    for command in ["solve", "trace", "shoot", "compare", "spectrum", "reference"] {
        let run = bench.run(&[command, "plate.toml"]);
        assert_eq!(run.code, 2, "{command}: {}", run.stderr);
        for words in ["plate.toml is a scene of waves, not of light", "`fredholm waves plate.toml`"] {
            assert!(run.stderr.contains(words), "{command}: {}", run.stderr);
        }
    }
    let run = bench.run(&["waves", "room.toml"]);
    assert_eq!(run.code, 2, "{}", run.stderr);
    for words in ["room.toml is a scene of light, not of waves", "`fredholm solve room.toml`"] {
        assert!(run.stderr.contains(words), "{}", run.stderr);
    }
}
