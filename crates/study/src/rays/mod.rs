//! The computation to an accuracy by rays, for scenes in which links would take far longer.
//!
//! Each row of the light equation is estimated by rays from its element and looks at lamps
//! ([`fredholm_montecarlo::rows`]), and the equation is solved with these rows; what stands between
//! surfaces costs nothing but the time that rays take to find it. There are three steps:
//!
//! 1. Few rays tell how much the rows of each element vary, which lamps are worth a look, and whether
//!    the light of lamps may be reflected by elements as wholes: else rays look at lamps from where
//!    they end.
//! 2. Rays are shared out so that the error in the L2 norm over the faces, by chance and by the
//!    elements together, is what is asked for.
//! 3. All rows are prolonged until it is, and then those of large faces that are still uncertain;
//!    elements are divided where they are too large.
//!
//! Rays of the first step are not used in the rows of the second: elements of which few rays have
//! found little light would get few more, and keep too little. docs/rays.md. W/m².

mod budget;
mod estimate;
mod ground;

use std::ops::ControlFlow;
use std::sync::Arc;

use fredholm_coupling::Means;
use fredholm_linop::{MultiVector, StopReason};
use fredholm_mesh::{Mesh, Patch};
use fredholm_montecarlo::rows::{Family, Looks, REPLICATES, RowSampler};
use fredholm_scene::Scene;
use fredholm_visibility::Occluders;

use self::budget::{Budget, Share};
use self::estimate::Estimate;
use self::ground::{Ground, LARGE_FACE};
use crate::error::{Error, ErrorKind};
use crate::hierarchical;
use crate::memory::Plan;
use crate::options::SolveSettings;
use crate::prediction::BYTES_OF_AN_ELEMENT;
use crate::problem::{Problem, check, occluders, pictures, scene_failure, with_results};
use crate::registry;
use crate::solution::Solution;
use crate::stages::{Signals, Stages};

/// What the record calls the discretisation and the solver.
pub(crate) const NAME: &str = "rays";
/// What solves the rows, which are not symmetric.
pub(crate) const SOLVER: &str = "bicgstab";
/// The same numbers in every run.
const SEED: u64 = 1;
/// Share of the accuracy that the elements may take up before they are divided; and once many rays
/// are cast, so that it is quicker to cast some more than to begin again.
const OF_ELEMENTS: f64 = 0.6;
const MOST_OF_ELEMENTS: f64 = 0.85;
/// Error by chance over what the elements leave to it, up to which it is.
const MOST_NOISE_OVER_WHAT_IS_LEFT: f64 = 1.3;
/// Standard deviation of what a ray brings over its mean, about; share of all rays that the first
/// step takes; and its rays of a part and replicate at most.
const DEVIATION: f64 = 0.8;
const OF_FIRST_STEP: f64 = 0.1;
const MOST_OF_FIRST_STEP: f64 = 8.0;
/// Rays of a large face in the first step, so that its variance is known; and where these find it to
/// be dim.
const RAYS_OF_A_LARGE_FACE: u32 = 128;
const RAYS_OF_A_DIM_FACE: u32 = 1024;
/// One ray in so many of each part and replicate checks whether elements may reflect as wholes, the
/// first one too.
const CHECKED: usize = 4;
/// Share of the differences within elements whose elements are divided.
const DIVIDED: f64 = 0.9;
/// Steps at most, so that what cannot be reached ends.
const MOST_STEPS: u32 = 24;
/// Rays that a scene needs: [`RAYS_OF_AN_ELEMENT`] for each, [`RAYS_OF_A_FACE`] (1 %/ε)^a for each
/// face, were all of them alike, and [`RAYS_OF_A_LARGE_FACE_ALONE`] (1 %/ε) for each large one,
/// whose own error counts.
const RAYS_OF_AN_ELEMENT: f64 = 16.0;
const RAYS_OF_A_FACE: f64 = 1500.0;
const RAYS_EXPONENT: f64 = 1.4;
const RAYS_OF_A_LARGE_FACE_ALONE: f64 = 5000.0;
/// Rays of an element by this, from which on it is cut into four: four of each part and replicate.
const RAYS_OF_FOUR_PARTS: f64 = 64.0;
/// Bytes of a ray, twice while rows grow, and of a part and band of it.
const BYTES_OF_A_RAY: f64 = 10.0;
/// Bytes of a look at a lamp in the first step while lamps are weighed by it, and looks of a ray.
const BYTES_OF_A_LOOK: f64 = 80.0;
const LOOKS_OF_A_RAY: f64 = 2.0;
const BYTES_OF_A_PART: u128 = 700;
const BYTES_OF_A_BAND: u128 = 400;
/// How to need less memory.
const HELP: &str = "ask for less accuracy, use fewer elements (elements_per_face, divide, largest_edge in the scene), or no pictures";

