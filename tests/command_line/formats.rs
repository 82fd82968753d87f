//! Formats of others: the examples of docs/formats.md, and results as meshes.

use std::fs;
use std::path::Path;

use crate::support::{Bench, column};

/// The commands of a page, in its order.
fn commands(page: &str) -> Vec<Vec<String>> {
    let text = fs::read_to_string(Path::new(env!("CARGO_MANIFEST_DIR")).join(page)).unwrap();
    let lines = text.lines().filter_map(|line| line.strip_prefix("    fredholm "));
    lines.map(|line| line.split_whitespace().map(str::to_owned).collect()).collect()
}

#[test]
fn the_examples_of_the_page_run() {
    let scene = Path::new(env!("CARGO_MANIFEST_DIR")).join("scenes/cornell_planar.toml");
    // Fewer elements than for the pictures of the page are enough.
    let text = fs::read_to_string(scene).unwrap().replace("elements_per_face", "# elements_per_face");
    let bench = Bench::new(&text);
    fs::rename(bench.path("scene.toml"), bench.path("cornell_planar.toml")).unwrap();
    let commands = commands("docs/formats.md");
    assert!(commands.len() >= 9, "{commands:?}");
    for command in commands {
        let words: Vec<&str> = command.iter().map(String::as_str).collect();
        let run = bench.run(&words);
        assert_eq!(run.code, 0, "{words:?}: {}{}", run.stdout, run.stderr);
    }
    for name in ["mitsuba/cornell_planar.xml", "pbrt/cornell_planar.pbrt", "out/field.ply", "out/field.glb"] {
        assert!(bench.path(name).is_file(), "{name}");
    }
    let record = fs::read_to_string(bench.path("out/run.json")).unwrap();
    assert!(record.contains("\"field.glb\"") && record.contains("\"field.ply\""), "{record}");
}

/// A closed room with a lamp in its ceiling.
const ROOM: &str = "[materials.wall]\nreflectance = 0.5\n[materials.lamp]\nreflectance = 0\nexitance = 10\n\
    [[surface]]\nname = \"room\"\nmaterial = \"wall\"\nbox = { min = [0, 0, 0], max = [1, 1, 1], inward = true }\n\
    [[surface]]\nname = \"lamp\"\nmaterial = \"lamp\"\nquad = [[0.4, 0.4, 0.9], [0.4, 0.6, 0.9], [0.6, 0.6, 0.9], [0.6, 0.4, 0.9]]\n";

#[test]
fn a_scene_has_the_same_light_in_every_format_that_holds_materials() {
    let bench = Bench::new(ROOM);
    let light = |file: &str| {
        let run = bench.run(&["solve", file, "-o", "out", "--no-pictures", "--no-report", "--quiet"]);
        assert_eq!(run.code, 0, "{file}: {}{}", run.stdout, run.stderr);
        column(&bench.path("out/faces.csv"), "irradiance_grey")
    };
    let expected = light("scene.toml");
    for file in ["a.obj", "a.glb", "a.rad", "a.xml"] {
        assert_eq!(bench.run(&["convert", "scene.toml", file, "--quiet"]).code, 0, "{file}");
        let found = light(file);
        // Quads are two triangles in glTF and for Mitsuba, so that the light is that of a finer
        // mesh.
        let mean = |values: &[f64]| values.iter().sum::<f64>() / values.len() as f64;
        let (a, b) = (mean(&expected), mean(&found));
        let tolerance = if matches!(file, "a.glb" | "a.xml") { 0.1 } else { 1e-9 };
        assert!((a - b).abs() < tolerance * a, "{file}: {a} {b}");
    }
}

#[test]
fn what_cannot_be_written_or_expressed_is_refused() {
    let bench = Bench::new(ROOM);
    let run = bench.run(&["convert", "scene.toml", "a.dae"]);
    assert!(run.code == 2 && run.stderr.contains(".glb"), "{}", run.stderr);
    let bench = Bench::new(&format!("bands = [\"low\", \"high\"]\n{ROOM}"));
    let run = bench.run(&["export", "scene.toml", "--to", "mitsuba", "-o", "m"]);
    assert!(run.code == 2 && run.stderr.contains("low, high"), "{}", run.stderr);
    assert_eq!(bench.run(&["export", "scene.toml", "--to", "mitsuba", "--band", "low", "-o", "m"]).code, 0);
}
