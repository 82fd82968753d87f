//! Studies of waves: boundary elements against exact answers, sweeps, files.

#![allow(clippy::unwrap_used, reason = "tests may panic")]

use std::fs;
use std::path::Path;

use fredholm_mesh::Vec3;
use fredholm_study::{CouplingStorage, Error, Quiet, ResultFolder, SolvedWaves, WaveOptions, waves};
use fredholm_waves::material::{conductor_impedance, sheet_impedance};
use fredholm_waves::source::PlaneWave;
use fredholm_waves::{
    Complex64, ConductingSphere, DielectricSphere, ImpedanceSphere, LayeredSphere, ResistiveShell, Source,
    Wave,
};

const SOURCE: &str = "[[source]]\nkind = \"plane-wave\"\ntravel = [0, 1, 0]\npolarisation = [0, 0, 1]\n";

fn solved(folder: &Path, text: &str) -> SolvedWaves<'static> {
    stored(folder, text, None).unwrap_or_else(|error| panic!("{error}"))
}

fn stored(
    folder: &Path,
    text: &str,
    storage: Option<CouplingStorage>,
) -> Result<SolvedWaves<'static>, Error> {
    let path = folder.join("scene.toml");
    fs::write(&path, text).unwrap();
    waves(&path, &WaveOptions { no_report: true, storage, ..WaveOptions::default() }, &Quiet)
}

/// ‖a − b‖₂/‖b‖₂ of scattered fields.
fn gap(a: &[[f64; 6]], b: &[[f64; 6]]) -> f64 {
    let difference: f64 = a.iter().flatten().zip(b.iter().flatten()).map(|(a, b)| (a - b).powi(2)).sum();
    (difference / b.iter().flatten().map(|b| b * b).sum::<f64>()).sqrt()
}

/// A ball with a circle of points around it, and whatever else.
fn ball(method: &str, radius: f64, edge: &str, distance: f64, more: &str) -> String {
    format!(
        "[wave]\nfrequencies_hz = [1e9]\nmethod = \"{method}\"\n{SOURCE}[[surface]]\nname = \"ball\"\n\
         sphere = {{ centre = [0, 0, 0], radius = {radius} }}\nedge = \"{edge}\"\n{more}\n\
         [[receiver]]\nname = \"circle\"\n\
         circle = {{ centre = [0, 0, 0], radius = {distance}, normal = [0, 0, 1], start = [1, 0, 0], points = 36 }}\n"
    )
}

/// E of the scattered field at all points, V/m.
fn scattered(found: &SolvedWaves<'_>) -> Vec<[f64; 6]> {
    found.near().iter().map(|row| std::array::from_fn(|i| row.scattered[i])).collect()
}

/// The compressed matrix gives the answer of the whole one, and what does not go together is
/// refused.
#[test]
fn boundary_elements_are_compressed_where_asked_for() {
    let folder = tempfile::tempdir().unwrap();
    let text = ball("cfie", 0.12, "lambda/8", 2.0, "");
    let run = |text: &str, storage| stored(folder.path(), text, storage);
    let whole = run(&text, Some(CouplingStorage::Matrix)).unwrap();
    let compressed = run(&text, Some(CouplingStorage::Compressed)).unwrap();
    assert!(whole.frequencies()[0].residuals.len() < 3 && compressed.frequencies()[0].residuals.len() > 5);
    let difference = gap(&scattered(&compressed), &scattered(&whole));
    assert!(difference > 0.0 && difference < 2e-3, "{difference:e}");
    let refused = |text: &str, storage| run(text, Some(storage)).map(drop).unwrap_err().to_string();
    // Of small bodies the compressed matrix would lose currents around loops; that of the combined
    // equation does not.
    let small = ball("efie", 0.006, "lambda/250", 2.0, "");
    assert!(refused(&small, CouplingStorage::Compressed).contains("around loops"));
    let [whole, compressed] = [CouplingStorage::Matrix, CouplingStorage::Compressed]
        .map(|storage| run(&small.replace("efie", "cfie"), Some(storage)).unwrap());
    assert!(gap(&scattered(&compressed), &scattered(&whole)) < 2e-3);
    assert!(refused(&text, CouplingStorage::Products).contains("--storage matrix, compressed or multipole"));
    let lu = text.replace("method", "solver = \"lu\"\nmethod");
    assert!(refused(&lu, CouplingStorage::Compressed).contains("needs all entries"));
    let facets = text.replace("cfie", "mfie");
    assert!(refused(&facets, CouplingStorage::Compressed).contains("--storage matrix or products"));
}

