//! The computation to an accuracy: elements and links by hierarchical radiosity, then the same
//! results as of any other.

use std::ops::ControlFlow;
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::{Arc, Mutex, PoisonError};

use fredholm_hierarchical::{
    Goal, HierarchyError, Options as Limits, Problem as Input, RESIDUAL_OVER_ACCURACY, Round, RoundWatch,
    Solution as Solved, Solvers, State, Surfaces, expected_bytes,
};
use fredholm_linop::{Access, MultiVector, Watch};
use fredholm_mesh::{Mesh, MeshBuilder, MeshError, Patch};
use fredholm_report::{Hierarchy, HierarchyGoal, HierarchyRound, ResultFolder};
use fredholm_scene::Scene;
use fredholm_visibility::Occluders;

use crate::checkpoint::{self, Checkpoint, Header};
use crate::choice::expected;
use crate::error::{Error, ErrorKind};
use crate::memory::{Limit, Plan};
use crate::options::{Precision, ProblemSettings, SolveOptions, SolveSettings, USUAL_DISCRETISATION};
use crate::prediction::{BYTES_OF_AN_ELEMENT, Dense, Pictures, Prediction, Size, results};
use crate::problem::{self, Problem, check, occluders, scene_failure};
use crate::registry::{self, SolverEntry};
use crate::size::Bytes;
use crate::solution::{Solution, coupling_failure, solve_failure};
use crate::stages::{Signals, Stages};

/// What the record calls the discretisation.
const NAME: &str = "hierarchical";
/// What solves where the solver asked for fails: it needs products alone.
const FALLBACK_SOLVER: &str = "gmres";
/// The solver where none is asked for.
const USUAL_SOLVER: &str = "cg-theta";
/// What the operator of the links offers. A row or column of it takes a product.
const OFFERED_ACCESS: Access = Access::Diagonal;
/// How to need less memory.
const MEMORY_HELP: &str = "use fewer faces, or a smaller picture";
/// Pictures: of the field, of the elements, of links.
const MOST_PICTURES: usize = 3;
/// Share that tree and links may take of what the scene and the pictures leave: the other part is
/// for results of the elements, whose number is not known before.
const LINKS_SHARE_OF_MEMORY: f64 = 0.6;

/// Share of what tree and links take that is still there when the results are written and has no
/// room for them.
const KEPT_SHARE: f64 = 0.5;
/// Growth of elements and links in a round, where none is known yet, and the most that is expected.
const MOST_GROWTH_A_ROUND: f64 = 2.0;
const MOST_GROWTH: f64 = 3.0;

/// The options in force.
pub(crate) fn options(asked: &SolveOptions, scene: &Scene, accuracy: f64) -> Result<SolveSettings, Error> {
    let mut problem = ProblemSettings::new(&asked.problem, scene.solve());
    NAME.clone_into(&mut problem.discretisation);
    if asked.problem.solver.is_none() && scene.solve().solver.is_none() {
        USUAL_SOLVER.clone_into(&mut problem.solver);
    } else {
        let entry = registry::build(&problem.solver).map_err(|e| Error::new(ErrorKind::Input, e))?;
        if entry.access > OFFERED_ACCESS {
            return Err(unsuitable(&problem.solver));
        }
    }
    let mut options = SolveSettings::new(problem, asked.stop, scene.solve());
    options.accuracy = Some(accuracy);
    options.goal.clone_from(&asked.goal);
    options.final_gather = asked.final_gather;
    options.false_colour.clone_from(&asked.false_colour);
    options.discontinuity = asked.discontinuity;
    options.no_pictures = asked.no_pictures;
    options.no_report = asked.no_report;
    options.also.clone_from(&asked.also);
    options.points = asked.points.receivers();
    options.tolerance =
        asked.stop.tolerance.or(scene.solve().tolerance).unwrap_or(RESIDUAL_OVER_ACCURACY * accuracy);
    Ok(options)
}

