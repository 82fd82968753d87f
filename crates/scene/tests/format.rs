//! What the keys of a scene file mean.

#![allow(clippy::unwrap_used, reason = "a test fails by panicking")]

use std::collections::BTreeSet;
use std::path::Path;

use fredholm_mesh::{Mesh, Vec3};
use fredholm_scene::{Scene, Storage, schema};
use serde_json::Value;

const WALL: &str = "[materials.wall]\nreflectance = 0.5\nexitance = 1\n";
const SQUARE: &str = "quad = [[0, 0, 0], [1, 0, 0], [1, 1, 0], [0, 1, 0]]";

fn scene(text: &str) -> Scene {
    Scene::from_str(text, "scene.toml").unwrap()
}

/// One surface with the given keys.
fn surface(keys: &str) -> Mesh {
    scene(&format!("{WALL}[[surface]]\nname = \"a\"\nmaterial = \"wall\"\n{keys}\n")).mesh().unwrap()
}

fn names(mesh: &Mesh) -> Vec<&str> {
    mesh.surfaces().iter().map(|surface| surface.name.as_str()).collect()
}

#[test]
fn numbers_per_band_can_be_written_in_three_ways() {
    let text = "bands = [\"r\", \"g\"]\n[materials.a]\nreflectance = 0.25\nexitance = 3\n\
        [materials.b]\nreflectance = [0.25, 0.5]\n[materials.c]\nreflectance = { g = 0.5, r = 0 }\n\
        [[surface]]\nname = \"x\"\nmaterial = \"b\"\n";
    let scene = scene(&format!("{text}{SQUARE}\ndivide = [1, 2]\n"));
    let reflectance: Vec<&[f64]> = scene.materials().iter().map(|m| m.reflectance.as_slice()).collect();
    assert_eq!(reflectance, [[0.25, 0.25], [0.25, 0.5], [0.0, 0.5]]);
    assert_eq!(scene.materials()[0].exitance, [3.0, 3.0]);
    let mesh = scene.mesh().unwrap();
    assert_eq!(scene.reflectance(&mesh), [0.25, 0.5, 0.25, 0.5]);
    assert_eq!(scene.exitance(&mesh), [0.0; 4]);
}

#[test]
fn defaults_are_those_of_the_documentation() {
    let text = format!("{WALL}[[surface]]\nname = \"a\"\nmaterial = \"wall\"\n{SQUARE}\n");
    let bare = scene(&text);
    assert_eq!((bare.bands(), bare.title(), bare.camera()), (&["grey".to_owned()][..], None, None));
    assert_eq!(bare.solve(), &fredholm_scene::SolveDefaults::default());
    assert_eq!(bare.predicted_elements(), 1);
    let seen = scene(&format!("[camera]\neye = [0, 5, 1]\ntarget = [0, 0, 1]\n{text}"));
    let camera = seen.camera().unwrap();
    assert_eq!((camera.up, camera.width, camera.height), (Vec3::Z, 800, 800));
    assert_eq!((camera.vertical_fov_degrees, camera.exposure), (45.0, None));
}

#[test]
fn settings_of_the_solution_are_passed_on() {
    let text = "[solve]\nsolver = \"southwell\"\ntolerance = 1e-6\nmax_iterations = 7\n\
        form_factor_tolerance = 1e-4\nstorage = \"f32\"\n";
    let scene = scene(&format!("{text}{WALL}[[surface]]\nname = \"a\"\nmaterial = \"wall\"\n{SQUARE}\n"));
    let solve = scene.solve();
    assert_eq!((solve.solver.as_deref(), solve.tolerance), (Some("southwell"), Some(1e-6)));
    assert_eq!((solve.max_iterations, solve.form_factor_tolerance), (Some(7), Some(1e-4)));
    assert_eq!(solve.storage, Some(Storage::F32));
}

#[test]
fn surfaces_are_cut_as_they_say() {
    for (keys, faces, elements) in [
        ("", 1, 1),
        ("divide = [2, 3]", 6, 6),
        ("divide = [2, 3]\nelements_per_face = 9", 6, 54),
        ("u_lines = [0, 0.3, 1]", 2, 2),
        ("v_lines = [0, 0.3, 0.6, 1]\nskip = [[0, 1]]", 2, 2),
        ("largest_edge = 0.3", 16, 16),
    ] {
        let mesh = surface(&format!("{SQUARE}\n{keys}"));
        assert_eq!((mesh.faces().len(), mesh.len()), (faces, elements), "{keys}");
    }
}

#[test]
fn elements_per_face_of_a_surface_goes_before_that_of_the_scene() {
    let text = format!("elements_per_face = 4\n{WALL}");
    let entry =
        |name, keys| format!("[[surface]]\nname = \"{name}\"\nmaterial = \"wall\"\n{SQUARE}\n{keys}\n");
    let scene = scene(&format!("{text}{}{}", entry("a", ""), entry("b", "elements_per_face = 16")));
    assert_eq!(scene.predicted_elements(), 20);
}

