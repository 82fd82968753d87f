//! Scenes of waves that are hostile or make no sense: a typed error with line and cure, or a
//! warning.

#![allow(clippy::unwrap_used, reason = "tests may panic")]

use std::fmt::Write;
use std::fs;

use fredholm_study::{Bytes, CheckedWaves, Error, ErrorKind, Quiet, WaveOptions, check_waves};

const GOOD_SCENE: &str = r#"
[wave]
frequencies_hz = [1e9]

[[source]]
kind = "plane-wave"
travel = [0, 1, 0]
polarisation = [0, 0, 1]

[[surface]]
name = "plate"
quad = [[-0.3, 0, -0.3], [0.3, 0, -0.3], [0.3, 0, 0.3], [-0.3, 0, 0.3]]

[[receiver]]
name = "point"
points = [[0, -1, 0]]
"#;
const PLATE: &str = "quad = [[-0.3, 0, -0.3], [0.3, 0, -0.3], [0.3, 0, 0.3], [-0.3, 0, 0.3]]";
const POINT: &str = "points = [[0, -1, 0]]";
const SOURCE: &str = "kind = \"plane-wave\"\ntravel = [0, 1, 0]\npolarisation = [0, 0, 1]";
const CUBE: &str = "box = { min = [-0.2, -0.2, -0.2], max = [0.2, 0.2, 0.2] }";

/// Six faces of a cube, each with its corners counter-clockwise seen from outside.
const FACES: [[usize; 4]; 6] =
    [[1, 4, 3, 2], [5, 6, 7, 8], [1, 2, 6, 5], [2, 3, 7, 6], [3, 4, 8, 7], [4, 1, 5, 8]];

/// A cube of 0.4 m as an OBJ file of these faces.
fn cube(faces: &[[usize; 4]]) -> String {
    let mut text = String::from("o cube\n");
    for (x, y, z) in [(0, 0, 0), (1, 0, 0), (1, 1, 0), (0, 1, 0), (0, 0, 1), (1, 0, 1), (1, 1, 1), (0, 1, 1)]
    {
        let [x, y, z] = [x, y, z].map(|c| 0.4 * f64::from(c));
        writeln!(text, "v {x} {y} {z}").unwrap();
    }
    for [a, b, c, d] in faces {
        writeln!(text, "f {a} {b} {c} {d}").unwrap();
    }
    text
}

fn checked(scene: &str, mesh: &str) -> Result<CheckedWaves, Error> {
    let folder = tempfile::tempdir().unwrap();
    fs::write(folder.path().join("scene.toml"), scene).unwrap();
    fs::write(folder.path().join("mesh.obj"), mesh).unwrap();
    let memory = Some(Bytes(1 << 30));
    let options = WaveOptions { memory, ..WaveOptions::default() };
    check_waves(folder.path().join("scene.toml"), &options, &Quiet)
}

fn changed(changes: &[(&str, &str)]) -> String {
    changes.iter().fold(GOOD_SCENE.to_owned(), |scene, (from, to)| {
        assert!(scene.contains(from), "{from}");
        scene.replacen(from, to, 1)
    })
}

/// Fails with a message that names the file, says `what`, and has a cure.
fn refused(changes: &[(&str, &str)], mesh: &str, what: &str) {
    let error = checked(&changed(changes), mesh).map(|_| ()).unwrap_err();
    let text = error.to_string();
    assert!(matches!(error.kind(), ErrorKind::Input | ErrorKind::Resources), "{changes:?}: {text}");
    assert!(text.contains(what) && text.contains("help: "), "{changes:?}: {text}");
    assert!(
        error.kind() == ErrorKind::Resources || text.contains(".toml:") || text.contains(".obj:"),
        "{text}"
    );
}

fn warned(changes: &[(&str, &str)], mesh: &str, what: &str) {
    let checked = checked(&changed(changes), mesh).unwrap_or_else(|error| panic!("{changes:?}: {error}"));
    let told = checked.warnings.iter().map(ToString::to_string).collect::<Vec<_>>().join("\n");
    assert!(told.contains(what) && told.contains("; "), "{changes:?}: {told}");
}

