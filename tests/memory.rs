//! What every command says it will hold, against what it held; and that none is killed under a
//! limit of the system.
//!
//! `cargo test --release --test memory -- --ignored --nocapture` prints the table of all runs; a
//! few short ones are tested always.

// A test that cannot run should panic, in its helpers too.
#![allow(clippy::unwrap_used)]
#![cfg(target_os = "linux")]

use std::fmt::Write;
use std::fs;
use std::path::{Path, PathBuf};
use std::process::{Command, Stdio};

use serde_json::Value;
use tempfile::TempDir;

const MIB: f64 = (1 << 20) as f64;
/// Below this the program itself is most of it.
const SMALL_PEAK: f64 = 25.0 * MIB;
/// No limit is below this share of it: the code of the program and its libraries need addresses
/// before it can refuse anything.
const CODE: f64 = 64.0 * MIB;
/// Predicted over held, and held over predicted.
const MOST_RATIO: f64 = 1.15;
/// Exit codes of runs that end by themselves: done, not converged or limited, refused, disagreeing.
const ORDERLY: [i32; 4] = [0, 3, 4, 6];

/// A run of the program.
struct Case {
    arguments: String,
    /// Whether the run does what it predicts, which `check` does not.
    predictable: bool,
}

/// What a run came to.
#[derive(Debug)]
struct Outcome {
    code: Option<i32>,
    /// Bytes, as they were stated first and last. Of links an estimate is stated first, and after
    /// every round what the next one is likely to leave.
    first: f64,
    predicted: f64,
    peak: f64,
    errors: String,
}

/// A folder with generated scenes.
struct Bench(TempDir);

impl Bench {
    fn new() -> Self {
        let bench = Self(tempfile::tempdir().unwrap());
        for n in [10, 20, 26, 30, 36, 90, 150] {
            bench.write(&format!("room{n}.toml"), &room(n, "\"grey\"", 400));
        }
        bench.write("colour20.toml", &room(20, "\"r\", \"g\", \"b\"", 400));
        bench.write("picture.toml", &room(6, "\"grey\"", 1600));
        bench.write("camera.toml", &room(6, "\"grey\"", 16384));
        bench.write("grid40.obj", &grid(40));
        bench.write("grid200.obj", &grid(200));
        bench.write("coupled.toml", &cube("lambda/4", 4, "solver = \"lu\""));
        bench.write("products.toml", &cube("lambda/6", 4, "solver = \"gmres\""));
        bench.write("map.toml", &cube("lambda/3", 300, "bounces = 1"));
        bench.write("fine.toml", &cube("lambda/40", 4, "bounces = 1"));
        bench
    }

    fn write(&self, name: &str, text: &str) {
        fs::write(self.0.path().join(name), text).unwrap();
    }

    /// Runs the program, with a limit on its address space in KiB where one is given.
    fn run(&self, arguments: &str, address_space: Option<u64>) -> Outcome {
        let limit = address_space.map_or_else(String::new, |kib| format!("ulimit -v {kib}; "));
        let program = assert_cmd::cargo::cargo_bin!("fredholm").display();
        let script = format!("{limit}exec '{program}' {arguments} --log json");
        let mut command = Command::new("sh");
        command.args(["-c", &script]).current_dir(self.0.path()).env("SCENES", scenes());
        let output = command.stdin(Stdio::null()).stdout(Stdio::null()).output().unwrap();
        let errors = String::from_utf8_lossy(&output.stderr).into_owned();
        let lines = || errors.lines().filter_map(|line| serde_json::from_str::<Value>(line).ok());
        let last = |key: &str| lines().filter_map(|line| line[key].as_f64()).next_back().unwrap_or(0.0);
        let (predicted, peak) = (last("predicted_bytes"), last("peak_bytes"));
        let first = lines().find_map(|line| line["predicted_bytes"].as_f64()).unwrap_or(0.0);
        let plain: Vec<&str> = errors.lines().filter(|line| !line.contains("\"progress\"")).collect();
        Outcome { code: output.status.code(), first, predicted, peak, errors: plain.join("\n") }
    }
}

fn scenes() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("scenes")
}

