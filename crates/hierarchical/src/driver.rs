//! Solve, refine where the solution says so, solve again: until the change from one solution to the
//! next says that the accuracy is reached.
//!
//! Every round lowers the error that a link may leave by [`THRESHOLD_RATIO`]. The irradiance of the
//! input faces then changes by about what the round before was wrong by; what remains is less. The
//! stated error is [`CONFIDENCE`] times the relative change ‖E − E'‖/‖E‖ in the area-weighted L2
//! norm over the faces, in the worst band; a change is not believed to be less than
//! [`LEAST_CHANGE_RATIO`] times the one before. To it comes what the balance of energy tells: the
//! power that row sums lose or gain against what rays say, over the power that is absorbed; and
//! what the residual of the solver leaves, amplified as reflection may amplify it. The irradiances
//! are solutions, so that multiple reflection has amplified it already.
//!
//! A round that refined nothing tells nothing: it keeps the error that was stated before. So does a
//! round that memory ended, but for a larger change. With a [`Goal`] the dual problem is solved in
//! every round too, and the error is that of the mean irradiance of the goal ([`crate::goal`]).

use crate::closure::{Aim, Wholes, balance};
use crate::exposure::Exposure;
use crate::goal::{Estimate, Goal, Reached, expected, weights};
use crate::oracle::Light;
use crate::refine::{Limits, bytes, refine};
use crate::transport::Sight;
use crate::{HierarchicalOperator, HierarchyError, Link, State, Surfaces, Tree};
use fredholm_coupling::{Extent, Means, Radiosity};
use fredholm_linop::{
    MultiVector, Progress, Quiet, Report, SecondKind, SolveError, Solver, Stop, StopReason, Watch,
};
use fredholm_mesh::{Mesh, Patch};
use fredholm_visibility::Occluders;
use fredholm_visibility::body::Bodies;
use std::sync::Arc;

/// Factor from one threshold to the next.
pub(crate) const THRESHOLD_RATIO: f64 = 0.3;
/// First threshold, over the accuracy.
const FIRST_THRESHOLD: f64 = 4.0;
/// Stated error over the last change.
pub(crate) const CONFIDENCE: f64 = 2.0;
/// Least change that is believed, over that of the round before: a smaller one is chance.
const LEAST_CHANGE_RATIO: f64 = 0.35;
/// Rounds at most.
const ROUNDS: usize = 24;
/// Residual of a solution, over the accuracy, that is small beside it.
pub const RESIDUAL_OVER_ACCURACY: f64 = 1e-3;
/// Share of the accuracy that the residual of the solver may cost.
const RESIDUAL_SHARE_OF_ACCURACY: f64 = 0.05;
/// No residual less than this is asked for: rounding would keep it from being met.
const LEAST_RESIDUAL: f64 = 1e-13;
/// Tolerance of exchanges, over the accuracy.
const EXCHANGE_OVER_ACCURACY: f64 = 0.1;
/// Least area of an element, over that of the scene.
const LEAST_AREA: f64 = 1e-10;

/// What row sums may exceed 1 by where it is not known whether something leaves: cutting off all
/// that is above, and adding nothing to what is below, would lose power.
const ROW_SUM_SLACK: f64 = 0.04;
/// Mean relative change of the factors at which scaling ends, over the least slack and the
/// accuracy: what is left to be cut is small beside them.
const SCALED_ENOUGH: f64 = 0.05;
/// Row sum up to which a leaf of a closed scene is not believed to lack links alone.
const LEAST_ROW: f64 = 0.7;

/// What links that are not divided may hide, over the share of the light that each may carry: found
/// by trying nearly white rooms that lose light.
const HIDDEN_BY_LINKS: f64 = 3.0;
/// The most that was found hidden: 24 % by 33 links.
const MOST_HIDDEN_BY_LINKS: f64 = 0.25;
/// How often light is received in the mean, up to which changes from round to round tell enough.
const TIMES_RECEIVED: f64 = 4.0;
/// Standard errors from which on a difference between rays and links of the whole scene is taken
/// for a fault of the links.
const CLEAR_STANDARD_ERRORS: f64 = 2.0;
/// Least part of the differences between rays and links that is worth taking for faults of the
/// links.
const LEAST_PART: f64 = 0.2;

/// Occluders that are put together to bodies, at most.
const MOST_JOINED_OCCLUDERS: usize = 2048;

/// What is solved.
#[derive(Clone, Copy, Debug)]
pub struct Problem<'a> {
    /// The input elements, one a leaf.
    pub mesh: &'a Mesh,
    /// What blocks the view.
    pub occluders: &'a Occluders,
    /// Materials of the input elements.
    pub surfaces: &'a Surfaces,
    /// Where accuracy is asked for; everywhere where there is none.
    pub goal: Option<&'a Goal>,
}

