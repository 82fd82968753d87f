//! Mesh files given instead of scenes.

use std::fs;

use crate::support::{Bench, column};

/// A unit cube, lit outside, its top of another material.
const CUBE: &str = "\u{feff}# a cube\nmtllib cube.mtl\n\
    v 0 0 0\nv 1 0 0\nv 0 1 0\nv 1 1 0\nv 0 0 1\nv 1 0 1\nv 0 1 1\nv 1 1 1\n\
    o cube\nusemtl side\nf 1 5 7 3\nf 2 4 8 6\nf 1 2 6 5\nf 3 7 8 4\nf 1 3 4 2\nusemtl top\nf 5 6 8 7\n";

/// The same, lit inside.
fn room() -> String {
    let turn = |line: &str| match line.strip_prefix("f ") {
        Some(corners) => format!("f {}\n", corners.split(' ').rev().collect::<Vec<_>>().join(" ")),
        None => format!("{line}\n"),
    };
    CUBE.lines().map(turn).collect()
}

fn bench(obj: &str, mtl: &[u8]) -> Bench {
    let bench = Bench::new("");
    fs::write(bench.path("cube.obj"), obj).unwrap();
    fs::write(bench.path("cube.mtl"), mtl).unwrap();
    bench
}

#[test]
fn a_convex_object_under_the_even_light_receives_pi() {
    let bench = bench(CUBE, b"newmtl side\nKd 0.5 0.5 0.5\n# caf\xe9\nnewmtl top\nKd 1 1 1\n");
    let run = bench.run(&["solve", "cube.obj"]);
    assert_eq!(run.code, 0, "{}", run.stderr);
    let irradiance = column(&bench.path("out/cube/faces.csv"), "irradiance_grey");
    assert_eq!(irradiance.len(), 12);
    for e in &irradiance[..6] {
        assert!((e - std::f64::consts::PI).abs() < 1e-3, "{irradiance:?}");
    }
    for told in [
        "`side` is read from this library: reflectance 0.5;",
        "lowered to 0.95 where Kd is 1",
        "`sky`, lights it evenly",
    ] {
        assert!(run.stdout.contains(told), "no {told}: {}", run.stdout);
    }
    assert!(fs::metadata(bench.path("out/cube/image.png")).unwrap().len() > 1000);
    let run = bench.run(&["solve", "cube.obj", "--no-pictures", "--accuracy", "5%"]);
    assert_eq!(run.code, 0, "{}", run.stderr);
    for gone in ["image.png", "mesh.png", "links.png"] {
        assert!(!bench.path("out/cube").join(gone).exists(), "{gone}");
    }
    assert!(!bench.record("out/cube")["files"].to_string().contains("png"));
}

#[test]
fn what_emits_lights_the_mesh_in_the_colours_of_its_library() {
    let mtl = b"newmtl side\r\nKd 0.6 0.3 0.2\r\nnewmtl top\r\nKd 0 0 0\r\nKe 2 1 0\r\nmap_Kd top.png\r\n";
    let bench = bench(&room(), mtl);
    let run = bench.run(&["solve", "cube.obj"]);
    assert_eq!(run.code, 0, "{}", run.stderr);
    let [red, blue] =
        ["r", "b"].map(|band| column(&bench.path("out/cube/faces.csv"), &format!("irradiance_{band}")));
    assert!(
        red.len() == 6 && red.iter().all(|e| *e > 0.3) && blue.iter().all(|e| *e == 0.0),
        "{red:?} {blue:?}"
    );
    assert!(
        run.stdout.contains("exitance π Ke = 6.2832 3.1416 0 W/m²; its picture `top.png` is not read"),
        "{}",
        run.stdout
    );
    assert!(!run.stdout.contains("sky"));
}

#[test]
fn the_materials_of_a_scene_come_before_those_of_the_library() {
    let bench = bench(&room(), b"newmtl side\nKd 0.5 0.5 0.5\nnewmtl top\nKd 0 0 0\nKe 1 1 1\n");
    let solved = |materials: &str| {
        let scene = format!("{materials}[[surface]]\nname = \"x\"\nobj = {{ file = \"cube.obj\" }}\n");
        fs::write(bench.path("scene.toml"), scene).unwrap();
        let run = bench.solve(&["--no-pictures"]);
        (column(&bench.path("out/scene/faces.csv"), "irradiance_grey")[4], run.stdout)
    };
    let (bright, told) = solved("");
    assert!(told.contains("`side` is read") && told.contains("`top` is read"), "{told}");
    let (dark, told) = solved("[materials.side]\nreflectance = 0\n");
    assert!(!told.contains("`side` is read") && told.contains("`top` is read"), "{told}");
    assert!(dark < 0.9 * bright, "{dark} {bright}");
}

#[test]
fn colours_that_make_no_sense_are_refused_at_their_line() {
    for (line, wanted) in [
        ("Kd 0.2 1.5 0.1", "cube.mtl:2:1: the reflectance Kd of `side` is out of range"),
        ("Kd 0.2 -0.5 0.1", "no surface reflects more than it receives"),
        ("Kd red", "cube.mtl:2:1: this is no colour"),
        ("Ke inf 0 0", "this is no colour"),
    ] {
        let run = bench(CUBE, format!("newmtl side\n{line}\n").as_bytes()).run(&["check", "cube.obj"]);
        assert!(run.code == 2 && run.stderr.contains(wanted), "{}", run.stderr);
    }
}

#[test]
fn a_mesh_without_its_library_is_grey() {
    let bench = Bench::new("");
    fs::write(bench.path("cube.obj"), CUBE).unwrap();
    let run = bench.run(&["check", "cube.obj", "-o", "drawn"]);
    assert_eq!(run.code, 0, "{}", run.stderr);
    for told in [
        "cannot read the material library `cube.mtl`",
        "without a material that is known reflect 0.5",
        "hang together in 1 objects, 1 of them closed",
    ] {
        assert!(run.stdout.contains(told), "no {told}: {}", run.stdout);
    }
    assert!(fs::metadata(bench.path("drawn/check.png")).unwrap().len() > 1000);
    assert!(!bench.path("out").exists());
}

#[test]
fn a_matrix_that_does_not_fit_has_its_mesh_told_and_another_way_named() {
    let bench = bench(CUBE, b"newmtl side\nKd 0.5 0.5 0.5\nnewmtl top\nKd 0.5 0.5 0.5\n");
    let run = bench.run(&["check", "cube.obj", "--memory", "1MB"]);
    assert_eq!(run.code, 0, "{}", run.stderr);
    assert!(
        run.stdout.contains("6 flat pieces") && run.stdout.contains("solve --accuracy 5%"),
        "{}",
        run.stdout
    );
    let solve = bench.run(&["solve", "cube.obj", "--memory", "1MB"]);
    assert!(solve.code == 4 && solve.stderr.contains("--accuracy 5%"), "{}", solve.stderr);
}

#[test]
fn the_other_commands_take_a_mesh_file() {
    let bench = bench(CUBE, b"newmtl side\nKd 0.5 0.5 0.5\nnewmtl top\nKd 0.5 0.5 0.5\n");
    for line in [
        "shoot cube.obj --no-pictures",
        "trace cube.obj --to 20% --no-pictures",
        "compare cube.obj --solvers gauss-seidel,lu",
    ] {
        let run = bench.run(&line.split(' ').collect::<Vec<_>>());
        assert_eq!(run.code, 0, "{line}: {}", run.stderr);
    }
}