/// A closed room of 6 n² elements with a lamp for a ceiling, seen in a picture of `pixels` ×
/// `pixels`.
fn room(n: usize, bands: &str, pixels: usize) -> String {
    let walls = [
        ("floor", "white", "[[0, 0, 0], [1, 0, 0], [1, 1, 0], [0, 1, 0]]"),
        ("lamp", "lamp", "[[0, 0, 1], [0, 1, 1], [1, 1, 1], [1, 0, 1]]"),
        ("south", "white", "[[0, 0, 0], [0, 0, 1], [1, 0, 1], [1, 0, 0]]"),
        ("north", "white", "[[0, 1, 0], [1, 1, 0], [1, 1, 1], [0, 1, 1]]"),
        ("west", "white", "[[0, 0, 0], [0, 1, 0], [0, 1, 1], [0, 0, 1]]"),
        ("east", "white", "[[1, 0, 0], [1, 0, 1], [1, 1, 1], [1, 1, 0]]"),
    ];
    let mut text = format!(
        "bands = [{bands}]\n\
         [camera]\neye = [0.5, 0.1, 0.5]\ntarget = [0.5, 1, 0.4]\nwidth = {pixels}\nheight = {pixels}\n\
         [materials.white]\nreflectance = 0.6\n[materials.lamp]\nreflectance = 0.5\nexitance = 10\n"
    );
    for (name, material, quad) in walls {
        writeln!(
            text,
            "[[surface]]\nname = \"{name}\"\nmaterial = \"{material}\"\nquad = {quad}\ndivide = [{n}, {n}]"
        )
        .unwrap();
    }
    text
}

/// A plane of n × n quads.
fn grid(n: usize) -> String {
    let mut text = String::new();
    for j in 0..=n {
        (0..=n).for_each(|i| writeln!(text, "v {i} {j} 0").unwrap());
    }
    for j in 0..n {
        for i in 0..n {
            let a = j * (n + 1) + i + 1;
            writeln!(text, "f {a} {} {} {}", a + 1, a + n + 2, a + n + 1).unwrap();
        }
    }
    text
}

/// A cube of waves with a map of n × n points.
fn cube(edge: &str, n: usize, method: &str) -> String {
    format!(
        "[wave]\nfrequencies_hz = [1e9]\n{method}\n\
         [[source]]\nkind = \"plane-wave\"\ntravel = [0, 1, 0]\npolarisation = [0, 0, 1]\n\
         [[surface]]\nname = \"cube\"\nbox = {{ min = [-0.4, -0.4, -0.4], max = [0.4, 0.4, 0.4] }}\nedge = \"{edge}\"\n\
         [[receiver]]\nname = \"map\"\n\
         grid = {{ corner = [-3, -3, 0], u = [6, 0, 0], v = [0, 6, 0], columns = {n}, rows = {n} }}\n"
    )
}

fn cases(lines: &[&str]) -> Vec<Case> {
    let case = |line: &&str| Case {
        arguments: line.trim_start_matches('~').to_owned(),
        predictable: !line.starts_with('~'),
    };
    lines.iter().map(case).collect()
}

/// All runs agree with their prediction, and keep every limit, which is given as an option and set
/// by the system.
fn agree(cases: &[Case]) {
    let bench = Bench::new();
    let mut failures = String::new();
    println!("{:>9} {:>9} {:>9} {:>6}  run", "first", "predicted", "held", "ratio");
    for case in cases {
        let free = bench.run(&format!("{} --memory 4GiB", case.arguments), None);
        let ratio = free.predicted / free.peak;
        println!(
            "{:9.1} {:9.1} {:9.1} {ratio:6.2}  {} ({:?})",
            free.first / MIB,
            free.predicted / MIB,
            free.peak / MIB,
            case.arguments,
            free.code
        );
        let close =
            !case.predictable || free.peak < SMALL_PEAK || (1.0 / MOST_RATIO..=MOST_RATIO).contains(&ratio);
        if free.code.is_none_or(|code| !ORDERLY.contains(&code)) || !close {
            writeln!(failures, "{}: {ratio:.2}, {:?}\n{}", case.arguments, free.code, free.errors).unwrap();
        }
        let most = if case.predictable { free.predicted } else { free.peak };
        for share in [0.7, 1.5] {
            limited(&bench, case, share * most.max(CODE), &mut failures);
        }
    }
    assert!(failures.is_empty(), "{failures}");
}

