//! The mean irradiance of a surface, from solutions to the accuracy of everything and to that of
//! the surface alone, against one that is refined much further:
//! `cargo run --release -p fredholm-hierarchical --example goal -- SCENE SURFACE[,SURFACE] ACCURACY...`.

use fredholm_hierarchical::{
    Goal, Options, Problem, RESIDUAL_OVER_ACCURACY, Solution, Solvers, Stated, Surfaces, solve,
};
use fredholm_iterative::{CgTheta, Gmres};
use fredholm_linop::{MultiVector, Quiet};
use fredholm_mesh::Mesh;
use fredholm_scene::Scene;
use fredholm_visibility::Occluders;
use std::error::Error;

/// The solver of the command line, and the one that takes its place.
const SOLVERS: Solvers = Solvers { first: &CgTheta, fallback: &Gmres { restart: 50 } };

/// Accuracy of everything in the solution that the others are compared with.
const OVER_REFINED: f64 = 2e-3;

fn main() -> Result<(), Box<dyn Error>> {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    let [path, names, accuracies @ ..] = &arguments[..] else {
        return Err("give a scene, a surface and accuracies".into());
    };
    let scene = Scene::load(path)?;
    let (mesh, bands) = (scene.face_mesh()?, scene.bands().len());
    let surfaces = Surfaces {
        reflectance: MultiVector::from_vec(mesh.len(), bands, scene.reflectance(&mesh))?,
        exitance: MultiVector::from_vec(mesh.len(), bands, scene.exitance(&mesh))?,
    };
    let occluders = Occluders::new(mesh.occluders())?;
    let goal = Goal::new(&mesh, &names.split(',').collect::<Vec<_>>())?;
    let everywhere = Problem { mesh: &mesh, occluders: &occluders, surfaces: &surfaces, goal: None };
    let there = Problem { goal: Some(&goal), ..everywhere };
    let exact = means(&goal, &mesh, &to(&everywhere, OVER_REFINED)?);
    println!(
        "{:>10} {:>9} {:>9} {:>9} {:>9} {:>9} {:>8}",
        "for", "accuracy", "links", "elements", "stated", "true", "CPU s"
    );
    for accuracy in accuracies {
        for (name, problem) in [("everything", &everywhere), ("the goal", &there)] {
            let start = cpu_seconds();
            let solution = to(problem, accuracy.parse()?)?;
            let spent = cpu_seconds() - start;
            let found = means(&goal, &mesh, &solution);
            let error = found.iter().zip(&exact).map(|(e, x)| (e / x - 1.0).abs()).fold(0.0, f64::max);
            let stated = solution.error.as_ref().map_or(f64::NAN, Stated::worst);
            let percent = [stated, error].map(|x| format!("{:.3} %", 100.0 * x));
            let (links, elements) = (solution.links.len(), solution.system.elements().len());
            println!(
                "{name:>10} {accuracy:>9} {links:>9} {elements:>9} {:>9} {:>9} {spent:8.2}",
                percent[0], percent[1]
            );
        }
    }
    Ok(())
}

fn to(problem: &Problem, accuracy: f64) -> Result<Solution, Box<dyn Error>> {
    let residual = RESIDUAL_OVER_ACCURACY * accuracy;
    let options = Options { accuracy, linear: true, residual, bytes: 8 << 30, max_iterations: 200 };
    Ok(solve(problem, &options, SOLVERS, None, &Quiet)?)
}

/// Mean irradiance of the goal, W/m².
fn means(goal: &Goal, mesh: &Mesh, solution: &Solution) -> Vec<f64> {
    let bands = solution.means.irradiance.rhs_count();
    let mut faces = vec![0.0; mesh.faces().len() * bands];
    for (i, leaf) in solution.tree.leaves().into_iter().enumerate() {
        let node = &solution.tree.nodes()[leaf as usize];
        let Some(face) = node.face() else { continue };
        for (band, e) in solution.means.irradiance.row(i).iter().enumerate() {
            faces[face * bands + band] += e * node.area() / mesh.faces()[face].area;
        }
    }
    goal.means(mesh, &faces, bands)
}

/// Processor time of this program so far, where the system tells.
fn cpu_seconds() -> f64 {
    let stat = std::fs::read_to_string("/proc/self/stat").unwrap_or_default();
    let ticks = stat.split(' ').skip(13).take(2).filter_map(|ticks| ticks.parse::<f64>().ok());
    ticks.sum::<f64>() / 100.0
}
