//! Files in the formats of others: what is written is read back with the same values, and damaged
//! files are read or refused at a line or a byte, without a panic and without memory for what is
//! not there.

#![allow(clippy::unwrap_used, reason = "a test fails by panicking")]

use std::fmt::Write;
use std::fs;
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::path::{Path, PathBuf};

use base64::Engine;
use base64::engine::general_purpose::STANDARD;
use fredholm_mesh::Vec3;
use fredholm_scene::{ExportFormat, Geometry, Outline, Scene, SceneError};
use rayon::prelude::*;

const SCENE: &str = r#"
bands = ["r", "g", "b"]
[camera]
eye = [0.5, 0.5, 3]
target = [0.5, 0.5, 0]
up = [0, 1, 0]
vertical_fov_degrees = 40
width = 64
height = 48
[materials."white wall"]
reflectance = [0.1, 0.7000000000000001, 0.333333333333333]
[materials.lamp]
reflectance = 0
exitance = [10, 0.1, 3.3]
[[surface]]
name = "floor"
material = "white wall"
quad = [[0, 0, 0], [1, 0, 0], [1, 1, 0], [0, 1, 0]]
[[surface]]
name = "block"
material = "white wall"
box = { min = [0.1, 0.2, 0.3], max = [0.4, 0.5, 0.6] }
[[surface]]
name = "lamp"
material = "lamp"
triangle = [[0.2, 0.2, 1.7], [0.3, 0.7, 1.7], [0.8, 0.123456789012345, 1.7]]
"#;

/// Formats that are read back, with what they hold: names and materials, and in how many bits.
const FORMATS: [(ExportFormat, bool, bool, f64); 7] = [
    (ExportFormat::Obj, true, true, 0.0),
    (ExportFormat::Stl, false, false, 1e-7),
    (ExportFormat::Ply, false, false, 0.0),
    (ExportFormat::Glb, true, true, 1e-7),
    (ExportFormat::Gmsh, true, false, 0.0),
    (ExportFormat::Radiance, true, true, 0.0),
    (ExportFormat::Mitsuba, true, true, 0.0),
];

fn scene() -> Scene {
    Scene::from_str(SCENE, "scene.toml").unwrap()
}

fn written(outline: &Outline, format: ExportFormat, folder: &Path) -> PathBuf {
    let files = outline.export(format, "a").files;
    for (name, bytes) in &files {
        let path = folder.join(name);
        fs::create_dir_all(path.parent().unwrap()).unwrap();
        fs::write(path, bytes).unwrap();
    }
    folder.join(&files[0].0)
}

/// The triangles of all surfaces, in their order.
fn triangles(outline: &Outline) -> Vec<[Vec3; 3]> {
    let faces = outline.surfaces.iter().flat_map(|surface| &surface.faces);
    faces.flat_map(|face| face[1..].windows(2).map(|side| [face[0], side[0], side[1]])).collect()
}

fn close(a: f64, b: f64, tolerance: f64) -> bool {
    (a - b).abs() <= tolerance.max(4.0 * f64::EPSILON) * a.abs().max(b.abs())
}

#[test]
fn every_format_reads_back_to_the_same_values() {
    let outline = scene().outline(None).unwrap();
    for (format, names, materials, tolerance) in FORMATS {
        let folder = tempfile::tempdir().unwrap();
        let read = Scene::load(written(&outline, format, folder.path())).unwrap();
        let found = read.outline(None).unwrap().bare(&read);
        let (expected, triangles) = (triangles(&outline), triangles(&found));
        assert_eq!(expected.len(), triangles.len(), "{format:?}");
        // Both may begin a polygon at another corner, as long as it runs the same way round.
        let centre = |t: &[Vec3; 3]| (t[0] + t[1] + t[2]) / 3.0;
        for (a, b) in expected.iter().zip(&triangles) {
            let same = a.iter().zip(b).all(|(a, b)| a.distance(*b) <= tolerance * 2.0);
            assert!(same, "{format:?}: {a:?} {b:?} {}", centre(a));
        }
        if names {
            let of = |outline: &Outline| outline.surfaces.iter().map(|s| s.name.clone()).collect::<Vec<_>>();
            assert_eq!(of(&outline), of(&found), "{format:?}");
        }
        if materials {
            for (a, b) in outline.surfaces.iter().zip(&found.surfaces) {
                let (a, b) = (&outline.materials[a.material], &found.materials[b.material]);
                for k in 0..3 {
                    assert!(close(a.reflectance[k], b.reflectance[k], tolerance), "{format:?} {a:?} {b:?}");
                    assert!(close(a.exitance[k], b.exitance[k], tolerance), "{format:?} {a:?} {b:?}");
                }
            }
        }
    }
}