/// Refuses what an accuracy is not promised for.
pub(crate) fn refuse_dense(options: &ProblemSettings) -> Result<(), Error> {
    let what = match (options.discretisation.as_str(), options.storage) {
        (USUAL_DISCRETISATION, Precision::F64) => return Ok(()),
        (USUAL_DISCRETISATION, Precision::F32) => "--storage f32".to_owned(),
        (name, _) => format!("the discretisation {name}"),
    };
    let help = "leave out one of them; with an accuracy there is no stored matrix, and the elements are \
                chosen by hierarchical radiosity";
    let text = format!("{what} does not go with an accuracy");
    Err(Error::new(ErrorKind::Input, text).with_help(help))
}

/// Refuses a goal without an accuracy.
pub(crate) fn goal_alone() -> Error {
    let help = "add one, such as --accuracy 1%; the mean irradiance of the goal will have it";
    Error::new(ErrorKind::Input, "a goal needs an accuracy").with_help(help)
}

/// The goal that the options name, if any.
fn goal(options: &SolveSettings, mesh: &Mesh) -> Result<Option<Goal>, Error> {
    let goal = (!options.goal.is_empty()).then(|| Goal::new(mesh, &options.goal));
    goal.transpose().map_err(failure)
}

fn unsuitable(solver: &str) -> Error {
    let text =
        format!("{solver} reads rows or columns of a matrix, which hierarchical radiosity does not have");
    let help = format!("with an accuracy choose one of {}", registry::names_within(OFFERED_ACCESS));
    Error::new(ErrorKind::Input, text).with_help(help)
}

/// What links take, as far as it is known.
struct Forecast {
    faces: usize,
    bands: usize,
    pictures: Pictures,
    /// Bytes that tree and links may take.
    most: u64,
    limit: Limit,
}

impl Forecast {
    /// Of a scene of so many faces.
    fn new(scene: &Scene, faces: usize, options: &SolveSettings, most: u64) -> Self {
        Self {
            faces,
            bands: scene.bands().len(),
            pictures: pictures(scene, options),
            most,
            limit: options.problem.memory_limit(),
        }
    }

    /// With so many elements and links in the end.
    fn plan(&self, [elements, links]: [usize; 2]) -> Plan {
        let bytes = expected_bytes(elements, links, self.bands).min(self.most);
        Plan::default()
            .hold(format!("{} faces", self.faces), BYTES_OF_AN_ELEMENT * self.faces as u128)
            .hold(
                format!("about {links} links and {elements} elements ({} allowed)", Bytes(self.most.into())),
                (bytes as f64 * KEPT_SHARE) as u128,
            )
            .stage("their solution", (bytes as f64 * (1.0 - KEPT_SHARE)) as u128)
            .stage("results and pictures", results(elements, self.bands, self.pictures))
    }

    /// After so many rounds: what there is, or where the accuracy is not reached yet what the next
    /// round is likely to leave.
    fn after(&self, rounds: &[Round], reached: bool) -> Option<Plan> {
        let last = rounds.last()?;
        let size = |round: &Round| [round.elements, round.links];
        if reached {
            return Some(self.plan(size(last)));
        }
        let before = rounds.len().checked_sub(2).map(|i| size(&rounds[i]));
        let grown = |k: usize| {
            let growth =
                before.map_or(MOST_GROWTH_A_ROUND, |before| size(last)[k] as f64 / before[k].max(1) as f64);
            (size(last)[k] as f64 * growth.clamp(1.0, MOST_GROWTH)) as usize
        };
        Some(self.plan([grown(0), grown(1)]))
    }
}

/// What a run to an accuracy is expected to hold, with so many elements and links where they are
/// known.
pub(crate) fn expected_plan(
    scene: &Scene,
    options: &SolveSettings,
    accuracy: f64,
    sizes: Option<[usize; 2]>,
) -> Plan {
    let count = usize::try_from(scene.predicted_faces()).unwrap_or(usize::MAX);
    let most = limits(options, accuracy, &plan(scene, count, options)).bytes;
    Forecast::new(scene, count, options, most).plan(sizes.unwrap_or_else(|| expected(count, accuracy)))
}

/// What a run came to.
pub(crate) enum Answer {
    /// A solution.
    Solved(Box<(Problem, Solution)>),
    /// Ended from outside with nothing kept: what its rounds had come to.
    Begun { rounds: Vec<Reached> },
}