/// How far to go.
#[derive(Clone, Copy, Debug)]
pub struct Options {
    /// Relative error to reach: of the irradiance of the faces, L2, or of the mean irradiance of
    /// the goal.
    pub accuracy: f64,
    /// Whether links follow the variation of the form factor to first order; else it is constant
    /// over each node.
    pub linear: bool,
    /// Relative residual ‖b − A x‖₂/‖b‖₂ to which each system is solved; [`RESIDUAL_OVER_ACCURACY`]
    /// times the accuracy is small beside it.
    pub residual: f64,
    /// Bytes that tree and links may take.
    pub bytes: u64,
    /// Iterations of the solver at most, in each round.
    pub max_iterations: usize,
}

/// What a round did.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Round {
    /// Relative error that one link was allowed to leave.
    pub threshold: f64,
    /// Leaves.
    pub elements: usize,
    /// Links, each of which serves both ways.
    pub links: usize,
    /// Relative change of the irradiance of the faces since the round before, L2, worst band; none
    /// in the first. With a goal, that of its mean irradiance, or what the input elements have to
    /// do with it if that is more.
    pub change: Option<f64>,
}

/// Estimated error of the irradiance of the faces, or of its mean over the goal where there is one.
#[derive(Clone, Debug, PartialEq)]
pub struct Stated {
    /// Relative, of each band; the area-weighted L2 norm over the faces, or that of the one mean.
    pub relative_l2: Vec<f64>,
    /// Largest of a face, or that of the mean, W/m², of each band.
    pub largest: Vec<f64>,
}

impl Stated {
    /// The relative error of the worst band.
    #[must_use]
    pub fn worst(&self) -> f64 {
        self.relative_l2.iter().copied().fold(0.0, f64::max)
    }

    /// The same with a further error of the whole of each band.
    fn with(mut self, further: &[f64]) -> Self {
        self.relative_l2.iter_mut().zip(further).for_each(|(error, further)| *error += further);
        self
    }

    /// Whatever is more of either.
    fn or_more(mut self, other: &Self) -> Self {
        let more = |errors: &mut [f64], others: &[f64]| {
            errors.iter_mut().zip(others).for_each(|(error, other)| *error = error.max(*other));
        };
        more(&mut self.relative_l2, &other.relative_l2);
        more(&mut self.largest, &other.largest);
        self
    }
}

/// A watch that follows the rounds of a solution.
pub trait RoundWatch: Watch {
    /// Called after each round with all rounds so far and the state to go on from.
    ///
    /// # Errors
    /// What the caller cannot do, such as saving the state, ends the solution.
    fn round(&self, _rounds: &[Round], _state: &State) -> Result<(), HierarchyError> {
        Ok(())
    }
}

impl RoundWatch for Quiet {}

/// A solved problem.
#[derive(Debug)]
pub struct Solution {
    /// Elements and clusters.
    pub tree: Tree,
    /// Links.
    pub links: Arc<Vec<Link>>,
    /// Irradiance and radiosity of the leaves, W/m², in the order of [`Tree::leaves`].
    pub means: Means,
    /// The part of the irradiance that comes straight from what emits, W/m²: the links' own mean of
    /// it.
    pub direct: MultiVector<f64>,
    /// The system of the leaves.
    pub system: Radiosity,
    /// Radiosity of the exposed parts of the leaves, W/m².
    pub radiosity: MultiVector<f64>,
    /// Row sums Σ_j F_ij of the exposed parts.
    pub closure: Vec<f64>,
    /// What the solver did in the last round.
    pub report: Report,
    /// All rounds.
    pub rounds: Vec<Round>,
    /// Estimated error of the irradiance of the faces, or of the goal where there is one; none
    /// after a single round, or two with a goal.
    pub error: Option<Stated>,
    /// What was reached of the goal, where there is one.
    pub goal: Option<Reached>,
    /// Whether memory ended the refinement before the accuracy was reached.
    pub limited: bool,
    /// Factors of the leaves on both sides of the operator of the links, which make its row sums
    /// hold.
    pub scale: Vec<f64>,
    /// Why the solver asked for was replaced by the other one, where it was.
    pub replaced: Option<String>,
}

/// The solver to be used, and the one that takes its place where it fails.
#[derive(Clone, Copy)]
pub struct Solvers<'a> {
    /// The one asked for.
    pub first: &'a dyn Solver<f64>,
    /// One that needs no more than products.
    pub fallback: &'a dyn Solver<f64>,
}

/// Bytes that a tree with so many leaves and its links take with all that a solution of some bands
/// does with them.
#[must_use]
pub fn expected_bytes(elements: usize, links: usize, bands: usize) -> u64 {
    // The parts of the divided and the clusters of all: a half more, as measured.
    bytes(elements.saturating_add(elements / 2), links, bands)
}