#[test]
fn the_camera_goes_to_mitsuba_and_back() {
    let folder = tempfile::tempdir().unwrap();
    let outline = scene().outline(None).unwrap();
    let read = Scene::load(written(&outline, ExportFormat::Mitsuba, folder.path())).unwrap();
    let (a, b) = (outline.camera.unwrap(), *read.camera().unwrap());
    assert_eq!((a.eye, a.width, a.height), (b.eye, b.width, b.height));
    assert!((a.vertical_fov_degrees - b.vertical_fov_degrees).abs() < 1e-12);
    let ahead = |eye: Vec3, target: Vec3| (target - eye).normalize();
    assert!(ahead(a.eye, a.target).distance(ahead(b.eye, b.target)) < 1e-15);
}

#[test]
fn two_sided_surfaces_stay_so_in_mitsuba() {
    let text = SCENE.replace("name = \"floor\"", "name = \"floor\"\ntwo_sided = true");
    let outline = Scene::from_str(&text, "scene.toml").unwrap().outline(None).unwrap();
    assert_eq!(outline.surfaces[0].back, Some(outline.surfaces[0].material));
    let folder = tempfile::tempdir().unwrap();
    let read = Scene::load(written(&outline, ExportFormat::Mitsuba, folder.path())).unwrap();
    let sides: Vec<bool> = read.outline(None).unwrap().surfaces.iter().map(|s| s.back.is_some()).collect();
    assert_eq!(sides, [true, false, false]);
}

#[test]
fn surfaces_back_to_back_are_one_of_two_sides_in_mitsuba() {
    let plate = "[[surface]]\nname = \"plate\"\nmaterial = \"white wall\"\nquad = [[0, 0, 1], [1, 0, 1], \
                 [1, 1, 1], [0, 1, 1]]\n[[surface]]\nname = \"below\"\nmaterial = \"lamp\"\nquad = [[1, 1, 1], \
                 [1, 0, 1], [0, 0, 1], [0, 1, 1]]\n";
    let outline = Scene::from_str(&format!("{SCENE}{plate}"), "scene.toml").unwrap().outline(None).unwrap();
    let exported = outline.export(ExportFormat::Mitsuba, "scene");
    assert!(exported.notes.iter().any(|note| note == "`plate` is written as the back of `below`"));
    let text = String::from_utf8(exported.files[0].1.clone()).unwrap();
    let shape = text.split("<shape").find(|shape| shape.contains("id=\"below\"")).unwrap();
    assert!(shape.contains("twosided") && shape.contains("emitter"), "{shape}");
    assert!(!text.contains("id=\"plate\""));
    assert_eq!(text.matches("<shape").count(), 4);
}

#[test]
fn a_mesh_is_a_surface_of_a_scene_and_its_objects_take_materials() {
    let folder = tempfile::tempdir().unwrap();
    written(&scene().outline(None).unwrap(), ExportFormat::Gmsh, folder.path());
    let text = "[materials.clay]\nreflectance = 0.5\n[materials.glow]\nreflectance = 0\nexitance = 2\n[[surface]]\n\
        name = \"room\"\nmaterial = \"clay\"\nmesh = { file = \"a.msh\", scale = 2, materials = { \"lamp\" = \"glow\" } }\n";
    let path = folder.path().join("scene.toml");
    let mesh = |text: &str| Scene::from_str(text, &path).and_then(|scene| scene.mesh());
    let found = mesh(text).unwrap();
    let names: Vec<(&str, usize)> = found.surfaces().iter().map(|s| (s.name.as_str(), s.material)).collect();
    assert_eq!(names, [("room/floor", 0), ("room/block", 0), ("room/lamp", 1)]);
    let error = mesh(&text.replace("\"lamp\" =", "\"lump\" =")).unwrap_err();
    assert!(error.to_string().contains("uses no material `lump`"), "{error}");
}

#[test]
fn bands_that_are_no_colours_are_exported_one_by_one() {
    let text = SCENE.replace("[\"r\", \"g\", \"b\"]", "[\"low\", \"mid\", \"high\"]");
    let scene = Scene::from_str(&text, "scene.toml").unwrap();
    assert!(scene.outline(None).unwrap_err().to_string().contains("low, mid, high"));
    let grey = scene.outline(Some("mid")).unwrap();
    let wall = grey.materials.iter().find(|material| material.name == "white wall").unwrap();
    assert!(wall.reflectance.iter().all(|r| close(*r, 0.7, 1e-15)));
    assert!(scene.outline(Some("red")).unwrap_err().to_string().contains("no band `red`"));
}

