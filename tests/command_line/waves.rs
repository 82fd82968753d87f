//! Scenes of waves: results that compare with references, and messages for what is wrong.

use std::fs;
use std::path::Path;

use crate::support::{Bench, Run, fredholm_in};

const GOOD: &str = r#"
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

fn waves(scene: &str) -> (Bench, Run) {
    let bench = Bench::new(scene);
    let run = bench.run(&["waves", "scene.toml", "--threads", "2"]);
    (bench, run)
}

/// The table as columns by title.
fn column(table: &str, title: &str) -> Vec<f64> {
    let at = table.lines().next().unwrap().split(',').position(|found| found == title).unwrap();
    table.lines().skip(1).map(|line| line.split(',').nth(at).unwrap().parse().unwrap()).collect()
}

fn root() -> &'static Path {
    Path::new(env!("CARGO_MANIFEST_DIR"))
}

/// ‖ours − reference‖₂/‖reference‖₂ of the scattered E_z.
fn error(results: &Path, reference: &str, name: &str) -> f64 {
    let ours = fs::read_to_string(results.join("receivers.csv")).unwrap();
    let theirs = fs::read_to_string(root().join("tests/data/wave").join(reference)).unwrap();
    let (mut gap, mut size) = (0.0, 0.0);
    for part in ["re", "im"] {
        let a = column(&ours, &format!("sca_ez_{part}"));
        let b = column(&theirs, &format!("{name}_{part}_Ez"));
        assert_eq!((a.len(), b.len()), (360, 360));
        gap += a.iter().zip(&b).map(|(a, b)| (a - b).powi(2)).sum::<f64>();
        size += b.iter().map(|b| b * b).sum::<f64>();
    }
    (gap / size).sqrt()
}

#[test]
fn the_scenes_of_the_references_compare_with_them() {
    let cases = [
        ("plate", "plate_5lambda_normal.csv", "poJ", 0.01),
        ("cube", "cube_5lambda_normal.csv", "poJ", 0.01),
        ("two_plates", "two_plates_normal.csv", "mom", 0.09),
        ("sphere", "sphere_1lambda.csv", "mie", 0.005),
    ];
    for (scene, reference, name, bound) in cases {
        let output = tempfile::tempdir().unwrap();
        let results = output.path().join(scene);
        let file = format!("scenes/waves/{scene}.toml");
        let run = fredholm_in(root(), &["waves", &file, "-o", results.to_str().unwrap()]);
        assert_eq!(run.code, 0, "{scene}: {}", run.stderr);
        let error = error(&results, reference, name);
        assert!(error < bound, "{scene}: {error}");
        for file in ["receivers.npz", "currents.vtu", "circle.svg", "run.json"] {
            assert!(fs::metadata(results.join(file)).unwrap().len() > 100, "{scene} {file}");
        }
    }
}

#[test]
fn threads_change_no_byte_of_the_table() {
    let scene = fs::read_to_string(root().join("scenes/waves/dihedral.toml")).unwrap();
    let bench = Bench::new(&scene);
    let table = |threads: &str| {
        let run = bench.run(&["waves", "scene.toml", "-o", threads, "--threads", threads, "--quiet"]);
        assert_eq!(run.code, 0, "{}", run.stderr);
        fs::read(bench.folder.path().join(threads).join("far.csv")).unwrap()
    };
    let one = table("1");
    assert!(one.len() > 10_000);
    assert!(table("2") == one && table("4") == one);
}

