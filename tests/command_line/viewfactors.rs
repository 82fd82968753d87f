//! `fredholm viewfactors`: known values, files, receivers, the sky, closure, exit codes.

use std::fs;
use std::path::{Path, PathBuf};
use std::process::{Command, Stdio};
use std::thread;
use std::time::{Duration, Instant};

use fredholm::report::{Factors, ViewFactors};
use serde_json::Value;

use crate::support::{Bench, Run, furnace, program};

/// Unit squares at distance 1, and at a right angle with a common edge (J. R. Howell, C-11 and
/// C-14).
const PARALLEL: f64 = 0.199_824_895_698_387_5;
const PERPENDICULAR: f64 = 0.200_043_776_075_403_1;
/// The parallel squares with a centred square of side 0.5 halfway: exact shadow inside, 400 Gauss
/// points outside.
const BLOCKED: f64 = 0.099_506_294_598_985;

fn data(name: &str) -> String {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/data/viewfactors").join(name);
    path.to_str().unwrap().to_owned()
}

fn bench() -> Bench {
    Bench::new(&furnace(2, &[0.5]))
}

fn run(bench: &Bench, input: &str, arguments: &[&str]) -> Run {
    bench.run(&[&["viewfactors", input], arguments].concat())
}

/// Computes `F.npz` and expects success.
fn computed(bench: &Bench, input: &str, arguments: &[&str]) -> ViewFactors {
    let run = run(bench, input, &[arguments, &["-o", "F.npz"]].concat());
    assert_eq!(run.code, 0, "{}", run.stderr);
    ViewFactors::read_npz(&bench.path("F.npz")).unwrap()
}

fn record(bench: &Bench) -> Value {
    serde_json::from_slice(&fs::read(bench.path("F.json")).unwrap()).unwrap()
}

fn row(factors: &ViewFactors, i: usize) -> Vec<f64> {
    let mut row = vec![0.0; factors.len()];
    factors.copy_row(i, &mut row);
    row
}

fn place(factors: &ViewFactors, name: &str) -> usize {
    factors.surfaces.names.iter().position(|other| other == name).unwrap()
}

/// Whether there is nothing in the folder but the scene.
fn is_untouched(bench: &Bench) -> bool {
    fs::read_dir(bench.folder.path()).unwrap().count() == 1
}

#[test]
fn squares_have_their_closed_forms() {
    let bench = bench();
    for (file, exact, error) in [
        ("parallel.obj", PARALLEL, 1e-9),
        ("perp.obj", PERPENDICULAR, 1e-9),
        ("blocked.obj", BLOCKED, 1e-9),
        ("blocked.vs3", BLOCKED, 1e-9),
    ] {
        let factors = computed(&bench, &data(file), &["--tolerance", "1e-8"]);
        let (forth, back) = (row(&factors, 0)[1], row(&factors, 1)[0]);
        assert!((forth - exact).abs() < error, "{file}: {:e}", forth - exact);
        assert!((forth - back).abs() < 1e-16, "{file}: areas are equal");
        assert!((forth - exact).abs() <= f64::from(factors.errors[1]) + 1e-15, "{file}");
    }
}

#[test]
fn the_errors_of_the_pairs_of_a_row_add_up_to_its_own() {
    let bench = bench();
    let options: [&[&str]; 3] =
        [&["--rows", "element"], &["--rows", "surface", "--sky"], &["--sky", "--close"]];
    for options in options {
        let pairs = [options, &["--method", "auto", "--tolerance", "1e-2"]].concat();
        let factors = computed(&bench, &data("cubebox8.vs3"), &pairs);
        let n = factors.len();
        let sky = options.contains(&"--sky");
        for i in 0..n - usize::from(sky) {
            let errors = &factors.errors[i * n..(i + 1) * n];
            let (sum, row) =
                (errors.iter().map(|&e| f64::from(e)).sum::<f64>(), factors.surfaces.row_error[i]);
            assert!((sum / row - 1.0).abs() < 1e-6 && row > 0.0, "{options:?} row {i}: {sum:e} for {row:e}");
        }
    }
    let sparse = computed(&bench, &data("cube8.vs3"), &["--threshold", "1e-2"]);
    assert_eq!(sparse.errors.len(), sparse.stored());
}

