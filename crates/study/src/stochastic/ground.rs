//! What paths are traced on: a meshed scene, and what a deterministic solution adds to it.

use std::sync::Arc;

use fredholm_coupling::exposed_shares;
use fredholm_mesh::{Mesh, Patch};
use fredholm_montecarlo::light::Control;
use fredholm_montecarlo::{Enclosure, Groups, Surfaces};
use fredholm_scene::Scene;

use super::tracer::failure;
use crate::error::{Error, ErrorKind};
use crate::memory::{self, Plan};
use crate::options::{ProblemOptions, SceneSource, USUAL_DISCRETISATION};
use crate::prediction::BYTES_OF_AN_ELEMENT;
use crate::problem::{Problem, check, occluders, prepare, scene_failure};
use crate::solution::Solution;
use crate::stages::Stages;

/// Bytes an element takes while paths are traced: what rays are cast at, densities, the state that
/// is written.
const BYTES_OF_A_TRACED_ELEMENT: u128 = 600;
/// Vectors of all elements and bands held at once: a wave of batches, sums, means and errors.
const VECTORS_HELD: u128 = fredholm_montecarlo::BATCHES_AT_ONCE as u128 + 12;

/// Bytes of an element while the results are drawn and written, and of each of its values: what
/// paths are traced on is still there.
const BYTES_OF_A_WRITTEN_ELEMENT: u128 = 920;
const BYTES_A_VALUE: u128 = 200;

/// A meshed scene.
pub(crate) struct Ground {
    pub(crate) scene: Arc<Scene>,
    pub(crate) mesh: Mesh,
    pub(crate) warnings: Vec<String>,
}

impl Ground {
    /// Reads, meshes and checks a scene; refuses it before memory is taken where it does not fit.
    pub(crate) fn load(
        source: &SceneSource,
        asked: &ProblemOptions,
        picture: &dyn Fn(&Scene) -> Drawn,
        stages: &mut Stages,
    ) -> Result<Self, Error> {
        let scene = source.load(asked.memory, stages)?;
        admit(&scene, asked, &picture(&scene), stages)?;
        let mesh = stages.run("mesh", || scene.mesh().map_err(scene_failure))?;
        let warnings = check(&scene, &mesh, stages)?;
        Ok(Self { scene, mesh, warnings })
    }
}

/// What is drawn of a traced scene.
pub(crate) enum Drawn {
    /// Nothing.
    Nothing,
    /// The means of the elements, or else pixels: bytes.
    Picture(u128),
}

fn admit(scene: &Scene, asked: &ProblemOptions, drawn: &Drawn, stages: &Stages) -> Result<(), Error> {
    let elements = usize::try_from(scene.predicted_elements()).unwrap_or(usize::MAX);
    let n = elements as u128;
    let plan = Plan::default().hold(format!("{elements} elements"), BYTES_OF_AN_ELEMENT.saturating_mul(n));
    let mut plan = with_tracing(plan, scene, elements);
    if let Drawn::Picture(bytes) = drawn {
        let element = BYTES_OF_A_WRITTEN_ELEMENT + BYTES_A_VALUE * scene.bands().len() as u128;
        plan = plan.stage("results and pictures", element.saturating_mul(n).saturating_add(*bytes));
    }
    let help =
        "use fewer elements (elements_per_face, divide, largest_edge in the scene), or a smaller picture";
    stages.admit(&plan, memory::limit(asked.memory), help)
}

/// Random paths as a thing after another.
pub(crate) fn with_tracing(plan: Plan, scene: &Scene, elements: usize) -> Plan {
    let element = BYTES_OF_A_TRACED_ELEMENT + VECTORS_HELD * 8 * scene.bands().len() as u128;
    plan.stage("random paths", element.saturating_mul(elements as u128))
}

/// The scene as a tracer sees it.
pub(crate) fn enclosure(scene: &Scene, mesh: &Mesh) -> Result<Enclosure, Error> {
    let patches: Vec<Patch> = mesh.patches().copied().collect();
    let shares = exposed_shares(&mesh.patches().collect::<Vec<_>>(), &prepare(&patches)?);
    let (rho, exitance) = (scene.reflectance(mesh), scene.exitance(mesh));
    Enclosure::of(Surfaces::blocked_by(occluders(scene, mesh)?, patches), scene.bands().len(), rho, exitance)
        .and_then(|all| all.with_exposed(shares))
        .map_err(failure)
}