/// Those of order 1 on coarse cells are nearer to the truth than those of order 0, on curved shapes
/// and on flat ones, and the compressed matrix has them, too.
#[test]
fn functions_of_the_first_order_are_better_on_the_same_cells() {
    let folder = tempfile::tempdir().unwrap();
    let first = |text: &str| text.replace("[wave]\n", "[wave]\norder = 1\n");
    let glass = "material = \"glass\"\n[materials.glass]\nhalf_space = { permittivity = [3, -0.1] }";
    let shape = |text: String, shape: &str| {
        let line = text.lines().find(|line| line.starts_with("sphere")).unwrap().to_owned();
        text.replace(&line, shape)
    };
    let can = "cylinder = { base = [0, 0, -0.05], axis = [0, 0, 0.1], radius = 0.05 }";
    let disc = "disc = { centre = [0, 0, 0], normal = [0, 1, 0.2], radius = 0.06 }";
    let runs: Vec<Run<'_>> = vec![
        ("efie", Box::new(|edge| ball("efie", 0.08, edge, 1.0, "")), ["lambda/7", "lambda/12"]),
        ("cfie", Box::new(|edge| ball("cfie", 0.08, edge, 1.0, "")), ["lambda/7", "lambda/12"]),
        ("pmchwt", Box::new(|edge| ball("pmchwt", 0.06, edge, 1.0, glass)), ["lambda/10", "lambda/14"]),
        ("can", Box::new(|edge| shape(ball("efie", 0.08, edge, 1.0, ""), can)), ["lambda/6", "lambda/14"]),
        ("disc", Box::new(|edge| shape(ball("efie", 0.08, edge, 1.0, ""), disc)), ["lambda/6", "lambda/20"]),
    ];
    for (name, scene, [edge, fine]) in runs {
        let lowest = solved(folder.path(), &scene(edge));
        let found = solved(folder.path(), &first(&scene(edge)));
        let truth = solved(folder.path(), &first(&scene(fine)));
        let [lowest, error] = [lowest, found].map(|run| gap(&scattered(&run), &scattered(&truth)));
        println!("{name}: {lowest:.5} {error:.5}");
        // At the rims of the can and of the disc fields are singular.
        assert!(error < 0.4 * lowest && error < 0.04, "{name}: {lowest} {error}");
    }
    let text = first(&ball("cfie", 0.1, "lambda/5", 2.0, ""));
    let run = |storage| stored(folder.path(), &text, Some(storage)).unwrap();
    let [whole, compressed] = [CouplingStorage::Matrix, CouplingStorage::Compressed].map(run);
    let difference = gap(&scattered(&compressed), &scattered(&whole));
    assert!(difference > 0.0 && difference < 1e-4, "{difference:e}");
    for (wrong, what) in [
        (text.replace("order = 1", "order = 2"), "no functions of order 2"),
        (text.replace("cfie", "mfie"), "mfie has no functions of a choice of orders"),
    ] {
        let error = stored(folder.path(), &wrong, None).map(drop).unwrap_err().to_string();
        assert!(error.contains(what), "{error}");
    }
}

/// So do multipoles; bodies that are too small for them are compressed in blocks, and what has no
/// multipoles is refused.
#[test]
fn boundary_elements_are_taken_to_multipoles_where_asked_for() {
    let folder = tempfile::tempdir().unwrap();
    let run = |text: &str, storage| stored(folder.path(), text, Some(storage));
    let text = ball("cfie", 0.2, "lambda/6", 2.0, "");
    let [whole, found] =
        [CouplingStorage::Matrix, CouplingStorage::Multipole].map(|how| run(&text, how).unwrap());
    let difference = gap(&scattered(&found), &scattered(&whole));
    assert!(difference > 0.0 && difference < 2e-3, "{difference:e}");
    assert!(found.frequencies()[0].solution.ends_with("with the diagonal blocks of the multipoles"));
    let small = run(&ball("cfie", 0.04, "lambda/12", 2.0, ""), CouplingStorage::Multipole).unwrap();
    assert!(small.frequencies()[0].solution.ends_with("of the compressed matrix"));
    let refused = |text: &str| run(text, CouplingStorage::Multipole).map(drop).unwrap_err().to_string();
    assert!(refused(&text.replace("cfie", "mfie")).contains("--storage matrix or products"));
    let glass = "material = \"glass\"\n[materials.glass]\nhalf_space = { permittivity = [3, -0.1] }";
    assert!(refused(&ball("pmchwt", 0.06, "lambda/10", 1.0, glass)).contains("perfect conductors only"));
}

/// A sweep of more waves than are solved for together, of conductors and of dielectrics.
#[test]
fn compressed_sweeps_are_those_of_the_whole_matrix() {
    let folder = tempfile::tempdir().unwrap();
    let glass = "material = \"glass\"\n[materials.glass]\nhalf_space = { permittivity = [3, -0.1] }";
    for (method, material) in [("efie", ""), ("cfie", ""), ("pmchwt", glass)] {
        let ball = ball(method, 0.06, "lambda/10", 1.0, material);
        let sweep = "theta_degrees = 80, phi_degrees = { from = 0, to = 190, points = 20 }";
        let text = format!("{ball}[[receiver]]\nname = \"back\"\nmonostatic = {{ {sweep} }}\n");
        let run = |storage| stored(folder.path(), &text, Some(storage)).unwrap();
        let [whole, compressed] = [CouplingStorage::Matrix, CouplingStorage::Compressed].map(run);
        let rows = |found: &SolvedWaves<'_>| -> Vec<[f64; 6]> {
            let ends = |s: [[f64; 2]; 4]| [s[0][0], s[0][1], s[1][0], s[1][1], s[3][0], s[3][1]];
            found.monostatic().iter().map(|row| ends(row.scattering)).collect()
        };
        let difference = gap(&rows(&compressed), &rows(&whole));
        assert!(
            rows(&whole).len() == 20 && difference > 0.0 && difference < 2e-3,
            "{method}: {difference:e}"
        );
        assert!(compressed.frequencies().iter().all(|solved| solved.solution.contains("gmres")), "{method}");
    }
}

/// A dielectric ball against its series outside; one that is small has 3/(ε + 2) of the incident
/// field inside.
#[test]
fn dielectric_bodies_have_the_field_of_the_series_near_and_far_and_inside() {
    let folder = tempfile::tempdir().unwrap();
    let wave = Wave::new(1e9).unwrap();
    let source = PlaneWave::new(Vec3::Y, Vec3::Z, 1.0.into()).unwrap();
    let glass = "material = \"glass\"\n[materials.glass]\nhalf_space = { permittivity = [3, -0.1] }";
    let permittivity = Complex64::new(3.0, -0.1);
    let radius = 0.05;
    let exact = DielectricSphere::new(radius, permittivity).unwrap();
    for (distance, bound) in [(0.08, 0.02), (5.0, 0.02)] {
        let found = solved(folder.path(), &ball("pmchwt", radius, "lambda/18", distance, glass));
        let series = |p: [f64; 3]| {
            let e = exact.scattered(&wave, &source, Vec3::from_array(p)).components();
            [e[0].re, e[0].im, e[1].re, e[1].im, e[2].re, e[2].im]
        };
        let series: Vec<[f64; 6]> = found.near().iter().map(|row| series(row.position)).collect();
        let error = gap(&scattered(&found), &series);
        assert!(error < bound && found.method() == "pmchwt", "{distance}: {error}");
    }
    let small = solved(folder.path(), &ball("pmchwt", 0.005, "lambda/120", 0.002, glass));
    let expected = 3.0 / (permittivity + 2.0);
    for row in small.near() {
        let incident = source.field(&wave, Vec3::from_array(row.position)).e.components()[2];
        let total = Complex64::new(row.scattered[4], row.scattered[5]) + incident;
        assert!((total - expected * incident).norm() < 0.08, "{total} {expected}");
    }
    let bare = ball("pmchwt", radius, "lambda/18", 1.0, "");
    let refused = stored(folder.path(), &bare, None).map(drop).unwrap_err().to_string();
    assert!(refused.contains("half_space"), "{refused}");
}