#[test]
fn rows_with_a_budget_are_within_what_is_stated_and_pairs_less_exact() {
    let bench = bench();
    let exact = computed(&bench, &data("cubebox8.vs3"), &["--tolerance", "1e-6", "--method", "auto"]);
    let loose = computed(&bench, &data("cubebox8.vs3"), &["--tolerance", "1e-2"]);
    assert!(record(&bench)["pairs"]["segments"].as_u64().unwrap() > 1000);
    let (mut largest, mut sum) = (0.0_f64, 0.0);
    for i in 0..exact.surfaces.names.len() {
        let (found, truth) = (row(&loose, i), row(&exact, i));
        let off: f64 = found.iter().zip(&truth).map(|(a, b)| a - b).sum();
        assert!(
            off.abs() <= loose.surfaces.row_error[i] + exact.surfaces.row_error[i],
            "{i}: {off} {}",
            loose.surfaces.row_error[i]
        );
        largest = largest.max(loose.surfaces.row_error[i]);
        sum += found.iter().zip(&truth).map(|(a, b)| (a - b).abs()).sum::<f64>();
    }
    assert!(largest < 0.05 && sum > 0.0, "{largest} {sum}");
}

#[test]
fn the_walls_of_a_cube_add_up_from_their_patches() {
    let bench = bench();
    let factors = computed(&bench, &data("cube8.vs3"), &["--tolerance", "1e-6"]);
    assert_eq!((factors.len(), factors.surfaces.emissivity.as_ref().unwrap()[383]), (384, 0.9));
    for i in 0..384 {
        let stated = factors.surfaces.row_error[i];
        assert!((factors.row_sums[i] - 1.0).abs() <= stated && stated < 3e-6, "{i}: {stated:e}");
    }
    // Patches of a wall are neighbours in the file: 64 of each.
    let wall = |i: usize| i / 64;
    let mut sums = [0.0; 6];
    (0..64).for_each(|i| row(&factors, i).iter().enumerate().for_each(|(j, f)| sums[wall(j)] += f / 64.0));
    for (j, sum) in sums.iter().enumerate() {
        let exact = [0.0, PARALLEL, PERPENDICULAR][j.min(2)];
        assert!((sum - exact).abs() < 1e-6, "{j}: {sum}");
    }
    let walls = computed(&bench, "scene.toml", &["--rows", "surface", "--tolerance", "1e-8"]);
    assert_eq!((walls.len(), walls.surfaces.emissivity.clone()), (1, None));
    assert!((row(&walls, 0)[0] - 1.0).abs() < 1e-8, "a closed room sees itself only");
}

#[test]
fn every_file_is_the_same_with_1_2_and_4_threads() {
    let bench = bench();
    let files = |threads: &str| {
        let more =
            ["--threads", threads, "--tolerance", "1e-2", "--close", "--sky", "--point", "0.1,0.2,0.1,0,0,1"];
        computed(&bench, &data("cubebox8.vs3"), &more);
        let mut record = record(&bench);
        for key in ["timings", "peak_memory_bytes"] {
            assert!(record.as_object_mut().unwrap().remove(key).is_some(), "{key}");
        }
        assert!(record["options"].as_object_mut().unwrap().remove("threads").is_some());
        (["F.npz", "F.png", "F.svg"].map(|name| fs::read(bench.path(name)).unwrap()), record)
    };
    let one = files("1");
    assert!(one == files("2") && one == files("4"));
}