#[test]
fn every_shape_has_the_area_of_its_formula() {
    let pi = std::f64::consts::PI;
    for (keys, expected) in [
        ("triangle = [[0, 0, 0], [3, 0, 0], [0, 4, 0]]", 6.0),
        (
            "polygon = { outline = [[0, 0, 1], [3, 0, 1], [3, 3, 1], [0, 3, 1]], holes = [[[1, 1, 1], [2, 1, 1], [1, 2, 1]]] }",
            8.5,
        ),
        ("box = { min = [0, 0, 0], max = [1, 2, 3] }", 22.0),
        ("sphere = { centre = [1, 2, 3], radius = 2 }", 16.0 * pi),
        ("disc = { centre = [1, 2, 3], normal = [1, 1, 1], radius = 2, segments = 12 }", 4.0 * pi),
        ("cylinder = { base = [0, 0, 0], axis = [0, 3, 4], radius = 1, caps = false }", 10.0 * pi),
        ("cylinder = { base = [0, 0, 0], axis = [0, 3, 4], radius = 1 }", 12.0 * pi),
    ] {
        let area: f64 = surface(keys).faces().iter().map(|face| face.area).sum();
        assert!((area / expected - 1.0).abs() < 1e-9, "{keys}: {area} instead of {expected}");
    }
}

#[test]
fn a_two_sided_surface_has_a_back_of_its_own() {
    let text = format!(
        "{WALL}[materials.black]\nreflectance = 0\n[[surface]]\nname = \"a\"\nmaterial = \"wall\"\n{SQUARE}\n"
    );
    let scene = scene(&format!("{text}two_sided = true\nback_material = \"black\"\n"));
    let mesh = scene.mesh().unwrap();
    assert_eq!(names(&mesh), ["a", "a/back"]);
    assert_eq!(scene.materials()[mesh.surfaces()[1].material].name, "black");
    assert_eq!([mesh.patch(0).normal(), mesh.patch(1).normal()], [Vec3::Z, -Vec3::Z]);
    assert_eq!(mesh.occluders().len(), 1);
}

/// A scene beside an OBJ file.
fn with_obj(folder: &Path, obj: &str, keys: &str) -> Scene {
    std::fs::write(folder.join("a.obj"), obj).unwrap();
    let text = format!("{WALL}[materials.oak]\nreflectance = 0.3\n[[surface]]\nname = \"a\"\n{keys}\n");
    Scene::from_str(&text, folder.join("scene.toml")).unwrap()
}

const CORNERS: &str = "v 1 0 0\nv 2 0 0\nv 2 1 0\nv 1 1 0\nv 0.5 0.5 0\n";

#[test]
fn an_obj_file_is_scaled_then_turned_then_moved() {
    let folder = tempfile::tempdir().unwrap();
    let keys = "material = \"wall\"\nobj = { file = \"a.obj\", scale = 2, turn = { axis = [0, 0, 5], degrees = 90 }, \
        translate = [0, 0, 3] }";
    let mesh = with_obj(folder.path(), &format!("{CORNERS}f 1 2 3 4\n"), keys).mesh().unwrap();
    let expected =
        [[0.0, 2.0, 3.0], [0.0, 4.0, 3.0], [-2.0, 4.0, 3.0], [-2.0, 2.0, 3.0]].map(Vec3::from_array);
    for (found, expected) in mesh.patch(0).corners().iter().zip(expected) {
        assert!(found.distance(expected) < 1e-14, "{found}");
    }
    assert_eq!((mesh.patch(0).sides(), mesh.occluders().len()), (4, 1));
}

#[test]
fn objects_and_materials_of_an_obj_file_become_surfaces() {
    let folder = tempfile::tempdir().unwrap();
    let obj = format!(
        "mtllib none.mtl\n{CORNERS}f 1 2 3\no p\nusemtl x\nf 1 2 3 4\no q\nf 1 2 3 4 5\nusemtl wall\nf 1 2 3\n"
    );
    let keys = "material = \"wall\"\ntwo_sided = false\nobj = { file = \"a.obj\", materials = { x = \"oak\", wall = \"wall\" } }";
    let scene = with_obj(folder.path(), &obj, keys);
    let mesh = scene.mesh().unwrap();
    assert_eq!(names(&mesh), ["a", "a/p", "a/q/x", "a/q/wall"]);
    let materials: Vec<&str> =
        mesh.surfaces().iter().map(|surface| scene.materials()[surface.material].name.as_str()).collect();
    assert_eq!(materials, ["wall", "oak", "oak", "wall"]);
    assert_eq!(scene.predicted_elements(), 6);
    // The pentagon: a unit square and a triangle of base 1 and height 1/2.
    // They lie on each other, and each place is left to one of them.
    assert!((mesh.faces().iter().map(|face| face.area).sum::<f64>() - 1.25).abs() < 1e-14);
}