/// The input faces as groups of elements.
pub(crate) fn faces(mesh: &Mesh, enclosure: &Enclosure) -> Result<Groups, Error> {
    let of = (0..mesh.len()).map(|leaf| mesh.face_of(leaf)).collect();
    Groups::new(enclosure, of, mesh.faces().len()).map_err(failure)
}

/// A problem whose solution is to be a control variate: constants on the elements, whatever the
/// scene asks for, since of them alone it is known that they are the means of what they send.
pub(crate) fn controlling(
    source: &SceneSource,
    asked: &ProblemOptions,
    more: &dyn Fn(Plan, &Scene, usize) -> Plan,
    stages: &mut Stages,
) -> Result<Problem, Error> {
    if let Some(other) = asked.discretisation.as_ref().filter(|&name| name != USUAL_DISCRETISATION) {
        let text = format!("a control variate is the solution by {USUAL_DISCRETISATION}, not by {other}");
        return Err(Error::new(ErrorKind::Input, text).with_help("leave out --discretisation"));
    }
    let asked = ProblemOptions { discretisation: Some(USUAL_DISCRETISATION.to_owned()), ..asked.clone() };
    Problem::load(source, &asked, more, stages)
}

/// A deterministic solution as a control variate.
pub(crate) fn control(enclosure: &Enclosure, solution: &Solution, patchwise: bool) -> Result<Control, Error> {
    let irradiance = solution.means.irradiance.as_slice().to_vec();
    Control::new(enclosure, (irradiance, &solution.exposed), patchwise).map_err(failure)
}

/// What a deterministic solution says of the error of the irradiance of each face and band, W/m²:
/// what it states of the whole, errors of the mesh and the form factors together, no less than the
/// relative error of the scene; or of the form factors alone, their estimated errors times the
/// largest radiosity.
pub(crate) fn expected_error(problem: &Problem, solution: &Solution, meshed: bool) -> Vec<f64> {
    let (mesh, bands) = (&problem.mesh, problem.scene.bands().len());
    let radiosity = &solution.means.radiosity;
    let exposed = |leaf: usize| solution.exposed[leaf].max(0.5);
    let largest = |band: usize| {
        (0..mesh.len()).map(|leaf| radiosity.row(leaf)[band] / exposed(leaf)).fold(0.0, f64::max)
    };
    let largest: Vec<f64> = (0..bands).map(largest).collect();
    let row = |leaf: usize| solution.row_error.get(leaf).copied().unwrap_or(0.0);
    let error = |at: usize| {
        let (face, band) = (at / bands, at % bands);
        let leaves = || mesh.leaves_of_face(face);
        let mean = |value: &dyn Fn(usize) -> f64| {
            leaves().map(|leaf| mesh.patch(leaf).area() * value(leaf)).sum::<f64>() / mesh.faces()[face].area
        };
        match solution.mesh_error.as_ref().filter(|_| meshed) {
            None => mean(&row) * largest[band],
            Some(error) => {
                let irradiance = mean(&|leaf| solution.means.irradiance.row(leaf)[band]);
                let own = error.per_face.get(at).copied().unwrap_or(0.0);
                own.max(error.relative_l2[band] * irradiance)
            }
        }
    };
    (0..mesh.faces().len() * bands).map(error).collect()
}

/// Mean irradiance of the faces, faces × bands, W/m².
pub(crate) fn face_means(problem: &Problem, solution: &Solution) -> Vec<f64> {
    let (mesh, bands) = (&problem.mesh, problem.scene.bands().len());
    let mean = |face: usize, band: usize| {
        let weighed = |leaf: usize| mesh.patch(leaf).area() * solution.means.irradiance.row(leaf)[band];
        mesh.leaves_of_face(face).map(weighed).sum::<f64>() / mesh.faces()[face].area
    };
    (0..mesh.faces().len()).flat_map(|face| (0..bands).map(move |band| mean(face, band))).collect()
}
