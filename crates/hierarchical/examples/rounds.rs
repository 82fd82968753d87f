//! Solves a scene to an accuracy and prints its rounds: `cargo run --release -p fredholm-hierarchical --example rounds -- scenes/cornell_planar.toml 0.01 [FACES.csv]`.

use fredholm_hierarchical::{HierarchyError, Options, Problem, Round, State, Surfaces, Watch, solve};
use fredholm_iterative::CgTheta;
use fredholm_linop::MultiVector;
use fredholm_scene::Scene;
use fredholm_visibility::Occluders;
use std::error::Error;
use std::io::Write;

struct Print;

impl Watch for Print {
    fn round(&self, rounds: &[Round], _: &State) -> Result<(), HierarchyError> {
        print(&rounds[rounds.len() - 1]);
        Ok(())
    }
}

fn print(round: &Round) {
    let change = round.change.map_or_else(|| "-".to_owned(), |change| format!("{:.3} %", 100.0 * change));
    let per = round.links as f64 / round.elements as f64;
    println!(
        "{:9.2e} {:9} {:10} {per:6.1} {change:>10} {:8.2} s",
        round.threshold,
        round.elements,
        round.links,
        cpu()
    );
}

fn cpu() -> f64 {
    let stat = std::fs::read_to_string("/proc/self/stat").unwrap_or_default();
    let ticks: Vec<f64> = stat.split(' ').skip(13).take(2).filter_map(|t| t.parse().ok()).collect();
    ticks.iter().sum::<f64>() / 100.0
}

fn main() -> Result<(), Box<dyn Error>> {
    let mut args = std::env::args().skip(1);
    let (path, accuracy) = (args.next().ok_or("give a scene")?, args.next().ok_or("give an accuracy")?);
    let scene = Scene::load(&path)?;
    let mesh = scene.face_mesh()?;
    let (rows, bands) = (mesh.len(), scene.bands().len());
    let surfaces = Surfaces {
        reflectance: MultiVector::from_vec(rows, bands, scene.reflectance(&mesh))?,
        exitance: MultiVector::from_vec(rows, bands, scene.exitance(&mesh))?,
    };
    let occluders = Occluders::new(mesh.occluders())?;
    let problem = Problem { mesh: &mesh, occluders: &occluders, surfaces: &surfaces };
    let options = Options {
        accuracy: accuracy.parse()?,
        linear: std::env::var_os("CONSTANT").is_none(),
        residual: 1e-5,
        bytes: 8 << 30,
        max_iterations: 200,
    };
    println!("threshold  elements      links  links/  change       CPU");
    let solution = solve(&problem, &options, &CgTheta, None, &Print)?;
    print(&solution.rounds[solution.rounds.len() - 1]);
    closure(&solution);
    println!("stated error {:.3} %", 100.0 * solution.error.as_ref().map_or(f64::NAN, |error| error.worst()));
    if let Some(file) = args.next() {
        faces(&mesh, &solution, scene.bands(), &file)?;
    }
    Ok(())
}

fn closure(solution: &fredholm_hierarchical::Solution) {
    let mut worst: Vec<(f64, u32)> =
        solution.closure.iter().zip(solution.tree.leaves()).map(|(c, leaf)| (c - 1.0, leaf)).collect();
    worst.sort_by(|a, b| a.0.total_cmp(&b.0));
    let mean = worst.iter().map(|(d, l)| d.abs() * solution.tree.nodes()[*l as usize].area()).sum::<f64>()
        / solution.tree.nodes()[0].area();
    println!("closure {:.3e} to {:.3e}, mean {mean:.3e}", worst[0].0, worst[worst.len() - 1].0);
    for (d, l) in worst.iter().rev().take(3).chain(worst.iter().take(3)) {
        let p = solution.tree.nodes()[*l as usize].patch().unwrap();
        println!("{d:.3e} at {:?} n {:?} size {:.2e}", p.centroid(), p.normal(), p.area().sqrt());
    }
}

/// Writes the irradiance of the faces.
fn faces(
    mesh: &fredholm_mesh::Mesh,
    solution: &fredholm_hierarchical::Solution,
    bands: &[String],
    file: &str,
) -> Result<(), Box<dyn Error>> {
    let mut sums = vec![0.0; mesh.faces().len() * bands.len()];
    for (i, leaf) in solution.tree.leaves().into_iter().enumerate() {
        let node = &solution.tree.nodes()[leaf as usize];
        let face = node.face().ok_or("a leaf without face")?;
        for (band, e) in solution.means.irradiance.row(i).iter().enumerate() {
            sums[face * bands.len() + band] += e * node.area() / mesh.faces()[face].area;
        }
    }
    let mut out = std::fs::File::create(file)?;
    let names: Vec<String> = bands.iter().map(|band| format!("irradiance_{band}")).collect();
    writeln!(out, "surface,area,cx,cy,cz,{}", names.join(","))?;
    for (face, e) in mesh.faces().iter().zip(sums.chunks(bands.len())) {
        let c = face.centroid;
        let values: Vec<String> = e.iter().map(ToString::to_string).collect();
        let name = &mesh.surfaces()[face.surface].name;
        writeln!(out, "{name},{},{},{},{},{}", face.area, c.x, c.y, c.z, values.join(","))?;
    }
    Ok(())
}
