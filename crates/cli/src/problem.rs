//! From a scene file to a meshed problem that fits the memory: what `solve` and `check` have in common.

use fredholm_coupling::form_factor::PairIntegrator;
use fredholm_linop::MultiVector;
use fredholm_mesh::{Mesh, Patch};
use fredholm_scene::{Scene, SceneError};
use fredholm_visibility::Occluders;

use crate::args::ProblemArgs;
use crate::failure::{Ending, Failure};
use crate::options::ProblemOptions;
use crate::prediction::{Prediction, Size};
use crate::registry::{self, Entry};
use crate::stages::Stages;

/// A scene, its mesh, and how it is to be solved.
pub(crate) struct Problem {
    pub(crate) scene: Scene,
    pub(crate) options: ProblemOptions,
    pub(crate) solver: Entry,
    pub(crate) mesh: Mesh,
    pub(crate) prediction: Prediction,
    pub(crate) warnings: Vec<String>,
    pub(crate) occluders: Occluders,
}

impl Problem {
    /// Reads, meshes and checks a scene; refuses it before memory is taken where it does not fit.
    pub(crate) fn load(args: &ProblemArgs, stages: &mut Stages) -> Result<Self, Failure> {
        let scene = stages.run("scene", || Scene::load(&args.scene).map_err(scene_failure))?;
        let options = ProblemOptions::new(args, scene.solve());
        let solver = registry::find(&options.solver)
            .ok_or_else(|| scene_failure(scene.unknown_solver(&registry::names())))?;
        let elements = usize::try_from(scene.predicted_elements()).unwrap_or(usize::MAX);
        predict(&scene, &options, &solver, elements, 0).admit(&options)?;
        let mesh = stages.run("mesh", || scene.mesh().map_err(scene_failure))?;
        let prediction = predict(&scene, &options, &solver, mesh.len(), coarse(&mesh));
        prediction.admit(&options)?;
        let warnings = check(&scene, &mesh, stages)?;
        let occluders = stages.run("visibility", || occluders(&scene, &mesh))?;
        Ok(Self { scene, options, solver, mesh, prediction, warnings, occluders })
    }

    /// What computes the form factors of the elements.
    pub(crate) fn integrator(&self) -> PairIntegrator<'_> {
        let tolerance = self.options.form_factor_tolerance;
        PairIntegrator::new(self.mesh.patches(), &self.occluders, tolerance)
    }

    /// The elements.
    pub(crate) fn patches(&self) -> Vec<&Patch> {
        self.mesh.patches().collect()
    }

    /// A value for each element and band, from a scene's vector.
    pub(crate) fn multivector(&self, values: Vec<f64>) -> Result<MultiVector<f64>, Failure> {
        let vector = MultiVector::from_vec(self.mesh.len(), self.scene.bands().len(), values);
        vector.map_err(|error| Failure::new(Ending::Input, error))
    }
}

/// Prepares patches for queries of visibility.
pub(crate) fn prepare(patches: &[Patch]) -> Result<Occluders, Failure> {
    Occluders::new(patches).map_err(|error| Failure::new(Ending::Input, error))
}

fn occluders(scene: &Scene, mesh: &Mesh) -> Result<Occluders, Failure> {
    let named = |error| Failure::new(Ending::Input, format!("{}: {error}", scene.path().display()));
    Occluders::new(mesh.occluders()).map_err(named)
}

/// Patches of the coarser problem: the faces, where each is computed on 2 × 2 elements or more.
pub(crate) fn coarse(mesh: &Mesh) -> usize {
    let faces = mesh.faces().len();
    if (0..faces).all(|face| mesh.leaves_of_face(face).len() >= 4) { faces } else { 0 }
}

fn predict(
    scene: &Scene,
    options: &ProblemOptions,
    solver: &Entry,
    elements: usize,
    coarse: usize,
) -> Prediction {
    let size = Size { elements, bands: scene.bands().len(), coarse };
    Prediction::new(size, options.storage, solver)
}

fn check(scene: &Scene, mesh: &Mesh, stages: &Stages) -> Result<Vec<String>, Failure> {
    let warnings = scene.check(mesh).map_err(scene_failure)?;
    let warnings: Vec<String> = warnings.iter().map(ToString::to_string).collect();
    for warning in &warnings {
        stages.console.warn(warning);
    }
    Ok(warnings)
}

/// Unreadable files and scenes too large have exit codes of their own.
fn scene_failure(error: SceneError) -> Failure {
    let ending = match error.kind() {
        fredholm_scene::ErrorKind::Io => Ending::Files,
        fredholm_scene::ErrorKind::TooLarge => Ending::Resources,
        _ => Ending::Input,
    };
    Failure::new(ending, error)
}