/// What a round came to.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Reached {
    /// The error stated.
    pub(crate) error: f64,
    /// Elements and links.
    pub(crate) sizes: [usize; 2],
}

/// Solves a scene to an accuracy.
pub(crate) fn compute(
    scene: &Arc<Scene>,
    options: &SolveSettings,
    (accuracy, checkpoint, folder): (f64, Option<&Checkpoint>, Option<&ResultFolder>),
    stages: &mut Stages,
) -> Result<Answer, Error> {
    let admit =
        |plan: &Plan, stages: &Stages| stages.admit(plan, options.problem.memory_limit(), MEMORY_HELP);
    let count = usize::try_from(scene.predicted_faces()).unwrap_or(usize::MAX);
    admit(&plan(scene, count, options), stages)?;
    let faces = stages.run("mesh", || scene.face_mesh().map_err(scene_failure))?;
    let goal = goal(options, &faces)?;
    let warnings = check(scene, &faces, stages)?;
    let plan = plan(scene, faces.len(), options);
    admit(&plan, stages)?;
    let occluders = stages.run("visibility", || occluders(scene, &faces))?;
    let surfaces = surfaces(scene, &faces)?;
    let input = Input { mesh: &faces, occluders: &occluders, surfaces: &surfaces, goal: goal.as_ref() };
    let limits = limits(options, accuracy, &plan);
    let forecast = Forecast::new(scene, faces.len(), options, limits.bytes);
    let plan = forecast.plan(expected(faces.len(), accuracy));
    stages.tell(&plan, forecast.limit);
    let entry = registry::build(&options.problem.solver).map_err(|e| Error::new(ErrorKind::Input, e))?;
    let state = checkpoint.map(|checkpoint| state(checkpoint, scene, &input)).transpose()?;
    let fallback = registry::build(FALLBACK_SOLVER).map_err(|e| Error::new(ErrorKind::Input, e))?;
    let solvers = Solvers { first: &*entry.solver, fallback: &*fallback.solver };
    let watch = Follower {
        forecast: &forecast,
        signals: stages.signals(),
        header: Header::new(scene, options, accuracy),
        accuracy,
        folder,
        saved: AtomicBool::new(false),
        reached: Mutex::default(),
    };
    let solve = || match fredholm_hierarchical::solve(&input, &limits, solvers, state, &watch) {
        // What the last round came to is in the checkpoint, which stays: the run can go on from
        // there.
        Err(HierarchyError::Interrupted) => {
            let Some(saved) = watch.folder.filter(|_| watch.saved.load(Ordering::Relaxed)) else {
                return Ok(None);
            };
            let state = self::state(&checkpoint::read(saved.path())?, scene, &input)?;
            fredholm_hierarchical::conclude(&input, &limits, solvers, state).map_err(failure).map(Some)
        }
        solved => solved.map_err(failure).map(Some),
    };
    let solved = stages.run("solution", solve)?;
    let Some(solved) = solved else {
        let rounds = watch.reached.into_inner().unwrap_or_else(PoisonError::into_inner);
        return Ok(Answer::Begun { rounds });
    };
    stages.begin_saving()?;
    if let Some(plan) = forecast.after(&solved.rounds, true) {
        stages.tell(&plan, forecast.limit);
    }
    let mesh = refined(&faces, &solved).map_err(|e| Error::new(ErrorKind::Input, e))?;
    let problem = problem((scene, options), mesh, (warnings, occluders), (entry, plan))?;
    Ok(Answer::Solved(Box::new((problem, solution(solved, options, accuracy)))))
}

/// The problem that was solved, on the elements that it came to.
pub(crate) fn problem(
    (scene, options): (&Arc<Scene>, &SolveSettings),
    mesh: Mesh,
    (warnings, occluders): (Vec<String>, Arc<Occluders>),
    (solver, plan): (SolverEntry, Plan),
) -> Result<Problem, Error> {
    let (unknowns, dense) = (mesh.len(), Some(Dense { bytes: 0 }));
    let size = Size { elements: unknowns, unknowns, dense };
    let discretisation = fredholm_discretisation::discretisation(USUAL_DISCRETISATION)
        .map_err(|error| Error::new(ErrorKind::Input, error))?;
    Ok(Problem {
        scene: Arc::clone(scene),
        options: options.problem.clone(),
        discretisation,
        prediction: Prediction::new(size, scene.bands().len(), Precision::F64, &solver),
        plan,
        solver,
        mesh,
        unknowns,
        warnings,
        occluders,
    })
}