const CORE: &str = "material = \"core\"\n[materials.core]\nhalf_space = { permittivity = [5, -0.5] }\n";

/// A ball of two layers, the inner one perhaps a conductor, against its series outside, and the
/// error stated of it.
#[test]
fn coated_balls_have_the_field_of_the_series_and_a_stated_error_that_holds() {
    let folder = tempfile::tempdir().unwrap();
    let wave = Wave::new(1e9).unwrap();
    let source = PlaneWave::new(Vec3::Y, Vec3::Z, 1.0.into()).unwrap();
    let [coat, core] = [Complex64::new(2.5, -0.1), Complex64::new(5.0, -0.5)];
    let (inner, outer) = (0.04, 0.06);
    for (inside, of_core) in [("", None), (CORE, Some(core))] {
        for edge in ["lambda/12", "lambda/20"] {
            let more = format!(
                "material = \"coat\"\n[[surface]]\nname = \"core\"\n\
                 sphere = {{ centre = [0, 0, 0], radius = {inner} }}\nedge = \"{edge}\"\n{inside}\
                 [materials.coat]\nhalf_space = {{ permittivity = [2.5, -0.1] }}\n"
            );
            let found = solved(folder.path(), &ball("pmchwt", outer, edge, 5.0, &more));
            let layers = vec![(outer, coat)];
            let exact = match of_core {
                None => LayeredSphere::new(Some(inner), layers),
                Some(core) => LayeredSphere::new(None, [vec![(inner, core)], layers].concat()),
            }
            .unwrap();
            let series = |p: [f64; 3]| {
                let e = exact.scattered(&wave, &source, Vec3::from_array(p)).components();
                [e[0].re, e[0].im, e[1].re, e[1].im, e[2].re, e[2].im]
            };
            let series: Vec<[f64; 6]> = found.near().iter().map(|row| series(row.position)).collect();
            let error = gap(&scattered(&found), &series);
            let [stated] = found.stated_errors() else { panic!("{:?}", found.stated_errors()) };
            println!("{inside:?} {edge}: {error:.5}, stated {:.5}", stated.relative);
            assert!(error < 0.03 && error < stated.relative && stated.relative < 10.0 * error);
        }
    }
}

/// Its name, the scene with these edges, and the edges to compare.
type Run<'a> = (&'static str, Box<dyn Fn(&str) -> String + 'a>, [&'static str; 2]);

/// What is stated of surface impedances, thin sheets, bodies above the ground and bodies that are
/// small beside the wavelength, against series and far finer meshes.
#[test]
fn stated_errors_hold_on_all_that_boundary_elements_solve() {
    let folder = tempfile::tempdir().unwrap();
    let material = |text: &str| format!("material = \"m\"\n[materials.m]\n{text}\n");
    let [rough, film, glass] = [
        "impedance_ohm = [90, 40]",
        "sheet = { resistance_ohm = [150, -60] }",
        "half_space = { permittivity = [4, 0] }",
    ]
    .map(material);
    let film = format!("closed = false\n{film}");
    let plate = "quad = [[0, -0.1, 0.03], [0, 0.1, 0.03], [0, 0.1, 0.2], [0, -0.1, 0.2]]";
    let of_plate = |text: String| {
        let line = text.lines().find(|line| line.starts_with("sphere")).unwrap().to_owned();
        text.replace(&line, plate)
    };
    let grounded = |text: String| {
        text.replace("[wave]\n", "[wave]\nground = { height_m = -0.15 }\n")
            .replace("travel = [0, 1, 0]", "travel = [0, 0.8, -0.6]")
            .replace("polarisation = [0, 0, 1]", "polarisation = [0, 0.6, 0.8]")
    };
    let runs: Vec<Run<'_>> = vec![
        ("impedance", Box::new(|edge| ball("efie", 0.08, edge, 5.0, &rough)), ["lambda/8", "lambda/24"]),
        ("shell", Box::new(|edge| ball("efie", 0.08, edge, 5.0, &film)), ["lambda/8", "lambda/24"]),
        ("film", Box::new(|edge| of_plate(ball("efie", 0.08, edge, 5.0, &film))), ["lambda/8", "lambda/36"]),
        ("grounded", Box::new(|edge| grounded(ball("cfie", 0.08, edge, 5.0, ""))), ["lambda/8", "lambda/24"]),
        (
            "grounded plate",
            Box::new(|edge| grounded(of_plate(ball("efie", 0.08, edge, 5.0, "closed = false")))),
            ["lambda/8", "lambda/36"],
        ),
        (
            "grounded glass",
            Box::new(|edge| grounded(ball("pmchwt", 0.06, edge, 5.0, &glass))),
            ["lambda/16", "lambda/32"],
        ),
        ("small", Box::new(|edge| ball("efie", 0.003, edge, 5.0, "")), ["lambda/300", "lambda/900"]),
        (
            "small, combined",
            Box::new(|edge| ball("cfie", 0.003, edge, 0.005, "")),
            ["lambda/300", "lambda/700"],
        ),
        (
            "small glass",
            Box::new(|edge| ball("pmchwt", 0.003, edge, 5.0, &glass)),
            ["lambda/300", "lambda/700"],
        ),
    ];
    for (name, scene, edges) in runs {
        let [found, truth] = edges.map(|edge| solved(folder.path(), &scene(edge)));
        let error = gap(&scattered(&found), &scattered(&truth));
        let [stated] = found.stated_errors() else { panic!("{name}: {:?}", found.stated_errors()) };
        println!("{name}: {error:.5}, stated {:.5}", stated.relative);
        assert!(
            error < stated.relative && stated.relative < 12.0 * error,
            "{name}: {error} {}",
            stated.relative
        );
    }
}

