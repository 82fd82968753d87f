//! The scenes that newcomers run first.

#![allow(clippy::unwrap_used, reason = "a test fails by panicking")]

use std::path::{Path, PathBuf};

use fredholm_mesh::{Mesh, Vec3};
use fredholm_scene::Scene;

fn folder() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("../../scenes")
}

fn load(name: &str) -> (Scene, Mesh) {
    let scene = Scene::load(folder().join(name)).unwrap();
    let mesh = scene.mesh().unwrap();
    (scene, mesh)
}

/// Area of a surface, m².
fn area(mesh: &Mesh, name: &str) -> f64 {
    let surface = mesh.surfaces().iter().position(|surface| surface.name == name).unwrap();
    mesh.faces().iter().filter(|face| face.surface == surface).map(|face| face.area).sum()
}

fn assert_close(found: f64, expected: f64, what: &str) {
    assert!((found - expected).abs() <= 1e-12 * expected.abs(), "{what}: {found} instead of {expected}");
}

#[test]
fn every_scene_is_sound_and_says_what_it_shows() {
    let files = std::fs::read_dir(folder()).unwrap().map(|entry| entry.unwrap().path());
    let files: Vec<PathBuf> = files.filter(|path| path.extension().is_some_and(|e| e == "toml")).collect();
    assert!(files.len() >= 5);
    for file in files {
        let scene = Scene::load(&file).unwrap();
        let mesh = scene.mesh().unwrap();
        assert_eq!(scene.check(&mesh).unwrap(), [], "{}", file.display());
        assert_eq!(scene.predicted_elements(), mesh.len() as u128);
        assert!((24..60_000).contains(&mesh.len()), "{}: {}", file.display(), mesh.len());
        assert!(std::fs::read_to_string(&file).unwrap().starts_with("# Shows "), "{}", file.display());
    }
}

#[test]
fn the_references_have_the_faces_of_their_patches() {
    for (name, surfaces, faces) in [("cornell_planar.toml", 16, 480), ("occluder.toml", 9, 936)] {
        let (_, mesh) = load(name);
        assert_eq!((mesh.surfaces().len(), mesh.faces().len()), (surfaces, faces), "{name}");
    }
    let (scene, mesh) = load("cornell_planar.toml");
    assert_eq!(scene.bands(), ["r", "g", "b"]);
    // A cell of the ceiling that touches the lamp: 71 mm × 75.667 mm, beginning at x = 142 mm, z =
    // 151.333 mm.
    let near = Vec3::new(0.1775, 0.5488, 0.189_166_666_666_666_67);
    let face = mesh.faces().iter().find(|face| face.centroid.distance(near) < 1e-9).unwrap();
    assert_close(face.area, 0.071 * 0.227 / 3.0, "cell");
    assert_close(area(&mesh, "ceiling") + area(&mesh, "light"), 0.5528 * 0.5592, "ceiling");
    let (_, mesh) = load("occluder.toml");
    assert_close(area(&mesh, "ceiling"), 1.0 - 0.3 * 0.3, "ceiling");
    assert_close(area(&mesh, "plate_bottom"), 0.4 * 0.4, "plate");
}

#[test]
fn the_cornell_box_is_the_published_one() {
    let (scene, mesh) = load("cornell_box.toml");
    assert_close(area(&mesh, "lamp"), 0.130 * 0.105, "lamp");
    assert_close(area(&mesh, "ceiling"), 0.556 * 0.5592 - 0.130 * 0.105, "ceiling");
    assert_close(area(&mesh, "floor"), 0.5592 * (0.5528 + 0.5496) / 2.0, "floor");
    assert_close(area(&mesh, "back"), 0.5488 * (0.5496 + 0.556) / 2.0, "back");
    assert_close(area(&mesh, "right_green"), 0.5592 * 0.5488, "right wall");
    assert_close(area(&mesh, "short_side1"), 0.165 * 0.05_f64.hypot(0.158), "short block");
    assert_close(area(&mesh, "tall_side1"), 0.33 * 0.049_f64.hypot(0.159), "tall block");
    // Published at 440, 540 and 640 nm.
    for (name, published) in
        [("white", [0.745, 0.743, 0.712]), ("green", [0.097, 0.441, 0.114]), ("red", [0.059, 0.059, 0.609])]
    {
        let material = scene.materials().iter().find(|material| material.name == name).unwrap();
        for (band, reflectance) in ["440nm", "540nm", "640nm"].into_iter().zip(published) {
            let index = scene.bands().iter().position(|b| b == band).unwrap();
            assert_close(material.reflectance[index], reflectance, band);
        }
    }
}

#[test]
fn the_left_wall_of_the_cornell_box_is_a_bilinear_surface() {
    let (_, mesh) = load("cornell_box.toml");
    // x(u, v) = 552.8 − 3.2 u + v (3.2 + 3.2 u) mm at z = 559.2 u, y = 548.8 v; area by the
    // midpoint rule.
    let (w, h, n) = (0.5592, 0.5488, 400);
    let cell = |i: usize, j: usize| {
        let [u, v] = [i, j].map(|k| (k as f64 + 0.5) / f64::from(n));
        let slopes = [(0.0032 * v - 0.0032) / w, (0.0032 + 0.0032 * u) / h];
        (1.0 + slopes[0] * slopes[0] + slopes[1] * slopes[1]).sqrt()
    };
    let cells = n as usize;
    let sum: f64 = (0..cells).flat_map(|i| (0..cells).map(move |j| cell(i, j))).sum();
    let expected = w * h * sum / (cells * cells) as f64;
    // The triangles differ from the surface by less; a flat wall would by 2e-5.
    let error = area(&mesh, "left_red") / expected - 1.0;
    assert!(error.abs() < 1e-7, "{error}");
}

#[test]
fn furniture_from_files_has_the_sizes_it_was_given() {
    let (scene, mesh) = load("studio.toml");
    // A slab 1.6 m × 0.9 m × 0.04 m; the outline of the sofa, drawn out over 2 m.
    assert_close(area(&mesh, "table/top"), 2.0 * (1.6 * 0.9 + 1.6 * 0.04 + 0.9 * 0.04), "table");
    let seat = 2.0 * (0.42 * 0.42 + 2.0 * 0.42 * 0.03);
    for chair in ["chair_1/seat", "chair_3/seat"] {
        assert_close(area(&mesh, chair), seat, chair);
    }
    let profile = [(0.42, 0.0), (-0.02, -0.6), (0.45, -0.1), (0.0, -0.2), (-0.85, 0.0)]
        .map(|(z, y): (f64, f64)| z.hypot(y));
    // Trapezoids under the seat and the back.
    let end = 0.6 * 0.41 + 0.1 * (0.4 + 0.85) / 2.0 + 0.2 * 0.85;
    assert_close(area(&mesh, "sofa/sofa"), 2.0 * profile.iter().sum::<f64>() + 2.0 * end, "sofa");
    assert!(mesh.surfaces().iter().any(|surface| surface.name == "pendant/back"));
    let lamps = scene.exitance(&mesh).iter().filter(|&&exitance| exitance > 0.0).count();
    assert!(lamps > 100, "{lamps}");
}