#[test]
fn what_a_threshold_drops_is_stated() {
    let bench = bench();
    let full = computed(&bench, &data("cube8.vs3"), &[]);
    let sparse = computed(&bench, &data("cube8.vs3"), &["--threshold", "2e-3"]);
    assert!(matches!(sparse.factors, Factors::Sparse(_)) && sparse.stored() < full.stored());
    assert_eq!((&sparse.row_sums, full.row_dropped.iter().all(|&d| d == 0.0)), (&full.row_sums, true));
    for i in 0..384 {
        let kept = row(&sparse, i);
        let dropped: f64 = row(&full, i).iter().filter(|&&f| f < 2e-3).sum();
        assert!((dropped - sparse.row_dropped[i]).abs() < 1e-15 && dropped > 0.0, "{i}");
        assert!(kept.iter().all(|&f| f == 0.0 || f >= 2e-3));
    }
    assert_eq!(record(&bench)["counts"]["stored"], sparse.stored());
}

/// A unit cube with a window in the ceiling, a floor of two pieces, and a plate that only blocks.
const ASSEMBLED_CUBE: &str = "T cube\nF 3\nV 1 0 0 0\nV 2 1 0 0\nV 3 1 1 0\nV 4 0 1 0\nV 5 0 0 1\nV 6 1 0 1\nV 7 1 1 1\nV 8 0 1 1\n\
    V 9 0.2 0.3 1\nV 10 0.2 0.7 1\nV 11 0.6 0.7 1\nV 12 0.6 0.3 1\n\
    S 1 1 2 3 0 0 0 0.9 floor\nS 2 5 8 7 6 0 0 0.8 ceiling\nS 3 9 10 11 12 2 0 0.1 window\nS 4 1 3 4 0 0 1 0.9 floor-2\n\
    S 5 1 5 6 2 0 0 0.9 south\nS 6 2 6 7 3 0 0 0.9 east\nS 7 3 7 8 4 0 0 0.9 north\nS 8 4 8 5 1 0 0 0.9 west\n";

#[test]
fn combined_surfaces_and_windows_add_up() {
    let bench = bench();
    fs::write(bench.path("cube.vs3"), format!("{ASSEMBLED_CUBE}End\n")).unwrap();
    let factors = computed(&bench, "cube.vs3", &["--tolerance", "1e-8"]);
    assert_eq!(factors.surfaces.names, ["floor", "ceiling", "window", "south", "east", "north", "west"]);
    let area = &factors.surfaces.area;
    assert!(
        (area[0] - 1.0).abs() < 1e-15 && (area[1] - 0.84).abs() < 1e-14 && (area[2] - 0.16).abs() < 1e-15
    );
    assert!(factors.defects().iter().all(|&defect| defect < 1e-9), "{:?}", factors.defects());
    let [ceiling, window] = [row(&factors, 1), row(&factors, 2)];
    assert!((area[1] * ceiling[0] + area[2] * window[0] - PARALLEL).abs() < 1e-9);
    assert!((area[1] * ceiling[4] + area[2] * window[4] - PERPENDICULAR).abs() < 1e-9);
    // An obstruction under the whole ceiling hides it and has no row.
    let plate = "V 13 -1 -1 0.999\nV 14 2 -1 0.999\nV 15 2 2 0.999\nV 16 -1 2 0.999\nO 9 13 14 15 16\n";
    fs::write(bench.path("hidden.vs3"), format!("{ASSEMBLED_CUBE}{plate}End\n")).unwrap();
    let hidden = computed(&bench, "hidden.vs3", &["--tolerance", "1e-3"]);
    assert_eq!(hidden.len(), 7);
    assert!(row(&hidden, 0)[1] == 0.0 && row(&hidden, 0)[2] == 0.0 && row(&hidden, 0)[3] > 0.1);
}

/// The unit cube without its lid.
const OPEN_CUBE: &str = "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nv 0 0 1\nv 1 0 1\nv 1 1 1\nv 0 1 1\n\
    o floor\nf 1 2 3 4\no south\nf 1 5 6 2\no east\nf 2 6 7 3\no north\nf 3 7 8 4\no west\nf 4 8 5 1\n";