/// The state of a checkpoint, which must be one of this scene.
fn state(checkpoint: &Checkpoint, scene: &Scene, input: &Input) -> Result<State, Error> {
    if checkpoint.header.scene_sha256 != scene.sha256() {
        let text = format!("{} has changed since the checkpoint", scene.path().display());
        return Err(Error::new(ErrorKind::Input, text).with_help("solve it again"));
    }
    State::read(input, &mut checkpoint.state.as_slice()).map_err(failure)
}

/// What is held besides tree and links.
fn plan(scene: &Scene, count: usize, options: &SolveSettings) -> Plan {
    let bands = scene.bands().len();
    Plan::default()
        .hold(format!("{count} faces"), BYTES_OF_AN_ELEMENT * count as u128)
        .hold("results and pictures", results(count, bands, pictures(scene, options)))
}

/// Pictures that are drawn.
fn pictures(scene: &Scene, options: &SolveSettings) -> Pictures {
    problem::pictures(scene, MOST_PICTURES, (options.no_pictures, options.further_pictures()))
}

fn limits(options: &SolveSettings, accuracy: f64, plan: &Plan) -> Limits {
    let allowed = options.problem.memory_limit().bytes().0.saturating_sub(plan.peak().0);
    let allowed = u64::try_from(allowed).unwrap_or(u64::MAX);
    Limits {
        accuracy,
        linear: true,
        residual: options.tolerance,
        bytes: (allowed as f64 * LINKS_SHARE_OF_MEMORY) as u64,
        max_iterations: usize::try_from(options.max_iterations).unwrap_or(usize::MAX),
    }
}

fn surfaces(scene: &Scene, mesh: &Mesh) -> Result<Surfaces, Error> {
    let vector = |values| {
        let vector = MultiVector::from_vec(mesh.len(), scene.bands().len(), values);
        vector.map_err(|error| Error::new(ErrorKind::Input, error))
    };
    Ok(Surfaces { reflectance: vector(scene.reflectance(mesh))?, exitance: vector(scene.exitance(mesh))? })
}

/// The mesh of the faces, each on the elements that the solution has there.
fn refined(faces: &Mesh, solved: &Solved) -> Result<Mesh, MeshError> {
    let mut parts: Vec<Vec<Patch>> = vec![Vec::new(); faces.faces().len()];
    for leaf in solved.tree.leaves() {
        let node = &solved.tree.nodes()[leaf as usize];
        if let (Some(face), Some(patch)) = (node.face(), node.patch()) {
            parts[face].push(*patch);
        }
    }
    let mut builder = MeshBuilder::default();
    let mut parts = parts.into_iter().zip(faces.faces()).peekable();
    for (index, surface) in faces.surfaces().iter().enumerate() {
        builder.surface(surface.name.as_str(), surface.material);
        while let Some((part, _)) = parts.next_if(|(_, face)| face.surface == index) {
            builder.face(&part)?;
        }
    }
    faces.occluders().iter().for_each(|patch| builder.occluder(*patch));
    Ok(builder.build())
}

fn solution(solved: Solved, options: &SolveSettings, accuracy: f64) -> Solution {
    let energy = solved.system.energy(&solved.radiosity, &solved.means, &solved.closure);
    let exposed = solved.system.elements().iter().map(|size| size.exposed / size.area).collect();
    let stated = |error: &fredholm_hierarchical::Stated| fredholm_coupling::MeshError {
        relative_l2: error.relative_l2.clone(),
        largest: error.largest.clone(),
        per_face: Vec::new(),
    };
    let entries = 2 * solved.links.len() as u64;
    Solution {
        // With a goal nothing is stated for the faces.
        mesh_error: solved.error.as_ref().filter(|_| solved.goal.is_none()).map(stated),
        hierarchy: Some(hierarchy(&solved, options, accuracy)),
        tree: Some(crate::pictures::Hierarchy { tree: solved.tree, links: solved.links }),
        rays: None,
        means: solved.means,
        direct: Some(solved.direct),
        report: solved.report,
        means_of: "H B_h, over links",
        entries,
        closure: solved.closure,
        row_error: Vec::new(),
        pair_error: None,
        reciprocity: None,
        methods: None,
        exposed,
        energy,
        field_error: None,
        senders: Vec::new(),
        replaced: solved
            .replaced
            .map(|why| format!("{} was replaced by {FALLBACK_SOLVER}: {why}", options.problem.solver)),
    }
}