/// What rays came to.
#[derive(Clone, Debug)]
pub(crate) struct Rays {
    /// Accuracy asked for.
    pub(crate) accuracy: f64,
    /// Rays from elements.
    pub(crate) cast: u64,
}

/// Rays that a scene of so many elements is likely to need.
pub(crate) fn expected(elements: f64, Faces { alike, large }: Faces, accuracy: f64) -> f64 {
    let ratio = 0.01 / accuracy;
    RAYS_OF_AN_ELEMENT * elements
        + RAYS_OF_A_FACE * alike * ratio.powf(RAYS_EXPONENT)
        + RAYS_OF_A_LARGE_FACE_ALONE * large * ratio
}

/// Faces of equal area that need as many rays as those of a mesh, (Σ √A)²/Σ A, and its large faces.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Faces {
    pub(crate) alike: f64,
    pub(crate) large: f64,
}

impl Faces {
    pub(crate) fn of(mesh: &Mesh) -> Self {
        let areas = || mesh.faces().iter().map(|face| face.area);
        let whole: f64 = areas().sum();
        let large = areas().filter(|&area| area > LARGE_FACE * whole).count() as f64;
        Self { alike: areas().map(f64::sqrt).sum::<f64>().powi(2) / whole, large }
    }
}

/// Which elements are cut into four. Those that are smaller than the parts of a mean one stay whole,
/// and those to which an accuracy gives few rays for each part: a part has one ray of each replicate
/// at least, needed or not.
fn in_four(mesh: &Mesh, accuracy: f64) -> impl Iterator<Item = bool> {
    let mean = mesh.patches().map(Patch::area).sum::<f64>() / mesh.len() as f64;
    // Shared out by the roots of the areas of faces, and evenly over each.
    let areas = || mesh.faces().iter().map(|face| face.area);
    let of_faces = RAYS_OF_A_FACE * (0.01 / accuracy).powf(RAYS_EXPONENT);
    let of_a_root = of_faces * areas().map(f64::sqrt).sum::<f64>() / areas().sum::<f64>();
    mesh.patches().enumerate().map(move |(element, patch)| {
        let area = patch.area();
        let rays = of_a_root * area / mesh.faces()[mesh.face_of(element)].area.sqrt();
        area >= 0.25 * mean && rays >= RAYS_OF_FOUR_PARTS
    })
}

/// Rays of a part and replicate in the first step.
fn rays_of_first_step(accuracy: f64) -> u32 {
    let few = OF_FIRST_STEP * (DEVIATION / accuracy).powi(2) / 64.0;
    1 << few.clamp(1.0, MOST_OF_FIRST_STEP).log2().round() as u32
}

/// Solves a scene to an accuracy.
pub(crate) fn compute(
    scene: &Arc<Scene>,
    options: &SolveSettings,
    accuracy: f64,
    stages: &mut Stages,
) -> Result<(Problem, Solution), Error> {
    let limit = options.problem.memory_limit();
    let count = usize::try_from(scene.predicted_elements()).unwrap_or(usize::MAX);
    stages.admit(&plan(scene, (count, 0.0, accuracy), options), limit, HELP)?;
    let mut mesh = stages.run("mesh", || scene.mesh().map_err(scene_failure))?;
    let plan = plan_on(scene, &mesh, options, accuracy);
    stages.admit(&plan, limit, HELP)?;
    let warnings = check(scene, &mesh, stages)?;
    let occluders = stages.run("visibility", || occluders(scene, &mesh))?;
    stages.begin_saving()?;
    let signals = stages.signals();
    let found = stages.run("solution", || solved((scene, &occluders), &mut mesh, accuracy, &signals))?;
    let entry =
        registry::build(registry::USUAL_SOLVER).map_err(|error| Error::new(ErrorKind::Input, error))?;
    let problem = hierarchical::problem((scene, options), mesh, (warnings, occluders), (entry, plan))?;
    let solution = solution(&problem, found, accuracy)?;
    Ok((problem, solution))
}