#[test]
fn the_sky_takes_the_place_of_a_lid() {
    let bench = bench();
    fs::write(bench.path("court.obj"), OPEN_CUBE).unwrap();
    let factors =
        computed(&bench, "court.obj", &["--sky", "--tolerance", "1e-7", "--point", "0.5,0.5,0,0,0,1"]);
    let sky = place(&factors, "sky");
    assert_eq!(sky, 5);
    for (name, exact) in [("floor", PARALLEL), ("south", PERPENDICULAR), ("west", PERPENDICULAR)] {
        let found = row(&factors, place(&factors, name));
        let stated = factors.surfaces.row_error[place(&factors, name)];
        assert!(
            (found[sky] - exact).abs() < 1e-6 && stated < 3e-6,
            "{name}: {:e} {stated:e}",
            found[sky] - exact
        );
        assert!((found.iter().sum::<f64>() - 1.0).abs() <= stated);
    }
    // A unit square at height 1 above the middle of the floor: four times Howell B-3.
    let s = 0.5 / 1.25_f64.sqrt();
    let exact = 4.0 * s * s.atan() / std::f64::consts::PI;
    let seen = factors.points.unwrap().factors;
    assert!((seen[sky] - exact).abs() < 1e-12 && (seen.iter().sum::<f64>() - 1.0).abs() < 1e-12, "{seen:?}");
}

#[test]
fn points_in_a_closed_room_see_all_of_it() {
    let bench = bench();
    let plane = "0.05,0.05,0.15,0.9,0,0,0,0.9,0.3,5,4";
    let points = ["--plane", plane, "--point", "0.9,0.1,0.9,-1,0,0.5", "--point", "0.28,0.5,0.5,-1,0,0"];
    let factors = computed(&bench, &data("cubebox8.vs3"), &[&points[..], &["--tolerance", "1e-2"]].concat());
    let found = factors.points.as_ref().unwrap();
    assert_eq!((found.points.len(), found.points[0]), (22, [0.9, 0.1, 0.9]));
    // A plane's points follow those given one by one; it tilts by 0.3 over 0.9.
    let normal = [0.0, -0.3 / 0.9_f64.hypot(0.3), 0.9 / 0.9_f64.hypot(0.3)];
    assert!((0..3).all(|k| (found.normals[2][k] - normal[k]).abs() < 1e-15));
    for (k, seen) in found.factors.chunks(factors.len()).enumerate() {
        // Those inside the box see its dark insides.
        let inside = found.points[k].iter().all(|&x| (0.3..=0.7).contains(&x));
        let sum: f64 = seen.iter().sum();
        assert!(inside || (sum - 1.0).abs() < 1e-12, "{k}: {:e}", sum - 1.0);
    }
}

#[test]
fn closure_is_enforced_where_asked_for_and_stated() {
    let bench = bench();
    let plain = computed(&bench, &data("cubebox8.vs3"), &["--tolerance", "1e-2"]);
    assert!(record(&bench)["enforced"].is_null());
    let closed = computed(&bench, &data("cubebox8.vs3"), &["--tolerance", "1e-2", "--close"]);
    let worst = |factors: &ViewFactors| factors.defects().into_iter().fold(0.0, f64::max);
    assert!(worst(&plain) > 1e-5 && worst(&closed) < 1e-12, "{:e}", worst(&closed));
    let change = &record(&bench)["enforced"];
    assert!((change["closure_before"].as_f64().unwrap() - worst(&plain)).abs() < 1e-15);
    let (mut largest, area) = (0.0_f64, &closed.surfaces.area);
    for i in 0..closed.len() {
        let (before, after) = (row(&plain, i), row(&closed, i));
        assert!(after.iter().all(|&f| f >= 0.0));
        let back = |j: usize| row(&closed, j)[i] * area[j];
        assert!((0..closed.len()).step_by(97).all(|j| (after[j] * area[i] - back(j)).abs() < 1e-17));
        largest = before.iter().zip(&after).map(|(b, a)| (a - b).abs()).fold(largest, f64::max);
    }
    assert!((change["largest"].as_f64().unwrap() - largest).abs() < 1e-15);
}