/// Each of these ends with exit code 2, the line of the fault, and nothing written.
#[test]
fn what_is_wrong_is_named_with_its_line() {
    assert_eq!(waves(GOOD).1.code, 0);
    let cases = [
        ("frequencies_hz = [1e9]", "frequencies_hz = [0]", "scene.toml:3:", "the frequency is 0 Hz"),
        ("frequencies_hz = [1e9]", "frequencies_hz = []", "scene.toml:3:", "there is no frequency"),
        ("kind = \"plane-wave\"", "kind = \"torch\"", "scene.toml:6:8:", "torch"),
        ("polarisation = [0, 0, 1]", "polarisation = [0, 5, 0]", "scene.toml:5:", "parallel"),
        ("travel = [0, 1, 0]", "travel = [0, 0, 0]", "scene.toml:5:", "finite vector other than 0"),
        (
            "name = \"plate\"",
            "name = \"plate\"\nedge = \"lambda/1\"",
            "scene.toml:10:",
            "half the wavelength",
        ),
        ("name = \"plate\"", "name = \"plate\"\nedge = \"lamda/9\"", "scene.toml:12:", "no edge"),
        ("name = \"plate\"", "name = \"plate\"\nmaterial = \"gold\"", "scene.toml:12:", "no material `gold`"),
        ("points = [[0, -1, 0]]", "points = [[0.01, 0, 0.02]]", "scene.toml:14:", "lies on facet"),
        ("points = [[0, -1, 0]]", "points = []", "scene.toml:14:", "0 receiver points"),
        ("[wave]", "[wave]\nshadow = \"exact\"\nsolver = \"lu\"", "scene.toml:12:", "closed bodies"),
        ("[wave]", "[wave]\nshadow = \"thesis\"\nedge_currents = true", "scene.toml:4:", "physical optics"),
        ("[wave]", "[wave]\nsolver = \"magic\"", "scene.toml:3:", "unknown solver `magic`"),
        ("[wave]", "[wave]\nvelocity = 3", "scene.toml:3:1:", "velocity"),
    ];
    for (from, to, place, what) in cases {
        let (bench, run) = waves(&GOOD.replace(from, to));
        assert_eq!(run.code, 2, "{to}: {}", run.stderr);
        assert!(run.stderr.contains(place) && run.stderr.contains(what), "{to}: {}", run.stderr);
        assert!(run.stderr.contains("help: ") && !bench.path("out").exists(), "{to}: {}", run.stderr);
    }
}

#[test]
fn a_source_must_be_there_and_a_material_must_not_give_energy_away() {
    let start = GOOD.find("[[source]]").unwrap();
    let end = GOOD.find("[[surface]]").unwrap();
    let dark = GOOD.replace(&GOOD[start..end], "");
    assert!(waves(&dark).1.stderr.contains("the scene has no source"));
    for permittivity in ["[-2, 0]", "[2, 0.5]", "[nan, 0]"] {
        let metal = format!("{GOOD}\n[materials.odd]\nhalf_space = {{ permittivity = {permittivity} }}\n");
        let run = waves(&metal).1;
        assert!(run.code == 2 && run.stderr.contains("odd"), "{permittivity}: {}", run.stderr);
    }
}

#[test]
fn a_receiver_in_a_source_is_refused() {
    let start = GOOD.find("kind").unwrap();
    let end = GOOD.find("[[surface]]").unwrap();
    let sources = [
        "kind = \"half-wave-dipole\"\nposition = [0, -1, 0]\naxis = [0, 0, 1]\ncurrent_a = 1",
        "kind = \"hertzian-dipole\"\nposition = [0, -1, 0]\naxis = [0, 0, 1]\nmoment_a_m = 1",
        "kind = \"omnidirectional\"\nposition = [0, -1, 0]\naxis = [0, 0, 1]\npower_w = 1",
    ];
    for source in sources {
        let run = waves(&GOOD.replace(&GOOD[start..end], &format!("{source}\n\n"))).1;
        assert!(run.code == 2 && run.stderr.contains("of a source at point 0"), "{source}: {}", run.stderr);
    }
}

/// The closed cube of 2.1λ has no convergent series of bounces.
#[test]
fn a_series_that_diverges_is_no_result() {
    let scene = GOOD.replace("[wave]", "[wave]\nshadow = \"exact\"\nsolver = \"neumann\"").replace(
        "quad = [[-0.3, 0, -0.3], [0.3, 0, -0.3], [0.3, 0, 0.3], [-0.3, 0, 0.3]]",
        "box = { min = [0, 0, 0], max = [0.62956, 0.62956, 0.62956] }\nedge = \"lambda/6\"",
    );
    let (bench, run) = waves(&scene);
    assert!(run.code == 3 && run.stderr.contains("diverges"), "{}", run.stderr);
    assert!(!bench.path("out/scene/run.json").exists());
}