/// Solves to an accuracy, from the start or from a saved state.
///
/// # Errors
/// Any [`HierarchyError`].
pub fn solve(
    problem: &Problem,
    options: &Options,
    solvers: Solvers,
    state: Option<State>,
    watch: &dyn RoundWatch,
) -> Result<Solution, HierarchyError> {
    if !(options.accuracy > 0.0 && options.accuracy < 1.0) {
        return Err(HierarchyError::Accuracy { value: options.accuracy });
    }
    with_run(problem, options, solvers, watch, |run| {
        let mut state = match state {
            Some(state) => run.taken(state)?,
            None => State::new(problem, options.accuracy * FIRST_THRESHOLD)?,
        };
        let mut system = run.resumed(&state)?;
        loop {
            let (next, report) = run.round(&mut state, system.take())?;
            let ends = report.reason != StopReason::Converged || state.limited || run.enough(&state);
            if ends {
                return Ok(run.finish(state, next, report));
            }
            state.threshold *= THRESHOLD_RATIO;
            watch.round(&state.rounds, &state)?;
            system = Some(next);
        }
    })
}

/// The solution that a saved state holds, such as that of the last round before a run was
/// interrupted, with the error that was stated then. Nothing is refined or solved.
///
/// # Errors
/// [`HierarchyError::State`] for a state without a round, or one of another goal.
pub fn conclude(
    problem: &Problem,
    options: &Options,
    solvers: Solvers,
    state: State,
) -> Result<Solution, HierarchyError> {
    with_run(problem, options, solvers, &Quiet, |run| {
        let state = run.taken(state)?;
        let Some(system) = run.resumed(&state)? else {
            return Err(HierarchyError::State { why: "has no round yet" });
        };
        // No iteration: only the residual is wanted.
        let stop = Stop { tolerance: options.residual, max_iterations: 0 };
        let (rhs, mut x) = (system.radiosity.exitance(), state.radiosity.clone());
        let found = run.solved(&system, rhs, &mut x, stop)?;
        Ok(run.finish(state, system, Report { reason: StopReason::Interrupted, ..found }))
    })
}

/// Prepares what does not change from round to round.
fn with_run<T>(
    problem: &Problem,
    options: &Options,
    solvers: Solvers,
    watch: &dyn RoundWatch,
    f: impl FnOnce(&mut Run) -> Result<T, HierarchyError>,
) -> Result<T, HierarchyError> {
    let patches: Vec<&Patch> = problem.mesh.patches().collect();
    let many = problem.occluders.len() > MOST_JOINED_OCCLUDERS;
    let bodies = if many { Bodies::default() } else { Bodies::new(problem.occluders, &patches, &[]) };
    let reflectances = problem.surfaces.reflectance.as_slice();
    let exposure = Exposure::new(problem.mesh, reflectances.iter().copied().fold(0.0, f64::max))?;
    let sight = Sight { occluders: problem.occluders, bodies: &bodies, many };
    let dual = problem.goal.map(|goal| (goal, goal.dual(problem.mesh, problem.surfaces)));
    f(&mut Run { problem, options, solvers, watch, sight, exposure, dual, replaced: None })
}

/// The operator of some links and the system that it makes.
struct System {
    operator: HierarchicalOperator,
    radiosity: Radiosity,
    /// The input element of each leaf.
    roots: Vec<u32>,
    /// w of the dual problem, where there is a goal, 1/m².
    dual: Option<MultiVector<f64>>,
}

/// What a round starts from, on all nodes.
struct Known {
    radiosity: MultiVector<f64>,
    /// With a goal: irradiance, W/m², and importance, 1/m².
    goal: Option<[MultiVector<f64>; 2]>,
}

/// What does not change from round to round.
struct Run<'a> {
    problem: &'a Problem<'a>,
    options: &'a Options,
    solvers: Solvers<'a>,
    watch: &'a dyn RoundWatch,
    sight: Sight<'a>,
    exposure: Exposure<'a>,
    /// With a goal: the dual problem, of the same reflectances.
    dual: Option<(&'a Goal, Surfaces)>,
    /// Why the fallback solves.
    replaced: Option<String>,
}

impl Solution {
    /// The operator that was solved with.
    #[must_use]
    pub fn operator(&self) -> HierarchicalOperator {
        let exposed = exposed(self.system.elements());
        let mut operator = HierarchicalOperator::new(&self.tree, Arc::clone(&self.links), &exposed);
        operator.set_scale(self.scale.clone());
        operator
    }

    /// Bytes of the tree, the links and the vectors on them.
    #[must_use]
    pub fn bytes(&self) -> u64 {
        bytes(self.tree.nodes().len(), self.links.len(), self.radiosity.rhs_count())
    }
}

