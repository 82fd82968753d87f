//! A room made in code, solved, compared and written: `cargo run --release --example room`.
//!
//! The lamp hangs at several heights; what comes out is the irradiance of the table with its stated
//! error. Of the last room the solvers are compared. A folder holds the results of one run.

use std::error::Error;

use fredholm::scene::Scene;
use fredholm::study::{CompareOptions, Quiet, ResultFolder, SolveOptions, compare, solve};

/// A closed room of 4 m × 3 m × 2.5 m with a square lamp of 1 m² at some height (m).
fn room(height: f64) -> Result<Scene, Box<dyn Error>> {
    let corners = [[1.5, 1.0], [1.5, 2.0], [2.5, 2.0], [2.5, 1.0]];
    let lamp: Vec<String> = corners.iter().map(|[x, y]| format!("[{x}, {y}, {height}]")).collect();
    let text = format!(
        r#"
        [materials.wall]
        reflectance = 0.6
        [materials.lamp]
        reflectance = 0.1
        exitance = 100
        [[surface]]
        name = "room"
        material = "wall"
        box = {{ min = [0, 0, 0], max = [4, 3, 2.5], inward = true }}
        [[surface]]
        name = "table"
        material = "wall"
        box = {{ min = [1, 1, 0], max = [2, 2, 0.8] }}
        [[surface]]
        name = "lamp"
        material = "lamp"
        quad = [{}]
        "#,
        lamp.join(", ")
    );
    Ok(Scene::from_str(&text, "room.toml")?)
}

fn main() -> Result<(), Box<dyn Error>> {
    let folder = std::env::temp_dir().join("fredholm-room");
    let options = SolveOptions { accuracy: Some(0.02), ..SolveOptions::default() };
    for height in [1.6, 2.0, 2.4] {
        let mut solved = solve(room(height)?, &options, &Quiet)?;
        let table = solved.surface("table").ok_or("there is no table")?;
        let (irradiance, error) = (table.irradiance[0], table.error[0]);
        println!("lamp at {height} m: {irradiance:.3} ± {error:.3} W/m² on the table");
        solved.write(&ResultFolder::claim(folder.join(format!("lamp-{height}")))?)?;
    }
    let solvers = ["gauss-seidel", "cg-theta", "lu"].map(str::to_owned).to_vec();
    let options = CompareOptions { solvers, ..CompareOptions::default() };
    let compared = ResultFolder::claim(folder.join("compared"))?;
    let (record, _) = compare(room(2.4)?, &options, &compared, &Quiet)?;
    for run in record.cases.iter().flat_map(|case| &case.runs) {
        println!("{}: {} iterations, error {:.1e}", run.solver, run.iterations, run.error);
    }
    println!("written to {}", folder.display());
    Ok(())
}
