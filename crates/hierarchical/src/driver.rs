//! Solve, refine where the solution says so, solve again: until the change from one solution to the next says that the accuracy is reached.
//!
//! Every round lowers the error that a link may leave by [`STEP`]. The irradiance of the input faces then changes by about what the round before was wrong by; what remains is less. The stated error
//! is [`CONFIDENCE`] times the relative change ‖E − E'‖/‖E‖ in the area-weighted L2 norm over the faces, in the worst band. With a [`Goal`] the dual problem is solved in every round too, and the error is
//! that of the mean irradiance of the goal ([`crate::goal`]).

use crate::exposure::Exposure;
use crate::goal::{Estimate, Goal, Reached, expected, weights};
use crate::oracle::Light;
use crate::refine::{Limits, bytes, refine};
use crate::transport::Sight;
use crate::{HierarchicalOperator, HierarchyError, Link, State, Surfaces, Tree};
use fredholm_coupling::{Extent, Means, Radiosity};
use fredholm_linop::{MultiVector, Progress, Report, SecondKind, Solver, Stop, StopReason};
use fredholm_mesh::{Mesh, Patch};
use fredholm_visibility::Occluders;
use fredholm_visibility::body::Bodies;
use std::ops::ControlFlow;

/// Factor from one threshold to the next.
pub(crate) const STEP: f64 = 0.3;
/// First threshold, over the accuracy.
const FIRST: f64 = 4.0;
/// Stated error over the last change.
pub(crate) const CONFIDENCE: f64 = 1.5;
/// Rounds at most.
const ROUNDS: usize = 24;
/// Residual of a solution, over the accuracy, that is small beside it.
pub const RESIDUAL: f64 = 1e-3;
/// Tolerance of exchanges, over the accuracy.
const EXCHANGE: f64 = 0.1;
/// Least area of an element, over that of the scene.
const LEAST: f64 = 1e-10;

/// Occluders that are put together to bodies, at most.
const MANY: usize = 2048;

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
    /// Relative error to reach: of the irradiance of the faces, L2, or of the mean irradiance of the goal.
    pub accuracy: f64,
    /// Whether links follow the variation of the form factor to first order; else it is constant over each node.
    pub linear: bool,
    /// Relative residual ‖b − A x‖₂/‖b‖₂ to which each system is solved; [`RESIDUAL`] times the accuracy is small beside it.
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
    /// Relative change of the irradiance of the faces since the round before, L2, worst band; none in the first. With a goal, that of its mean irradiance, or what the input
    /// elements have to do with it if that is more.
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
}

/// Follows a solution and may stop it.
pub trait Watch: Sync {
    /// Whether to go on; asked often, from any thread.
    fn poll(&self) -> ControlFlow<()> {
        ControlFlow::Continue(())
    }

    /// Called after each round with all rounds so far and the state to go on from.
    ///
    /// # Errors
    /// What the caller cannot do, such as saving the state, ends the solution.
    fn round(&self, _rounds: &[Round], _state: &State) -> Result<(), HierarchyError> {
        Ok(())
    }
}

/// The watch that only waits.
#[derive(Clone, Copy, Debug, Default)]
pub struct Patient;

impl Watch for Patient {}

/// A solved problem.
#[derive(Debug)]
pub struct Solution {
    /// Elements and clusters.
    pub tree: Tree,
    /// Links.
    pub links: Vec<Link>,
    /// Irradiance and radiosity of the leaves, W/m², in the order of [`Tree::leaves`].
    pub means: Means,
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
    /// Estimated error of the irradiance of the faces, or of the goal where there is one; none after a single round, or two with a goal.
    pub error: Option<Stated>,
    /// What was reached of the goal, where there is one.
    pub goal: Option<Reached>,
    /// Whether memory ended the refinement before the accuracy was reached.
    pub limited: bool,
}