/// Two blocks that touch: of one dielectric in two materials as of one, and what is said of blocks
/// that do not fit.
#[test]
fn blocks_that_touch_are_solved_together() {
    let folder = tempfile::tempdir().unwrap();
    let scene = |second: &str, box_: &str, edge: &str| {
        format!(
            "[wave]\nfrequencies_hz = [1e9]\nmethod = \"pmchwt\"\n{SOURCE}\
             [[surface]]\nname = \"low\"\nbox = {{ min = [0, 0, 0], max = [0.1, 0.1, 0.05] }}\n\
             edge = 0.025\nmaterial = \"glass\"\n\
             [[surface]]\nname = \"high\"\nbox = {{ {box_} }}\nedge = {edge}\n{second}\
             [materials.glass]\nhalf_space = {{ permittivity = [3, -0.1] }}\n\
             [materials.other]\nhalf_space = {{ permittivity = [3, -0.1] }}\n\
             [[receiver]]\nname = \"line\"\nline = {{ from = [0.05, 0.05, -0.3], to = [0.05, 0.05, 0.31], points = 24 }}\n"
        )
    };
    let above = "min = [0, 0, 0.05], max = [0.1, 0.1, 0.1]";
    let one = solved(folder.path(), &scene("material = \"glass\"\n", above, "0.025"));
    let two = solved(folder.path(), &scene("material = \"other\"\n", above, "0.025"));
    let difference = gap(&scattered(&two), &scattered(&one));
    assert!(difference > 0.0 && difference < 0.03, "{difference}");
    // On a conductor they are not the same.
    let metal = solved(folder.path(), &scene("", above, "0.025"));
    assert!(gap(&scattered(&metal), &scattered(&one)) > 0.3);
    // A block of free space on a conductor is none: the error is that of the edges, and is stated.
    let airy = scene("", above, "0.025").replace("[3, -0.1]", "[1, 0]");
    let alone = "[wave]\nfrequencies_hz = [1e9]\nmethod = \"cfie\"\n".to_owned()
        + SOURCE
        + &airy[airy.find("[[surface]]\nname = \"high\"").unwrap()..];
    let alone = alone.replace("edge = 0.025", "edge = 0.01");
    let (airy, alone) = (solved(folder.path(), &airy), solved(folder.path(), &alone));
    let error = gap(&scattered(&airy), &scattered(&alone));
    let [stated] = airy.stated_errors() else { panic!("{:?}", airy.stated_errors()) };
    println!("free space on a conductor: {error:.5}, stated {:.5}", stated.relative);
    assert!(error < stated.relative && error < 0.05);
    let refused = |box_: &str, edge: &str| {
        let text = scene("material = \"other\"\n", box_, edge);
        stored(folder.path(), &text, None).map(drop).unwrap_err().to_string()
    };
    assert!(
        refused(above, "0.02").contains("`low` and `high` lie on each other"),
        "{}",
        refused(above, "0.02")
    );
    let crossing = refused("min = [0.013, 0.01, 0.017], max = [0.12, 0.12, 0.1]", "0.025");
    assert!(crossing.contains("cross"), "{crossing}");
}

/// Thin sheets are solved by the electric equation unasked, at several frequencies, whole and
/// compressed: a shell against its series on both sides, and the powers balance.
#[test]
fn thin_sheets_have_the_field_of_the_series_and_absorb_what_is_missing() {
    let folder = tempfile::tempdir().unwrap();
    let source = PlaneWave::new(Vec3::Y, Vec3::Z, 1.0.into()).unwrap();
    let resistive = "sheet = { resistance_ohm = [150, -60] }";
    let dielectric = "sheet = { permittivity = [9, -2], thickness_m = 0.002 }";
    for (film, storage) in
        [(resistive, None), (dielectric, None), (resistive, Some(CouplingStorage::Compressed))]
    {
        for distance in [0.06, 2.0] {
            let more = format!("closed = false\nmaterial = \"film\"\n[materials.film]\n{film}");
            let text = ball("efie", 0.1, "lambda/12", distance, &more)
                .replace("method = \"efie\"\n", "")
                .replace("[1e9]", "[8e8, 1e9]");
            let found = stored(folder.path(), &text, storage).unwrap();
            assert_eq!(found.method(), "efie");
            let series = |row: &fredholm_report::WaveRow| {
                let wave = Wave::new(row.frequency).unwrap();
                let z = if film == resistive {
                    Complex64::new(150.0, -60.0)
                } else {
                    sheet_impedance(Complex64::new(9.0, -2.0), 0.002, &wave)
                };
                let exact = ResistiveShell::new(0.1, z).unwrap();
                let e = exact.scattered(&wave, &source, Vec3::from_array(row.position)).components();
                [e[0].re, e[0].im, e[1].re, e[1].im, e[2].re, e[2].im]
            };
            let series: Vec<[f64; 6]> = found.near().iter().map(series).collect();
            let error = gap(&scattered(&found), &series);
            assert!(error < 0.02 && series.len() == 72, "{film} {distance}: {error}");
            for balance in found.balances() {
                assert!(balance.absorbed > 0.1 * balance.supplied);
                assert!((balance.ratio() - 1.0).abs() < 3e-3, "{film}: {}", balance.ratio());
            }
            assert_eq!(found.balances().len(), 2);
        }
    }
}

