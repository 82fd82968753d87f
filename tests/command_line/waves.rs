//! Scenes of waves: results that compare with references, and messages for what is wrong.

use std::fs;
use std::path::Path;

use crate::support::{Bench, PLATE as GOOD, Run, fredholm_in};

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
        ("points = [[0, -1, 0]]", "points = [[0.01, 0, 0.02]]", "scene.toml:14:", "lies on triangle"),
        ("points = [[0, -1, 0]]", "points = []", "scene.toml:14:", "0 receiver points"),
        ("[wave]", "[wave]\nmethod = \"mfie\"\nsolver = \"lu\"", "scene.toml:12:", "closed bodies"),
        ("[wave]", "[wave]\nmethod = \"thesis\"\nedge_currents = true", "scene.toml:4:", "physical optics"),
        ("[wave]", "[wave]\nsolver = \"magic\"", "scene.toml:3:10:", "there is no solver"),
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
    let scene = GOOD.replace("[wave]", "[wave]\nmethod = \"mfie\"\nsolver = \"neumann\"").replace(
        "quad = [[-0.3, 0, -0.3], [0.3, 0, -0.3], [0.3, 0, 0.3], [-0.3, 0, 0.3]]",
        "box = { min = [0, 0, 0], max = [0.62956, 0.62956, 0.62956] }\nedge = \"lambda/6\"",
    );
    let (bench, run) = waves(&scene);
    assert!(run.code == 3 && run.stderr.contains("diverges"), "{}", run.stderr);
    assert!(!bench.path("out/scene/run.json").exists());
}

/// GOOD with other keys under [wave], another source, surface or receiver.
fn changed(changes: &[(&str, &str)]) -> String {
    changes.iter().fold(GOOD.to_owned(), |scene, (from, to)| {
        assert!(scene.contains(from), "{from}");
        scene.replace(from, to)
    })
}

const PLATE: &str = "quad = [[-0.3, 0, -0.3], [0.3, 0, -0.3], [0.3, 0, 0.3], [-0.3, 0, 0.3]]";
const POINT: &str = "points = [[0, -1, 0]]";
const CUBE: &str = "box = { min = [0, 0, 0], max = [0.62956, 0.62956, 0.62956] }\nedge = \"lambda/6\"";

fn read(bench: &Bench, name: &str) -> String {
    fs::read_to_string(bench.path("out/scene").join(name)).unwrap()
}

/// On the closed cube of 2.1λ the bounces diverge, and GMRES does not: told, with exit code 3, and
/// no field is written.
#[test]
fn a_comparison_tells_what_diverges() {
    let bench =
        Bench::new(&changed(&[("[wave]", "[wave]\nmethod = \"mfie\"\nsolver = \"lu\""), (PLATE, CUBE)]));
    let run = bench.run(&[
        "waves",
        "scene.toml",
        "--compare",
        "neumann,gmres:restart=100,cg-theta",
        "-o",
        "out/scene",
    ]);
    assert_eq!(run.code, 3, "{}", run.stderr);
    let table = read(&bench, "compare.csv");
    let rows: Vec<Vec<&str>> = table.lines().skip(1).map(|line| line.split(',').collect()).collect();
    let outcomes: Vec<&str> = rows.iter().map(|row| row[3]).collect();
    assert_eq!(outcomes, ["diverged", "converged", "refused"]);
    // The radius of an independent code is 1.12.
    let radius: f64 = rows[0][1].parse().unwrap();
    assert!((radius / 1.12 - 1.0).abs() < 0.05, "{radius}");
    let residual: f64 = rows[1][7].parse().unwrap();
    assert!(residual < 1e-6 && rows[0][8].is_empty(), "{table}");
    assert!(read(&bench, "compare_history.csv").lines().count() > 100);
    for file in ["compare.svg", "compare.json", "report.html"] {
        assert!(read(&bench, file).contains("neumann"), "{file}");
    }
    assert!(!bench.path("out/scene/run.json").exists() && run.stdout.contains("spectral radius 1.1"));
    let wrong = bench.run(&["waves", "scene.toml", "--compare", "magic"]);
    assert!(wrong.code == 2 && wrong.stderr.contains("magic"), "{}", wrong.stderr);
}

