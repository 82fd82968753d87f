//! `fredholm viewfactors --method`: every method by name, settings, refusals.

use std::fs;
use std::path::Path;

use fredholm::coupling::method::methods;
use fredholm::report::ViewFactors;
use serde_json::Value;

use crate::support::{Bench, Run, furnace};

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

fn run(bench: &Bench, input: &str, method: &str, arguments: &[&str]) -> Run {
    bench.run(&[&["viewfactors", input, "-o", "F.npz", "--method", method], arguments].concat())
}

fn computed(bench: &Bench, input: &str, method: &str, arguments: &[&str]) -> ViewFactors {
    let run = run(bench, input, method, arguments);
    assert_eq!(run.code, 0, "{method}: {}", run.stderr);
    ViewFactors::read_npz(&bench.path("F.npz")).unwrap()
}

fn entry(factors: &ViewFactors, i: usize, j: usize) -> f64 {
    let mut row = vec![0.0; factors.len()];
    factors.copy_row(i, &mut row);
    row[j]
}

fn record(bench: &Bench) -> Value {
    serde_json::from_slice(&fs::read(bench.path("F.json")).unwrap()).unwrap()
}

#[test]
fn every_method_computes_the_squares() {
    let bench = Bench::new("");
    for method in methods() {
        for (file, exact) in [("parallel.obj", PARALLEL), ("perp.obj", PERPENDICULAR)] {
            let factors = computed(&bench, &data(file), method.name(), &["-q"]);
            let (forth, back) = (entry(&factors, 0, 1), entry(&factors, 1, 0));
            let stated = factors.surfaces.row_error[0];
            let (error, allowed) = ((forth - exact).abs(), if method.convergent() { 1e-3 } else { 0.2 });
            assert!(forth > 0.0 && (forth - back).abs() < 1e-15, "{}: {forth} {back}", method.name());
            // Of Monte Carlo the stated error is one standard error.
            assert!(
                error <= 4.0 * stated + 1e-14 && error < allowed,
                "{} on {file}: {error:e}",
                method.name()
            );
            if method.name() != "auto" {
                assert_eq!(record(&bench)["pairs"], serde_json::json!({ method.name(): 1 }));
            }
        }
    }
}

#[test]
fn settings_decide_how_close_a_method_comes() {
    let bench = Bench::new("");
    let error = |method, setting| {
        let factors = computed(&bench, &data("parallel.obj"), method, &["--setting", setting, "-q"]);
        (entry(&factors, 0, 1) - PARALLEL).abs()
    };
    assert!(error("area-gauss", "12") < 1e-10 && error("area-gauss", "2") > 1e-6);
    assert!(error("contour", "1e-12") < 1e-10);
    assert!(error("monte-carlo", "100000,3") < 2e-3 && error("monte-carlo", "16") > 1e-6);
    let record = record(&bench);
    assert_eq!(record["options"]["setting"], "16 samples with seed 1");
}

#[test]
fn a_closed_room_closes_by_methods_that_know_no_approximation() {
    let bench = Bench::new(&furnace(3, &[0.5]));
    for method in ["schroeder-hanrahan", "contour", "point-polygon"] {
        let setting: &[&str] = if method == "schroeder-hanrahan" { &[] } else { &["--setting", "1e-9"] };
        let factors = computed(&bench, "scene.toml", method, &[setting, &["-q"]].concat());
        let worst = factors.row_sums.iter().map(|sum| (sum - 1.0).abs()).fold(0.0, f64::max);
        assert!(factors.len() == 54 && worst < 1e-8, "{method}: {worst:e}");
    }
}

#[test]
fn occluders_are_seen_or_the_pair_is_named() {
    let bench = Bench::new("");
    let factors = computed(&bench, &data("blocked.obj"), "point-polygon", &["--setting", "1e-8", "-q"]);
    assert!((entry(&factors, 0, 1) - BLOCKED).abs() < 1e-8);
    let refused = run(&bench, &data("blocked.obj"), "schroeder-hanrahan", &[]);
    assert_eq!(refused.code, 2, "{}", refused.stderr);
    assert!(
        refused.stderr.contains("element 0 (`") && refused.stderr.contains("and element 1 (`"),
        "{}",
        refused.stderr
    );
    assert!(refused.stderr.contains("use point-polygon or auto"), "{}", refused.stderr);
}

#[test]
fn the_number_of_threads_changes_no_bit() {
    let bench = Bench::new(&furnace(2, &[0.5]));
    for (method, setting) in [("monte-carlo", "64"), ("hemicube", "16")] {
        let files = |threads| {
            let run = run(&bench, "scene.toml", method, &["--setting", setting, "--threads", threads, "-q"]);
            assert_eq!(run.code, 0, "{}", run.stderr);
            fs::read(bench.path("F.npz")).unwrap()
        };
        assert!(files("1") == files("3"), "{method}");
    }
}

#[test]
fn settings_that_mean_nothing_are_refused() {
    let bench = Bench::new(&furnace(1, &[0.5]));
    for (method, arguments, hint) in [
        ("auto", ["--setting", "3"], "takes --tolerance"),
        ("hemicube", ["--setting", "7"], "an even resolution"),
        ("area-gauss", ["--setting", "many"], "usual one is order 8"),
        ("centre", ["--setting", "2"], "no setting"),
        ("hemicube", ["--tolerance", "1e-3"], "give its --setting"),
    ] {
        let refused = run(&bench, "scene.toml", method, &arguments);
        assert_eq!((refused.code, refused.stdout.as_str()), (2, ""), "{}", refused.stderr);
        assert!(refused.stderr.contains(hint), "{}", refused.stderr);
    }
    assert!(!bench.path("F.npz").exists());
}