/// Memory of a whole run to an accuracy.
pub(crate) fn expected_plan(scene: &Scene, options: &SolveSettings, accuracy: f64) -> Result<Plan, Error> {
    let mesh = scene.mesh().map_err(scene_failure)?;
    Ok(plan_on(scene, &mesh, options, accuracy))
}

/// The same of a mesh.
pub(crate) fn plan_on(scene: &Scene, mesh: &Mesh, options: &SolveSettings, accuracy: f64) -> Plan {
    let rays = expected(mesh.len() as f64, Faces::of(mesh), accuracy);
    let parts = mesh.len() + 3 * in_four(mesh, accuracy).filter(|&is_cut| is_cut).count();
    plan(scene, (parts, rays, accuracy), options)
}

fn plan(scene: &Scene, (parts, rays, accuracy): (usize, f64, f64), options: &SolveSettings) -> Plan {
    let count = parts as u128;
    // Looks are forgotten before most rays are cast.
    let first = (REPLICATES * parts) as f64 * f64::from(rays_of_first_step(accuracy));
    let most = (BYTES_OF_A_RAY * rays).max((BYTES_OF_A_RAY + LOOKS_OF_A_RAY * BYTES_OF_A_LOOK) * first);
    let pictures = pictures(scene, 1, (options.no_pictures, options.further_pictures()));
    let bands = scene.bands().len() as u128;
    let rows = (BYTES_OF_A_PART + BYTES_OF_A_BAND * bands).saturating_mul(count);
    let plan = Plan::default()
        .hold(format!("{parts} parts of elements"), BYTES_OF_AN_ELEMENT.saturating_mul(count))
        .stage("rays", rows.saturating_add(most as u128));
    with_results(plan, scene, parts, (pictures, 0))
}

/// A solution to the accuracy, or where it was cancelled.
struct Found {
    estimate: Estimate,
    exposed: Vec<f64>,
    rays: u64,
}

/// What has to be done next.
enum Next {
    /// Rays of this budget, which are likely to be enough.
    Cast(Budget),
    /// Elements do not reflect as wholes: rays look at lamps from where they end.
    Look,
    /// These elements are too large.
    Divide(Vec<bool>),
}

fn solved(
    (scene, occluders): (&Scene, &Arc<Occluders>),
    mesh: &mut Mesh,
    accuracy: f64,
    signals: &Signals,
) -> Result<Found, Error> {
    let chosen: Vec<bool> = in_four(mesh, accuracy).collect();
    mesh.split_leaves(|leaf| chosen[leaf]).map_err(|error| Error::new(ErrorKind::Resources, error))?;
    let mut run = Run { accuracy, signals, stage: 0, rays: 0, best: None };
    let mut everywhere = false;
    loop {
        let ground = Ground::new(scene, mesh, occluders)?;
        let divided = run.on(&ground, &mut everywhere)?;
        let Some(chosen) = divided else { break };
        mesh.split_leaves(|part| chosen[part]).map_err(|error| Error::new(ErrorKind::Resources, error))?;
    }
    run.best.ok_or_else(Error::cancelled)
}

/// What earlier rows on the same elements have found: exposed shares of all parts, and what they
/// send of reflected light, W/m².
#[derive(Default)]
struct Known {
    exposed: Option<Vec<f64>>,
    sent: Option<MultiVector<f64>>,
}

/// The steps of a computation.
struct Run<'s> {
    accuracy: f64,
    signals: &'s Signals<'s>,
    stage: u32,
    rays: u64,
    best: Option<Found>,
}

