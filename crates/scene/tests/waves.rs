//! Scenes of waves: those that are shipped, their schema, shapes, files and frequencies.

#![allow(clippy::unwrap_used, reason = "a test fails by panicking")]

use std::collections::BTreeSet;
use std::path::{Path, PathBuf};

use fredholm_scene::wave_schema;
use fredholm_scene::waves::{Cuts, Places, WaveScene, is_wave_scene};
use fredholm_waves::{Kind, Wave};
use serde_json::Value;

const FINE_CUTS: Cuts = Cuts { wavelength: 0.3, stretch: 1.0, whole: false };

fn folder() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("../../scenes")
}

/// A scene with these surfaces, and other frequencies where they are given.
fn scene(frequencies: &str, surfaces: &str, path: &Path) -> WaveScene {
    let text = format!(
        "[wave]\nfrequencies_hz = {frequencies}\n[[source]]\nkind = \"plane-wave\"\ntravel = [0, 1, 0]\n\
         polarisation = [0, 0, 1]\n{surfaces}\n[[receiver]]\nname = \"far\"\n\
         far = {{ theta_degrees = [0, 90], phi_degrees = {{ from = 0, to = 90, points = 3 }} }}\n"
    );
    WaveScene::from_str(&text, path.join("scene.toml")).unwrap_or_else(|error| panic!("{error}"))
}

fn with_surface(shape: &str) -> WaveScene {
    scene("[1e9]", &format!("[[surface]]\nname = \"one\"\n{shape}"), Path::new(""))
}

/// How many facets there are, and whether all of them belong to closed bodies.
fn facets(scene: &WaveScene) -> (usize, bool) {
    let mesh = scene.cut(FINE_CUTS).unwrap().mesh().unwrap();
    let materials = scene.materials(&scene.waves()[0]).unwrap();
    let scatterer = scene.scatterer(&mesh, &materials).unwrap();
    (mesh.len(), scatterer.facets().iter().all(|facet| facet.kind == Kind::Closed))
}

#[test]
fn every_shipped_scene_is_sound() {
    let files = std::fs::read_dir(folder().join("waves")).unwrap().map(|entry| entry.unwrap().path());
    let files: Vec<PathBuf> = files.filter(|path| path.extension().is_some_and(|e| e == "toml")).collect();
    assert!(files.len() >= 12);
    for file in files {
        assert!(is_wave_scene(&file));
        let scene = WaveScene::load(&file).unwrap();
        assert_eq!(scene.check().unwrap(), [], "{}", file.display());
        let wavelength = scene.waves()[0].wavelength();
        let cut = scene.cut(Cuts { wavelength, ..FINE_CUTS }).unwrap();
        assert_eq!(cut.facets(), cut.mesh().unwrap().len() as u128);
    }
    assert!(
        !is_wave_scene(&folder().join("cornell_box.toml")) && !is_wave_scene(&folder().join("none.toml"))
    );
}

/// All names of properties in a schema.
fn properties(schema: &Value, found: &mut BTreeSet<String>) {
    if let Value::Object(object) = schema {
        if let Some(Value::Object(own)) = object.get("properties") {
            found.extend(own.keys().cloned());
            let described =
                |(name, property): (&String, &Value)| name == "kind" || property.get("description").is_some();
            assert!(own.iter().all(described), "{own:?}");
        }
        object.values().for_each(|value| properties(value, found));
    } else if let Value::Array(list) = schema {
        for value in list {
            properties(value, found);
        }
    }
}

#[test]
fn the_schema_describes_every_key() {
    let schema = wave_schema();
    let mut found = BTreeSet::new();
    properties(&schema, &mut found);
    let keys = "frequencies_hz method order shadows bounces solver tolerance max_iterations edge_currents \
                estimate_errors sweep_accuracy ground height_m spacing kind travel polarisation moment_a_m current_a power_w impedance_ohm conductivity_s_per_m \
                half_space layers sheet resistance_ohm itu thickness_m quad triangle polygon holes box sphere disc cylinder mesh \
                scale turn translate edge closed points line circle grid far monostatic theta_degrees";
    for key in keys.split_whitespace() {
        assert!(found.contains(key), "{key}: {found:?}");
    }
    let text = schema.to_string();
    for name in ["dual-surface-mfie", "physical-optics", "radiated", "logarithmic", "half-wave-dipole"] {
        assert!(text.contains(name), "{name}");
    }
    assert!(!text.contains("null") && !found.contains("shadow"));
}

#[test]
fn all_shapes_of_light_are_there() {
    let plate = "[[0, 0, 0], [0.3, 0, 0], [0.3, 0.3, 0], [0, 0.3, 0]]";
    let hole = "[[[0.1, 0.1, 0], [0.2, 0.1, 0], [0.2, 0.2, 0], [0.1, 0.2, 0]]]";
    let cases = [
        (format!("quad = {plate}"), false),
        (format!("polygon = {{ outline = {plate}, holes = {hole} }}"), false),
        ("disc = { centre = [0, 0, 0], normal = [0, 0, 1], radius = 0.2 }".to_owned(), false),
        ("cylinder = { base = [0, 0, 0], axis = [0, 0, 0.3], radius = 0.1 }".to_owned(), true),
        ("cylinder = { base = [0, 0, 0], axis = [0, 0, 0.3], radius = 0.1, caps = false }".to_owned(), false),
        ("sphere = { centre = [0, 0, 0], radius = 0.1 }".to_owned(), true),
        ("box = { min = [0, 0, 0], max = [0.1, 0.1, 0.1] }".to_owned(), true),
        ("box = { min = [0, 0, 0], max = [0.1, 0.1, 0.1] }\nclosed = false".to_owned(), false),
    ];
    for (shape, closed) in cases {
        let coarse = with_surface(&shape);
        assert_eq!(coarse.check().unwrap(), [], "{shape}");
        let fine = with_surface(&format!("{shape}\nedge = \"lambda/20\""));
        let ((few, found), (many, _)) = (facets(&coarse), facets(&fine));
        assert!(found == closed && many > 2 * few, "{shape}: {few} {many} {found}");
    }
    // Edges in metres and in wavelengths are the same thing.
    let shape = format!("quad = {plate}\nedge = ");
    assert_eq!(
        facets(&with_surface(&format!("{shape}0.1"))),
        facets(&with_surface(&format!("{shape}\"lambda/3\"")))
    );
}

