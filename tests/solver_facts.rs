//! The facts that M. Leblond states of radiosity matrices and schemes (Mathématiques et radiosité,
//! GdR ALP 2002), on scenes of the size and kind that he used.

// A test that cannot run should panic, in its helpers too.
#![allow(clippy::unwrap_used)]

use std::fs;
use std::path::Path;
use std::process::Command;
use std::sync::OnceLock;

use serde_json::Value;

const SCENES: [&str; 2] = ["leblond_room.toml", "leblond_furnished.toml"];

/// Runs a verb on a shipped scene and returns its record.
fn record(verb: &str, scene: &str, arguments: &[&str]) -> Value {
    let folder = tempfile::tempdir().unwrap();
    let scene = Path::new(env!("CARGO_MANIFEST_DIR")).join("scenes").join(scene);
    let mut command = Command::new(env!("CARGO_BIN_EXE_fredholm"));
    command.arg(verb).arg(scene).arg("--quiet").arg("-o").arg(folder.path()).args(arguments);
    let run = command.output().unwrap();
    assert!(run.status.success(), "{}", String::from_utf8_lossy(&run.stderr));
    serde_json::from_slice(&fs::read(folder.path().join(format!("{verb}.json"))).unwrap()).unwrap()
}

/// All solvers that the facts are about, run once on each scene.
const SOLVERS: &str = "jacobi,gauss-seidel,sur:omega=0.9,sur:omega=0.6,sor:omega=1.05,sor:omega=1.1,sor:omega=1.15,\
                       sor:omega=1.2,sor:omega=1.5,sor:omega=1.9,cg-psi,cg-theta,hgs1,hgs2";

/// The comparison on a scene.
fn compared(scene: &str) -> &'static Value {
    static RECORDS: OnceLock<Vec<Value>> = OnceLock::new();
    let records = RECORDS
        .get_or_init(|| SCENES.map(|scene| record("compare", scene, &["--solvers", SOLVERS])).to_vec());
    &records[SCENES.iter().position(|known| *known == scene).unwrap()]["cases"][0]
}

fn run<'a>(case: &'a Value, solver: &str) -> &'a Value {
    case["runs"].as_array().unwrap().iter().find(|run| run["solver"] == solver).unwrap()
}

/// Iterations to the tolerance.
fn iterations(case: &Value, solver: &str) -> u64 {
    let run = run(case, solver);
    assert_eq!(run["outcome"], "converged", "{solver}");
    run["iterations"].as_u64().unwrap()
}

fn residuals(case: &Value, solver: &str) -> Vec<f64> {
    let history = run(case, solver)["history"]["residual"].as_array().unwrap();
    history.iter().map(|residual| residual.as_f64().unwrap()).collect()
}

#[test]
fn the_matrices_are_what_the_theory_says() {
    for scene in SCENES {
        let record = record("spectrum", scene, &[]);
        let band = &record["bands"][0];
        let number = |name: &str| band[name].as_f64().unwrap();
        // Real eigenvalues, of modulus below 1.
        assert!(number("largest_imaginary") < 1e-12, "{scene}");
        assert!(number("reflection_radius") < 0.8, "{scene}");
        // ρ(L₁) < ρ(J) < 1, and ρ(L₁) below the largest reflectance.
        assert!(number("gauss_seidel_radius") < number("jacobi_radius") && number("jacobi_radius") < 1.0);
        assert!(number("gauss_seidel_radius") < 0.8, "{scene}");
        assert_eq!((&band["m_matrix"], &band["stieltjes"]), (&Value::Bool(true), &Value::Bool(true)));
        assert_eq!(band["irreducible"], true);
        assert_eq!(number("symmetry_defect").to_bits(), 0.0_f64.to_bits());
        // cond₂(Θ) ≤ cond₂(Ψ).
        assert!(number("condition_theta") <= number("condition_psi"), "{scene}");
        // The eigenvalues of Θ are those of Φ: 1 − those of R F.
        let values = |matrix: &str| -> Vec<f64> {
            let all = band["eigenvalues"].as_array().unwrap();
            let found = all.iter().find(|one| one["matrix"] == matrix).unwrap();
            let mut values: Vec<f64> =
                found["values"].as_array().unwrap().iter().map(|value| value[0].as_f64().unwrap()).collect();
            values.sort_by(f64::total_cmp);
            values
        };
        let (theta, mut reflection) = (values("theta"), values("reflection"));
        reflection.reverse();
        assert!(theta.iter().zip(&reflection).all(|(theta, rf)| (theta + rf - 1.0).abs() < 1e-12), "{scene}");
    }
}

#[test]
fn relaxations_rank_as_the_theory_says() {
    for scene in SCENES {
        let count = |solver| iterations(compared(scene), solver);
        assert!(count("gauss-seidel") < count("jacobi"), "{scene}");
        assert!(count("gauss-seidel") < count("sur:omega=0.9"), "{scene}");
        assert!(count("sur:omega=0.9") < count("sur:omega=0.6"), "{scene}");
        // With 1 < ω < 2 it converges, for whatever good it does.
        assert!(count("sor:omega=1.5") < count("sor:omega=1.9"), "{scene}");
    }
}

#[test]
fn some_over_relaxation_is_faster_than_gauss_seidel() {
    for scene in SCENES {
        let count = |solver| iterations(compared(scene), solver);
        let some = ["sor:omega=1.05", "sor:omega=1.1", "sor:omega=1.15", "sor:omega=1.2"];
        assert!(some.map(count).iter().any(|&found| found < count("gauss-seidel")), "{scene}");
    }
}

#[test]
fn conjugate_gradients_on_theta_are_faster_than_on_psi() {
    for scene in SCENES {
        let count = |solver| iterations(compared(scene), solver);
        assert!(count("cg-theta") < count("cg-psi"), "{scene}");
    }
}

#[test]
fn high_reflectance_touches_conjugate_gradients_less_than_gauss_seidel() {
    for scene in SCENES {
        let sweep = ["--solvers", "gauss-seidel,cg-theta", "--sweep", "reflectance=0.3..0.99:2"];
        let record = record("compare", scene, &sweep);
        let growth = |solver| {
            let [low, high] = [0, 1].map(|case| iterations(&record["cases"][case], solver) as f64);
            high / low
        };
        assert!(growth("cg-theta") < growth("gauss-seidel"), "{scene}");
    }
}

#[test]
fn residuals_of_the_hybrids_are_never_above_those_of_gauss_seidel() {
    for scene in SCENES {
        let seidel = residuals(compared(scene), "gauss-seidel");
        for solver in ["hgs1", "hgs2"] {
            for (k, (hybrid, seidel)) in residuals(compared(scene), solver).iter().zip(&seidel).enumerate() {
                assert!(hybrid <= &(seidel * (1.0 + 1e-10)), "{scene}, {solver}, {k}: {hybrid:e} {seidel:e}");
            }
        }
    }
}