/// A run that may take so many bytes, by its option and by the system.
fn limited(bench: &Bench, case: &Case, limit: f64, failures: &mut String) {
    let arguments = format!("{} --memory {limit:.0}", case.arguments);
    for address_space in [None, Some((limit / 1024.0) as u64)] {
        let run = bench.run(&arguments, address_space);
        let orderly = run.code.is_some_and(|code| ORDERLY.contains(&code));
        println!(
            "                    {:9.1}         under {:.1} MiB, {}: {:?}",
            run.peak / MIB,
            limit / MIB,
            if address_space.is_some() { "ulimit -v" } else { "--memory" },
            run.code
        );
        if !orderly || (run.peak > limit && run.peak > SMALL_PEAK) {
            let (held, limit) = (run.peak / MIB, limit / MIB);
            writeln!(
                failures,
                "{arguments} under {address_space:?}: {held:.1} of {limit:.1} MiB, {:?}\n{}",
                run.code, run.errors
            )
            .unwrap();
        }
    }
}

#[test]
fn short_runs_hold_what_they_said() {
    agree(&cases(&[
        "solve room20.toml -o out",
        "viewfactors grid40.obj -o F.npz",
        "waves coupled.toml -o out",
    ]));
}

#[test]
fn what_would_never_fit_is_refused_at_once() {
    let bench = Bench::new();
    for arguments in [
        "solve camera.toml -o out",
        "trace camera.toml --samples 4 --spp 1 -o out",
        "solve camera.toml --accuracy 5% -o out",
        "viewfactors grid200.obj -o F.npz",
    ] {
        let run = bench.run(&format!("{arguments} --memory 1GiB"), None);
        assert_eq!(run.code, Some(4), "{arguments}: {}", run.errors);
        assert!(run.peak < 100.0 * MIB && run.errors.contains("help: "), "{arguments}: {run:?}");
    }
}

#[test]
#[ignore = "takes minutes"]
fn all_commands_hold_what_they_said() {
    agree(&cases(&[
        "solve room20.toml -o out",
        "solve room30.toml -o out",
        "solve room36.toml -o out --threads 1",
        "solve room30.toml -o out --storage f32",
        "solve room26.toml -o out --solver lu",
        "solve room26.toml -o out --solver gmres",
        "solve colour20.toml -o out",
        "solve picture.toml -o out",
        "solve room10.toml -o out --discretisation galerkin-1",
        "solve room20.toml -o out --final-gather",
        "solve $SCENES/cornell_box.toml -o out",
        "solve $SCENES/leblond_furnished.toml -o out",
        "solve $SCENES/cornell_planar.toml --accuracy 2% -o out",
        "solve $SCENES/studio.toml --accuracy 10% -o out",
        "~check room30.toml",
        "~check room150.toml",
        "~check $SCENES/leblond_room_fine.toml",
        "converge room10.toml --levels 2 -o out",
        "compare room20.toml -o out",
        "spectrum room10.toml -o out",
        "shoot room30.toml --keep 4MiB -o out",
        "shoot room90.toml --keep 4MiB --max-shots 20 -o out",
        "viewfactors room20.toml --rows element -o F.npz",
        "viewfactors room20.toml --rows element --close -o F.csv",
        "viewfactors room26.toml --rows surface -o F.npz",
        "viewfactors room20.toml --threshold 0.01 -o F.npz",
        "viewfactors grid40.obj -o F.npz",
        "waves coupled.toml -o out",
        "waves products.toml -o out",
        "waves map.toml -o out",
        "waves fine.toml -o out",
        "waves $SCENES/waves/trihedral.toml -o out",
        "trace room90.toml --samples 8 -o out",
        "trace picture.toml --samples 8 --spp 1 -o out",
        "trace map.toml --samples 4096 --method surface-sampling -o out",
        "crosscheck room20.toml --to 5% -o out",
        "reference room20.toml --to 5% -o out",
    ]));
}