#[test]
fn open_scenes_are_not_closed_without_a_sky() {
    let bench = bench();
    let refused = run(&bench, &data("parallel.obj"), &["--close", "-o", "F.npz"]);
    assert_eq!((refused.code, refused.stdout.as_str()), (2, ""));
    assert!(
        refused.stderr.contains("the scene is open") && refused.stderr.contains("--sky"),
        "{}",
        refused.stderr
    );
    assert!(is_untouched(&bench));
    let factors = computed(&bench, &data("parallel.obj"), &["--close", "--sky", "--tolerance", "1e-2"]);
    assert!(factors.row_sums.iter().all(|sum| (sum - 1.0).abs() < 1e-12));
    assert!((row(&factors, 0)[1] - PARALLEL).abs() < 1e-3);
}

#[test]
fn the_form_follows_the_name_or_the_option() {
    let bench = bench();
    let written = |arguments: &[&str]| {
        let run = run(&bench, &data("blocked.vs3"), arguments);
        assert_eq!(run.code, 0, "{}", run.stderr);
    };
    written(&["-o", "F.csv"]);
    written(&["-o", "F.vf"]);
    written(&["-o", "deep/er/F.dat", "--format", "view3d"]);
    let csv = fs::read_to_string(bench.path("F.csv")).unwrap();
    assert!(csv.starts_with(
        "name,area,emissivity,row_sum,row_error,row_dropped,a_1,b_2,blk_up_3,blk_dn_4\na_1,1,0.9,"
    ));
    let text = fs::read_to_string(bench.path("F.vf")).unwrap();
    let lines: Vec<&str> = text.lines().collect();
    assert_eq!(
        (lines[0], lines[1], lines[6], lines.len()),
        ("View3D 3.3 0 0 0 4            ", "1 1 0.25 0.25", "0.9 0.9 0.9 0.9", 7)
    );
    assert_eq!(text, fs::read_to_string(bench.path("deep/er/F.dat")).unwrap());
    let first: Vec<f64> = lines[2].split(' ').map(|word| word.parse().unwrap()).collect();
    assert!((first[1] - BLOCKED).abs() < 1e-4 && first[0] == 0.0);
    let picture = fs::read(bench.path("deep/er/F.png")).unwrap();
    assert!(
        picture.starts_with(b"\x89PNG")
            && fs::read_to_string(bench.path("F.svg")).unwrap().contains("Closure of 4 rows")
    );
    for name in ["F.png", "F.xyz", "F"] {
        let refused = run(&bench, &data("blocked.vs3"), &["-o", name]);
        assert!(refused.code == 2 && refused.stderr.contains("help: end"), "{name}: {}", refused.stderr);
    }
}

#[test]
fn what_goes_wrong_has_its_exit_code() {
    let bench = bench();
    let refused = |input: &str, arguments: &[&str], code: i32, hint: &str| {
        let run = run(&bench, input, arguments);
        assert_eq!((run.code, run.stdout.as_str()), (code, ""), "{arguments:?}: {}", run.stderr);
        assert!(run.stderr.contains(hint), "{hint}: {}", run.stderr);
    };
    let cube = data("cube8.vs3");
    refused(&cube, &["--method", "magic"], 2, "possible values: centre");
    refused(&cube, &["--point", "1,2,3"], 2, "write 6 finite numbers");
    refused(&cube, &["--plane", "0,0,0,1,0,0,2,0,0,3,3"], 2, "span an area");
    refused(&cube, &["--memory", "1MB"], 4, "--threshold");
    refused(&cube, &["--plane", "0,0,0,1,0,0,0,1,0,9999,9999", "--memory", "1GiB"], 4, "--memory");
    refused("missing.vs3", &[], 5, "missing.vs3");
    refused("missing.toml", &[], 5, "missing.toml");
    refused(&cube, &["-o", "scene.toml/F.npz"], 5, "scene.toml");
    fs::create_dir(bench.path("F.svg")).unwrap();
    refused(&cube, &["-o", "F.npz"], 5, "F.svg: it is a folder");
    let hostile = Path::new(env!("CARGO_MANIFEST_DIR")).join("crates/scene/tests/hostile/vs3");
    let files: Vec<PathBuf> = fs::read_dir(hostile).unwrap().map(|entry| entry.unwrap().path()).collect();
    assert!(files.len() >= 30);
    for file in files {
        refused(file.to_str().unwrap(), &["-o", "G.npz"], 2, &format!("{}:", file.display()));
    }
    assert!(!bench.path("G.npz").exists() && !bench.path("G.json").exists());
}

