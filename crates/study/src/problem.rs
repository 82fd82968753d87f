//! From a scene file to a meshed problem that fits the memory: what `solve` and `check` have in
//! common.

use std::sync::Arc;

use fredholm_coupling::form_factor::PairIntegrator;
use fredholm_discretisation::{Discretisation, Surface, discretisation, discretisations};
use fredholm_linop::MultiVector;
use fredholm_mesh::{Mesh, Patch};
use fredholm_report::USUAL_PIXELS;
use fredholm_scene::{Scene, SceneError};
use fredholm_visibility::Occluders;

use crate::error::{Error, ErrorKind};
use crate::memory::Plan;
use crate::options::{Precision, ProblemOptions, ProblemSettings, SceneSource, USUAL_DISCRETISATION};
use crate::prediction::{Dense, Pictures, Prediction, Size, results, without_matrix};
use crate::registry::{self, SolverEntry};
use crate::size::Bytes;
use crate::stages::Stages;

/// A scene, its mesh, and how it is to be solved.
pub(crate) struct Problem {
    pub(crate) scene: Arc<Scene>,
    pub(crate) options: ProblemSettings,
    pub(crate) discretisation: Box<dyn Discretisation>,
    pub(crate) solver: SolverEntry,
    pub(crate) mesh: Mesh,
    /// Unknowns in each band.
    pub(crate) unknowns: usize,
    pub(crate) prediction: Prediction,
    /// Memory of the whole run.
    pub(crate) plan: Plan,
    pub(crate) warnings: Vec<String>,
    pub(crate) occluders: Arc<Occluders>,
}

/// What a verb adds to the memory of a solution, of a scene with so many elements.
pub(crate) type More<'a> = &'a dyn Fn(Plan, &Scene, usize) -> Plan;

impl Problem {
    /// Reads, meshes and checks a scene; refuses it before memory is taken where it does not fit,
    /// together with what the verb adds.
    pub(crate) fn load(
        source: &SceneSource,
        asked: &ProblemOptions,
        more: More,
        stages: &mut Stages,
    ) -> Result<Self, Error> {
        let scene = source.load(asked.memory, stages)?;
        let options = ProblemSettings::new(asked, scene.solve());
        Self::refined(scene, options, (1, more), stages)
    }

    /// Meshes a scene, every element cut into `refinement` × `refinement`. What is as it is in the
    /// scene is checked without refinement only.
    pub(crate) fn refined(
        scene: Arc<Scene>,
        options: ProblemSettings,
        (refinement, more): (usize, More),
        stages: &mut Stages,
    ) -> Result<Self, Error> {
        let solver = registry::find(&options.solver)
            .ok_or_else(|| scene_failure(scene.unknown_solver(&registry::names())))?;
        let discretisation = named(&scene, &options)?;
        let options = ProblemSettings { discretisation: discretisation.name().to_owned(), ..options };
        let elements = scene.predicted_elements().saturating_mul((refinement as u128).pow(2));
        let elements = usize::try_from(elements).unwrap_or(usize::MAX);
        let before = predict(&scene, &options, &solver, Size::before_mesh(elements, &options));
        before.admit(&more(before.plan(), &scene, elements), &options, stages)?;
        let mesh = stages.run("mesh", || scene.refined_mesh(refinement).map_err(scene_failure))?;
        let size = size(&scene, &*discretisation, &mesh)?;
        let prediction = predict(&scene, &options, &solver, size);
        let plan = more(prediction.plan(), &scene, mesh.len());
        prediction.admit(&plan, &options, stages)?;
        let warnings = if refinement == 1 { check(&scene, &mesh, stages)? } else { Vec::new() };
        let occluders = stages.run("visibility", || occluders(&scene, &mesh))?;
        let unknowns = size.unknowns;
        Ok(Self {
            scene,
            options,
            discretisation,
            solver,
            mesh,
            unknowns,
            prediction,
            plan,
            warnings,
            occluders,
        })
    }

