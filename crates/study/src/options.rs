//! What a caller asks for, and the settings in force: what was asked for, else what the `[solve]`
//! table of the scene says, else the usual value.

use std::path::{Path, PathBuf};
use std::sync::Arc;

use fredholm_coupling::Receiver;
use fredholm_mesh::Vec3;
use fredholm_report::{FIELD_EXR, FIELD_GLB, FIELD_PLY, ResultFolder};
use fredholm_scene::waves::is_wave_scene;
use fredholm_scene::{Scene, SceneError, SolveDefaults, Storage};
use serde::{Deserialize, Serialize, Serializer};
use serde_json::{Map, Value};

use crate::error::{Error, ErrorKind};
use crate::memory::{self, Limit, Plan};
use crate::problem::scene_failure;
use crate::size::Bytes;
use crate::stages::Stages;
use crate::{registry, threads};

const TOLERANCE: f64 = 1e-10;
const MAX_ITERATIONS: u64 = 1000;
const FORM_FACTOR_TOLERANCE: f64 = 1e-3;
/// The discretisation where none is asked for: constants on the elements, from form factors.
pub(crate) const USUAL_DISCRETISATION: &str = "galerkin-0";

/// Number format of the stored matrix.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "lowercase")]
pub enum Precision {
    /// 8 bytes an entry.
    F64,
    /// 4 bytes an entry; arithmetic stays f64.
    F32,
}

/// How the caller was called, added to the options in the record of a run.
pub type Recorded = Map<String, Value>;

/// Where a scene comes from.
#[derive(Clone, Debug)]
pub enum SceneSource {
    /// A scene file, or a mesh file that stands for a scene.
    File(PathBuf),
    /// A scene that is there already.
    Scene(Arc<Scene>),
}

impl SceneSource {
    /// The scene, read in a stage of its own; refused where reading it takes more than there may
    /// be.
    pub(crate) fn load(&self, memory: Option<Bytes>, stages: &mut Stages) -> Result<Arc<Scene>, Error> {
        stages.run("scene", || match self {
            Self::File(path) => {
                admit_file(path, memory)?;
                Scene::load(path).map(Arc::new).map_err(|error| of_light(path, error))
            }
            Self::Scene(scene) => Ok(Arc::clone(scene)),
        })
    }

    /// The file of the scene, as it is named.
    pub(crate) fn path(&self) -> &Path {
        match self {
            Self::File(path) => path,
            Self::Scene(scene) => scene.path(),
        }
    }
}

/// What is wrong with a scene that was read as one of light: one of waves has a command of its own.
fn of_light(path: &Path, error: SceneError) -> Error {
    if !is_wave_scene(path) {
        return scene_failure(error);
    }
    let shown = path.display();
    let help = format!(
        "compute its fields with `fredholm waves {shown}`; `fredholm check {shown}` tells what it is"
    );
    Error::new(ErrorKind::Input, format!("{shown} is a scene of waves, not of light")).with_help(help)
}

/// What is wrong with a scene that was read as one of waves, in the same way.
pub(crate) fn of_waves(path: &Path, error: SceneError) -> Error {
    if is_wave_scene(path) || Scene::load(path).is_err() {
        return scene_failure(error);
    }
    let shown = path.display();
    let help = format!(
        "compute its light with `fredholm solve {shown}`; a scene of waves has a table [wave] (`fredholm schema --waves`)"
    );
    Error::new(ErrorKind::Input, format!("{shown} is a scene of light, not of waves")).with_help(help)
}

/// Bytes that reading takes for every byte of a scene file, and of a mesh: measured on files of 80
/// and 100 MB, rounded up.
const READ_SCENE: u128 = 60;
const READ_MESH: u128 = 30;

/// Bytes for reading that are not worth a question: what is wrong with a small scene, and what
/// would fit, can then still be told.
const UNQUESTIONED_BYTES: u128 = 1 << 20;

/// Refuses a file that is too large to be read.
pub(crate) fn admit_file(path: &Path, memory: Option<Bytes>) -> Result<(), Error> {
    // A file that is not there is for the reader to complain of.
    let Ok(found) = std::fs::metadata(path) else { return Ok(()) };
    let text = path.extension().is_some_and(|ending| ending.eq_ignore_ascii_case("toml"));
    let each = if text { READ_SCENE } else { READ_MESH };
    let bytes = each.saturating_mul(found.len().into());
    if bytes < UNQUESTIONED_BYTES {
        return Ok(());
    }
    let plan = Plan::default().stage("reading the scene", bytes);
    plan.admit(memory::limit(memory), "give a smaller scene, its large parts as mesh files")
}