#[test]
fn info_tells_what_a_matrix_holds() {
    let bench = bench();
    let matrix = computed(&bench, &data("blocked.vs3"), &["--point", "0.5,0.5,0.9,0,0,-1"]);
    let info = bench.run(&["info", "F.npz"]);
    assert_eq!(info.code, 0, "{}", info.stderr);
    for figure in ["4 rows, 16 of 16 factors", "2.500000 m²", "row sums", "1 point"] {
        assert!(info.stdout.contains(figure), "{figure}: {}", info.stdout);
    }
    let record = bench.run(&["info", "F.json"]);
    assert!(
        record.stdout.contains("blocked.vs3") && record.stdout.contains("\"method\": \"row-budget\""),
        "{}",
        record.stdout
    );
    let bytes = fs::read(bench.path("F.npz")).unwrap();
    fs::write(bench.path("short.npz"), &bytes[..bytes.len() / 2]).unwrap();
    let short = bench.run(&["info", "short.npz"]);
    assert!(short.code == 2 && short.stderr.contains("short.npz"), "{}", short.stderr);
    assert_eq!(bench.run(&["info", "none.npz"]).code, 5);
    // Tables are told about by their record.
    let table = run(&bench, &data("blocked.vs3"), &["-o", "table.csv"]);
    assert_eq!(table.code, 0, "{}", table.stderr);
    let table = bench.run(&["info", "table.csv"]);
    assert!(table.code == 0 && table.stdout.contains("row sums"), "{}{}", table.stdout, table.stderr);
    fs::remove_file(bench.path("table.json")).unwrap();
    let alone = bench.run(&["info", "table.csv"]);
    assert!(alone.code == 5 && alone.stderr.contains("in the record beside it"), "{}", alone.stderr);
    let mut again = Vec::new();
    matrix.write_npz(&mut again).unwrap();
    assert!(again == bytes, "what is read and written again is the same file");
}

#[test]
fn what_a_file_asks_for_and_does_not_get_is_said() {
    let bench = bench();
    let text = fs::read_to_string(data("blocked.vs3"))
        .unwrap()
        .replace("C out=1 encl=0", "C eps=1e-5 emit=1 encl=1");
    fs::write(bench.path("asks.vs3"), text).unwrap();
    let run = run(&bench, "asks.vs3", &["-o", "F.npz"]);
    assert!(
        run.code == 0 && run.stderr.contains("emit=1") && run.stderr.contains("encl=1"),
        "{}",
        run.stderr
    );
    assert_eq!(record(&bench)["options"]["tolerance"], 1e-5);
    assert_eq!(record(&bench)["warnings"].as_array().unwrap().len(), 2);
}

#[test]
#[cfg(unix)]
fn an_interrupted_run_writes_nothing() {
    let bench = Bench::new(&furnace(40, &[0.5]));
    let mut command = Command::new(program());
    command.current_dir(bench.folder.path()).args([
        "viewfactors",
        "scene.toml",
        "-o",
        "F.npz",
        "--tolerance",
        "1e-9",
        "--threads",
        "1",
    ]);
    let mut child = command.stdout(Stdio::null()).stderr(Stdio::null()).spawn().unwrap();
    thread::sleep(Duration::from_millis(700));
    let started = Instant::now();
    assert!(Command::new("kill").args(["-INT", &child.id().to_string()]).status().unwrap().success());
    assert_eq!(child.wait().unwrap().code(), Some(130));
    assert!(started.elapsed() < Duration::from_millis(1500), "{:?}", started.elapsed());
    assert!(is_untouched(&bench));
}
