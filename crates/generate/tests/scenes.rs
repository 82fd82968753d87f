//! What is generated can be read, has what was asked for, and stays the same.

#![allow(clippy::unwrap_used, reason = "a test fails by panicking")]

use fredholm_generate::{Almond, City, Files, Room, Scan};
use fredholm_mesh::{Mesh, Vec3};
use fredholm_scene::Scene;
use fredholm_scene::waves::{Cuts, WaveScene};

fn read(files: &Files) -> (Scene, Mesh) {
    let folder = tempfile::tempdir().unwrap();
    let scene = Scene::load(files.write(folder.path()).unwrap()).unwrap();
    let mesh = scene.mesh().unwrap();
    scene.check(&mesh).unwrap();
    (scene, mesh)
}

#[test]
fn a_city_has_the_faces_asked_for_and_one_sky() {
    for (faces, jitter) in [(1_000, 0.0), (13_000, 0.0), (13_000, 0.003), (100_000, 0.003)] {
        let city = City { faces, jitter, ..City::default() };
        let (scene, mesh) = read(&city.files());
        let found = mesh.faces().len();
        assert!(found <= faces && found + 6 > faces - 12, "{found} of {faces}");
        let reflectance = scene.reflectance(&mesh);
        let emits = scene.exitance(&mesh);
        for (reflectance, exitance) in reflectance.iter().zip(&emits) {
            assert!(if *exitance > 0.0 { *reflectance == 0.0 } else { (0.2..=0.7).contains(reflectance) });
        }
    }
}

#[test]
fn faces_of_a_city_without_jitter_are_flat_enough_to_stay_whole() {
    let (_, mesh) = read(&City { faces: 3_000, ..City::default() }.files());
    let quads = mesh.patches().filter(|patch| patch.sides() == 4).count();
    // What touching blocks cover of each other is cut away, which leaves triangles.
    assert!(5 * quads > 2 * mesh.len(), "{quads} of {}", mesh.len());
}

#[test]
fn corners_moved_by_a_length_are_moved_by_it() {
    let corners = |jitter: f64| {
        let files = City { faces: 2_000, seed: 3, jitter }.files();
        let numbers = |line: &str| -> Vec3 {
            let xyz: Vec<f64> = line[2..].split(' ').map(|x| x.parse().unwrap()).collect();
            Vec3::new(xyz[0], xyz[1], xyz[2])
        };
        let lines = files.others[0].1.lines().filter(|line| line.starts_with("v ")).take(8);
        lines.map(numbers).collect::<Vec<_>>()
    };
    for (from, to) in corners(1e-6).into_iter().zip(corners(0.003)) {
        assert!((from.distance(to) - 0.003).abs() < 1e-5, "{from} {to}");
    }
}

#[test]
fn a_scan_is_closed_creased_and_of_the_size_asked_for() {
    for triangles in [500, 20_000, 100_000] {
        let (_, mesh) = read(&Scan { triangles, ..Scan::default() }.files());
        let figure: Vec<_> = mesh.patches().filter(|patch| patch.sides() == 3).collect();
        assert!(figure.len() <= triangles && 10 * figure.len() >= 9 * triangles, "{}", figure.len());
        let open: Vec3 = figure.iter().map(|patch| patch.normal() * patch.area()).sum();
        let area: f64 = figure.iter().map(|patch| patch.area()).sum();
        assert!(open.length() < 1e-5 * area, "the figure is closed");
        let flux: f64 =
            figure.iter().map(|patch| patch.centroid().dot(patch.normal()) * patch.area() / 3.0).sum();
        assert!((0.05..0.5).contains(&flux), "its volume is {flux} m³: is it inside out?");
    }
}

#[test]
fn a_room_is_closed_and_of_one_reflectance() {
    for (boxes, furnace) in [(0, false), (1, false), (7, true), (40, false)] {
        let room = Room { reflectance: 0.98, boxes, furnace, seed: 5, ..Room::default() };
        let (scene, mesh) = read(&room.files());
        let open: Vec3 = mesh.patches().map(|patch| patch.normal() * patch.area()).sum();
        assert!(open.length() < 1e-9);
        assert_eq!(mesh.len(), 6 * 16 + 6 * boxes);
        assert!(scene.reflectance(&mesh).iter().all(|&reflectance| (reflectance - 0.98).abs() < 1e-15));
        let emitting = scene.exitance(&mesh).iter().filter(|&&exitance| exitance > 0.0).count();
        assert_eq!(emitting, if furnace { mesh.len() } else { 1 });
    }
}

#[test]
fn the_same_seed_gives_the_same_files_and_another_gives_others() {
    let city = |seed| City { faces: 1_000, seed, jitter: 0.003 }.files();
    assert_eq!(city(1), city(1));
    assert_ne!(city(1).others, city(2).others);
    let scan = |seed| Scan { triangles: 1_000, seed, noise: 0.1 }.files();
    assert_eq!(scan(1), scan(1));
    assert_ne!(scan(1).others, scan(2).others);
    let room = |seed| Room { seed, ..Room::default() }.files();
    assert_eq!(room(1), room(1));
    assert_ne!(room(1).others, room(2).others);
}

/// The volume tends to that of the formulae (3.716661e-4 m³ by fine quadrature).
#[test]
fn the_almond_is_closed_and_has_its_size() {
    for edge in [0.012, 0.003] {
        let folder = tempfile::tempdir().unwrap();
        let files = Almond { frequency: 3.5e9, edge: Some(edge) }.files();
        let scene = WaveScene::load(files.write(folder.path()).unwrap()).unwrap();
        assert!(scene.check().unwrap().is_empty(), "{:?}", scene.check());
        let mesh =
            scene.cut(Cuts { wavelength: 0.0857, stretch: 1.0, whole: false }).unwrap().mesh().unwrap();
        let longest = mesh.patches().flat_map(|patch| {
            (0..3).map(|i| patch.corner(i).distance(patch.corner(i + 1))).collect::<Vec<_>>()
        });
        let longest = longest.fold(0.0, f64::max);
        assert!(longest < 2.0 * edge && longest > 0.9 * edge, "{longest}");
        let volume: f64 = mesh.patches().map(|p| p.centroid().dot(p.normal()) * p.area() / 3.0).sum();
        assert!((volume / 3.716_661e-4 - 1.0).abs() < 1.5e3 * edge * edge, "{volume}");
        let tip = mesh.patches().flat_map(|p| p.corners().to_vec()).map(|p| p.x).fold(0.0, f64::max);
        assert!((tip - 0.147_217).abs() < 1e-5, "{tip}");
    }
}