/// A ball with a surface impedance, given or by its conductivity, whole and compressed, against its
/// series; the powers balance.
#[test]
fn bodies_with_a_surface_impedance_have_the_field_of_the_series() {
    let folder = tempfile::tempdir().unwrap();
    let (wave, radius) = (Wave::new(1e9).unwrap(), 0.09);
    let source = PlaneWave::new(Vec3::Y, Vec3::Z, 1.0.into()).unwrap();
    let given = ("impedance_ohm = [90, 40]", Complex64::new(90.0, 40.0));
    let conductor = ("conductivity_s_per_m = 100", conductor_impedance(100.0, &wave));
    for ((material, z), storage) in
        [(given, None), (conductor, None), (given, Some(CouplingStorage::Compressed))]
    {
        let more = format!("material = \"m\"\n[materials.m]\n{material}");
        let text = ball("efie", radius, "lambda/12", 0.3, &more);
        let found = stored(folder.path(), &text, storage).unwrap();
        let exact = ImpedanceSphere::new(radius, z).unwrap();
        let series = |p: [f64; 3]| {
            let e = exact.scattered(&wave, &source, Vec3::from_array(p)).components();
            [e[0].re, e[0].im, e[1].re, e[1].im, e[2].re, e[2].im]
        };
        let series: Vec<[f64; 6]> = found.near().iter().map(|row| series(row.position)).collect();
        let error = gap(&scattered(&found), &series);
        assert!(error < 0.01 && found.method() == "efie", "{material}: {error}");
        let balance = found.balances()[0];
        let [extinction, scattering] = exact.cross_sections(&wave);
        let absorbed = balance.absorbed / balance.supplied;
        assert!((absorbed - (1.0 - scattering / extinction)).abs() < 0.01, "{material}: {absorbed}");
        assert!((balance.ratio() - 1.0).abs() < 2e-3, "{material}: {}", balance.ratio());
    }
}

/// A plate above ground in a wave is that plate and its mirror image in the wave and its mirror
/// image, whole and compressed; what the reflected wave loses is radiated upwards.
#[test]
fn a_conducting_ground_is_a_mirror() {
    let folder = tempfile::tempdir().unwrap();
    let plate = |name: &str, sign: f64| {
        let corner = |x: f64, z: f64| format!("[{x}, 0, {}]", sign * z);
        let corners = [corner(-0.1, 0.04), corner(0.1, 0.04), corner(0.1, 0.24), corner(-0.1, 0.24)];
        format!("[[surface]]\nname = \"{name}\"\nquad = [{}]\n", corners.join(", "))
    };
    let source = |sign: f64| {
        let (up, along, across) = (-0.6 * sign, sign, -0.2 * sign);
        format!(
            "[[source]]\nkind = \"plane-wave\"\ntravel = [0.2, 1, {up}]\npolarisation = [{along}, {across}, 0]\n"
        )
    };
    let receivers = "[[receiver]]\nname = \"r\"\nline = { from = [0.3, -1, 0], to = [-0.2, 2, 1.5], points = 20 }\n\
                     [[receiver]]\nname = \"f\"\nfar = { theta_degrees = [10, 50, 90], phi_degrees = [0, 70] }\n";
    let wave = |more: &str| format!("[wave]\nfrequencies_hz = [1e9]\n{more}\n");
    let ground = wave("ground = { height_m = 0 }") + &source(1.0) + &plate("upper", 1.0) + receivers;
    let mirror = wave("method = \"efie\"")
        + &source(1.0)
        + &source(-1.0)
        + &plate("upper", 1.0)
        + &plate("lower", -1.0)
        + receivers;
    let both = solved(folder.path(), &mirror);
    for storage in [None, Some(CouplingStorage::Compressed)] {
        let found = stored(folder.path(), &ground, storage).unwrap();
        assert_eq!(found.method(), "efie");
        let near = gap(&scattered(&found), &scattered(&both));
        let incident = found.near().iter().zip(both.near()).flat_map(|(a, b)| {
            a.incident.iter().zip(b.incident).map(|(a, b)| (a - b).abs()).collect::<Vec<_>>()
        });
        let amplitudes =
            |found: &SolvedWaves<'_>| found.far().iter().flat_map(|row| row.amplitude).collect::<Vec<f64>>();
        let (a, b) = (amplitudes(&found), amplitudes(&both));
        let far = a.iter().zip(&b).map(|(a, b)| (a - b).powi(2)).sum::<f64>()
            / b.iter().map(|b| b * b).sum::<f64>();
        assert!(near < 1e-3 && far.sqrt() < 1e-3, "{near:e} {far:e}");
        assert!(incident.fold(0.0, f64::max) < 1e-12);
        let ratio = found.balances()[0].ratio();
        assert!((ratio - 1.0).abs() < 2e-3, "{ratio}");
    }
    let optics = ground.replace("[wave]", "[wave]\nmethod = \"physical-optics\"");
    let refused = stored(folder.path(), &optics, None).map(drop).unwrap_err().to_string();
    assert!(refused.contains("the ground is known to boundary elements only"), "{refused}");
}