/// ‖f − g‖/‖g‖ of the far fields of two runs.
fn far_difference(one: &str, other: &str) -> f64 {
    let (mut gap, mut size) = (0.0, 0.0);
    for part in ["f_theta_re", "f_theta_im", "f_phi_re", "f_phi_im"] {
        let (a, b) = (column(one, part), column(other, part));
        gap += a.iter().zip(&b).map(|(a, b)| (a - b).powi(2)).sum::<f64>();
        size += b.iter().map(|b| b * b).sum::<f64>();
    }
    (gap / size).sqrt()
}

/// Methods beside each other: each has the fields of a run of its own, differences are those from
/// the one that states the least error, what a scene does not admit has its reason, and numbers of
/// threads change nothing but seconds.
#[test]
fn methods_are_compared_with_the_one_that_states_the_least_error() {
    let far = "far = { theta_degrees = 90, phi_degrees = { from = 0, to = 180, points = 19 } }";
    let grid = "grid = { corner = [-1, -1, 0], u = [2, 0, 0], v = [0, 2, 0], columns = 9, rows = 8 }";
    let receivers = format!("{far}\n\n[[receiver]]\nname = \"map\"\n{grid}");
    let scene = changed(&[(POINT, &receivers)]);
    let bench = Bench::new(&scene);
    let list = "physical-optics,iterated:edges,efie,cfie";
    for threads in ["1", "2"] {
        let run = bench.run(&["waves", "scene.toml", "--methods", list, "-o", threads, "--threads", threads]);
        assert_eq!(run.code, 0, "{}", run.stderr);
        assert!(run.stdout.contains("differences from efie"), "{}", run.stdout);
        assert!(run.stderr.contains("cfie is left out: the combined field equation"), "{}", run.stderr);
    }
    let read = |file: &str| fs::read_to_string(bench.path(file)).unwrap();
    assert_eq!(read("1/methods_over_angle.csv"), read("2/methods_over_angle.csv"));
    let table = read("1/methods.csv");
    let rows: Vec<Vec<&str>> = table.lines().skip(1).map(|line| line.split(',').collect()).collect();
    let methods: Vec<&str> = rows.iter().map(|row| row[0]).collect();
    let twice = |name| [name; 2];
    assert_eq!(methods[..4], [twice("physical-optics"), twice("iterated:edges")].concat()[..]);
    assert_eq!(methods[4..], ["efie", "efie", "cfie"]);
    assert!(rows[6][1] == "refused" && table.contains("made for closed bodies"), "{table}");
    assert!(rows[4][4].parse::<f64>().unwrap() < 0.1 && rows[4][5].is_empty(), "{table}");
    let alone = |method: &str| {
        let text = scene.replace("[wave]", &format!("[wave]\n{method}"));
        fs::write(bench.path("alone.toml"), text).unwrap();
        let run = bench.run(&["waves", "alone.toml", "-o", "alone"]);
        assert_eq!(run.code, 0, "{}", run.stderr);
        read("alone/far.csv")
    };
    let exact = alone("method = \"efie\"");
    let optics = alone("method = \"physical-optics\"\nbounces = 1\nedge_currents = false");
    let (told, found) = (rows[0][5].parse::<f64>().unwrap(), far_difference(&optics, &exact));
    assert!(found > 0.01 && (told / found - 1.0).abs() < 1e-9, "{told} {found}");
    let files = ["map_efie_ez_magnitude.png", "map_iterated-edges_ez_difference.png", "report.html"];
    for file in files {
        assert!(bench.path("1").join(file).exists(), "{file}");
    }
    assert!(!bench.path("1/map_efie_ez_difference.png").exists());
    let told = bench.run(&["info", "1"]).stdout;
    assert!(told.contains("iterated:edges at map, 1000 MHz: states"), "{told}");
    let wrong = bench.run(&["waves", "scene.toml", "--methods", "efie:edges"]);
    assert!(wrong.code == 2 && wrong.stderr.contains("known are order=0 and order=1"), "{}", wrong.stderr);
    let absent = bench.run(&["waves", "absent.toml", "--methods", "all"]);
    assert!(absent.code == 5 && !absent.stderr.contains("left out"), "{}", absent.stderr);
    let none = bench.run(&["waves", "scene.toml", "--methods", "cfie,mfie"]);
    assert!(none.code == 2 && none.stderr.contains("closed bodies"), "{}", none.stderr);
}

