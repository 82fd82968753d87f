//! What is generated can be read, has what was asked for, and stays the same.

#![allow(clippy::unwrap_used, reason = "a test fails by panicking")]

use fredholm_generate::{Almond, City, Classroom, Files, Office, Room, Scan};
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

/// What is shipped in scenes/ is what is made.
#[test]
fn the_office_and_the_classroom_are_those_that_are_shipped() {
    let shipped = std::path::Path::new(env!("CARGO_MANIFEST_DIR")).join("../../scenes");
    for files in [Office::default().files(), Classroom::default().files()] {
        let text = |name: &str| std::fs::read_to_string(shipped.join(name)).unwrap();
        assert!(text(&files.name) == files.scene, "{} is another", files.name);
        for (name, made) in &files.others {
            assert!(text(name) == *made, "{name} is another");
        }
    }
}

#[test]
fn an_office_grows_by_bays_and_is_lit_from_every_ceiling() {
    let triangles = |mesh: &Mesh| mesh.patches().map(|patch| patch.sides() - 2).sum::<usize>();
    let (_, one) = read(&Office::default().files());
    assert!((20_000..=50_000).contains(&triangles(&one)), "{}", triangles(&one));
    for bays in [3, 8] {
        let (scene, mesh) = read(&Office { bays, seed: 2 }.files());
        let ratio = triangles(&mesh) as f64 / (bays * triangles(&one)) as f64;
        assert!((0.9..1.1).contains(&ratio), "{bays}: {ratio}");
        let power: f64 = scene
            .exitance(&mesh)
            .chunks(3)
            .zip(mesh.patches())
            .filter(|(_, patch)| patch.normal().z < -0.99)
            .map(|(exitance, patch)| exitance[0] * patch.area())
            .sum();
        let of_a_bay = 6.0 * 1.2 * 0.22 * 170.0;
        assert!((0.99..1.2).contains(&(power / (bays as f64 * of_a_bay))), "{bays}: {power}");
    }
}

/// Bodies that are whole by themselves enclose a volume, their faces outwards.
#[test]
fn furniture_is_turned_outwards() {
    let objects = |files: Files| files.others.into_iter();
    let sheets = ["leaves", "curtain"];
    for (name, text) in objects(Office::default().files()).chain(objects(Classroom::default().files())) {
        if sheets.iter().any(|sheet| name.contains(sheet)) {
            continue;
        }
        let numbers =
            |line: &str| line.split(' ').skip(1).map(|x| x.parse::<f64>().unwrap()).collect::<Vec<_>>();
        let corners: Vec<Vec3> = text
            .lines()
            .filter(|line| line.starts_with("v "))
            .map(|line| Vec3::from_slice(&numbers(line)))
            .collect();
        let (mut sides, mut volume) = (std::collections::HashMap::new(), 0.0);
        for face in text.lines().filter(|line| line.starts_with("f ")).map(numbers) {
            let [a, b, c] = [face[0], face[1], face[2]].map(|i| i as usize - 1);
            volume += corners[a].dot(corners[b].cross(corners[c])) / 6.0;
            for side in [(a, b), (b, c), (c, a)] {
                *sides.entry(side).or_insert(0) += 1;
            }
        }
        assert!(volume > 0.0, "{name}: its volume is {volume} m³");
        let twice = sides.iter().filter(|(_, count)| **count > 1).count();
        assert_eq!(twice, 0, "{name}: faces that share a side run along it in opposite directions");
        let open = sides.keys().filter(|(a, b)| !sides.contains_key(&(*b, *a))).count();
        // The lamp that hangs has its housing and its diffuser side by side.
        assert!(open == 0 || name.contains("luminaire"), "{name} has {open} open sides");
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
