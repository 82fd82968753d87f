//! Scenes for the tests, and solving them.

use fredholm_hierarchical::{Options, Problem, RoundWatch, Solution, Solvers, State, Surfaces, solve};
use fredholm_iterative::{CgTheta, Gmres};
use fredholm_linop::{MultiVector, Quiet};
use fredholm_mesh::Mesh;
use fredholm_scene::Scene;
use fredholm_visibility::Occluders;
use std::path::Path;

/// The solver of the command line, and the one that takes its place.
pub const SOLVERS: Solvers = Solvers { first: &CgTheta, fallback: &Gmres { restart: 50 } };

/// A scene on its faces.
pub struct Bench {
    pub scene: Scene,
    pub mesh: Mesh,
    pub occluders: Occluders,
    pub surfaces: Surfaces,
}

impl Bench {
    pub fn new(scene: Scene) -> Self {
        let mesh = scene.face_mesh().unwrap();
        let (rows, bands) = (mesh.len(), scene.bands().len());
        let vector = |values| MultiVector::from_vec(rows, bands, values).unwrap();
        let surfaces = Surfaces {
            reflectance: vector(scene.reflectance(&mesh)),
            exitance: vector(scene.exitance(&mesh)),
        };
        let occluders = Occluders::new(mesh.occluders()).unwrap();
        Self { scene, mesh, occluders, surfaces }
    }

    #[allow(dead_code, reason = "not every test needs one")]
    pub fn text(text: &str) -> Self {
        Self::new(Scene::from_str(text, "test.toml").unwrap())
    }

    /// A scene that the project ships.
    #[allow(dead_code, reason = "not every test needs one")]
    pub fn shipped(name: &str) -> Self {
        let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../scenes").join(name);
        Self::new(Scene::load(path).unwrap())
    }

    pub fn problem(&self) -> Problem<'_> {
        Problem { mesh: &self.mesh, occluders: &self.occluders, surfaces: &self.surfaces, goal: None }
    }

    #[allow(dead_code, reason = "not every test needs every helper")]
    pub fn solve(&self, accuracy: f64) -> Solution {
        self.resume(accuracy, None, &Quiet)
    }

    pub fn resume(&self, accuracy: f64, state: Option<State>, watch: &dyn RoundWatch) -> Solution {
        solve(&self.problem(), &options(accuracy), SOLVERS, state, watch).unwrap()
    }

    /// Irradiance of the faces, faces × bands, W/m².
    #[allow(dead_code, reason = "not every test needs it")]
    pub fn faces(&self, solution: &Solution) -> Vec<f64> {
        let bands = self.scene.bands().len();
        let mut sums = vec![0.0; self.mesh.faces().len() * bands];
        for (i, leaf) in solution.tree.leaves().into_iter().enumerate() {
            let node = &solution.tree.nodes()[leaf as usize];
            let face = node.face().unwrap();
            for (band, e) in solution.means.irradiance.row(i).iter().enumerate() {
                sums[face * bands + band] += e * node.area() / self.mesh.faces()[face].area;
            }
        }
        sums
    }
}

pub fn options(accuracy: f64) -> Options {
    Options { accuracy, linear: true, residual: 1e-3 * accuracy, bytes: 4 << 30, max_iterations: 200 }
}

/// A room of one material with a block in it.
#[allow(dead_code, reason = "not every test needs it")]
pub fn room(reflectance: f64) -> String {
    format!(
        "[materials.wall]\nreflectance = {reflectance}\nexitance = 1\n\
         [[surface]]\nname = \"room\"\nmaterial = \"wall\"\n\
         box = {{ min = [0, 0, 0], max = [2, 1.5, 1], inward = true }}\ndivide = [2, 2]\n\
         [[surface]]\nname = \"block\"\nmaterial = \"wall\"\n\
         box = {{ min = [0.8, 0.6, 0.3], max = [1.3, 0.9, 0.6] }}\n"
    )
}
