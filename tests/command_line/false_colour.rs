//! The irradiance in false colour: its numbers are those of the solution.

use std::fs;

use crate::support::{Bench, column, furnace, room};

/// A floor of 10 × 10 faces under a lamp, seen from above so that it fills the picture.
const FLOOR: &str = r#"
bands = ["r", "g"]
[materials.grey]
reflectance = [0.5, 0.2]
[materials.lamp]
reflectance = 0.0
exitance = [20.0, 10.0]
[[surface]]
name = "floor"
material = "grey"
quad = [[-1, -1, 0], [1, -1, 0], [1, 1, 0], [-1, 1, 0]]
divide = [10, 10]
[[surface]]
name = "lamp"
material = "lamp"
quad = [[-0.2, -0.2, 1.6], [-0.2, 0.2, 1.6], [0.2, 0.2, 1.6], [0.2, -0.2, 1.6]]
[camera]
eye = [0, 0, 0.5]
target = [0, 0, 0]
up = [0, 1, 0]
vertical_fov_degrees = 126.869897645844
width = 480
height = 480
"#;

fn mean(values: impl Iterator<Item = f64>) -> f64 {
    let (sum, count) = values.fold((0.0, 0), |(sum, count), value| (sum + value, count + 1));
    sum / f64::from(count)
}

#[test]
fn the_numbers_average_to_those_of_the_faces() {
    let bench = Bench::new(FLOOR);
    // Pixels are equal parts of the floor, and so the numbers are a midpoint rule over it.
    for (asked, bands) in [("--false-colour", &["r", "g"][..]), ("--false-colour=g", &["g"])] {
        bench.solve(&[asked, "-o", "out"]);
        let table = bench.path("out/false_colour.csv");
        let found = column(&table, "irradiance");
        let face = column(&table, "face");
        assert!(found.len() > 25 && face.iter().all(|face| *face < 100.0));
        let of_faces =
            |band: &&str| column(&bench.path("out/faces.csv"), &format!("irradiance_{band}"))[..100].to_vec();
        let in_bands: Vec<Vec<f64>> = bands.iter().map(of_faces).collect();
        let of_face = |face: usize| in_bands.iter().map(|values| values[face]).sum::<f64>();
        let expected = mean((0..100).map(of_face));
        let apart = mean(found.iter().copied()) / expected - 1.0;
        assert!(apart.abs() < 0.01, "{asked}: {apart}");
        for (e, face) in found.iter().zip(&face) {
            let own = of_face(*face as usize);
            assert!((e / own - 1.0).abs() < 0.2, "{asked}: {e} on a face of {own}");
        }
        let points = ["x", "y", "z"].map(|axis| column(&table, axis));
        assert!(points[2].iter().all(|z| z.abs() < 1e-9));
        let [columns, rows] = ["column", "row"].map(|name| column(&table, name));
        for (k, (column, row)) in columns.into_iter().zip(rows).enumerate() {
            assert!((points[0][k] - ((column + 0.5) / 240.0 - 1.0)).abs() < 1e-9);
            assert!((points[1][k] + ((row + 0.5) / 240.0 - 1.0)).abs() < 1e-9);
        }
    }
}

#[test]
fn in_a_furnace_all_numbers_are_one() {
    let bench = Bench::new(&furnace(4, &[0.5, 0.9]));
    bench.solve(&["--false-colour=b1", "--form-factor-tolerance", "1e-8", "-o", "out"]);
    let found = column(&bench.path("out/false_colour.csv"), "irradiance");
    assert!(!found.is_empty() && found.iter().all(|e| (e / 10.0 - 1.0).abs() < 1e-6), "{found:?}");
    let listed = bench.record("out")["files"].clone();
    for name in ["false_colour.png", "false_colour.csv"] {
        assert!(listed.as_array().unwrap().iter().any(|file| file == name), "{listed}");
    }
}

#[test]
fn it_goes_with_an_accuracy_and_names_bands_that_are_unknown() {
    let bench = Bench::new(&room(4));
    bench.solve(&["--accuracy", "20%", "--false-colour", "-o", "out"]);
    assert!(fs::read(bench.path("out/false_colour.png")).unwrap().starts_with(b"\x89PNG"));
    let run = bench.run(&["solve", "scene.toml", "--false-colour=x"]);
    assert!(run.code == 2 && run.stderr.contains("no band x") && run.stderr.contains("r, g"), "{run:?}");
    let run = bench.run(&["solve", "scene.toml", "--false-colour", "--no-pictures"]);
    assert_eq!(run.code, 2, "{}", run.stderr);
    bench.solve(&["-o", "out"]);
    assert!(!bench.path("out/false_colour.png").exists(), "what another result left does not stay");
}