#[test]
fn every_mesh_file_is_one_for_view_factors() {
    let outline = scene().outline(None).unwrap();
    for (format, ..) in FORMATS {
        let folder = tempfile::tempdir().unwrap();
        let geometry = Geometry::load(written(&outline, format, folder.path())).unwrap();
        assert!((8..=15).contains(&geometry.surfaces().unwrap().mesh.len()), "{format:?}");
    }
}

/// Files by their names.
type Files = Vec<(String, Vec<u8>)>;

/// A small file in every form, by the name that it goes under, with the files that it names.
fn originals() -> Vec<(String, Files)> {
    let outline = scene().outline(None).unwrap();
    let mut all: Vec<(String, Files)> = vec![];
    for (format, ..) in FORMATS {
        let files = outline.export(format, "a").files;
        all.push((files[0].0.clone(), files));
    }
    let own = |name: &str, bytes: Vec<u8>| (name.to_owned(), vec![(name.to_owned(), bytes)]);
    all.push(own("t.stl", text_stl(&outline)));
    all.push(own("t.ply", text_ply()));
    all.push(own("b.msh", packed_msh()));
    all.push(own("t.gltf", text_gltf(&outline.export(ExportFormat::Glb, "a").files[0].1)));
    all
}

fn text_stl(outline: &Outline) -> Vec<u8> {
    let mut text = "solid a\n".to_owned();
    for corners in triangles(outline) {
        text.push_str("facet normal 0 0 1\nouter loop\n");
        for p in corners {
            writeln!(text, "vertex {} {} {}", p.x, p.y, p.z).unwrap();
        }
        text.push_str("endloop\nendfacet\n");
    }
    (text + "endsolid a\n").into_bytes()
}

fn text_ply() -> Vec<u8> {
    b"ply\nformat ascii 1.0\ncomment c\nelement vertex 4\nproperty float x\nproperty float y\nproperty float z\nelement face 2\n\
      property list uchar int vertex_indices\nend_header\n0 0 0\n1 0 0\n1 1 0\n0 1 0.5\n3 0 1 2\n3 0 2 3\n".to_vec()
}

fn packed_msh() -> Vec<u8> {
    let mut bytes = b"$MeshFormat\n4.1 1 8\n".to_vec();
    let int = |bytes: &mut Vec<u8>, values: &[i32]| values.iter().for_each(|x| bytes.extend(x.to_le_bytes()));
    let size =
        |bytes: &mut Vec<u8>, values: &[u64]| values.iter().for_each(|x| bytes.extend(x.to_le_bytes()));
    let real =
        |bytes: &mut Vec<u8>, values: &[f64]| values.iter().for_each(|x| bytes.extend(x.to_le_bytes()));
    int(&mut bytes, &[1]);
    bytes.extend(b"\n$EndMeshFormat\n$PhysicalNames\n1\n2 7 \"wall\"\n$EndPhysicalNames\n$Entities\n");
    size(&mut bytes, &[0, 0, 1, 0]);
    int(&mut bytes, &[1]);
    real(&mut bytes, &[0.0, 0.0, 0.0, 1.0, 1.0, 0.0]);
    size(&mut bytes, &[1]);
    int(&mut bytes, &[7]);
    size(&mut bytes, &[0]);
    bytes.extend(b"\n$EndEntities\n$Nodes\n");
    size(&mut bytes, &[1, 4, 1, 4]);
    int(&mut bytes, &[2, 1, 0]);
    size(&mut bytes, &[4, 1, 2, 3, 4]);
    real(&mut bytes, &[0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 1.0, 1.0, 0.0, 0.0, 1.0, 0.0]);
    bytes.extend(b"\n$EndNodes\n$Elements\n");
    size(&mut bytes, &[1, 2, 1, 2]);
    int(&mut bytes, &[2, 1, 2]);
    size(&mut bytes, &[2, 1, 1, 2, 3, 2, 1, 3, 4]);
    bytes.extend(b"\n$EndElements\n");
    bytes
}

/// The same as JSON with its numbers inside.
fn text_gltf(glb: &[u8]) -> Vec<u8> {
    let length = u32::from_le_bytes(glb[12..16].try_into().unwrap()) as usize;
    let mut json: serde_json::Value = serde_json::from_slice(&glb[20..20 + length]).unwrap();
    let blob = &glb[28 + length..];
    json["buffers"][0]["uri"] =
        format!("data:application/octet-stream;base64,{}", STANDARD.encode(blob)).into();
    serde_json::to_vec_pretty(&json).unwrap()
}