impl Run<'_> {
    /// A saved state, which must be one of the goal.
    fn taken(&self, state: State) -> Result<State, HierarchyError> {
        let goal = self.problem.goal.map_or(&[][..], Goal::surfaces);
        if state.goal == goal {
            Ok(state)
        } else {
            Err(HierarchyError::State { why: "belongs to another goal" })
        }
    }

    /// The system of a state that has been solved.
    fn resumed(&mut self, state: &State) -> Result<Option<System>, HierarchyError> {
        if state.rounds.is_empty() { Ok(None) } else { self.system(&state.tree, &state.links).map(Some) }
    }

    fn system(&mut self, tree: &Tree, links: &Arc<Vec<Link>>) -> Result<System, HierarchyError> {
        let mut extents = self.exposure.extents(tree, &tree.leaves());
        let mut operator = HierarchicalOperator::new(tree, Arc::clone(links), &exposed(&extents));
        if widen(&mut extents, &operator.row_sums()) {
            operator = HierarchicalOperator::new(tree, Arc::clone(links), &exposed(&extents));
        }
        let root = |&leaf: &u32| tree.nodes()[leaf as usize].root().unwrap_or(0) as u32;
        let roots: Vec<u32> = operator.leaves().iter().map(root).collect();
        // Far from a goal elements are coarse and row sums rough: to correct them would disturb
        // what the goal receives.
        if self.dual.is_none() {
            self.close(tree, &mut operator, &extents, &roots);
        }
        let of_leaves = |values: &MultiVector<f64>| {
            MultiVector::from_fn(roots.len(), values.rhs_count(), |i, band| {
                values.row(roots[i] as usize)[band]
            })
        };
        let Surfaces { reflectance, exitance } = self.problem.surfaces;
        let radiosity = Radiosity::new(extents, of_leaves(reflectance), of_leaves(exitance))?;
        let dual = self.dual.as_ref().map(|(_, dual)| of_leaves(&dual.exitance));
        Ok(System { operator, radiosity, roots, dual })
    }

    /// Scales the operator until its row sums hold: none above 1 by more than a tolerance, and 1
    /// exactly in a closed scene. A row sum that is far too small there has another cause, such as
    /// a buried part that no grid saw, and is left as it is.
    fn close(&self, tree: &Tree, operator: &mut HierarchicalOperator, extents: &[Extent], roots: &[u32]) {
        let slack = |root: u32| {
            let reflectances = self.problem.surfaces.reflectance.row(root as usize);
            let reflectance = reflectances.iter().copied().fold(0.0, f64::max);
            // Half of what would make the system indefinite.
            ROW_SUM_SLACK.min(0.5 * (1.0 / reflectance - 1.0))
        };
        let aim = |((size, &root), row): ((&Extent, &u32), f64)| {
            if self.exposure.opening().loses_nothing(root as usize) && row > LEAST_ROW * size.exposed {
                Aim { least: size.exposed, most: size.exposed }
            } else {
                Aim { least: 0.0, most: (1.0 + slack(root)) * size.exposed }
            }
        };
        let rows = operator.row_sums();
        let aims: Vec<Aim> = extents.iter().zip(roots).zip(rows.iter().copied()).map(aim).collect();
        let kept = kept_rows(&aims, &rows, roots, tree.roots().len());
        let told = self.whole_rows(tree, &rows, roots);
        let wholes = told.into_iter().zip(kept).map(|(told, kept)| told.or(kept)).collect();
        let least = (0..tree.roots().len() as u32).map(slack).fold(ROW_SUM_SLACK, f64::min);
        let uncut = SCALED_ENOUGH * least * self.options.accuracy;
        balance(operator, &aims, &Wholes { of_leaf: roots, aims: wholes }, uncut);
    }

    /// What the leaves of each input element should receive together, m², where something is lost.
    ///
    /// Rays say it without a systematic error, but with a standard error σ; links have none of
    /// chance. How far both differ tells which to believe: of a difference D the part 1 − σ²/D² is
    /// taken to be a fault of the links, first of all that is lost together, then, with D² in the
    /// mean over all elements, of each element (W. James, C. Stein, Proc. 4th Berkeley Symp. 1,
    /// 361–379, 1961; shrinking to a common mean: B. Efron, C. Morris, J. Am. Stat. Assoc. 68,
    /// 117–130, 1973). Fine links stay as they are.
    fn whole_rows(&self, tree: &Tree, rows: &[f64], roots: &[u32]) -> Vec<Option<Aim>> {
        let mut sums = vec![0.0; tree.roots().len()];
        roots.iter().zip(rows).for_each(|(&root, row)| sums[root as usize] += row);
        let area = |element: usize| tree.nodes()[tree.roots()[element] as usize].area();
        let told = |element| {
            let [row, error] = self.exposure.opening().row(element)?;
            Some([area(element) * row, area(element) * error])
        };
        let together = lost_together(&sums, &area, &told);
        let common = together.unwrap_or(0.0);
        let sums: Vec<f64> =
            sums.iter().enumerate().map(|(k, &sum)| sum + common * (area(k) - sum).abs()).collect();
        let (mut differences, mut errors) = (0.0, 0.0);
        for (element, &sum) in sums.iter().enumerate() {
            if let Some([row, error]) = told(element) {
                differences += (row - sum) * (row - sum) / area(element);
                errors += error * error / area(element);
            }
        }
        let part = if differences > errors { 1.0 - errors / differences } else { 0.0 };
        let known = part > LEAST_PART;
        let part = if known { part } else { 0.0 };
        let aim = |(element, &sum): (usize, &f64)| {
            // Linear functions may have left less than nothing.
            let row = (sum + part * (told(element)?[0] - sum)).max(0.0);
            (known || together.is_some()).then_some(Aim { least: row, most: row })
        };
        sums.iter().enumerate().map(aim).collect()
    }

    /// What is known of the light before the next round.
    fn light(&self, state: &State, system: Option<&System>) -> Light {
        let surfaces = self.problem.surfaces;
        let Some(System { operator, radiosity, .. }) = system else {
            let mut light = Light::ambient(&state.tree, surfaces);
            light.weights =
                self.dual.as_ref().map(|(_, dual)| weights(&state.tree, &expected(&state.tree, dual), None));
            return light;
        };
        let means = radiosity.means(operator, &state.radiosity);
        // What is buried of a face is part of the mean that accuracy is promised for.
        let nodes = [operator.means(&state.radiosity), state.nodes_means(&means.irradiance)];
        let mut light = Light::solved(&state.tree, surfaces, &state.links, operator, [&nodes[0], &nodes[1]]);
        light.weights = self.dual.as_ref().map(|_| {
            let [z, e] = [&state.importance, &means.irradiance].map(|leaves| state.nodes_means(leaves));
            weights(&state.tree, &z, Some(&e))
        });
        light
    }

    /// What is known on the nodes before a refinement.
    fn known(&self, state: &State, system: Option<&System>) -> Option<Known> {
        state.rounds.last()?;
        let goal = self.dual.as_ref().and(system).map(|System { operator, radiosity, .. }| {
            let irradiance = radiosity.means(operator, &state.radiosity).irradiance;
            [state.nodes_means(&irradiance), state.nodes_means(&state.importance)]
        });
        Some(Known { radiosity: state.nodes_radiosity(), goal })
    }

    /// Refines, solves, and adds what came of it to the state.
    fn round(
        &mut self,
        state: &mut State,
        system: Option<System>,
    ) -> Result<(System, Report), HierarchyError> {
        let mut light = self.light(state, system.as_ref());
        let before = self.known(state, system.as_ref());
        // The links are refined in their place: nothing else may hold them.
        drop(system);
        let links = before.as_ref().map(|_| Arc::unwrap_or_clone(std::mem::take(&mut state.links)));
        let limits = self.limits(state);
        let refined = refine(&mut state.tree, links, &mut light, self.sight, &limits)?;
        drop(light);
        (state.links, state.limited) = (Arc::new(refined.links), refined.limited);
        let system = self.system(&state.tree, &state.links)?;
        let mut x = match &before {
            Some(before) => inherited(&state.tree, &system.operator, &before.radiosity),
            None => system.radiosity.exitance().clone(),
        };
        let stop = Stop { tolerance: self.residual(), max_iterations: self.options.max_iterations };
        let mut report = self.solved(&system, system.radiosity.exitance(), &mut x, stop)?;
        let faces = self.faces(state, &system, &x);
        let (error, change);
        if let Some(w) = &system.dual {
            let earlier = before.as_ref().and_then(|before| before.goal.as_ref());
            let mut z =
                earlier.map_or_else(|| w.clone(), |[_, z]| inherited(&state.tree, &system.operator, z));
            let dual = self.solved(&system, w, &mut z, stop)?;
            if report.reason == StopReason::Converged && dual.reason != StopReason::Converged {
                report = dual;
            }
            state.importance = z;
            let found = before.map(|before| self.goal_error(state, &system, &before, (&x, &faces)));
            let (found, of_goal) = found.transpose()?.flatten().unzip();
            (error, change) = (found.flatten(), of_goal);
        } else {
            (error, change) = self.change(state, &faces).unzip();
        }
        let further: Vec<f64> = self
            .unbalanced(state, &system, &x)
            .iter()
            .zip(self.unsolved(&report))
            .map(|(a, b)| a + b)
            .collect();
        let known = if refined.changed { error.map(|error| error.with(&further)) } else { None };
        state.error = match (known, state.error.take()) {
            // Memory may have ended the round early: it mends a part only of what the last one
            // stated.
            (Some(known), Some(earlier)) if state.limited => Some(known.or_more(&earlier)),
            (Some(known), _) if !state.limited => Some(known),
            (_, earlier) => earlier,
        };
        let change = change.filter(|_| refined.changed);
        let (elements, links) = (system.operator.leaves().len(), state.links.len());
        state.rounds.push(Round { threshold: state.threshold, elements, links, change });
        (state.radiosity, state.faces) = (x, faces);
        Ok((system, report))
    }

    fn limits(&self, state: &State) -> Limits<'_> {
        let area = state.tree.nodes()[0].area();
        Limits {
            threshold: state.threshold,
            linear: self.options.linear,
            least_area: LEAST_AREA * area,
            tolerance: EXCHANGE_OVER_ACCURACY * self.options.accuracy,
            bytes: self.options.bytes,
            bands: self.problem.surfaces.exitance.rhs_count(),
            watch: self.watch,
        }
    }

    /// The residual to solve to: what is asked for, or less where reflection may amplify that to
    /// more than [`RESIDUAL_SHARE_OF_ACCURACY`] of the accuracy.
    fn residual(&self) -> f64 {
        let reflectances = self.problem.surfaces.reflectance.as_slice();
        let absorbed = 1.0 - reflectances.iter().copied().fold(0.0, f64::max);
        let bearable = (RESIDUAL_SHARE_OF_ACCURACY * self.options.accuracy * absorbed).max(LEAST_RESIDUAL);
        self.options.residual.min(bearable)
    }

    /// Solves from `x` on; a solver that the system does not suit is replaced for good.
    fn solved(
        &mut self,
        system: &System,
        rhs: &MultiVector<f64>,
        x: &mut MultiVector<f64>,
        stop: Stop,
    ) -> Result<Report, HierarchyError> {
        let a = SecondKind::new(&system.operator, system.radiosity.scaling())?;
        let watch = self.watch;
        let mut observer = |_: &Progress<'_, f64>| watch.go_on();
        let start = x.clone();
        let mut report = None;
        if self.replaced.is_none() {
            match self.solvers.first.solve(&a, rhs, x, &stop, &mut observer) {
                Ok(found) if found.reason != StopReason::Diverged => report = Some(found),
                Ok(_) => self.replaced = Some("it diverged".to_owned()),
                Err(error @ (SolveError::Indefinite { .. } | SolveError::Unsuitable { .. })) => {
                    self.replaced = Some(error.to_string());
                }
                Err(error) => return Err(error.into()),
            }
        }
        let report = if let Some(report) = report {
            report
        } else {
            *x = start;
            self.solvers.fallback.solve(&a, rhs, x, &stop, &mut observer)?
        };
        if report.reason == StopReason::Interrupted { Err(HierarchyError::Interrupted) } else { Ok(report) }
    }

    /// Irradiance of the input faces, faces × bands, W/m².
    fn faces(&self, state: &State, system: &System, x: &MultiVector<f64>) -> Vec<f64> {
        let means = system.radiosity.means(&system.operator, x);
        let (bands, faces) = (x.rhs_count(), self.problem.mesh.faces());
        let mut irradiance = vec![0.0; faces.len() * bands];
        for (i, &leaf) in system.operator.leaves().iter().enumerate() {
            let node = &state.tree.nodes()[leaf as usize];
            let face = node.face().unwrap_or(0);
            let share = node.area() / faces[face].area;
            for (sum, e) in irradiance[face * bands..].iter_mut().zip(means.irradiance.row(i)) {
                *sum += share * e;
            }
        }
        irradiance
    }

    /// The error that the change from the irradiance of the faces before lets expect, and that
    /// change, relative, of the worst band; none in the first round.
    fn change(&self, state: &State, now: &[f64]) -> Option<(Stated, f64)> {
        let before = &state.faces;
        if before.is_empty() {
            return None;
        }
        let bands = self.problem.surfaces.exitance.rhs_count();
        let (mut squares, mut norms) = (vec![0.0; bands], vec![0.0; bands]);
        let mut largest = vec![0.0; bands];
        for (k, face) in self.problem.mesh.faces().iter().enumerate() {
            for band in 0..bands {
                let (e, old) = (now[k * bands + band], before[k * bands + band]);
                squares[band] += face.area * (e - old) * (e - old);
                norms[band] += face.area * e * e;
                largest[band] = f64::max(largest[band], CONFIDENCE * (e - old).abs());
            }
        }
        let relative = |(square, norm): (f64, f64)| if norm > 0.0 { (square / norm).sqrt() } else { 0.0 };
        let changes: Vec<f64> = squares.into_iter().zip(norms).map(relative).collect();
        let worst = changes.iter().copied().fold(0.0, f64::max);
        // A small change may be chance.
        let earlier = state.rounds.iter().rev().find_map(|round| round.change).unwrap_or(0.0);
        let believed = |change: f64| {
            CONFIDENCE * change.max(if change > 0.0 { LEAST_CHANGE_RATIO * earlier } else { 0.0 })
        };
        Some((Stated { relative_l2: changes.into_iter().map(believed).collect(), largest }, worst))
    }

    /// The power that row sums lose or gain against what rays say, beyond twice the standard error
    /// of the rays, over the power that is absorbed or leaves, of each band.
    ///
    /// Rays tell of whole input elements only: within one, darker parts may lose more than brighter
    /// ones. So sums over input elements are compared, each with its mean radiosity. Coarse links
    /// do not see such parts, and two rounds that are too coarse may agree: as long as links that
    /// are not divided may carry a share of the light, the stated error holds that share times the
    /// reflections that repeat it.
    fn unbalanced(&self, state: &State, system: &System, x: &MultiVector<f64>) -> Vec<f64> {
        let System { operator, radiosity, roots, .. } = system;
        let (rows, means) = (operator.row_sums(), radiosity.means(operator, x));
        let (bands, inputs) = (x.rhs_count(), self.problem.mesh.len());
        let (mut gone, mut received) = (vec![0.0; bands], vec![0.0; bands]);
        // Of each input element: exposed area, row sum, and exposed area times radiosity.
        let mut wholes = vec![[0.0; 2]; inputs];
        let mut sent = MultiVector::<f64>::zeros(inputs, bands);
        for (i, size) in radiosity.elements().iter().enumerate() {
            let root = roots[i] as usize;
            wholes[root][0] += size.exposed;
            wholes[root][1] += rows[i];
            for (band, (gone, received)) in gone.iter_mut().zip(&mut received).enumerate() {
                let b = x.row(i)[band];
                sent.row_mut(root)[band] += b * size.exposed;
                let reflected = self.problem.surfaces.reflectance.row(root)[band];
                let power = size.area * means.irradiance.row(i)[band];
                let absorbed = (1.0 - reflected) * power;
                *received += power;
                *gone += absorbed + b * (size.exposed - rows[i]);
            }
        }
        let mut lost = vec![0.0; bands];
        // The rays of one element say the same of all of its leaves, so their errors add up.
        let mut unsure = sent;
        for (root, [exposed, row]) in wholes.into_iter().enumerate() {
            let [open, error] = self.exposure.opening().lost(root);
            let missing = if exposed > 0.0 { 1.0 - open - row / exposed } else { 0.0 };
            for (sent, lost) in unsure.row_mut(root).iter_mut().zip(&mut lost) {
                *lost += *sent * missing;
                *sent *= error;
            }
        }
        let threshold = if self.exposure.opening().closed() { 0.0 } else { state.threshold };
        let share = |(((lost, unsure), gone), received): (((&f64, f64), &f64), f64)| match *gone {
            gone if gone > 0.0 => {
                let unseen = (HIDDEN_BY_LINKS * threshold * (received / gone - TIMES_RECEIVED))
                    .clamp(0.0, MOST_HIDDEN_BY_LINKS);
                unseen + (lost.abs() - 2.0 * unsure).max(0.0) / gone
            }
            _ => 0.0,
        };
        lost.iter().zip(unsure.norms()).zip(&gone).zip(received).map(share).collect()
    }

    /// The error that the residual of the solver leaves at most, of each band: relative, times 1/(1
    /// − ρ) of the brightest surface.
    fn unsolved(&self, report: &Report) -> Vec<f64> {
        let reflectance = &self.problem.surfaces.reflectance;
        let mut largest = vec![0.0f64; reflectance.rhs_count()];
        let Some(record) = report.history.last() else { return largest };
        for row in reflectance.rows() {
            largest.iter_mut().zip(row).for_each(|(largest, rho)| *largest = largest.max(*rho));
        }
        let left = |(residual, rho): (&f64, f64)| residual / (1.0 - rho).max(f64::EPSILON);
        record.residuals.iter().zip(largest).map(left).collect()
    }

    /// The error that is stated for the goal.
    fn goal_error(
        &self,
        state: &State,
        system: &System,
        before: &Known,
        (x, faces): (&MultiVector<f64>, &[f64]),
    ) -> Result<Option<(Option<Stated>, f64)>, HierarchyError> {
        let (Some((goal, _)), Some([irradiance, _])) = (&self.dual, &before.goal) else { return Ok(None) };
        let System { operator, radiosity, .. } = system;
        let [old, unlit] =
            [&before.radiosity, irradiance].map(|nodes| inherited(&state.tree, operator, nodes));
        let means = [&state.faces, faces].map(|faces| goal.means(self.problem.mesh, faces, x.rhs_count()));
        let estimate = Estimate {
            tree: &state.tree,
            operator,
            leaves: operator.leaves(),
            radiosity,
            before: [&old, &unlit],
            x,
            importance: &state.importance,
            means: [&means[0], &means[1]],
        };
        Ok(Some(estimate.stated(state.rounds.last().and_then(|round| round.change))?))
    }

    fn enough(&self, state: &State) -> bool {
        state.rounds.len() >= ROUNDS
            || state.error().is_some_and(|error| error.worst() <= self.options.accuracy)
    }

    fn finish(&self, state: State, system: System, report: Report) -> Solution {
        let System { operator, radiosity: system, .. } = system;
        let (scale, replaced) = (operator.scale().to_vec(), self.replaced.clone());
        let means = system.means(&operator, &state.radiosity);
        let direct = system.means(&operator, system.exitance()).irradiance;
        let closed = |(sum, size): (f64, &Extent)| if size.exposed > 0.0 { sum / size.exposed } else { 1.0 };
        let closure = operator.row_sums().into_iter().zip(system.elements()).map(closed).collect();
        let State { tree, links, radiosity, importance, faces, rounds, error, limited, .. } = state;
        let goal = self.dual.as_ref().map(|(goal, _)| {
            let irradiance = goal.means(self.problem.mesh, &faces, radiosity.rhs_count());
            Reached { irradiance, importance }
        });
        Solution {
            tree,
            links,
            means,
            direct,
            system,
            radiosity,
            closure,
            report,
            rounds,
            error,
            goal,
            limited,
            scale,
            replaced,
        }
    }
}