/// A sweep needs no source, and has at every direction what the plane wave from there sends back.
#[test]
fn a_monostatic_sweep_is_the_backscatter_of_every_direction() {
    let far = "far = { theta_degrees = [90, 70], phi_degrees = [270, 250] }";
    let bistatic = |method: &str, theta: u32, phi: u32, along: &str| {
        let from = format!("from_theta_degrees = {theta}\nfrom_phi_degrees = {phi}");
        let polarised = format!("polarisation = \"{along}\"");
        let wave = format!("[wave]\n{method}");
        let bench = Bench::new(&changed(&[
            ("[wave]", &wave),
            ("travel = [0, 1, 0]", &from),
            ("polarisation = [0, 0, 1]", &polarised),
            (POINT, far),
        ]));
        assert_eq!(bench.run(&["waves", "scene.toml"]).code, 0);
        let table = read(&bench, "far.csv");
        let is =
            |title: &str, angle: u32, i: usize| (column(&table, title)[i] - f64::from(angle)).abs() < 1e-9;
        let at = (0..4).find(|&i| is("theta_degrees", theta, i) && is("phi_degrees", phi, i));
        ["rcs_theta", "rcs_phi"].map(|title| column(&table, title)[at.unwrap()])
    };
    for method in ["bounces = 1", "solver = \"gmres\""] {
        let start = GOOD.find("[[source]]").unwrap();
        let end = GOOD.find("[[surface]]").unwrap();
        let dark = GOOD.replace(&GOOD[start..end], "").replace("[wave]", &format!("[wave]\n{method}"));
        let bench = Bench::new(&dark.replace(POINT, &far.replace("far", "monostatic")));
        let run = bench.run(&["waves", "scene.toml"]);
        assert_eq!(run.code, 0, "{}", run.stderr);
        let table = read(&bench, "monostatic.csv");
        assert_eq!(column(&table, "index"), [0.0, 1.0, 2.0, 3.0]);
        for (row, theta, phi) in [(0, 90, 270), (3, 70, 250)] {
            for (along, titles) in [("theta", ["rcs_tt", "rcs_pt"]), ("phi", ["rcs_tp", "rcs_pp"])] {
                let expected = bistatic(method, theta, phi, along);
                let found = titles.map(|title| column(&table, title)[row]);
                let scale = expected[0].max(expected[1]);
                assert!(scale > 1e-6);
                for (a, b) in found.iter().zip(expected) {
                    assert!(
                        (a - b).abs() < 1e-9 * scale,
                        "{method} {theta} {phi} {along}: {found:?} {expected:?}"
                    );
                }
            }
        }
        assert!(read(&bench, "point.svg").contains("φθ"));
    }
}