fn hierarchy(solved: &Solved, options: &SolveSettings, accuracy: f64) -> Hierarchy {
    let round = |round: &Round| HierarchyRound {
        threshold: round.threshold,
        elements: round.elements as u64,
        links: round.links as u64,
        change: round.change,
    };
    Hierarchy {
        accuracy,
        stated: solved.error.as_ref().map(fredholm_hierarchical::Stated::worst),
        goal: solved.goal.as_ref().map(|reached| HierarchyGoal {
            surfaces: options.goal.clone(),
            irradiance: reached.irradiance.clone(),
            relative_error: solved.error.as_ref().map(|error| error.relative_l2.clone()).unwrap_or_default(),
        }),
        links: solved.links.len() as u64,
        limited: solved.limited,
        rounds: solved.rounds.iter().map(round).collect(),
    }
}

/// Follows the rounds.
struct Follower<'a> {
    forecast: &'a Forecast,
    signals: Signals<'a>,
    header: Header,
    accuracy: f64,
    /// Where checkpoints are kept.
    folder: Option<&'a ResultFolder>,
    /// Whether there is a checkpoint of this run.
    saved: AtomicBool,
    /// The rounds that stated an error.
    reached: Mutex<Vec<Reached>>,
}

impl Watch for Follower<'_> {
    fn go_on(&self) -> ControlFlow<()> {
        self.signals.watch.go_on()
    }
}

impl RoundWatch for Follower<'_> {
    fn round(&self, rounds: &[Round], state: &State) -> Result<(), HierarchyError> {
        let Some(last) = rounds.last() else { return Ok(()) };
        if let Some(folder) = self.folder {
            checkpoint::write(folder, &self.header, state).map_err(|why| HierarchyError::Save { why })?;
            self.saved.store(true, Ordering::Relaxed);
            // From now on there is a result worth the wait.
            self.signals.begin_saving().map_err(|_| HierarchyError::Interrupted)?;
        }
        let error = state.error().map(fredholm_hierarchical::Stated::worst);
        if let Some(error) = error {
            let sizes = [last.elements, last.links];
            self.reached.lock().unwrap_or_else(PoisonError::into_inner).push(Reached { error, sizes });
        }
        let reached = error.is_some_and(|error| error <= self.accuracy);
        if let Some(plan) = self.forecast.after(rounds, reached) {
            plan.tell(self.forecast.limit, self.signals.watch);
        }
        // The digits gained of those asked for.
        let share = error.map_or(0.0, |error| (error.ln() / self.accuracy.ln()).clamp(0.0, 1.0));
        self.signals.watch.advance(share, &|| {
            let error = error.map_or_else(String::new, |error| format!(", estimated error {error:.1e}"));
            format!("round {}: {} elements, {} links{error}", rounds.len(), last.elements, last.links)
        });
        Ok(())
    }
}

pub(crate) fn interrupted() -> Error {
    let text = "interrupted before the first round had ended; there is no result, nothing was written";
    Error::new(ErrorKind::Interrupted, text)
}

fn failure(error: HierarchyError) -> Error {
    match error {
        HierarchyError::Interrupted => interrupted(),
        HierarchyError::Solve(error) => solve_failure(error),
        HierarchyError::Coupling(error) => coupling_failure(error),
        HierarchyError::Memory { .. } | HierarchyError::TooLarge => Error::new(ErrorKind::Resources, error),
        HierarchyError::Save { .. } => Error::new(ErrorKind::Files, error),
        _ => Error::new(ErrorKind::Input, error),
    }
}