impl Run<'_> {
    /// The steps on the parts of one mesh: which of them to divide; none where it is done.
    fn on(&mut self, ground: &Ground, everywhere: &mut bool) -> Result<Option<Vec<bool>>, Error> {
        let few = rays_of_first_step(self.accuracy);
        let first = ground.at_least(RAYS_OF_A_LARGE_FACE, &vec![few; ground.families.len()]);
        let mut sampler = RowSampler::new(&ground.lit, &ground.families, SEED);
        let (mut budget, mut known) = (None, Known::default());
        loop {
            let looks = if *everywhere { Looks::Everywhere } else { Looks::Checked(CHECKED) };
            match self.step((ground, &mut sampler), &mut known, (looks, &first), budget.take())? {
                None => return Ok(None),
                Some(Next::Cast(next)) => budget = Some(next),
                Some(Next::Look) => (*everywhere, budget) = (true, None),
                Some(Next::Divide(chosen)) => return Ok(Some(chosen)),
            }
        }
    }

    /// Rows of the rays of a budget, prolonged until they are exact enough, and large faces certain;
    /// or of these few, which are prolonged for dim faces alone. What else has to be done; none where
    /// it is done.
    fn step(
        &mut self,
        (ground, sampler): (&Ground, &mut RowSampler),
        known: &mut Known,
        (looks, first): (Looks, &[u32]),
        mut budget: Option<Budget>,
    ) -> Result<Option<Next>, Error> {
        let dark = budget.as_ref().map_or_else(|| vec![false; first.len()], Budget::dark);
        let mut rows = sampler.start(looks, self.stage, dark);
        self.stage += 1;
        let mut counts = budget.as_ref().map_or_else(|| first.to_vec(), Budget::counts);
        loop {
            let cast = rows.rays();
            if !sampler.prolong(&mut rows, &counts, self.signals.watch) {
                return if self.best.is_some() { Ok(None) } else { Err(Error::cancelled()) };
            }
            self.rays += rows.rays() - cast;
            let exposed = rows.exposed_shares(&ground.lit, known.exposed.as_deref());
            let by = (exposed.as_slice(), &mut known.sent);
            let estimate = Estimate::new(ground, &rows, by, (looks, self.accuracy), self.signals)?;
            let stated = estimate.stated();
            let too_large = stated > self.accuracy && self.too_large(&estimate, budget.is_none());
            // Dark faces count little in the error that is stated, and are not to be left to the few
            // rays of the first step.
            let mut is_enough = stated <= self.accuracy;
            let next = match (too_large, &mut budget) {
                (true, _) if looks == Looks::Everywhere => {
                    ControlFlow::Break(Next::Divide(divided(ground, &estimate.differences)))
                }
                (true, _) => ControlFlow::Break(Next::Look),
                (false, None) => {
                    let dim = ground.at_least_of_dim(RAYS_OF_A_DIM_FACE, &estimate.irradiance, &counts);
                    if dim == counts {
                        let budget = self.budget(ground, &estimate, &counts);
                        is_enough &= !budget.short(&counts).contains(&true);
                        ControlFlow::Break(Next::Cast(budget))
                    } else {
                        is_enough = false;
                        ControlFlow::Continue(dim)
                    }
                }
                (false, Some(budget)) => {
                    // A few rays that found far more light than the others leave a large face
                    // uncertain, though the error over all faces is small.
                    let more = budget.of_uncertain(&counts, &estimate.uncertainties);
                    let left = self.left(estimate.elements.min(MOST_OF_ELEMENTS * self.accuracy));
                    ControlFlow::Continue(if is_enough {
                        is_enough = more == counts;
                        more
                    } else {
                        let wanted = budget.prolonged(&counts, estimate.worst_noise(), left);
                        wanted.into_iter().zip(more).map(|(wanted, more)| wanted.max(more)).collect()
                    })
                }
            };
            self.best = Some(Found { estimate, exposed: exposed.clone(), rays: self.rays });
            known.exposed = Some(exposed);
            let share = (self.accuracy / stated).powi(2).min(1.0);
            self.signals
                .watch
                .advance(share, &|| format!("{} rays, estimated error {stated:.1e}", self.rays));
            if is_enough || self.stage > MOST_STEPS || self.signals.watch.go_on().is_break() {
                return Ok(None);
            }
            match next {
                ControlFlow::Break(next) => {
                    if matches!(next, Next::Cast(_)) {
                        sampler.learn(&rows);
                    }
                    return Ok(Some(next));
                }
                ControlFlow::Continue(more) if more == counts => return Ok(None),
                ControlFlow::Continue(more) => counts = more,
            }
        }
    }

    /// Whether elements leave out too much. In the first step that is a share of the accuracy; later
    /// it is so where it is quicker to begin again than to cast the rays that would make up for it.
    fn too_large(&self, estimate: &Estimate, is_first: bool) -> bool {
        let Estimate { elements, elements_at_least, .. } = *estimate;
        let is_more_than = |share: f64| elements_at_least > share * self.accuracy;
        let noise = estimate.worst_noise();
        if is_first {
            return is_more_than(OF_ELEMENTS);
        }
        let is_costly = noise > MOST_NOISE_OVER_WHAT_IS_LEFT * self.left(elements);
        is_more_than(MOST_OF_ELEMENTS)
            || is_more_than(OF_ELEMENTS) && is_costly
            || noise <= self.left(MOST_OF_ELEMENTS * self.accuracy)
    }

    /// The error by chance that an error of the elements leaves.
    fn left(&self, elements: f64) -> f64 {
        (self.accuracy.powi(2) - elements.powi(2)).max(0.0).sqrt()
    }

    /// The rays that are likely to be enough, from the first step.
    fn budget(&self, ground: &Ground, estimate: &Estimate, counts: &[u32]) -> Budget {
        let left = self.left(estimate.elements_at_least.max(0.5 * OF_ELEMENTS * self.accuracy));
        // The standard error of a large face may be the accuracy: hardly any is off by five times it.
        let of_face = self.accuracy.powi(2);
        let share = |((family, variance), norm): ((&Family, &f64), &f64)| Share {
            weighed: ground.weight(family) * variance,
            most: of_face * norm,
            parts: family.parts.len(),
        };
        let families = ground.families.iter().zip(&estimate.variance).zip(&estimate.large);
        let shares: Vec<Share> = families.map(share).collect();
        // What is stated is larger than the standard error.
        let now: f64 = shares.iter().zip(counts).map(|(s, &n)| s.weighed / f64::from(n)).sum();
        let ratio = estimate.worst_noise() / now.sqrt().max(f64::MIN_POSITIVE);
        Budget::new(shares, counts, (left / ratio.max(1.0)).powi(2))
    }
}