/// A closed cube and a plate in one file: two objects, of two kinds and two materials.
#[test]
fn objects_of_a_file_are_surfaces_of_their_own() {
    let folder = tempfile::tempdir().unwrap();
    let text = "o cube\nv 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nv 0 0 1\nv 1 0 1\nv 1 1 1\nv 0 1 1\n\
                f 1 4 3 2\nf 5 6 7 8\nf 1 2 6 5\nf 2 3 7 6\nf 3 4 8 7\nf 4 1 5 8\n\
                o plate\nusemtl coat\nv 3 0 0\nv 4 0 0\nv 4 1 0\nv 3 1 0\nf 9 10 11 12\n";
    std::fs::write(folder.path().join("two.obj"), text).unwrap();
    let surface = "[materials.coat]\nimpedance_ohm = [50, 0]\n[[surface]]\nname = \"file\"\n\
                   mesh = { file = \"two.obj\", scale = 0.3, translate = [0, 0, 1] }\nedge = 0.1";
    let found = scene("[1e9]", surface, folder.path());
    assert_eq!(found.surface_names().collect::<Vec<_>>(), ["file/cube", "file/plate"]);
    assert_eq!(found.materials_of_surfaces().collect::<Vec<_>>(), [0, 1]);
    let (count, all_closed) = facets(&found);
    assert_eq!((count, all_closed), (6 * 9 + 9, false));
    // A material that the scene does not have needs one of the surface.
    let other = surface.replace("materials.coat", "materials.paint");
    let text = format!(
        "[wave]\nfrequencies_hz = [1e9]\n{other}\n[[receiver]]\nname = \"r\"\nmonostatic = {{ theta_degrees = 0, phi_degrees = 0 }}\n"
    );
    let path = folder.path().join("scene.toml");
    let error = WaveScene::from_str(&text, &path).unwrap_err().to_string();
    assert!(error.contains("no material `coat`") && error.contains("two.obj:"), "{error}");
    let mended = text.replace("edge = 0.1", "edge = 0.1\nmaterial = \"paint\"");
    assert!(WaveScene::from_str(&mended, &path).is_ok());
}

#[test]
fn sweeps_have_their_ends_and_equal_steps_or_ratios() {
    let plate = "[[surface]]\nname = \"p\"\nquad = [[0, 0, 0], [1, 0, 0], [1, 1, 0], [0, 1, 0]]";
    let frequencies = |text: &str| -> Vec<f64> {
        scene(text, plate, Path::new("")).waves().iter().map(Wave::frequency).collect()
    };
    let linear = frequencies("{ from = 1e9, to = 3e9, points = 5 }");
    let expected = [1e9, 1.5e9, 2e9, 2.5e9, 3e9];
    assert!(linear.iter().zip(expected).all(|(f, g)| (f / g - 1.0).abs() < 1e-15), "{linear:?}");
    let ratios = frequencies("{ from = 1e8, to = 1e10, points = 5, spacing = \"logarithmic\" }");
    assert!(ratios.windows(2).all(|pair| (pair[1] / pair[0] / 10_f64.sqrt() - 1.0).abs() < 1e-12));
    assert!((ratios[0] - 1e8).abs() < 1e-9 && (ratios[4] - 1e10).abs() < 1e-9);
    assert_eq!(frequencies("{ from = 1e9, to = 2e9, points = 1 }").len(), 1);
}

#[test]
fn places_are_as_many_as_was_said_before() {
    let found = with_surface("box = { min = [0, 0, 0], max = [0.1, 0.1, 0.1] }");
    let receiver = &found.receivers()[0];
    let Places::Far(angles) = receiver.places() else { panic!() };
    assert_eq!((angles.len() as u128, receiver.is_near()), (receiver.count(), false));
    assert_eq!(angles, [[0.0, 0.0], [0.0, 45.0], [0.0, 90.0], [90.0, 0.0], [90.0, 45.0], [90.0, 90.0]]);
}

/// One plate that is seen from far away in one bounce is left whole, where its edges are not given.
#[test]
fn a_single_plate_may_be_left_whole() {
    let whole = Cuts { whole: true, ..FINE_CUTS };
    let count = |surface: &str, cuts: Cuts| with_surface(surface).cut(cuts).unwrap().facets();
    let plate = "quad = [[0, 0, 0], [3, 0, 0], [3, 3, 0], [0, 3, 0]]";
    assert_eq!((count(plate, whole), count(plate, FINE_CUTS)), (1, 10_000));
    assert_eq!(count(&format!("{plate}\nedge = 1.0"), whole), 9);
    // A second plate may shade a part of the first.
    let two =
        format!("{plate}\n[[surface]]\nname = \"two\"\nquad = [[0, 0, 1], [1, 0, 1], [1, 1, 1], [0, 1, 1]]");
    assert!(count(&two, whole) > 10_000);
}