impl From<Scene> for SceneSource {
    fn from(scene: Scene) -> Self {
        Self::Scene(Arc::new(scene))
    }
}

impl From<Arc<Scene>> for SceneSource {
    fn from(scene: Arc<Scene>) -> Self {
        Self::Scene(scene)
    }
}

impl<P: AsRef<Path> + ?Sized> From<&P> for SceneSource {
    fn from(path: &P) -> Self {
        Self::File(path.as_ref().to_owned())
    }
}

/// What decides the size and the effort of a problem. What is none is as the scene says, else as
/// usual.
#[derive(Clone, Debug, Default)]
pub struct ProblemOptions {
    /// Threads of the run, as [`thread_pool`](crate::thread_pool) has them; one a core. Any number
    /// gives the same results.
    pub threads: Option<u16>,
    /// Discretisation, one of [`discretisations`](crate::discretisations); galerkin-0.
    pub discretisation: Option<String>,
    /// Solver, one of [`solvers`](crate::solvers); gauss-seidel, and cg-theta to an accuracy.
    pub solver: Option<String>,
    /// Error asked for in a row of form factors; 1e-3.
    pub form_factor_tolerance: Option<f64>,
    /// Number format of the stored matrix; f64.
    pub storage: Option<Precision>,
    /// Memory allowed; most of what the machine has left.
    pub memory: Option<Bytes>,
}

/// When a solution ends. What is none is as the scene says, else as usual.
#[derive(Clone, Copy, Debug, Default)]
pub struct StopOptions {
    /// Relative residual ‖b − A x‖₂/‖b‖₂ to reach in every band; 1e-10, to an accuracy a part of
    /// it.
    pub tolerance: Option<f64>,
    /// Iterations allowed; 1000.
    pub max_iterations: Option<u32>,
}

/// Points whose irradiance is gathered, or which see view factors.
#[derive(Clone, Debug, Default)]
pub struct GatherPoints {
    /// Points with their normals.
    pub points: Vec<Receiver>,
    /// Grids of points.
    pub grids: Vec<PointGrid>,
}

/// Bytes of a point: it is listed for the options, to gather, and for the file.
const BYTES_OF_A_POINT: u128 = 200;

impl GatherPoints {
    /// Number of points.
    pub(crate) fn count(&self) -> usize {
        self.points.len() + self.grids.iter().map(PointGrid::count).sum::<usize>()
    }

    /// Bytes that the points take, with their irradiance in each band.
    pub(crate) fn bytes(&self, bands: usize) -> u128 {
        self.count() as u128 * (BYTES_OF_A_POINT + 32 * bands as u128)
    }

    /// All points.
    pub(crate) fn receivers(&self) -> Vec<Receiver> {
        let grids = self.grids.iter().flat_map(PointGrid::receivers);
        self.points.iter().copied().chain(grids).collect()
    }
}

/// Points in a parallelogram, at the centres of equal cells.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PointGrid {
    origin: Vec3,
    sides: [Vec3; 2],
    counts: [usize; 2],
}

impl PointGrid {
    /// Points in the parallelogram from `origin` (m) along the sides u and v (m), so many along
    /// each; their normal is that of u × v. None where the sides span no area.
    #[must_use]
    pub fn new(origin: Vec3, sides: [Vec3; 2], counts: [usize; 2]) -> Option<Self> {
        sides[0].cross(sides[1]).try_normalize()?;
        Some(Self { origin, sides, counts })
    }

    /// Number of points.
    #[must_use]
    pub fn count(&self) -> usize {
        self.counts[0] * self.counts[1]
    }

    /// The points, with their normals.
    #[must_use]
    pub fn receivers(&self) -> Vec<Receiver> {
        Receiver::plane(self.origin, self.sides, self.counts).unwrap_or_default()
    }
}

/// What is asked of [`solve`](crate::solve).
#[derive(Clone, Debug, Default)]
#[allow(clippy::struct_excessive_bools, reason = "each is a switch of its own")]
pub struct SolveOptions {
    /// Relative error of the irradiance of the faces to reach, above 0 and below 1; the elements
    /// are then chosen where they are needed. None: the scene's, else the elements of the scene.
    pub accuracy: Option<f64>,
    /// How the accuracy is to be reached. None: as is predicted to cost about the least.
    pub way: Option<Way>,
    /// Surfaces, by their names, whose mean irradiance is to have the accuracy; all else is only as
    /// exact as that needs.
    pub goal: Vec<String>,
    /// Whether the light of the picture that lamps do not send is gathered.
    pub final_gather: bool,
    /// A further picture, of the irradiance in false colour.
    pub false_colour: Option<FalseColour>,
    /// Whether elements are cut along the borders of shadows for a further file.
    pub discontinuity: bool,
    /// Whether nothing is drawn.
    pub no_pictures: bool,
    /// Whether report.html is left out.
    pub no_report: bool,
    /// Further files with the field.
    pub also: Vec<FieldFile>,
    /// Points whose irradiance is gathered.
    pub points: GatherPoints,
    /// What decides the size and the effort.
    pub problem: ProblemOptions,
    /// When the solution ends.
    pub stop: StopOptions,
    /// Folder in which the state is kept between rounds of a run to an accuracy, so that
    /// [`resume`](crate::resume) can go on from there. None: an interrupted run leaves nothing.
    pub folder: Option<ResultFolder>,
    /// What else the record of the run is to say.
    pub recorded: Recorded,
}