/// The parts of the families that differ most.
fn divided(ground: &Ground, differences: &[f64]) -> Vec<bool> {
    let mut order: Vec<usize> = (0..differences.len()).collect();
    order.sort_by(|&a, &b| differences[b].total_cmp(&differences[a]).then(a.cmp(&b)));
    let mut left = DIVIDED * differences.iter().sum::<f64>();
    let mut chosen = vec![false; ground.mesh.len()];
    for family in order {
        if left <= 0.0 {
            break;
        }
        left -= differences[family];
        chosen[ground.families[family].parts.clone()].fill(true);
    }
    chosen
}

fn solution(problem: &Problem, found: Found, accuracy: f64) -> Result<Solution, Error> {
    let Found { estimate, exposed, rays } = found;
    let (reflectance, exitance) =
        (problem.scene.reflectance(&problem.mesh), problem.scene.exitance(&problem.mesh));
    let values = estimate.irradiance.as_slice().iter().zip(&reflectance).zip(&exitance);
    let radiosity: Vec<f64> = values.map(|((e, rho), m)| m + rho * e).collect();
    let reached = estimate.stated() <= accuracy;
    let reason = if reached { StopReason::Converged } else { StopReason::Interrupted };
    let mut report = estimate.report;
    report.reason = reason;
    let means = Means { irradiance: estimate.irradiance, radiosity: problem.multivector(radiosity)? };
    Ok(Solution {
        entries: rays,
        mesh_error: Some(estimate.error),
        direct: Some(estimate.direct),
        rays: Some(Rays { accuracy, cast: rays }),
        ..Solution::unassessed(means, "rows from rays", report, exposed)
    })
}
