//! Solves a scene to an accuracy and prints its rounds, with the true error where a reference is
//! given:
//! `cargo run --release -p fredholm-hierarchical --example rounds -- SCENE ACCURACY [constant|linear] [REFERENCE.csv]`.

use fredholm_hierarchical::{
    HierarchyError, Options, Problem, RESIDUAL_OVER_ACCURACY, Round, RoundWatch, Solution, Solvers, State,
    Stated, Surfaces, solve,
};
use fredholm_iterative::{CgTheta, Gmres};
use fredholm_linop::{MultiVector, Watch};
use fredholm_mesh::Mesh;
use fredholm_scene::Scene;
use fredholm_visibility::Occluders;
use std::collections::HashMap;
use std::error::Error;

/// The solver of the command line, and the one that takes its place.
const SOLVERS: Solvers = Solvers { first: &CgTheta, fallback: &Gmres { restart: 50 } };

/// Prints every round, with its true error where that is known.
struct Print<'a> {
    mesh: &'a Mesh,
    reference: Option<Vec<f64>>,
}

impl Watch for Print<'_> {}

impl RoundWatch for Print<'_> {
    fn round(&self, rounds: &[Round], state: &State) -> Result<(), HierarchyError> {
        if let Some(round) = rounds.last() {
            self.print(round, state.irradiance());
        }
        Ok(())
    }
}

impl Print<'_> {
    /// Prints a round and what is off in the irradiances of its faces, faces × bands, W/m².
    fn print(&self, round: &Round, found: &[f64]) {
        let change = round.change.map_or_else(|| "-".to_owned(), |change| format!("{:.3} %", 100.0 * change));
        let (elements, links) = (round.elements, round.links);
        let per = links as f64 / elements as f64;
        let truth = self.reference.as_ref().map_or_else(String::new, |reference| {
            let (l2, rms) = errors(self.mesh, found, reference);
            format!("   true {:.3} % (L2), {:.3} % (RMS over faces)", 100.0 * l2, 100.0 * rms)
        });
        println!(
            "{:9.2e} {elements:9} {links:10} {per:13.1} {change:>10} {:8.2} s{truth}",
            round.threshold,
            cpu_seconds()
        );
    }
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
    let residual = RESIDUAL_OVER_ACCURACY * accuracy;
    let options = Options { accuracy, linear, residual, bytes: 8 << 30, max_iterations: 200 };
    let reference = rest.get(1).map(|file| read(&mesh, scene.bands(), file)).transpose()?;
    let print = Print { mesh: &mesh, reference };
    println!("threshold  elements      links links/element     change        CPU");
    let solution = solve(&problem, &options, SOLVERS, None, &print)?;
    if let Some(round) = solution.rounds.last() {
        print.print(round, &faces(&mesh, &solution, bands));
    }
    println!("stated error {:.3} %", 100.0 * solution.error.as_ref().map_or(f64::NAN, Stated::worst));
    Ok(())
}

/// The irradiances of a table of faces, faces × bands, W/m².
fn read(mesh: &Mesh, bands: &[String], file: &str) -> Result<Vec<f64>, Box<dyn Error>> {
    let text = std::fs::read_to_string(file)?;
    let mut lines = text.lines().map(|line| line.split(',').collect::<Vec<&str>>());
    let titles = lines.next().ok_or("the table is empty")?;
    let at = |name: &str| titles.iter().position(|title| *title == name).ok_or("a column is missing");
    let (surface, centre) = (at("surface")?, [at("cx")?, at("cy")?, at("cz")?]);
    let columns = bands.iter().map(|name| {
        // A table of one band need not name it.
        at(&format!("E_{name}")).or_else(|_| at(&format!("irradiance_{name}"))).or_else(|_| at("E"))
    });
    let columns: Vec<usize> = columns.collect::<Result<_, _>>()?;
    let mut places: HashMap<(String, [i64; 3]), Vec<f64>> = HashMap::new();
    for row in lines {
        let [x, y, z] = centre.map(|c| row[c].parse().map_or(i64::MAX, rounded));
        let values = columns.iter().map(|&c| row[c].parse()).collect::<Result<_, _>>()?;
        places.insert((row[surface].to_owned(), [x, y, z]), values);
    }
    let mut values = Vec::with_capacity(mesh.faces().len() * bands.len());
    for face in mesh.faces() {
        let key = (mesh.surfaces()[face.surface].name.clone(), face.centroid.to_array().map(rounded));
        values.extend(places.get(&key).ok_or("a face is missing")?);
    }
    Ok(values)
}

/// A coordinate in units that tell faces apart and forgive what is rounded in a table.
fn rounded(x: f64) -> i64 {
    (x * 1e6 + 0.25).round() as i64
}

/// Relative L2 error of the worst band and root mean square over faces and bands against a
/// reference.
fn errors(mesh: &Mesh, found: &[f64], reference: &[f64]) -> (f64, f64) {
    let bands = found.len() / mesh.faces().len();
    let (mut worst, mut squares, mut count) = (0.0, 0.0, 0.0);
    for band in 0..bands {
        let (mut error, mut norm) = (0.0, 0.0);
        for (k, face) in mesh.faces().iter().enumerate() {
            let exact = reference[k * bands + band];
            let difference = found[k * bands + band] - exact;
            error += face.area * difference * difference;
            norm += face.area * exact * exact;
            if exact > 0.0 {
                squares += (difference / exact).powi(2);
                count += 1.0;
            }
        }
        worst = f64::max(worst, (error / norm).sqrt());
    }
    (worst, (squares / count).sqrt())
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