/// A sphere of 0.4 wavelengths against the series of Mie, by all equations: E at 2 m.
#[test]
fn equations_agree_with_the_exact_answer_on_a_sphere() {
    let folder = tempfile::tempdir().unwrap();
    let wave = Wave::new(1e9).unwrap();
    let radius = 0.4 * wave.wavelength();
    let source = PlaneWave::new(Vec3::Y, Vec3::Z, 1.0.into()).unwrap();
    let ball = ConductingSphere::new(radius).unwrap();
    for (method, bound) in [("efie", 0.02), ("cfie", 0.04), ("mfie", 0.02), ("dual-surface-mfie", 0.02)] {
        let text = format!(
            "[wave]\nfrequencies_hz = [1e9]\nmethod = \"{method}\"\n{SOURCE}[[surface]]\nname = \"ball\"\n\
             sphere = {{ centre = [0, 0, 0], radius = {radius} }}\nedge = \"lambda/8\"\n\
             [[receiver]]\nname = \"circle\"\n\
             circle = {{ centre = [0, 0, 0], radius = 2, normal = [0, 0, 1], start = [1, 0, 0], points = 36 }}\n"
        );
        let found = solved(folder.path(), &text);
        let (mut gap, mut size) = (0.0_f64, 0.0_f64);
        for row in found.near() {
            let exact = ball.scattered(&wave, &source, Vec3::from_array(row.position)).components();
            for (c, exact) in exact.iter().enumerate() {
                gap +=
                    (row.scattered[2 * c] - exact.re).powi(2) + (row.scattered[2 * c + 1] - exact.im).powi(2);
                size += exact.norm_sqr();
            }
        }
        let error = (gap / size).sqrt();
        assert!(error < bound && found.method() == method, "{method}: {error}");
    }
}

/// What a sweep of plane waves sends back is what the plane wave from there scatters there.
#[test]
fn boundary_elements_sweep_as_they_scatter() {
    let folder = tempfile::tempdir().unwrap();
    let text = "[wave]\nfrequencies_hz = [1e9]\nmethod = \"efie\"\n\
                [[source]]\nkind = \"plane-wave\"\nfrom_theta_degrees = 70\nfrom_phi_degrees = 20\npolarisation = \"theta\"\n\
                [[surface]]\nname = \"plate\"\nquad = [[0, -0.1, -0.1], [0, 0.1, -0.1], [0, 0.1, 0.1], [0, -0.1, 0.1]]\n\
                [[receiver]]\nname = \"far\"\nfar = { theta_degrees = 70, phi_degrees = 20 }\n\
                [[receiver]]\nname = \"back\"\nmonostatic = { theta_degrees = [30, 70], phi_degrees = 20 }\n";
    let found = solved(folder.path(), text);
    let (far, back) = (&found.far()[0], &found.monostatic()[1]);
    let expected = far.cross_section.unwrap();
    let sections = back.cross_sections();
    assert!(expected[0] > 1e-4);
    for (found, expected) in [sections[0], sections[1]].iter().zip(expected) {
        assert!((found - expected).abs() < 1e-9 * sections[0], "{sections:?} {expected:?}");
    }
}

/// A cube from a file scatters as the box does.
#[test]
fn a_mesh_file_scatters_as_the_shape_does() {
    let folder = tempfile::tempdir().unwrap();
    let cube = "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nv 0 0 1\nv 1 0 1\nv 1 1 1\nv 0 1 1\n\
                f 1 4 3 2\nf 5 6 7 8\nf 1 2 6 5\nf 2 3 7 6\nf 3 4 8 7\nf 4 1 5 8\n";
    fs::write(folder.path().join("cube.obj"), cube).unwrap();
    let field = |shape: &str| {
        let text = format!(
            "[wave]\nfrequencies_hz = [1e9]\nmethod = \"mfie\"\n{SOURCE}[[surface]]\nname = \"cube\"\n{shape}\n\
             edge = \"lambda/8\"\n[[receiver]]\nname = \"p\"\npoints = [[0.3, -1, 0.2]]\n"
        );
        solved(folder.path(), &text).near()[0].scattered
    };
    let exact = field("box = { min = [0, 0, 0], max = [0.12, 0.12, 0.12] }");
    let file = field("mesh = { file = \"cube.obj\", scale = 0.12 }");
    let size = exact.iter().fold(0.0_f64, |most, x| most.max(x.abs()));
    assert!(exact.iter().zip(file).all(|(a, b)| (a - b).abs() < 1e-5 * size), "{exact:?} {file:?}");
}

/// Many frequencies: one table, one plot of each receiver, and the closed form of a plate.
#[test]
fn a_sweep_has_one_plot_and_the_closed_form() {
    let folder = tempfile::tempdir().unwrap();
    let text = format!(
        "[wave]\nfrequencies_hz = {{ from = 5e8, to = 1.5e9, points = 101 }}\n{SOURCE}[[surface]]\nname = \"plate\"\n\
         quad = [[-0.75, 0, -0.75], [0.75, 0, -0.75], [0.75, 0, 0.75], [-0.75, 0, 0.75]]\n\
         [[receiver]]\nname = \"back\"\nfar = {{ theta_degrees = 90, phi_degrees = 270 }}\n\
         [[receiver]]\nname = \"around\"\nfar = {{ theta_degrees = 90, phi_degrees = {{ from = 180, to = 360, points = 9 }} }}\n"
    );
    let mut found = solved(folder.path(), &text);
    assert_eq!((found.frequencies().len(), found.frequencies()[0].facets), (101, 1));
    for row in found.far().iter().filter(|row| row.receiver == 0) {
        let wavelength = 299_792_458.0 / row.frequency;
        let closed = 4.0 * std::f64::consts::PI * (2.25 / wavelength).powi(2);
        assert!((row.cross_section.unwrap()[0] / closed - 1.0).abs() < 1e-9, "{row:?}");
    }
    let results = folder.path().join("out");
    found.write(&ResultFolder::claim(&results).unwrap()).unwrap();
    let mut names: Vec<String> =
        fs::read_dir(&results).unwrap().map(|e| e.unwrap().file_name().into_string().unwrap()).collect();
    names.sort();
    let expected = [
        ".fredholm",
        "around_over_frequency.png",
        "around_over_frequency.svg",
        "back_over_frequency.svg",
        "currents.vtu",
        "far.csv",
        "receivers.csv",
        "receivers.npz",
        "run.json",
    ];
    assert_eq!(names, expected);
    assert_eq!(fs::read_to_string(results.join("far.csv")).unwrap().lines().count(), 1 + 101 * 10);
}