/// Several sources together scatter the sum of what each scatters, whatever they are.
#[test]
fn sources_add_up() {
    let start = GOOD.find("[[source]]").unwrap();
    let end = GOOD.find("[[surface]]").unwrap();
    let plane = &GOOD[start..end];
    let dipole = "[[source]]\nkind = \"half-wave-dipole\"\nposition = [0.2, -0.7, 0.1]\naxis = [0, 1, 1]\ncurrent_a = 0.02\n\n";
    let field = |sources: &str| {
        let bench = Bench::new(&GOOD.replace(plane, sources).replace("[wave]", "[wave]\nbounces = 3"));
        assert_eq!(bench.run(&["waves", "scene.toml"]).code, 0);
        let table = read(&bench, "receivers.csv");
        ["tot_ex_re", "tot_ez_re", "tot_ez_im", "sca_hx_im"].map(|title| column(&table, title)[0])
    };
    let (one, other, both) = (field(plane), field(dipole), field(&format!("{plane}{dipole}")));
    for i in 0..4 {
        assert!(
            (one[i] + other[i] - both[i]).abs() < 1e-12 * both.iter().fold(0.0, |m: f64, x| m.max(x.abs()))
        );
    }
    assert!(one[1].abs() > 1e-3 && other[1].abs() > 1e-3);
}

/// Every treatment and material, with what is left of the bounces in files of its own.
#[test]
fn threads_change_no_byte_of_any_mode() {
    let corner = "quad = [[-0.3, 0, -0.3], [0.3, 0, -0.3], [0.3, 0, 0.3], [-0.3, 0, 0.3]]\nedge = \"lambda/5\"\n\n[[surface]]\nname = \"wing\"\nquad = [[-0.3, 0, -0.3], [-0.3, 0, 0.3], [-0.3, -0.6, 0.3], [-0.3, -0.6, -0.3]]\nedge = \"lambda/5\"";
    let small = "box = { min = [0, 0, 0], max = [0.3, 0.4, 0.35] }\nedge = \"lambda/6\"";
    let glass = "\n[materials.glass]\nlayers = [{ itu = \"glass\", thickness_m = 0.006 }]\n";
    let modes = [
        ("", corner, ""),
        ("bounces = 3", corner, ""),
        ("bounces = 2\nedge_currents = true\nestimate_errors = true", corner, ""),
        ("shadows = \"radiated\"\nsolver = \"gmres\"", corner, ""),
        ("method = \"thesis\"\nbounces = 2", corner, ""),
        ("bounces = 2", &*corner.replace("name = \"wing\"", "name = \"wing\"\nmaterial = \"glass\""), glass),
        ("method = \"mfie\"", small, ""),
        ("method = \"dual-surface-mfie\"\nsolver = \"gmres\"", small, ""),
    ];
    for (method, surface, materials) in modes {
        let receivers = "points = [[0, -1, 0], [0.2, 2, 1]]\n\n[[receiver]]\nname = \"sweep\"\nmonostatic = { theta_degrees = 80, phi_degrees = [250, 290] }";
        let wave = format!("[wave]\n{method}");
        let scene = changed(&[("[wave]", &wave), (PLATE, surface), (POINT, receivers)]) + materials;
        let bench = Bench::new(&scene);
        let results = |threads: &str| {
            let run = bench.run(&["waves", "scene.toml", "-o", threads, "--threads", threads, "--quiet"]);
            assert_eq!(run.code, 0, "{method}: {}", run.stderr);
            let file = |name: &str| fs::read(bench.folder.path().join(threads).join(name)).unwrap();
            ["receivers.csv", "monostatic.csv", "residuals.csv", "currents.vtu"].map(file)
        };
        let one = results("1");
        assert!(one.iter().all(|file| file.len() > 50), "{method}");
        assert!(results("2") == one && results("4") == one, "{method}");
    }
}