/// Solves to an accuracy, from the start or from a saved state.
///
/// # Errors
/// Any [`HierarchyError`].
pub fn solve(
    problem: &Problem,
    options: &Options,
    solver: &dyn Solver<f64>,
    state: Option<State>,
    watch: &dyn Watch,
) -> Result<Solution, HierarchyError> {
    if !(options.accuracy > 0.0 && options.accuracy < 1.0) {
        return Err(HierarchyError::Accuracy { value: options.accuracy });
    }
    let goal = problem.goal.map_or(&[][..], Goal::surfaces);
    if state.as_ref().is_some_and(|state| state.goal != goal) {
        return Err(HierarchyError::State { why: "belongs to another goal" });
    }
    let patches: Vec<&Patch> = problem.mesh.patches().collect();
    let many = problem.occluders.len() > MANY;
    let bodies = if many { Bodies::default() } else { Bodies::new(problem.occluders, &patches, &[]) };
    let exposure = Exposure::new(problem.mesh)?;
    let sight = Sight { occluders: problem.occluders, bodies: &bodies, many };
    let dual = problem.goal.map(|goal| (goal, goal.dual(problem.mesh, problem.surfaces)));
    let mut run = Run { problem, options, solver, watch, sight, exposure, dual };
    let mut state = match state {
        Some(state) => state,
        None => State::new(problem, options.accuracy * FIRST)?,
    };
    let mut system = run.resumed(&state)?;
    loop {
        let light = run.light(&state, system.as_ref());
        let (next, report) = run.round(&mut state, system.as_ref(), light)?;
        let ends = report.reason != StopReason::Converged || state.limited || run.enough(&state);
        if ends {
            return Ok(run.finish(state, next, report));
        }
        state.threshold *= STEP;
        watch.round(&state.rounds, &state)?;
        system = Some(next);
    }
}

/// The operator of some links and the system that it makes.
struct System {
    operator: HierarchicalOperator,
    radiosity: Radiosity,
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
    solver: &'a dyn Solver<f64>,
    watch: &'a dyn Watch,
    sight: Sight<'a>,
    exposure: Exposure<'a>,
    /// With a goal: the dual problem, of the same reflectances.
    dual: Option<(&'a Goal, Surfaces)>,
}

impl Solution {
    /// Bytes of the tree and the links.
    #[must_use]
    pub fn bytes(&self) -> u64 {
        bytes(&self.tree, self.links.len())
    }
}

impl Run<'_> {
    /// The system of a state that has been solved.
    fn resumed(&mut self, state: &State) -> Result<Option<System>, HierarchyError> {
        if state.rounds.is_empty() { Ok(None) } else { self.system(&state.tree, &state.links).map(Some) }
    }

