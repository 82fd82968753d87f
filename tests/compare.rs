//! `fredholm compare` and `fredholm spectrum`: files, agreement of the solvers, refusals, exit
//! codes, the same residuals for any number of threads.

// A test that cannot run should panic, in its helpers too.
#![allow(clippy::unwrap_used)]

use std::fs;
use std::path::Path;
use std::process::Command;

use serde_json::Value;
use tempfile::TempDir;

/// A closed room of two bands, one wall black, with a shelf in it.
const ROOM: &str = "\
bands = [\"r\", \"g\"]
elements_per_face = 1
[materials.wall]
reflectance = [0.7, 0.4]
[materials.black]
reflectance = 0.0
[materials.lamp]
reflectance = 0.3
exitance = [5.0, 2.0]
[[surface]]
name = \"floor\"
material = \"wall\"
quad = [[0, 0, 0], [2, 0, 0], [2, 1, 0], [0, 1, 0]]
divide = [6, 3]
[[surface]]
name = \"ceiling\"
material = \"lamp\"
quad = [[0, 0, 1], [0, 1, 1], [2, 1, 1], [2, 0, 1]]
divide = [3, 6]
[[surface]]
name = \"west\"
material = \"black\"
quad = [[0, 0, 0], [0, 1, 0], [0, 1, 1], [0, 0, 1]]
divide = [3, 3]
[[surface]]
name = \"east\"
material = \"wall\"
quad = [[2, 1, 0], [2, 0, 0], [2, 0, 1], [2, 1, 1]]
divide = [3, 3]
[[surface]]
name = \"south\"
material = \"wall\"
quad = [[2, 0, 0], [0, 0, 0], [0, 0, 1], [2, 0, 1]]
divide = [6, 3]
[[surface]]
name = \"north\"
material = \"wall\"
quad = [[0, 1, 0], [2, 1, 0], [2, 1, 1], [0, 1, 1]]
divide = [6, 3]
[[surface]]
name = \"shelf\"
material = \"wall\"
box = { min = [0.8, 0.3, 0.3], max = [1.2, 0.7, 0.5] }
";

struct Bench(TempDir);

struct Run {
    code: i32,
    stdout: String,
    stderr: String,
}

impl Bench {
    fn new(scene: &str) -> Self {
        let folder = tempfile::tempdir().unwrap();
        fs::write(folder.path().join("scene.toml"), scene).unwrap();
        Self(folder)
    }

    fn run(&self, arguments: &[&str]) -> Run {
        let mut command = Command::new(env!("CARGO_BIN_EXE_fredholm"));
        let output = command.current_dir(self.0.path()).args(arguments).output().unwrap();
        let text = |bytes| String::from_utf8(bytes).unwrap();
        Run { code: output.status.code().unwrap(), stdout: text(output.stdout), stderr: text(output.stderr) }
    }

    fn json(&self, path: &str) -> Value {
        serde_json::from_slice(&fs::read(self.0.path().join(path)).unwrap()).unwrap()
    }

    fn compare(&self, folder: &str, arguments: &[&str]) -> Value {
        let run = self.run(&[&["compare", "scene.toml", "-o", folder], arguments].concat());
        assert_eq!(run.code, 0, "{}", run.stderr);
        self.json(&format!("{folder}/compare.json"))
    }
}

fn runs(record: &Value, case: usize) -> &Vec<Value> {
    record["cases"][case]["runs"].as_array().unwrap()
}

#[test]
fn all_solvers_reach_the_answer_of_elimination() {
    let bench = Bench::new(ROOM);
    let record = bench.compare("all", &["--to", "1e-12"]);
    assert!(runs(&record, 0).len() >= 27);
    assert_eq!(record["cases"][0]["reference"], "lu");
    for run in runs(&record, 0) {
        assert_eq!(run["outcome"], "converged", "{run}");
        assert!(run["error"].as_f64().unwrap() < 1e-10, "{run}");
        let history = run["history"]["residual"].as_array().unwrap();
        assert_eq!(history.len() as u64, run["iterations"].as_u64().unwrap() + 1);
        assert!((history[0].as_f64().unwrap() - 1.0).abs() < 1e-15);
        assert_eq!(run["history"]["entries"].as_array().unwrap().last(), Some(&run["entries"]));
    }
    for name in ["compare.csv", "compare_history.csv", "compare.svg"] {
        assert!(bench.0.path().join("all").join(name).is_file(), "{name}");
    }
    assert!(!bench.0.path().join("all/compare_sweep.svg").exists());
}

#[test]
fn the_number_of_threads_changes_no_residual() {
    let bench = Bench::new(ROOM);
    let residuals = |threads: &str| -> Vec<Value> {
        let record = bench.compare(&format!("on{threads}"), &["--threads", threads]);
        runs(&record, 0).iter().map(|run| run["history"]["residual"].clone()).collect()
    };
    let one = residuals("1");
    assert_eq!(one, residuals("2"));
    assert_eq!(one, residuals("4"));
}