/// Small sheets are solved by boundary elements unasked: the answer is that of a finer mesh within
/// the stated error.
#[test]
fn small_sheets_are_solved_rigorously_within_the_stated_error() {
    let corner = |edge: &str| {
        format!(
            "quad = [[-0.2, 0, -0.2], [0.2, 0, -0.2], [0.2, 0, 0.2], [-0.2, 0, 0.2]]\nedge = \"{edge}\"\n\n\
             [[surface]]\nname = \"wing\"\nquad = [[-0.2, 0, -0.2], [-0.2, 0, 0.2], [-0.2, -0.4, 0.2], [-0.2, -0.4, -0.2]]\n\
             edge = \"{edge}\""
        )
    };
    let far = "far = { theta_degrees = { from = 10, to = 170, points = 9 }, phi_degrees = { from = 0, to = 330, points = 12 } }";
    let run = |edge: &str| {
        let bench = Bench::new(&changed(&[(PLATE, &corner(edge)), (POINT, far)]));
        let run = bench.run(&["waves", "scene.toml"]);
        assert_eq!(run.code, 0, "{}", run.stderr);
        let record: serde_json::Value = serde_json::from_str(&read(&bench, "run.json")).unwrap();
        assert_eq!(record["method"], "efie", "{}", record["chosen_because"]);
        let table = read(&bench, "far.csv");
        let header: Vec<&str> = table.lines().next().unwrap().split(',').collect();
        let first = header.iter().position(|name| *name == "f_theta_re").unwrap();
        let amplitudes = table.lines().skip(1).flat_map(|line| {
            let cells: Vec<&str> = line.split(',').collect();
            (first..first + 4).map(move |i| cells[i].parse::<f64>().unwrap())
        });
        (amplitudes.collect::<Vec<_>>(), record["stated_errors"][0]["relative"].as_f64().unwrap())
    };
    let ((coarse, stated), (fine, finer)) = (run("lambda/5"), run("lambda/10"));
    let square = |values: &mut dyn Iterator<Item = f64>| values.map(|x| x * x).sum::<f64>();
    let gap = square(&mut coarse.iter().zip(&fine).map(|(a, b)| a - b));
    let error = (gap / square(&mut fine.iter().copied())).sqrt();
    assert!(error > 0.01 && error < stated && stated < 0.25 && finer < stated, "{error} {stated} {finer}");
}

/// The residual after the bounces asked for, and the estimates, are in the record.
#[test]
fn errors_are_estimated_for_mesh_bounces_and_form() {
    let keys = "[wave]\nmethod = \"physical-optics\"\nestimate_errors = true";
    let far = "points = [[0, -1, 0]]\n\n[[receiver]]\nname = \"far\"\nfar = { theta_degrees = 90, phi_degrees = [200, 270] }";
    let scene = changed(&[("[wave]", keys), (POINT, far)]).replace("0.3, 0, 0.3]", "0.3, 0.0, 0.3]");
    let bench = Bench::new(&scene);
    assert_eq!(bench.run(&["waves", "scene.toml"]).code, 0);
    let record: serde_json::Value = serde_json::from_str(&read(&bench, "run.json")).unwrap();
    let receivers = |key: &str| -> Vec<String> {
        record[key].as_array().unwrap().iter().map(|e| e["receiver"].as_str().unwrap().to_owned()).collect()
    };
    for key in ["estimated_mesh_errors", "estimated_form_errors"] {
        assert_eq!(receivers(key), ["point", "far"], "{key}");
    }
    // One flat plate has no second bounce.
    assert_eq!(record["frequencies"][0]["residuals"].as_array().unwrap().len(), 2);
    assert!(record["frequencies"][0]["residuals"][1].as_f64().unwrap() < 1e-12);
}