#[test]
fn a_good_scene_is_told_nothing() {
    let found = checked(GOOD_SCENE, "").unwrap();
    assert!(found.warnings.is_empty() && found.facets == 441, "{found:?}");
    let solid = changed(&[(PLATE, "mesh = { file = \"mesh.obj\" }")]);
    let found = checked(&solid, &cube(&FACES)).unwrap();
    assert!(found.warnings.is_empty(), "{found:?}");
    let told = found.findings.iter().map(ToString::to_string).collect::<Vec<_>>().join("\n");
    assert!(told.contains("1 of them closed"), "{told}");
}

#[test]
fn numbers_and_names_that_are_none_are_refused() {
    let cases = [
        ("[1e9]", "[]", "there is no frequency"),
        ("[1e9]", "[nan]", "frequency"),
        ("[1e9]", "[-1e9]", "frequency"),
        ("[1e9]", "{ from = 1e9, to = 2e9, points = 0 }", "no frequency"),
        ("[1e9]", "{ from = 1e9, to = 2e9, points = 4000000000 }", "4000000000 frequencies"),
        ("[1e9]", "{ from = -1e9, to = 2e9, points = 3 }", "the frequency is -1000000000 Hz"),
        ("[1e9]", "{ from = 1e9, to = 2e9, points = 3, spacing = \"log\" }", "unknown value `log`"),
        ("[wave]", "[wave]\nshadow = \"exact\"", "method = \"physical-optics\", \"mfie\""),
        ("[wave]", "[wave]\nmethod = \"mfi\"", "did you mean `mfie`?"),
        ("[wave]", "[wave]\nshadows = \"geometrical\"", "did you mean `geometric`?"),
        ("[wave]", "[wave]\nmethd = \"mfie\"", "did you mean `method`?"),
        ("[wave]", "[wave]\nmethod = \"mfie\"\nbounces = 2", "first bounces mean nothing"),
        ("[wave]", "[wave]\nmethod = \"thesis\"\nshadows = \"radiated\"", "no choice of shadows"),
        ("[wave]", "[wave]\nmethod = \"thesis\"\nedge_currents = true", "physical optics"),
        ("[wave]", "[wave]\nbounces = 0", "bounces is 0"),
        ("[wave]", "[wave]\nbounces = 2\nsolver = \"lu\"", "bounces and solver"),
        ("[wave]", "[wave]\nsolver = \"gmres\"\ntolerance = 2", "tolerance is 2"),
        ("[wave]", "[wave]\nsolver = \"magic\"", "there is no solver"),
        ("[wave]", "[wave]\nmethod = \"mfie\"", "closed bodies"),
        ("name = \"plate\"", "name = \"plate\"\nmaterial = \"conducter\"", "did you mean `conductor`?"),
        ("name = \"plate\"", "name = \"plate\"\nedge = \"lambda/0\"", "no edge"),
        ("name = \"plate\"", "name = \"plate\"\nedge = 1e-9", "facets, more than"),
        ("name = \"plate\"", "name = \"plate\"\nedge = \"lambda\"", "half the wavelength"),
        (
            POINT,
            "far = { theta_degrees = { from = 0, to = 180, points = 65536 }, phi_degrees = { from = 0, to = 360, points = 65536 } }",
            "4294967296 receiver points",
        ),
        (POINT, "line = { from = [0, -1, 0], to = [0, nan, 0], points = 9 }", "not finite"),
        (POINT, "circl = { radius = 1 }", "did you mean `circle`?"),
        ("name = \"point\"", "name = \"a/b\"", "no name for a receiver"),
        ("polarisation = [0, 0, 1]", "polarisation = \"thetta\"", "did you mean `theta`?"),
        (PLATE, "sphere = { centre = [0, 0, 0], radius = 0 }", ""),
        (PLATE, "cylinder = { base = [0, 0, 0], axis = [0, 0, 0], radius = 1 }", "points nowhere"),
        (PLATE, "polygon = { outline = [[0, 0, 0], [1, 0, 0], [0, 1, 0], [1, 1, 0]] }", "crosses or touches"),
        (PLATE, "mesh = { file = \"missing.obj\" }", "missing.obj"),
    ];
    for (from, to, what) in cases {
        if to.contains("missing.obj") {
            let error = checked(&changed(&[(from, to)]), "").map(|_| ()).unwrap_err();
            assert!(error.kind() == ErrorKind::Files && error.to_string().contains(what), "{error}");
        } else {
            refused(&[(from, to)], "", what);
        }
    }
}