/// Above the stated number of rows a table is arrays only, and the record says so.
#[test]
fn large_tables_are_arrays_only() {
    let folder = tempfile::tempdir().unwrap();
    let text = format!(
        "[wave]\nfrequencies_hz = [1e9]\n{SOURCE}[[surface]]\nname = \"plate\"\n\
         quad = [[-0.1, 0, -0.1], [0.1, 0, -0.1], [0.1, 0, 0.1], [-0.1, 0, 0.1]]\n\
         [[receiver]]\nname = \"far\"\nfar = {{ theta_degrees = {{ from = 0, to = 180, points = 201 }}, phi_degrees = {{ from = 0, to = 359, points = 250 }} }}\n"
    );
    let mut found = solved(folder.path(), &text);
    let results = folder.path().join("out");
    found.write(&ResultFolder::claim(&results).unwrap()).unwrap();
    assert!(results.join("far.npz").exists() && !results.join("far.csv").exists());
    let record: serde_json::Value =
        serde_json::from_slice(&fs::read(results.join("run.json")).unwrap()).unwrap();
    assert_eq!(record["left_out_as_text"], serde_json::json!(["far.csv"]));
}

const BALL: &str =
    "[[surface]]\nname = \"ball\"\nsphere = { centre = [0, 0, 0], radius = 0.12 }\nedge = \"lambda/10\"\n";

/// A conductor absorbs nothing: of plane waves it scatters what they lose, and dipoles beside it
/// radiate what they supply.
#[test]
fn powers_balance_on_a_sphere() {
    let folder = tempfile::tempdir().unwrap();
    let dipole = "[[source]]\nkind = \"half-wave-dipole\"\nposition = [0.3, 0, 0]\naxis = [0, 0, 1]\ncurrent_a = 1\n\
                  [[source]]\nkind = \"hertzian-dipole\"\nposition = [0, -0.25, 0.1]\naxis = [0, 1, 1]\nmoment_a_m = 0.1\n";
    let far = "[[receiver]]\nname = \"f\"\nfar = { theta_degrees = [30, 70], phi_degrees = 20 }\n";
    for source in [SOURCE, dipole] {
        let text = format!("[wave]\nfrequencies_hz = [1e9]\n{source}{BALL}{far}");
        let found = solved(folder.path(), &text);
        let ratio = found.balances()[0].ratio();
        assert!((ratio - 1.0).abs() < 3e-3, "{ratio}");
        let total = found.far()[0].total;
        assert_eq!(total.is_some(), source == dipole);
        if let Some(total) = total {
            assert!(total.gain > 0.01 && total.gain < 10.0, "{}", total.gain);
        }
    }
}

/// A dipole beside a screen so small that it does nothing has its own far field and gain.
#[test]
fn the_far_field_has_the_sources_in() {
    let folder = tempfile::tempdir().unwrap();
    let text = "[wave]\nfrequencies_hz = [1e9]\n\
        [[source]]\nkind = \"half-wave-dipole\"\nposition = [0, 0, 0]\naxis = [0, 0, 1]\ncurrent_a = 1\n\
        [[surface]]\nname = \"speck\"\nquad = [[5, 0, 0], [5.001, 0, 0], [5.001, 0, 0.001], [5, 0, 0.001]]\n\
        [[receiver]]\nname = \"f\"\nfar = { theta_degrees = [90, 45], phi_degrees = 20 }\n";
    let found = solved(folder.path(), text);
    let totals: Vec<_> = found.far().iter().map(|row| row.total.unwrap()).collect();
    // 1.6409 across the wire, and |F| = η/(2π) there.
    assert!((totals[0].gain - 1.640_9).abs() < 1e-3, "{}", totals[0].gain);
    assert!((totals[0].amplitude[1].hypot(totals[0].amplitude[0]) - 59.958).abs() < 0.01);
    let pattern = (std::f64::consts::FRAC_PI_2 * 0.5_f64.sqrt()).cos() / 0.5_f64.sqrt();
    assert!((totals[1].gain / totals[0].gain - pattern * pattern).abs() < 1e-3);
}

/// Sweeps tell how reciprocal they are: the electric equation is, to rounding and the integrals of
/// its entries.
#[test]
fn sweeps_tell_their_reciprocity() {
    let folder = tempfile::tempdir().unwrap();
    let back = "[[receiver]]\nname = \"b\"\nmonostatic = { theta_degrees = [30, 50, 70, 110], phi_degrees = [20, 50, 110] }\n";
    let defect = |method: &str, surface: &str| {
        let text = format!("[wave]\nfrequencies_hz = [1e9]\nmethod = \"{method}\"\n{surface}{back}");
        let found = solved(folder.path(), &text);
        let kept = found.reciprocity();
        assert_eq!(kept.len(), 1);
        kept[0].defect
    };
    let cube = "[[surface]]\nname = \"cube\"\nbox = { min = [0, 0, 0], max = [0.2, 0.15, 0.25] }\nedge = \"lambda/8\"\n";
    let (electric, dual) = (defect("efie", cube), defect("dual-surface-mfie", cube));
    assert!(electric < 1e-9, "{electric}");
    assert!(dual < 0.02 && dual > electric, "{dual}");
}