#[test]
fn quads_and_polygons_that_are_not_flat_become_triangles() {
    let folder = tempfile::tempdir().unwrap();
    let keys = "material = \"wall\"\nobj = { file = \"a.obj\" }";
    let bent = CORNERS.replace("v 2 1 0", "v 2 1 0.1");
    let quad = with_obj(folder.path(), &format!("{bent}f 1 2 3 4\n"), keys).mesh().unwrap();
    assert_eq!((quad.faces().len(), quad.len(), quad.occluders().len()), (1, 2, 2));
    let pentagon = with_obj(folder.path(), &format!("{bent}f 1 2 3 4 5\n"), keys).mesh().unwrap();
    assert_eq!((pentagon.faces().len(), pentagon.len(), pentagon.occluders().len()), (3, 3, 3));
}

#[test]
fn materials_of_the_same_name_need_a_library_that_defines_them_or_none() {
    let folder = tempfile::tempdir().unwrap();
    std::fs::write(folder.path().join("some.mtl"), "newmtl oak\n").unwrap();
    for head in ["", "mtllib some.mtl\n"] {
        let obj = format!("{head}{CORNERS}usemtl oak\nf 1 2 3 4\n");
        let scene = with_obj(folder.path(), &obj, "obj = { file = \"a.obj\" }");
        let mesh = scene.mesh().unwrap();
        assert_eq!(scene.materials()[mesh.surfaces()[0].material].name, "oak");
    }
}

#[test]
fn the_fingerprint_covers_the_files_that_are_named() {
    let folder = tempfile::tempdir().unwrap();
    let keys = "material = \"wall\"\nobj = { file = \"a.obj\" }";
    let mut seen = BTreeSet::new();
    let mut add = |obj: &str, keys: &str| seen.insert(with_obj(folder.path(), obj, keys).sha256().to_owned());
    let obj = format!("{CORNERS}f 1 2 3\n");
    assert!(add(&obj, keys));
    assert!(!add(&obj, keys));
    assert!(add(&format!("{obj}\n"), keys));
    assert!(add(&obj, &format!("{keys} # same")));
    assert!(seen.iter().all(|hash| hash.len() == 64));
}

#[test]
fn warnings_point_at_what_is_probably_not_meant() {
    let dark = "[materials.wall]\nreflectance = 0.5\n";
    let room = "[[surface]]\nname = \"room\"\nmaterial = \"wall\"\nbox = { min = [0, 0, 0], max = [1, 1, 1], inward = true }\n";
    let quad = |name, x| {
        format!(
            "[[surface]]\nname = \"{name}\"\nmaterial = \"wall\"\nquad = [[0, 0, {x}], [1, 0, {x}], [1, 1, {x}], [0, 1, {x}]]\n"
        )
    };
    let warnings = |text: &str| {
        let scene = scene(text);
        let mesh = scene.mesh().unwrap();
        scene.check(&mesh).unwrap().iter().map(ToString::to_string).collect::<Vec<_>>()
    };
    assert_eq!(warnings(&format!("{WALL}{room}")), [""; 0]);
    assert!(warnings(&format!("{dark}{room}"))[0].starts_with("scene.toml:4:8: no surface emits light"));
    let outside = warnings(&format!("{WALL}{room}{}", quad("roof", 2)));
    assert!(outside[0].starts_with("scene.toml:9:8: the lit side of `roof` faces no other"), "{outside:?}");
    let twice = warnings(&format!("{WALL}{room}{}", quad("floor", 0)));
    assert!(
        twice[0].starts_with(
            "scene.toml:9:8: `room` and `floor` lie on each other, lit on the same side, over 1.000e0 m²"
        ),
        "{twice:?}"
    );
    assert_eq!((outside.len(), twice.len()), (1, 1));
}

/// All names of properties in a schema.
fn properties(schema: &Value, found: &mut BTreeSet<String>) {
    match schema {
        Value::Object(map) => {
            if let Some(Value::Object(properties)) = map.get("properties") {
                found.extend(properties.keys().cloned());
                assert!(
                    properties.values().all(|property| property.get("description").is_some()),
                    "{properties:?}"
                );
            }
            map.values().for_each(|value| properties(value, found));
        }
        Value::Array(list) => list.iter().for_each(|value| properties(value, found)),
        _ => {}
    }
}

#[test]
fn the_schema_describes_every_key() {
    let mut found = BTreeSet::new();
    properties(&schema(), &mut found);
    for key in [
        "title",
        "bands",
        "elements_per_face",
        "solve",
        "camera",
        "materials",
        "surface",
        "storage",
        "eye",
        "exposure",
        "reflectance",
        "exitance",
        "quad",
        "box",
        "obj",
        "divide",
        "u_lines",
        "skip",
        "two_sided",
        "back_material",
        "outline",
        "holes",
        "inward",
        "segments",
        "caps",
        "turn",
        "degrees",
    ] {
        assert!(found.contains(key), "{key}");
    }
    let surface = &schema()["$defs"]["Surface"];
    assert_eq!(surface["additionalProperties"], false);
    assert_eq!(surface["required"], serde_json::json!(["name"]));
    assert_eq!(surface["oneOf"].as_array().unwrap().len(), 9);
    assert!(!schema().to_string().contains("null"));
}