/// The radiosity of leaves from that of the nodes before a refinement: new elements have that of
/// the one they were cut from.
fn inherited(tree: &Tree, operator: &HierarchicalOperator, before: &MultiVector<f64>) -> MultiVector<f64> {
    let known = |leaf: u32| {
        let mut node = leaf;
        while node as usize >= before.dim() {
            node = tree.nodes()[node as usize].parent().unwrap_or(0);
        }
        node as usize
    };
    let leaves = operator.leaves();
    MultiVector::from_fn(leaves.len(), before.rhs_count(), |i, band| before.row(known(leaves[i]))[band])
}

/// The part of what the links lose that rays say is not lost, negative where they lose too little;
/// none where both agree.
fn lost_together(
    sums: &[f64],
    area: &impl Fn(usize) -> f64,
    told: &impl Fn(usize) -> Option<[f64; 2]>,
) -> Option<f64> {
    let (mut difference, mut variance, mut lost) = (0.0, 0.0, 0.0);
    for (element, &sum) in sums.iter().enumerate() {
        let [row, error] = told(element)?;
        difference += row - sum;
        variance += error * error;
        lost += (area(element) - sum).abs();
    }
    let clear =
        difference * difference > CLEAR_STANDARD_ERRORS * CLEAR_STANDARD_ERRORS * variance && lost > 0.0;
    clear.then(|| difference * (1.0 - variance / (difference * difference)) / lost)
}