    fn system(&mut self, tree: &Tree, links: &[Link]) -> Result<System, HierarchyError> {
        let extents = self.exposure.extents(tree, &tree.leaves());
        let exposed: Vec<f64> = extents.iter().map(|extent| extent.exposed).collect();
        let operator = HierarchicalOperator::new(tree, links, &exposed);
        let roots: Vec<usize> =
            operator.leaves().iter().map(|&leaf| tree.nodes()[leaf as usize].root().unwrap_or(0)).collect();
        let of_leaves = |values: &MultiVector<f64>| {
            MultiVector::from_fn(roots.len(), values.lanes(), |i, band| values.row(roots[i])[band])
        };
        let Surfaces { reflectance, exitance } = self.problem.surfaces;
        let radiosity = Radiosity::new(extents, of_leaves(reflectance), of_leaves(exitance))?;
        let dual = self.dual.as_ref().map(|(_, dual)| of_leaves(&dual.exitance));
        Ok(System { operator, radiosity, dual })
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
        let nodes = [operator.means(&state.radiosity), operator.means(&means.irradiance)];
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
        system: Option<&System>,
        mut light: Light,
    ) -> Result<(System, Report), HierarchyError> {
        let before = self.known(state, system);
        let links = before.as_ref().map(|_| std::mem::take(&mut state.links));
        let limits = self.limits(state);
        let refined = refine(&mut state.tree, links, &mut light, self.sight, &limits)?;
        (state.links, state.limited) = (refined.links, refined.limited);
        let system = self.system(&state.tree, &state.links)?;
        let mut x = match &before {
            Some(before) => inherited(&state.tree, &system.operator, &before.radiosity),
            None => system.radiosity.exitance().clone(),
        };
        let mut report = self.solved(&system, system.radiosity.exitance(), &mut x)?;
        let faces = self.faces(state, &system, &x);
        let change;
        if let Some(w) = &system.dual {
            let earlier = before.as_ref().and_then(|before| before.goal.as_ref());
            let mut z =
                earlier.map_or_else(|| w.clone(), |[_, z]| inherited(&state.tree, &system.operator, z));
            let dual = self.solved(&system, w, &mut z)?;
            if report.reason == StopReason::Converged && dual.reason != StopReason::Converged {
                report = dual;
            }
            state.importance = z;
            let found = before.map(|before| self.goal_error(state, &system, &before, (&x, &faces)));
            let (error, of_goal) = found.transpose()?.flatten().unzip();
            (state.error, change) = (error.flatten(), of_goal);
        } else {
            state.error = (!state.faces.is_empty()).then(|| self.change(&state.faces, &faces));
            change = state.error.as_ref().map(|error| error.worst() / CONFIDENCE);
        }
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
            least_area: LEAST * area,
            tolerance: EXCHANGE * self.options.accuracy,
            bytes: self.options.bytes,
            watch: self.watch,
        }
    }

    fn solved(
        &self,
        system: &System,
        rhs: &MultiVector<f64>,
        x: &mut MultiVector<f64>,
    ) -> Result<Report, HierarchyError> {
        let radiosity = &system.radiosity;
        let a = SecondKind::new(&system.operator, radiosity.scaling())?;
        let stop = Stop { tolerance: self.options.residual, max_iterations: self.options.max_iterations };
        let mut observer = |_: &Progress<'_, f64>| self.watch.poll();
        let report = self.solver.solve(&a, rhs, x, &stop, &mut observer)?;
        if report.reason == StopReason::Interrupted { Err(HierarchyError::Interrupted) } else { Ok(report) }
    }

    /// Irradiance of the input faces, faces × bands, W/m².
    fn faces(&self, state: &State, system: &System, x: &MultiVector<f64>) -> Vec<f64> {
        let means = system.radiosity.means(&system.operator, x);
        let (lanes, faces) = (x.lanes(), self.problem.mesh.faces());
        let mut irradiance = vec![0.0; faces.len() * lanes];
        for (i, &leaf) in system.operator.leaves().iter().enumerate() {
            let node = &state.tree.nodes()[leaf as usize];
            let face = node.face().unwrap_or(0);
            let share = node.area() / faces[face].area;
            for (sum, e) in irradiance[face * lanes..].iter_mut().zip(means.irradiance.row(i)) {
                *sum += share * e;
            }
        }
        irradiance
    }

    /// The error that the change from one irradiance of the faces to the next lets expect.
    fn change(&self, before: &[f64], now: &[f64]) -> Stated {
        let lanes = self.problem.surfaces.exitance.lanes();
        let (mut squares, mut norms) = (vec![0.0; lanes], vec![0.0; lanes]);
        let mut largest = vec![0.0; lanes];
        for (k, face) in self.problem.mesh.faces().iter().enumerate() {
            for band in 0..lanes {
                let (e, old) = (now[k * lanes + band], before[k * lanes + band]);
                squares[band] += face.area * (e - old) * (e - old);
                norms[band] += face.area * e * e;
                largest[band] = f64::max(largest[band], CONFIDENCE * (e - old).abs());
            }
        }
        let relative =
            |(square, norm): (f64, f64)| if norm > 0.0 { CONFIDENCE * (square / norm).sqrt() } else { 0.0 };
        Stated { relative_l2: squares.into_iter().zip(norms).map(relative).collect(), largest }
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
        let means = [&state.faces, faces].map(|faces| goal.means(self.problem.mesh, faces, x.lanes()));
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
        let means = system.means(&operator, &state.radiosity);
        let closed = |(sum, size): (f64, &Extent)| if size.exposed > 0.0 { sum / size.exposed } else { 1.0 };
        let closure = operator.row_sums().into_iter().zip(system.elements()).map(closed).collect();
        let State { tree, links, radiosity, importance, faces, rounds, error, limited, .. } = state;
        let goal = self.dual.as_ref().map(|(goal, _)| {
            let irradiance = goal.means(self.problem.mesh, &faces, radiosity.lanes());
            Reached { irradiance, importance }
        });
        Solution { tree, links, means, system, radiosity, closure, report, rounds, error, goal, limited }
    }
}

/// The radiosity of leaves from that of the nodes before a refinement: new elements have that of the one they were cut from.
fn inherited(tree: &Tree, operator: &HierarchicalOperator, before: &MultiVector<f64>) -> MultiVector<f64> {
    let known = |leaf: u32| {
        let mut node = leaf;
        while node as usize >= before.dim() {
            node = tree.nodes()[node as usize].parent().unwrap_or(0);
        }
        node as usize
    };
    let leaves = operator.leaves();
    MultiVector::from_fn(leaves.len(), before.lanes(), |i, band| before.row(known(leaves[i]))[band])
}