    /// Whether the system is that of form factors between elements.
    pub(crate) fn is_radiosity(&self) -> bool {
        self.options.discretisation == USUAL_DISCRETISATION
    }

    /// Refuses another system, for a study that works on the matrix of form factors.
    pub(crate) fn require_radiosity(&self, study: &str) -> Result<(), Error> {
        if self.is_radiosity() {
            return Ok(());
        }
        let text = format!(
            "{study} works on the matrix of form factors, which is {USUAL_DISCRETISATION}; the scene asks for {}",
            self.options.discretisation
        );
        Err(Error::new(ErrorKind::Input, text))
    }

    /// What computes the form factors of the elements.
    pub(crate) fn integrator(&self) -> PairIntegrator<'_> {
        let tolerance = self.options.form_factor_tolerance;
        PairIntegrator::new(self.mesh.patches(), &self.occluders, tolerance).with_row_budget()
    }

    /// The elements.
    pub(crate) fn patches(&self) -> Vec<&Patch> {
        self.mesh.patches().collect()
    }

    /// A value for each element and band, from a scene's vector.
    pub(crate) fn multivector(&self, values: Vec<f64>) -> Result<MultiVector<f64>, Error> {
        let vector = MultiVector::from_vec(self.mesh.len(), self.scene.bands().len(), values);
        vector.map_err(|error| Error::new(ErrorKind::Input, error))
    }
}

/// A scene and its mesh, for what stores no matrix.
pub(crate) struct Open {
    pub(crate) scene: Arc<Scene>,
    pub(crate) options: ProblemSettings,
    pub(crate) mesh: Mesh,
    pub(crate) warnings: Vec<String>,
    pub(crate) occluders: Arc<Occluders>,
}

impl Open {
    /// Reads, meshes and checks a scene; refuses it before memory is taken where the mesh and
    /// `kept` do not fit, and so many pictures.
    pub(crate) fn load(
        source: &SceneSource,
        asked: &ProblemOptions,
        (kept, pictures): (Bytes, usize),
        stages: &mut Stages,
    ) -> Result<Self, Error> {
        let scene = source.load(asked.memory, stages)?;
        let options = ProblemSettings::new(asked, scene.solve());
        let bands = scene.bands().len();
        let pictures = Pictures { pixels: pixels(&scene), count: pictures, lit: false, gathered: false };
        let admit = |elements: usize, stages: &Stages| {
            let results = results(elements, bands, pictures);
            let plan = without_matrix(elements, bands, kept).stage("results and pictures", results);
            let help = "keep less with --keep, use fewer elements (elements_per_face, divide, largest_edge in the scene)";
            stages.admit(&plan, options.memory_limit(), help)
        };
        admit(usize::try_from(scene.predicted_elements()).unwrap_or(usize::MAX), stages)?;
        let mesh = stages.run("mesh", || scene.mesh().map_err(scene_failure))?;
        admit(mesh.len(), stages)?;
        let warnings = check(&scene, &mesh, stages)?;
        let occluders = stages.run("visibility", || occluders(&scene, &mesh))?;
        Ok(Self { scene, options, mesh, warnings, occluders })
    }

    /// The elements.
    pub(crate) fn patches(&self) -> Vec<&Patch> {
        self.mesh.patches().collect()
    }
}

/// Pixels of the picture of a scene.
pub(crate) fn pixels(scene: &Scene) -> u128 {
    let [width, height] = scene.camera().map_or(USUAL_PIXELS, |camera| [camera.width, camera.height]);
    u128::from(width) * u128::from(height)
}

/// The pictures of a solution, of which lamps light one at a time: the usual ones, and further ones
/// that are asked for; none where none are wanted. The light of one is gathered where that is asked
/// for.
pub(crate) fn pictures(
    scene: &Scene,
    usual: usize,
    (no_pictures, (further, gathered)): (bool, (usize, bool)),
) -> Pictures {
    let count = if no_pictures { 0 } else { usual + further };
    Pictures { pixels: pixels(scene), count, lit: true, gathered }
}