/// What the leaves of each input element receive together, m², where a leaf receives more than it
/// may.
///
/// Errors of links make the row sums of some leaves too large and of others too small. To cut the
/// large ones alone would lose power in the mean, and reflection multiplies a loss by 1/(1 − ρ): so
/// their element keeps its sum.
fn kept_rows(aims: &[Aim], rows: &[f64], roots: &[u32], elements: usize) -> Vec<Option<Aim>> {
    let (mut sums, mut mosts, mut above) = (vec![0.0; elements], vec![0.0; elements], vec![false; elements]);
    for ((aim, &row), &root) in aims.iter().zip(rows).zip(roots) {
        let root = root as usize;
        sums[root] += row;
        mosts[root] += aim.most;
        above[root] |= row > aim.most && aim.least < aim.most;
    }
    let kept = |((sum, most), above): ((f64, f64), bool)| {
        let row = sum.min(most);
        above.then_some(Aim { least: row, most: row })
    };
    sums.into_iter().zip(mosts).zip(above).map(kept).collect()
}

/// Exposed areas, m².
fn exposed(extents: &[Extent]) -> Vec<f64> {
    extents.iter().map(|extent| extent.exposed).collect()
}

/// Where a part of an element is buried, a grid of points tells how much. What the links exchange
/// cannot be more than what is exposed, up to the whole area, so that they know better where little
/// is. Says whether anything grew.
fn widen(extents: &mut [Extent], rows: &[f64]) -> bool {
    let mut grown = false;
    for (extent, &row) in extents.iter_mut().zip(rows) {
        if extent.exposed < extent.area && row > extent.exposed {
            extent.exposed = row.min(extent.area);
            grown = true;
        }
    }
    grown
}