/// What a picture in false colour shows.
#[derive(Clone, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub struct FalseColour {
    /// The band, by its name; none for all bands together.
    pub band: Option<String>,
}

/// A way to an accuracy.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Way {
    /// Hierarchical radiosity: elements are chosen where they are needed, and linked.
    Links,
    /// Rays from the elements of the scene, whose parts they tell apart.
    Rays,
}

/// A further file with the field.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum FieldFile {
    /// field.ply: elements with colours at their corners, and the values of the elements.
    Ply,
    /// field.glb: elements with colours and radiosity at their corners.
    Glb,
    /// image.exr: the linear colours of the picture.
    Exr,
}

impl FieldFile {
    /// The name of the file.
    #[must_use]
    pub fn name(self) -> &'static str {
        match self {
            Self::Ply => FIELD_PLY,
            Self::Glb => FIELD_GLB,
            Self::Exr => FIELD_EXR,
        }
    }
}

/// What decides the size and the effort of a problem, in force.
#[derive(Clone, Debug, Serialize)]
pub(crate) struct ProblemSettings {
    pub(crate) discretisation: String,
    pub(crate) solver: String,
    pub(crate) form_factor_tolerance: f64,
    pub(crate) storage: Precision,
    pub(crate) threads: usize,
    /// `None`: most of what the system has.
    pub(crate) memory_limit_bytes: Option<u64>,
}

/// All settings of a solution.
#[derive(Clone, Debug, Serialize)]
#[allow(clippy::struct_excessive_bools, reason = "each is a switch of its own")]
pub(crate) struct SolveSettings {
    #[serde(flatten)]
    pub(crate) problem: ProblemSettings,
    /// Where elements are chosen by hierarchical radiosity.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub(crate) accuracy: Option<f64>,
    /// Surfaces whose mean irradiance is to have the accuracy.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub(crate) goal: Vec<String>,
    /// Why an accuracy was reached in the way it was.
    #[serde(skip)]
    pub(crate) choice: Option<String>,
    /// Points whose irradiance is gathered.
    #[serde(serialize_with = "places", skip_serializing_if = "Vec::is_empty")]
    pub(crate) points: Vec<Receiver>,
    /// Whether the light of the picture that lamps do not send is gathered.
    #[serde(skip_serializing_if = "std::ops::Not::not")]
    pub(crate) final_gather: bool,
    /// A picture of the irradiance in false colour.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub(crate) false_colour: Option<FalseColour>,
    /// Whether elements are cut along the borders of shadows.
    #[serde(skip_serializing_if = "std::ops::Not::not")]
    pub(crate) discontinuity: bool,
    /// Whether nothing is drawn.
    #[serde(skip_serializing_if = "std::ops::Not::not")]
    pub(crate) no_pictures: bool,
    /// Whether the page is left out.
    #[serde(skip_serializing_if = "std::ops::Not::not")]
    pub(crate) no_report: bool,
    /// Whether nobody asks what the elements leave out.
    #[serde(skip)]
    pub(crate) no_mesh_error: bool,
    /// Further files with the field.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub(crate) also: Vec<FieldFile>,
    pub(crate) tolerance: f64,
    pub(crate) max_iterations: u64,
    /// Folder of the results.
    pub(crate) output: String,
    #[serde(flatten)]
    pub(crate) recorded: Recorded,
}

impl ProblemSettings {
    pub(crate) fn new(asked: &ProblemOptions, scene: &SolveDefaults) -> Self {
        let discretisation = asked.discretisation.as_ref().or(scene.discretisation.as_ref());
        let solver = asked.solver.as_ref().or(scene.solver.as_ref());
        let form_factor_tolerance = asked.form_factor_tolerance.or(scene.form_factor_tolerance);
        let storage = asked.storage.or(scene.storage.map(precision));
        Self {
            discretisation: discretisation.map_or_else(|| USUAL_DISCRETISATION.to_owned(), Clone::clone),
            solver: solver.map_or_else(|| registry::USUAL_SOLVER.to_owned(), Clone::clone),
            form_factor_tolerance: form_factor_tolerance.unwrap_or(FORM_FACTOR_TOLERANCE),
            storage: storage.unwrap_or(Precision::F64),
            threads: threads::count(asked.threads),
            memory_limit_bytes: asked.memory.map(Bytes::as_u64),
        }
    }