#[test]
fn a_sweep_has_a_case_for_every_reflectance() {
    let bench = Bench::new(ROOM);
    let solvers = "gauss-seidel,cg-theta,sor:omega=1.1";
    let record = bench.compare("sweep", &["--solvers", solvers, "--sweep", "reflectance=0.2..0.9:3"]);
    let cases = record["cases"].as_array().unwrap();
    let values: Vec<f64> = cases.iter().map(|case| case["reflectance"].as_f64().unwrap()).collect();
    assert!(values.iter().zip([0.2, 0.55, 0.9]).all(|(value, exact)| (value - exact).abs() < 1e-12));
    let iterations = |case: usize, solver: usize| runs(&record, case)[solver]["iterations"].as_u64().unwrap();
    assert!(iterations(0, 0) < iterations(1, 0) && iterations(1, 0) < iterations(2, 0));
    assert_eq!(runs(&record, 0)[2]["solver"], "sor:omega=1.1");
    assert!(bench.0.path().join("sweep/compare_sweep.svg").is_file());
}

#[test]
fn bad_usage_is_2_and_no_convergence_is_3_with_the_results_written() {
    let bench = Bench::new(ROOM);
    for (arguments, hint) in [
        (["--solvers", "magic"], "known are gauss-seidel"),
        (["--solvers", "sor:omega=2"], "a number between 0 and 2"),
        (["--solvers", "lu:omega=1"], "its options: none"),
        (["--sweep", "occlusion=0..1"], "reflectance=LOW..HIGH"),
        (["--to", "2"], "such as 1e-6"),
    ] {
        let run = bench.run(&[&["compare", "scene.toml"][..], &arguments].concat());
        assert_eq!((run.code, run.stdout.as_str()), (2, ""), "{arguments:?}");
        assert!(run.stderr.contains(hint), "{}", run.stderr);
    }
    let run =
        bench.run(&["compare", "scene.toml", "--solvers", "neumann", "--max-iterations", "2", "-o", "few"]);
    assert_eq!(run.code, 3, "{}", run.stderr);
    assert!(run.stderr.contains("neumann: not converged after 2 iterations"), "{}", run.stderr);
    assert_eq!(bench.json("few/compare.json")["cases"][0]["runs"][0]["outcome"], "not converged");
    let refused = bench.run(&["compare", "missing.toml"]);
    assert_eq!(refused.code, 5, "{}", refused.stderr);
    let other = Bench::new(&format!("{ROOM}\n[solve]\ndiscretisation = \"galerkin-1\"\n"));
    for verb in ["compare", "spectrum"] {
        let run = other.run(&[verb, "scene.toml"]);
        assert!(run.code == 2 && run.stderr.contains("galerkin-0"), "{}", run.stderr);
    }
}

#[test]
fn a_solver_that_does_not_fit_the_memory_is_refused_and_the_others_run() {
    let walls = ROOM.replace("divide = [6, 3]", "divide = [24, 12]");
    let bench = Bench::new(&walls);
    let record = bench.compare("small", &["--solvers", "gauss-seidel,lu", "--memory", "24MB"]);
    let outcomes: Vec<&str> = runs(&record, 0).iter().map(|run| run["outcome"].as_str().unwrap()).collect();
    assert_eq!(outcomes, ["converged", "refused"]);
    assert!(runs(&record, 0)[1]["reason"].as_str().unwrap().contains("bytes"));
    assert_eq!(record["cases"][0]["reference"], "gauss-seidel");
}

#[test]
fn estimates_agree_with_dense_methods() {
    let bench = Bench::new(ROOM);
    let analysed = |folder: &str, arguments: &[&str]| {
        let run = bench.run(&[&["spectrum", "scene.toml", "-o", folder], arguments].concat());
        assert_eq!(run.code, 0, "{}", run.stderr);
        assert!(Path::new(&bench.0.path().join(folder).join("spectrum.svg")).is_file());
        bench.json(&format!("{folder}/spectrum.json"))
    };
    let dense = analysed("dense", &[]);
    let estimated = analysed("lanczos", &["--dense", "0", "--steps", "40"]);
    assert_eq!((dense["method"].as_str(), estimated["method"].as_str()), (Some("dense"), Some("lanczos")));
    for band in 0..2 {
        for quantity in ["reflection_radius", "gauss_seidel_radius", "condition_theta"] {
            let [exact, found] =
                [&dense, &estimated].map(|record| record["bands"][band][quantity].as_f64().unwrap());
            assert!((found / exact - 1.0).abs() < 1e-6, "{quantity}: {exact} {found}");
        }
    }
    // What a black wall sends nothing to cannot be reached from it.
    assert_eq!(dense["bands"][0]["irreducible"], false);
}