#[test]
fn bodies_that_are_none_are_refused() {
    let file = |closed: &str| format!("mesh = {{ file = \"mesh.obj\" }}\n{closed}");
    refused(&[("name = \"plate\"", "name = \"plate\"\nclosed = true")], "", "which is open: 4 sides");
    refused(&[(PLATE, &file("closed = true"))], &cube(&FACES[..5]), "which is open: 4 sides");
    refused(
        &[("[wave]", "[wave]\nmethod = \"mfie\""), (PLATE, &file(""))],
        &cube(&FACES[..5]),
        "closed bodies",
    );
    let mut turned = FACES;
    turned[2].reverse();
    refused(&[(PLATE, &file("closed = true"))], &cube(&turned), "turned differently");
    let inside_out = FACES.map(|[a, b, c, d]| [d, c, b, a]);
    warned(&[(PLATE, &file(""))], &cube(&inside_out), "point inwards");
}

#[test]
fn sources_and_receivers_in_bodies_are_told() {
    let dipole = |position: &str| {
        format!("kind = \"hertzian-dipole\"\nposition = {position}\naxis = [0, 0, 1]\nmoment_a_m = 1")
    };
    refused(&[(SOURCE, &dipole("[0, 0, 0.1]")), (PLATE, CUBE)], "", "inside the closed body `plate`");
    refused(&[(SOURCE, &dipole("[0.1, 0, 0.1]"))], "", "lies on the surface `plate`");
    // A room is closed around its source; outside of it is the body.
    let room = "box = { min = [-0.2, -0.2, -0.2], max = [0.2, 0.2, 0.2], inward = true }";
    let inside = (POINT, "points = [[0.05, 0.1, 0]]");
    assert!(checked(&changed(&[(SOURCE, &dipole("[0, 0, 0.1]")), (PLATE, room), inside]), "").is_ok());
    refused(&[(SOURCE, &dipole("[0, 0, 0.3]")), (PLATE, room), inside], "", "inside the closed body");
    warned(&[(PLATE, CUBE), inside], "", "all points of the receiver `point` lie inside");
}

#[test]
fn bodies_that_overlap_are_told_and_refused_by_equations() {
    let both = |second: &str| format!("{CUBE}\n\n[[surface]]\nname = \"second\"\n{second}");
    let crossing = both("box = { min = [0, 0, 0], max = [0.3, 0.3, 0.3] }");
    let touching = both("box = { min = [-0.2, 0.2, -0.2], max = [0.2, 0.3, 0.2] }");
    let nested = both("box = { min = [-0.1, -0.1, -0.1], max = [0.1, 0.1, 0.1] }");
    let cases = [(&crossing, "cross"), (&touching, "lie on each other"), (&nested, "inside the closed body")];
    for (scene, what) in cases {
        warned(&[(PLATE, scene)], "", what);
        refused(&[(PLATE, scene), ("[wave]", "[wave]\nmethod = \"mfie\"")], "", what);
    }
    let twice = format!("{PLATE}\n\n[[surface]]\nname = \"again\"\n{PLATE}");
    warned(&[(PLATE, &twice)], "", "count twice");
}

#[test]
fn memory_is_refused_before_it_is_taken() {
    let grid = "grid = { corner = [0, 1, 0], u = [1, 0, 0], v = [0, 0, 1], columns = 4000, rows = 4000 }";
    refused(&[(POINT, grid)], "", "but the limit is");
}