#[test]
fn all_forms_that_are_damaged_below_are_read() {
    for (name, files) in originals() {
        let folder = tempfile::tempdir().unwrap();
        put(folder.path(), &files);
        Scene::load(folder.path().join(&name)).unwrap().mesh().unwrap();
    }
}

fn put(folder: &Path, files: &[(String, Vec<u8>)]) {
    for (name, bytes) in files {
        let path = folder.join(name);
        fs::create_dir_all(path.parent().unwrap()).unwrap();
        fs::write(path, bytes).unwrap();
    }
}

/// Numbers by a linear congruential generator (D. E. Knuth, The Art of Computer Programming, vol.
/// 2).
struct Chance(u64);

impl Chance {
    fn below(&mut self, limit: usize) -> usize {
        self.0 = self.0.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        ((self.0 >> 33) as usize) % limit.max(1)
    }
}

const PIECES: [&[u8]; 12] = [
    b"nan",
    b"-1",
    b"4294967295",
    b"99999999999999999999",
    b"1e400",
    b" ",
    b"\n",
    b"\"",
    b"<",
    b"}",
    b"\0",
    b"\xff\xff\xff\xff",
];

/// Bytes that differ from a file in one to three places.
fn mutated(bytes: &[u8], chance: &mut Chance) -> Vec<u8> {
    let mut bytes = bytes.to_vec();
    for _ in 0..=chance.below(3) {
        let at = chance.below(bytes.len());
        match chance.below(6) {
            0 => bytes.truncate(at),
            1 => bytes.iter_mut().skip(at).take(1).for_each(|byte| *byte ^= 1 << (at % 8)),
            2 => drop(bytes.splice(at..at, PIECES[chance.below(PIECES.len())].iter().copied())),
            3 => bytes.iter_mut().skip(at).take(4).for_each(|byte| *byte = 0xff),
            4 => drop(bytes.drain(at..(at + 1 + chance.below(8)).min(bytes.len()))),
            _ => {
                let (from, to) = (chance.below(bytes.len()), (at + 12).min(bytes.len()));
                let piece = bytes[at..to].to_vec();
                bytes.splice(from..from, piece);
            }
        }
        if bytes.is_empty() {
            break;
        }
    }
    bytes
}

/// What happens to a file; meshes that a damaged number makes too large are not made.
fn loaded(path: &Path) -> Result<(), SceneError> {
    let scene = Scene::load(path)?;
    if scene.predicted_elements() < 10_000 {
        scene.mesh()?;
    }
    Ok(())
}

/// Greatest memory of the process so far, bytes; 0 where the system does not tell.
fn peak() -> u64 {
    let status = fs::read_to_string("/proc/self/status").unwrap_or_default();
    let line = status.lines().find_map(|line| line.strip_prefix("VmHWM:"));
    line.and_then(|line| line.split_whitespace().next()?.parse::<u64>().ok()).map_or(0, |kib| 1024 * kib)
}

const MUTANTS: u64 = 1_000;
/// The files have a few kB: what is read takes no more than that many times as much.
const MEMORY: u64 = 256 << 20;

/// Reads a file that was damaged in as many ways, and returns how often it was refused.
fn refusals(name: &str, files: &[(String, Vec<u8>)]) -> u64 {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join(name);
    put(folder.path(), files);
    let (mut refused, mut faults) = (0, vec![]);
    for seed in 0..MUTANTS {
        let mut chance = Chance(seed ^ 0x9e37_79b9_7f4a_7c15);
        let damaged = chance.below(files.len());
        let (file, bytes) = &files[damaged];
        fs::write(folder.path().join(file), mutated(bytes, &mut chance)).unwrap();
        match catch_unwind(AssertUnwindSafe(|| loaded(&path))) {
            Ok(Ok(())) => {}
            Ok(Err(error)) if error.place().is_some() && !error.help().is_empty() => refused += 1,
            Ok(Err(error)) => faults.push(format!("{name} {seed}: no place: {error}")),
            Err(_) => faults.push(format!("{name} {seed}: a panic")),
        }
        if files.len() > 1 {
            fs::write(folder.path().join(file), bytes).unwrap();
        }
    }
    assert!(faults.is_empty(), "{}", faults.join("\n"));
    refused
}

#[test]
fn a_thousand_damaged_files_of_every_form_are_read_or_refused_at_a_place() {
    let before = peak();
    let refused: Vec<(String, u64)> =
        originals().par_iter().map(|(name, files)| (name.clone(), refusals(name, files))).collect();
    println!("{refused:?}");
    assert!(refused.iter().all(|(_, refused)| (100..MUTANTS).contains(refused)), "{refused:?}");
    let taken = peak().saturating_sub(before);
    assert!(taken < MEMORY, "{taken} bytes");
}
