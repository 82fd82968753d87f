//! Solves a scene to an accuracy and prints its rounds, with the true error where a reference is given:
//! `cargo run --release -p fredholm-hierarchical --example rounds -- SCENE ACCURACY [constant|linear] [REFERENCE.csv]`.

use fredholm_hierarchical::{
    HierarchyError, Options, Problem, RESIDUAL, Round, Solution, Solvers, State, Stated, Surfaces, Watch,
    solve,
};
use fredholm_iterative::{CgTheta, Gmres};
use fredholm_linop::MultiVector;
use fredholm_mesh::Mesh;
use fredholm_scene::Scene;
use fredholm_visibility::Occluders;
use std::error::Error;

/// The solver of the command line, and the one that takes its place.
const SOLVERS: Solvers = Solvers { first: &CgTheta, fallback: &Gmres { restart: 50 } };

/// Prints every round.
struct Print;

impl Watch for Print {
    fn round(&self, rounds: &[Round], _: &State) -> Result<(), HierarchyError> {
        rounds.last().map_or(Ok(()), |round| {
            print(round);
            Ok(())
        })
    }
}

fn print(round: &Round) {
    let change = round.change.map_or_else(|| "-".to_owned(), |change| format!("{:.3} %", 100.0 * change));
    let (elements, links) = (round.elements, round.links);
    let per = links as f64 / elements as f64;
    println!(
        "{:9.2e} {elements:9} {links:10} {per:13.1} {change:>10} {:8.2} s",
        round.threshold,
        cpu_seconds()
    );
}

/// Processor time of this program so far, where the system tells.
fn cpu_seconds() -> f64 {
    let stat = std::fs::read_to_string("/proc/self/stat").unwrap_or_default();
    let ticks = stat.split(' ').skip(13).take(2).filter_map(|ticks| ticks.parse::<f64>().ok());
    ticks.sum::<f64>() / 100.0
}

fn main() -> Result<(), Box<dyn Error>> {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    let [path, accuracy, rest @ ..] = &arguments[..] else {
        return Err("give a scene and an accuracy".into());
    };
    let (scene, accuracy) = (Scene::load(path)?, accuracy.parse()?);
    let mesh = scene.face_mesh()?;
    let (rows, bands) = (mesh.len(), scene.bands().len());
    let surfaces = Surfaces {
        reflectance: MultiVector::from_vec(rows, bands, scene.reflectance(&mesh))?,
        exitance: MultiVector::from_vec(rows, bands, scene.exitance(&mesh))?,
    };
    let occluders = Occluders::new(mesh.occluders())?;
    let problem = Problem { mesh: &mesh, occluders: &occluders, surfaces: &surfaces, goal: None };
    let linear = rest.first().is_none_or(|order| order != "constant");
    let residual = RESIDUAL * accuracy;
    let options = Options { accuracy, linear, residual, bytes: 8 << 30, max_iterations: 200 };
    println!("threshold  elements      links links/element     change        CPU");
    let solution = solve(&problem, &options, SOLVERS, None, &Print)?;
    solution.rounds.last().into_iter().for_each(print);
    println!("stated error {:.3} %", 100.0 * solution.error.as_ref().map_or(f64::NAN, Stated::worst));
    if let Some(file) = rest.get(1) {
        let (l2, rms) = errors(&mesh, &solution, scene.bands(), file)?;
        println!("true error {:.3} % (L2, worst band), {:.3} % (RMS over faces)", 100.0 * l2, 100.0 * rms);
    }
    Ok(())
}

/// Relative L2 error of the worst band and root mean square over faces and bands against a reference.
fn errors(
    mesh: &Mesh,
    solution: &Solution,
    bands: &[String],
    file: &str,
) -> Result<(f64, f64), Box<dyn Error>> {
    let text = std::fs::read_to_string(file)?;
    let table: Vec<Vec<&str>> = text.lines().map(|line| line.split(',').collect()).collect();
    let found = faces(mesh, solution, bands.len());
    let (mut worst, mut squares, mut count) = (0.0, 0.0, 0.0);
    for (band, name) in bands.iter().enumerate() {
        let column = if bands.len() == 1 { "E".to_owned() } else { format!("E_{name}") };
        let at = |name: &str| table[0].iter().position(|title| *title == name).ok_or("a column is missing");
        let (surface, e) = (at("surface")?, at(&column)?);
        let centre = [at("cx")?, at("cy")?, at("cz")?];
        let (mut error, mut norm) = (0.0, 0.0);
        for (face, value) in mesh.faces().iter().zip(found.chunks(bands.len())) {
            let near = |row: &&Vec<&str>| {
                let place = centre.map(|c| row[c].parse().unwrap_or(f64::NAN));
                let here = face.centroid.to_array();
                row[surface] == mesh.surfaces()[face.surface].name
                    && (0..3).all(|k| (place[k] - here[k]).abs() < 1e-6)
            };
            let exact: f64 = table[1..].iter().find(near).ok_or("a face is missing")?[e].parse()?;
            let difference = value[band] - exact;
            error += face.area * difference * difference;
            norm += face.area * exact * exact;
            if exact > 0.0 {
                squares += (difference / exact).powi(2);
                count += 1.0;
            }
        }
        worst = f64::max(worst, (error / norm).sqrt());
    }
    Ok((worst, (squares / count).sqrt()))
}

/// Irradiance of the faces, faces × bands, W/m².
fn faces(mesh: &Mesh, solution: &Solution, bands: usize) -> Vec<f64> {
    let mut sums = vec![0.0; mesh.faces().len() * bands];
    for (i, leaf) in solution.tree.leaves().into_iter().enumerate() {
        let node = &solution.tree.nodes()[leaf as usize];
        let Some(face) = node.face() else { continue };
        for (band, e) in solution.means.irradiance.row(i).iter().enumerate() {
            sums[face * bands + band] += e * node.area() / mesh.faces()[face].area;
        }
    }
    sums
}