/// What a sphere sends back, along the polarisation of the wave: |S|, m.
fn echo_of_a_sphere(radius: f64, permittivity: Option<Complex64>) -> Complex64 {
    let wave = Wave::new(1e9).unwrap();
    let source = PlaneWave::new(Vec3::Y, Vec3::Z, 1.0.into()).unwrap();
    let p = Vec3::Y * -3e5;
    let e = match permittivity {
        Some(permittivity) => {
            DielectricSphere::new(radius, permittivity).unwrap().scattered(&wave, &source, p)
        }
        None => ConductingSphere::new(radius).unwrap().scattered(&wave, &source, p),
    };
    e.components()[2] * Complex64::cis(wave.wavenumber() * 3e5) * 3e5
}

/// The errors of sweeps are stated, by facets and by boundary elements, of conductors and of
/// dielectric bodies.
#[test]
fn errors_of_sweeps_are_stated_and_hold() {
    let folder = tempfile::tempdir().unwrap();
    let glass = "material = \"glass\"\n[materials.glass]\nhalf_space = { permittivity = [3, -0.1] }\n";
    let back = "[[receiver]]\nname = \"b\"\nmonostatic = { theta_degrees = [30, 90], phi_degrees = [20, 50, 110, 170] }\n";
    for (method, edge, more) in [
        ("efie", "lambda/8", ""),
        ("cfie", "lambda/8", ""),
        ("dual-surface-mfie", "lambda/8", ""),
        ("physical-optics", "lambda/8", ""),
        ("pmchwt", "lambda/16", glass),
    ] {
        let radius = if more.is_empty() { 0.12 } else { 0.05 };
        let text = format!(
            "[wave]\nfrequencies_hz = [1e9]\nmethod = \"{method}\"\n[[surface]]\nname = \"ball\"\n\
             sphere = {{ centre = [0, 0, 0], radius = {radius} }}\nedge = \"{edge}\"\n{more}{back}"
        );
        let found = solved(folder.path(), &text);
        let permittivity = (!more.is_empty()).then(|| Complex64::new(3.0, -0.1));
        let exact = echo_of_a_sphere(radius, permittivity);
        let (mut gap, mut size) = (0.0, 0.0);
        for row in found.monostatic() {
            for (part, truth) in [(0, exact), (1, Complex64::ZERO), (2, Complex64::ZERO), (3, exact)] {
                let [re, im] = row.scattering[part];
                gap += (Complex64::new(re, im) - truth).norm_sqr();
                size += truth.norm_sqr();
            }
        }
        let [stated] = found.stated_errors() else { panic!("{method}: {:?}", found.stated_errors()) };
        let (error, stated) = ((gap / size).sqrt(), stated.relative);
        eprintln!("{method}: error {error:.4}, stated {stated:.4}");
        assert!(error < stated && stated < 20.0 * error, "{method}: {error} {stated}");
    }
}

/// What is interpolated over the frequency is as exact as stated, beside all frequencies computed.
#[test]
fn interpolated_sweeps_are_as_exact_as_stated() {
    let folder = tempfile::tempdir().unwrap();
    let receivers = "[[receiver]]\nname = \"f\"\nfar = { theta_degrees = [40, 90], phi_degrees = [20, 130, 270] }\n\
                     [[receiver]]\nname = \"p\"\npoints = [[3, 1, 0], [-0.5, 0.1, 0.2]]\n\
                     [[receiver]]\nname = \"b\"\nmonostatic = { theta_degrees = 80, phi_degrees = [10, 60] }\n";
    // Apart from the origin, and a pair of plates with waves to and fro between them.
    let ball =
        "[[surface]]\nname = \"ball\"\nsphere = { centre = [0.5, 0.2, 0], radius = 0.1 }\nedge = 0.04\n";
    let pair = "[[surface]]\nname = \"a\"\nquad = [[0, 0, 0], [0.2, 0, 0], [0.2, 0.2, 0], [0, 0.2, 0]]\nedge = 0.05\n\
                [[surface]]\nname = \"b\"\nquad = [[0, 0, 0.06], [0.2, 0, 0.06], [0.2, 0.2, 0.06], [0, 0.2, 0.06]]\nedge = 0.05\n";
    let values = |found: &SolvedWaves<'_>, receiver: usize| -> Vec<f64> {
        let near = found.near().iter().filter(|row| row.receiver == receiver).flat_map(|row| row.scattered);
        let far = found.far().iter().filter(|row| row.receiver == receiver).flat_map(|row| row.amplitude);
        let back = found.monostatic().iter().filter(|row| row.receiver == receiver);
        near.chain(far).chain(back.flat_map(|row| row.scattering.into_iter().flatten())).collect()
    };
    for (method, surfaces, accuracy) in [("efie", pair, 1e-2), ("dual-surface-mfie", ball, 5e-3)] {
        let text = |more: &str| {
            format!(
                "[wave]\nfrequencies_hz = {{ from = 8e8, to = 1.2e9, points = 61 }}\nmethod = \"{method}\"\n\
                 {more}\n{SOURCE}{surfaces}{receivers}"
            )
        };
        let all = solved(folder.path(), &text(""));
        let some = solved(folder.path(), &text(&format!("sweep_accuracy = {accuracy}")));
        let stated = *some.interpolated().unwrap();
        assert_eq!((some.far().len(), some.near().len()), (all.far().len(), all.near().len()));
        let mut worst = 0.0_f64;
        for receiver in 0..3 {
            let (a, b) = (values(&some, receiver), values(&all, receiver));
            let size = b.iter().map(|x| x * x).sum::<f64>() / 61.0;
            let one = b.len() / 61;
            for (a, b) in a.chunks(one).zip(b.chunks(one)) {
                let gap: f64 = a.iter().zip(b).map(|(a, b)| (a - b) * (a - b)).sum();
                worst = worst.max((gap / size).sqrt());
            }
        }
        eprintln!(
            "{method} {accuracy}: {} of 61, stated {:.1e}, true {worst:.1e}",
            stated.computed, stated.relative
        );
        assert!(worst <= stated.relative && stated.relative <= accuracy);
        assert!(stated.computed < 50);
    }
}
