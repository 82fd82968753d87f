//! The computation to an accuracy by random paths, for scenes of so many faces that links would
//! take far longer.
//!
//! Particles leave the lamps in proportion to their power, E_i = Σ w/A_i over those that arrive at
//! element i, are reflected by chance and absorbed by chance (Russian roulette): the mean of every
//! element has no error but that of chance, whatever the mesh. The error in the L2 norm over the
//! faces, e² = Σ A s²/Σ A E² with the standard errors s of the batches, falls as 1/√N and is about
//! √(faces/N), so that it hardly matters how the faces lie
//! (light or particle tracing; docs/montecarlo.md). W/m².

use std::sync::Arc;

use fredholm_coupling::{Means, MeshError};
use fredholm_linop::{Report, StopReason, Watch, Work};
use fredholm_mesh::Mesh;
use fredholm_montecarlo::light::{Switches, estimator};
use fredholm_montecarlo::{BATCHES_AT_ONCE, Enclosure, FEWEST_BATCHES, State, Stop, Tracing};
use fredholm_scene::Scene;

use crate::error::{Error, ErrorKind};
use crate::hierarchical;
use crate::memory::Plan;
use crate::options::SolveSettings;
use crate::prediction::BYTES_OF_AN_ELEMENT;
use crate::problem::{Problem, check, occluders, pictures, scene_failure, with_results};
use crate::registry::{self, SolverEntry};
use crate::solution::Solution;
use crate::stages::Stages;
use crate::stochastic::{Silent, enclosure, faces, failure, with_tracing};

/// The estimator, and what the record calls the discretisation and the solver.
const METHOD: &str = "light";
pub(crate) const NAME: &str = "random-paths";
/// The same numbers in every run.
const SEED: u64 = 1;
/// Particles for each face at an error of 1, about: most arrive several times.
const PARTICLES_A_FACE: f64 = 0.25;
/// Batches in which the accuracy is likely to be reached, and sizes of a batch.
const BATCHES: f64 = 48.0;
const SAMPLES_OF_A_BATCH: [f64; 2] = [4096.0, 1_048_576.0];
/// Stated error over the standard error, at least: faces that the same paths light err together.
const CONFIDENCE: f64 = 1.25;
/// Standard errors that are stated for a single face.
const OF_FACE: f64 = 2.0;
/// How to need less memory.
const HELP: &str =
    "use fewer elements (elements_per_face, divide, largest_edge in the scene), or no pictures";

/// What random paths came to.
#[derive(Clone, Debug)]
pub(crate) struct Paths {
    /// Accuracy asked for.
    pub(crate) accuracy: f64,
    /// Paths that began at lamps, and rays and segments of them.
    pub(crate) begun: u64,
    pub(crate) rays: u64,
}

/// Solves a scene to an accuracy.
pub(crate) fn compute(
    scene: &Arc<Scene>,
    options: &SolveSettings,
    accuracy: f64,
    stages: &mut Stages,
) -> Result<(Problem, Solution), Error> {
    let count = usize::try_from(scene.predicted_elements()).unwrap_or(usize::MAX);
    let plan = plan(scene, count, options);
    stages.admit(&plan, options.problem.memory_limit(), HELP)?;
    let mesh = stages.run("mesh", || scene.mesh().map_err(scene_failure))?;
    let warnings = check(scene, &mesh, stages)?;
    let occluders = stages.run("visibility", || occluders(scene, &mesh))?;
    let lit = stages.run("exposure", || enclosure(scene, &mesh))?;
    stages.begin_saving()?;
    let watch = stages.watch;
    let (state, found) = stages.run("solution", || traced(&mesh, &lit, accuracy, watch))?;
    let entry = solver()?;
    let problem = hierarchical::problem((scene, options), mesh, (warnings, occluders), (entry, plan))?;
    let solution = solution(&problem, &lit, (&state, found), accuracy)?;
    Ok((problem, solution))
}

/// An entry for the problem, which needs one; nothing is solved with it.
fn solver() -> Result<SolverEntry, Error> {
    registry::build(registry::USUAL_SOLVER).map_err(|error| Error::new(ErrorKind::Input, error))
}

fn plan(scene: &Scene, elements: usize, options: &SolveSettings) -> Plan {
    let pictures = pictures(scene, 1, (options.no_pictures, options.further_pictures()));
    let plan = Plan::default()
        .hold(format!("{elements} elements"), BYTES_OF_AN_ELEMENT.saturating_mul(elements as u128));
    with_results(with_tracing(plan, scene, elements), scene, elements, (pictures, 0))
}

/// Paths that a scene of so many faces is likely to need.
pub(crate) fn expected_paths(faces: usize, accuracy: f64) -> f64 {
    PARTICLES_A_FACE * faces as f64 * (CONFIDENCE / accuracy).powi(2)
}

/// How exact the means are: the stated error of all faces in each band, and that of each face.
struct Stated {
    error: MeshError,
    reason: StopReason,
}