    pub(crate) fn memory_limit(&self) -> Limit {
        memory::limit(self.memory_limit_bytes.map(|bytes| Bytes(bytes.into())))
    }
}

impl SolveSettings {
    pub(crate) fn new(problem: ProblemSettings, stop: StopOptions, scene: &SolveDefaults) -> Self {
        let iterations = stop.max_iterations.map(u64::from).or(scene.max_iterations);
        Self {
            problem,
            accuracy: None,
            goal: Vec::new(),
            choice: None,
            points: Vec::new(),
            final_gather: false,
            false_colour: None,
            discontinuity: false,
            no_pictures: false,
            no_report: false,
            no_mesh_error: false,
            also: Vec::new(),
            tolerance: stop.tolerance.or(scene.tolerance).unwrap_or(TOLERANCE),
            max_iterations: iterations.unwrap_or(MAX_ITERATIONS),
            output: String::new(),
            recorded: Recorded::new(),
        }
    }

    /// Those of a solution that random paths go on from: what its elements leave out is what the
    /// paths find.
    pub(crate) fn of_control(problem: ProblemSettings, scene: &SolveDefaults) -> Self {
        let settings = Self::new(problem, StopOptions::default(), scene);
        Self { no_report: true, no_mesh_error: true, ..settings }
    }

    /// Number of pictures that are asked for besides the usual ones, and whether their light is
    /// gathered.
    pub(crate) fn further_pictures(&self) -> (usize, bool) {
        (usize::from(self.false_colour.is_some()), self.final_gather)
    }
}

/// Points as lists of numbers: place and normal.
fn places<S: Serializer>(points: &[Receiver], serializer: S) -> Result<S::Ok, S::Error> {
    serializer.collect_seq(points.iter().map(|r| [r.point.to_array(), r.normal.to_array()].concat()))
}

fn precision(storage: Storage) -> Precision {
    match storage {
        Storage::F64 => Precision::F64,
        Storage::F32 => Precision::F32,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn settings(asked: &ProblemOptions, stop: StopOptions, scene: &SolveDefaults) -> SolveSettings {
        SolveSettings::new(ProblemSettings::new(asked, scene), stop, scene)
    }

    #[test]
    fn the_caller_goes_before_the_scene_and_that_before_the_program() {
        let scene = SolveDefaults {
            discretisation: Some("nystrom-2".into()),
            solver: Some("lu".into()),
            tolerance: Some(1e-5),
            max_iterations: Some(7),
            form_factor_tolerance: Some(1e-6),
            storage: Some(Storage::F32),
            accuracy: None,
        };
        let nothing = (ProblemOptions::default(), StopOptions::default());
        let own = settings(&nothing.0, nothing.1, &SolveDefaults::default());
        assert_eq!(
            (own.problem.solver.as_str(), own.tolerance, own.max_iterations),
            ("gauss-seidel", 1e-10, 1000)
        );
        assert_eq!((own.problem.form_factor_tolerance, own.problem.storage), (1e-3, Precision::F64));
        assert_eq!(own.problem.discretisation, "galerkin-0");
        let theirs = settings(&nothing.0, nothing.1, &scene);
        assert_eq!(
            (theirs.problem.solver.as_str(), theirs.tolerance, theirs.max_iterations),
            ("lu", 1e-5, 7)
        );
        assert_eq!((theirs.problem.form_factor_tolerance, theirs.problem.storage), (1e-6, Precision::F32));
        assert_eq!(theirs.problem.discretisation, "nystrom-2");
        let asked = ProblemOptions {
            threads: Some(3),
            discretisation: Some("galerkin-1".into()),
            solver: Some("southwell".into()),
            form_factor_tolerance: None,
            storage: Some(Precision::F64),
            memory: Some(Bytes(2000)),
        };
        let stop = StopOptions { tolerance: None, max_iterations: Some(9) };
        let given = settings(&asked, stop, &scene);
        assert_eq!(given.problem.discretisation, "galerkin-1");
        assert_eq!((given.problem.solver.as_str(), given.problem.storage), ("southwell", Precision::F64));
        assert_eq!(
            (given.max_iterations, given.problem.threads, given.problem.memory_limit_bytes),
            (9, 3, Some(2000))
        );
    }
}