/// Numbers that are none, or beyond all measure, end with a message and a code, in no time and
/// without a file.
#[test]
fn hostile_numbers_are_refused_or_harmless() {
    let refused = [
        ("[1e9]", "[nan]", "frequency"),
        ("[1e9]", "[1e300]", ""),
        ("[1e9]", "[-1e9]", "frequency"),
        ("travel = [0, 1, 0]", "travel = [0, nan, 0]", "finite"),
        ("travel = [0, 1, 0]", "travel = [0, 1, 0]\namplitude_v_per_m = inf", "finite"),
        ("[[-0.3, 0, -0.3], [0.3, 0, -0.3]", "[[nan, 0, -0.3], [0.3, 0, -0.3]", ""),
        ("[[-0.3, 0, -0.3], [0.3, 0, -0.3]", "[[-1e200, 0, -0.3], [0.3, 0, -0.3]", ""),
        (PLATE, "sphere = { centre = [0, 0, 0], radius = 1e9 }", ""),
        (PLATE, "sphere = { centre = [0, 0, 0], radius = nan }", ""),
        (PLATE, "sphere = { centre = [0, 0, 0], radius = 0 }", ""),
        (POINT, "points = [[0, nan, 0]]", "finite"),
        (POINT, "points = [[0, -1e12, 0]]", "phase"),
        (
            POINT,
            "circle = { centre = [0, 0, 0], radius = 9, normal = [0, 0, 1], start = [0, 0, 2], points = 9 }",
            "start",
        ),
        (
            POINT,
            "grid = { corner = [0, 0, 0], u = [1, 0, 0], v = [0, 1, 0], columns = 100000, rows = 100000 }",
            "20000000",
        ),
        (POINT, "monostatic = { theta_degrees = nan, phi_degrees = 0 }", "finite"),
        ("[wave]", "[wave]\nbounces = 0", "bounce"),
        ("[wave]", "[wave]\nsolver = \"gmres:restart=0\"", "restart"),
        ("[wave]", "[wave]\nsolver = \"gmres\"\ntolerance = -1", "tolerance"),
    ];
    for (from, to, what) in refused {
        let (bench, run) = waves(&GOOD.replace(from, to));
        assert!(run.code == 2 || run.code == 4, "{to}: {} {}", run.code, run.stderr);
        assert!(run.stderr.contains(what) && run.stderr.contains("help: "), "{to}: {}", run.stderr);
        assert!(!bench.path("out").exists(), "{to}");
    }
    let harmless = [
        (POINT, "points = [[0, -1e8, 0]]"),
        ("travel = [0, 1, 0]", "travel = [0, 1e-300, 0]"),
        ("travel = [0, 1, 0]", "travel = [0, 1, 0]\namplitude_v_per_m = 0"),
    ];
    for (from, to) in harmless {
        let (bench, run) = waves(&GOOD.replace(from, to));
        assert_eq!(run.code, 0, "{to}: {}", run.stderr);
        assert!(column(&read(&bench, "receivers.csv"), "sca_ez_re")[0].is_finite(), "{to}");
    }
}

/// One bounce of plane waves seen from far away is a closed form: a plate of 20 wavelengths needs
/// no mesh in wavelengths, and has 4πA²/λ² straight back.
#[test]
fn far_fields_of_large_plates_need_one_facet() {
    let start = GOOD.find("[[source]]").unwrap();
    let end = GOOD.find("[[surface]]").unwrap();
    let dark = GOOD.replace(&GOOD[start..end], "");
    let large = "quad = [[-3, 0, -3], [3, 0, -3], [3, 0, 3], [-3, 0, 3]]\nedge = 10.0";
    let sweep = "monostatic = { theta_degrees = 90, phi_degrees = [270, 265] }";
    // Without the edge currents that a plate has unasked.
    let dark = dark.replace("[wave]", "[wave]\nbounces = 1");
    let bench = Bench::new(&dark.replace(PLATE, large).replace(POINT, sweep));
    let run = bench.run(&["waves", "scene.toml"]);
    assert!(run.code == 0 && run.stdout.contains("1 facets"), "{}{}", run.stdout, run.stderr);
    let wavelength = 299_792_458.0 / 1e9;
    let closed = 4.0 * std::f64::consts::PI * (36.0_f64 / wavelength).powi(2);
    let table = read(&bench, "monostatic.csv");
    for title in ["rcs_tt", "rcs_pp"] {
        assert!((column(&table, title)[0] / closed - 1.0).abs() < 1e-9, "{title}");
    }
    // Near by, the mesh matters.
    let (_, run) = waves(&GOOD.replace(PLATE, large));
    assert!(run.code == 2 && run.stderr.contains("half the wavelength"), "{}", run.stderr);
}