/// Results and pictures after a solution, and what these take besides.
pub(crate) fn with_results(
    plan: Plan,
    scene: &Scene,
    elements: usize,
    (pictures, more): (Pictures, u128),
) -> Plan {
    let bytes = results(elements, scene.bands().len(), pictures);
    plan.stage("results and pictures", bytes.saturating_add(more))
}

/// Prepares patches for queries of visibility.
pub(crate) fn prepare(patches: &[Patch]) -> Result<Occluders, Error> {
    Occluders::new(patches).map_err(|error| Error::new(ErrorKind::Input, error))
}

pub(crate) fn occluders(scene: &Scene, mesh: &Mesh) -> Result<Arc<Occluders>, Error> {
    let named = |error| Error::new(ErrorKind::Input, format!("{}: {error}", scene.path().display()));
    Occluders::new(mesh.occluders()).map(Arc::new).map_err(named)
}

/// The discretisation asked for, which the stored format must suit.
fn named(scene: &Scene, options: &ProblemSettings) -> Result<Box<dyn Discretisation>, Error> {
    let found = discretisation(&options.discretisation).map_err(|_| {
        let known: Vec<&str> = discretisations().iter().map(|known| known.name()).collect();
        scene_failure(scene.unknown_discretisation(&known))
    })?;
    if found.name() != USUAL_DISCRETISATION && options.storage == Precision::F32 {
        let error = Error::new(ErrorKind::Input, format!("{} stores f64 only", found.name()));
        return Err(error.with_help(format!("--storage f64, or {USUAL_DISCRETISATION}")));
    }
    Ok(found)
}

/// Sizes of the meshed problem.
fn size(scene: &Scene, discretisation: &dyn Discretisation, mesh: &Mesh) -> Result<Size, Error> {
    let elements = mesh.len();
    if discretisation.name() == USUAL_DISCRETISATION {
        return Ok(Size { elements, unknowns: elements, dense: None });
    }
    let surface = Surface::from_mesh(mesh);
    let space = discretisation.space(&surface).map_err(|error| Error::new(ErrorKind::Input, error))?;
    let bytes = 8 * discretisation.numbers(&space, different_reflectances(scene));
    Ok(Size { elements, unknowns: space.dim(), dense: Some(Dense { bytes }) })
}

/// Bands that differ in the reflectance of any material.
fn different_reflectances(scene: &Scene) -> usize {
    let of = |band: usize| scene.materials().iter().map(move |material| material.reflectance[band]);
    let mut different: Vec<usize> = Vec::new();
    for band in 0..scene.bands().len() {
        if !different.iter().any(|&other| of(other).eq(of(band))) {
            different.push(band);
        }
    }
    different.len()
}

fn predict(scene: &Scene, options: &ProblemSettings, solver: &SolverEntry, size: Size) -> Prediction {
    Prediction::new(size, scene.bands().len(), options.storage, solver)
}

pub(crate) fn check(scene: &Scene, mesh: &Mesh, stages: &Stages) -> Result<Vec<String>, Error> {
    let warnings = scene.check(mesh).map_err(scene_failure)?;
    let warnings: Vec<String> = warnings.iter().map(ToString::to_string).collect();
    for warning in &warnings {
        stages.watch.warn(warning);
    }
    Ok(warnings)
}

/// Unreadable files and scenes too large have exit codes of their own.
pub(crate) fn scene_failure(error: SceneError) -> Error {
    let ending = match error.kind() {
        fredholm_scene::ErrorKind::Io => ErrorKind::Files,
        fredholm_scene::ErrorKind::TooLarge => ErrorKind::Resources,
        _ => ErrorKind::Input,
    };
    Error::new(ending, error)
}