/// Traces until the stated error is within the accuracy, or the run is cancelled.
fn traced(mesh: &Mesh, lit: &Enclosure, accuracy: f64, watch: &dyn Watch) -> Result<(State, Stated), Error> {
    let method = estimator(METHOD, lit, Switches::default())
        .ok_or_else(|| Error::new(ErrorKind::Input, format!("there is no method {METHOD}")))?;
    let particles = expected_paths(mesh.faces().len(), accuracy);
    let samples = (particles / BATCHES).clamp(SAMPLES_OF_A_BATCH[0], SAMPLES_OF_A_BATCH[1]) as u32;
    let tracing = Tracing::new(lit, &*method, faces(mesh, lit)?, SEED, samples.next_power_of_two());
    let tracing = tracing.map_err(failure)?;
    let mut state = tracing.start();
    loop {
        let stop = Stop { batches: Some(state.batches() + u64::from(BATCHES_AT_ONCE)), ..Stop::default() };
        tracing.go_on(&mut state, &stop, &Silent(watch)).map_err(failure)?;
        if state.batches() < 2 {
            return Err(Error::cancelled());
        }
        let error = stated(mesh, &state, lit.bands());
        let worst = error.relative_l2.iter().copied().fold(0.0, f64::max);
        let reached = state.batches() >= u64::from(FEWEST_BATCHES) && worst <= accuracy;
        if reached || watch.go_on().is_break() {
            let reason = if reached { StopReason::Converged } else { StopReason::Interrupted };
            return Ok((state, Stated { error, reason }));
        }
        let share = (accuracy / worst).powi(2).min(1.0);
        watch.advance(share, &|| format!("{} paths, estimated error {worst:.1e}", state.paths));
    }
}

/// What the standard errors of the faces say.
fn stated(mesh: &Mesh, state: &State, bands: usize) -> MeshError {
    let (means, errors) = (state.groups.mean(), state.groups.standard_errors());
    let relative = |band: usize| {
        let (mut squares, mut norm, mut fourths) = (0.0, 0.0, 0.0);
        for (face, of) in mesh.faces().iter().enumerate() {
            let (mean, error) = (means[face * bands + band], errors[face * bands + band]);
            let square = of.area * error * error;
            squares += square;
            fourths += square * square;
            norm += of.area * mean * mean;
        }
        if squares > 0.0 { (squares / norm).sqrt() * confidence(squares * squares / fourths) } else { 0.0 }
    };
    let per_face: Vec<f64> = errors.iter().map(|error| OF_FACE * error).collect();
    let largest = |band| per_face.iter().skip(band).step_by(bands).copied().fold(0.0, f64::max);
    MeshError {
        relative_l2: (0..bands).map(relative).collect(),
        largest: (0..bands).map(largest).collect(),
        per_face,
    }
}

/// The 95 % quantile of √(χ²/k) for so many independent squares (E. B. Wilson, M. M. Hilferty,
/// Proc. Natl. Acad. Sci. 17, 684–688, 1931), no less than [`CONFIDENCE`].
fn confidence(independent: f64) -> f64 {
    let ninth = 2.0 / (9.0 * independent.max(1.0));
    (1.0 - ninth + 1.645 * ninth.sqrt()).powf(1.5).max(CONFIDENCE)
}

fn solution(
    problem: &Problem,
    lit: &Enclosure,
    (state, Stated { error, reason }): (&State, Stated),
    accuracy: f64,
) -> Result<Solution, Error> {
    let exposed = (0..lit.len()).map(|patch| lit.exposed(patch)).collect();
    let (reflectance, exitance) =
        (problem.scene.reflectance(&problem.mesh), problem.scene.exitance(&problem.mesh));
    let irradiance = state.patches.mean().to_vec();
    let radiosity: Vec<f64> =
        irradiance.iter().zip(&reflectance).zip(&exitance).map(|((e, rho), m)| m + rho * e).collect();
    Ok(Solution {
        means: Means {
            irradiance: problem.multivector(irradiance)?,
            radiosity: problem.multivector(radiosity)?,
        },
        report: Report { reason, history: Vec::new(), work: Work::default(), seconds: state.seconds },
        means_of: "random paths",
        entries: 0,
        closure: Vec::new(),
        row_error: Vec::new(),
        pair_error: None,
        reciprocity: None,
        methods: None,
        exposed,
        energy: Vec::new(),
        mesh_error: Some(error),
        hierarchy: None,
        tree: None,
        direct: None,
        paths: Some(Paths { accuracy, begun: state.paths, rays: state.rays }),
        field_error: None,
        senders: Vec::new(),
        replaced: None,
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn few_independent_squares_need_more_confidence() {
        // √χ² of one and of ten degrees of freedom at 95 %, from tables: 1.960 and √(18.307/10).
        assert!((confidence(1.0) - 1.960).abs() < 0.03);
        assert!((confidence(10.0) - 1.353).abs() < 0.005);
        assert!((confidence(1e6) - CONFIDENCE).abs() < 1e-12);
    }
}
