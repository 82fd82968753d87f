//! From incident currents to all bounces, by the method that the scene asks for.

use fredholm_linop::{LinearOperator, MultiVector, SecondKind, Solver, Stop, StopReason};
use fredholm_scene::waves::Places;
use fredholm_waves::{
    Bounces, Complex64, Discretisation, Kind, PhysicalOptics, Radiator, Sampling, Scatterer, Shadow, System,
    TOLERANCE, Wave, WaveError,
};

use super::CouplingStorage;
use super::Model;
use super::model::Method;
use super::registry::by_products;
use crate::error::{Error, ErrorKind};
use crate::memory::Plan;
use crate::prediction::of_threads;
use crate::stages::Signals;

pub(super) type Vectors = MultiVector<Complex64>;

/// The currents of all bounces: a right-hand side for each incident wave.
pub(super) struct Solution {
    pub(super) x: Vectors,
    /// Relative residual of the worst right-hand side, from the start on.
    pub(super) residuals: Vec<f64>,
    pub(super) reason: Option<StopReason>,
}

impl Solution {
    /// The residual that is left.
    pub(super) fn residual(&self) -> Option<f64> {
        self.residuals.last().copied()
    }

    /// That of two of which more is left, the first where it is the same.
    pub(super) fn worse(first: Option<Self>, second: Option<Self>) -> Option<Self> {
        match (first, second) {
            (Some(first), Some(second)) if second.residual() <= first.residual() => Some(first),
            (first, second) => second.or(first),
        }
    }
}

/// The system of a model's method; none where one bounce is all.
pub(super) fn system<'a>(
    model: &Model,
    scatterer: &'a Scatterer,
    (wave, shadow, first): (Wave, Shadow, &PhysicalOptics<'_>),
    signals: &Signals<'_>,
) -> Result<Option<System<'a>>, Error> {
    match &model.method {
        Method::Bounces(1) => {
            let plan = one_bounce_plan(model, scatterer, (&wave, first));
            signals.admit(&plan, model.limit, "take longer edges")?;
            Ok(None)
        }
        Method::Bounces(_) => lazy(model, scatterer, (wave, shadow), &[], signals).map(Some),
        Method::Solver { solver, .. } => {
            let products = EXPECTED_ITERATIONS * incident_waves(model);
            coupled(model, scatterer, (wave, shadow), (&[&**solver], products), signals).map(Some)
        }
    }
}

/// The memory of a run on a scatterer with its coupling and its solver, and how the run holds the
/// coupling; none where one bounce is all.
pub(super) fn plan(
    model: &Model,
    scatterer: &Scatterer,
    wave: Wave,
) -> Result<(Plan, Option<CouplingStorage>), Error> {
    let solvers: &[&dyn Solver<Complex64>] = match &model.method {
        Method::Bounces(1) => {
            let sources = model.sources();
            let first = PhysicalOptics::new(scatterer, wave, &sources, model.shadow);
            let first = first.map_err(|error| model.refused(&error, None))?;
            return Ok((one_bounce_plan(model, scatterer, (&wave, &first)), None));
        }
        Method::Bounces(_) => &[],
        Method::Solver { solver, .. } => &[&**solver],
    };
    let (at, products) = ((wave, model.shadow), EXPECTED_ITERATIONS * incident_waves(model));
    if !solvers.is_empty() && wants_matrix(model, scatterer, at, (solvers, products))? {
        return Ok((stored_plan(model, scatterer, at, solvers), Some(CouplingStorage::Matrix)));
    }
    Ok((lazy_plan(model, scatterer, at, solvers), Some(CouplingStorage::Products)))
}

/// The memory of one bounce, whose currents are sampled as finely as the fields need unless the far
/// field of all is known in closed form.
fn one_bounce_plan(
    model: &Model,
    scatterer: &Scatterer,
    (wave, first): (&Wave, &PhysicalOptics<'_>),
) -> Plan {
    let sheets = scatterer.facets().iter().all(|facet| facet.kind == Kind::Sheet);
    let plan = model.plan.clone();
    if model.is_closed_form() && sheets {
        return plan;
    }
    // The waves of a sweep light what those of the scene may not.
    let carries = |facet: usize| model.has_sweep() || first.is_lit(facet);
    let bytes = Radiator::bytes(scatterer, wave, Sampling::Tolerance(TOLERANCE), &carries);
    plan.stage("the radiating points", bytes.into())
}

/// The system whose products are computed anew each time, for bounces or for these solvers.
pub(super) fn lazy<'a>(
    model: &Model,
    scatterer: &'a Scatterer,
    (wave, shadow): (Wave, Shadow),
    solvers: &[&dyn Solver<Complex64>],
    signals: &Signals<'_>,
) -> Result<System<'a>, Error> {
    let help = "mesh coarser, or ask for one bounce";
    let plan = lazy_plan(model, scatterer, (wave, shadow), solvers);
    signals.admit(&plan, model.limit, help)?;
    System::lazy(scatterer, wave, shadow).map_err(|error: WaveError| model.refused(&error, None))
}

/// Iterations that are expected of a solver, before anything is known.
const EXPECTED_ITERATIONS: f64 = 40.0;
/// Directions of a sweep that are solved for together by products.
const DIRECTIONS_TOGETHER: usize = 8;
/// Copies of the right-hand sides that are held beside a solver's.
const RIGHT_HAND_SIDE_COPIES: u128 = 3;
/// Bytes of a matrix that is stored without being asked for, where products would do.
const MOST_UNASKED_BYTES: u64 = 1 << 30;

/// Incident waves of a run.
fn incident_waves(model: &Model) -> f64 {
    let swept: usize = sweeps(model).map(|directions| 2 * directions).sum();
    (swept + usize::from(model.has_bistatic())) as f64
}

/// Numbers of directions of the receivers that send their own waves.
fn sweeps(model: &Model) -> impl Iterator<Item = usize> {
    model.receivers.iter().filter_map(|receiver| match &receiver.places {
        Places::Monostatic(angles) => Some(angles.len()),
        _ => None,
    })
}

/// Directions of a sweep over so many that are solved for together: a factorisation serves all
/// waves, and others need memory for every wave that they solve for.
pub(super) fn directions_together(model: &Model, directions: usize) -> usize {
    match &model.method {
        _ if model.galerkin.is_some() => directions,
        Method::Solver { solver, .. } if !by_products().contains(&solver.name()) => directions,
        _ => directions.min(DIRECTIONS_TOGETHER),
    }
    .max(1)
}

/// Most right-hand sides that are solved for at once.
pub(super) fn rhs_count(model: &Model) -> usize {
    sweeps(model).map(|directions| 2 * directions_together(model, directions)).max().unwrap_or(1)
}

/// What solvers of so many unknowns take, with the vectors that they are given: the largest of
/// them.
pub(super) fn of_solvers(
    plan: Plan,
    (unknowns, rhs_count): (usize, usize),
    solvers: &[&dyn Solver<Complex64>],
) -> Plan {
    let largest = solvers.iter().map(|solver| solver.bytes(unknowns, rhs_count)).max().unwrap_or(0);
    let addresses = solvers.iter().map(|solver| solver.addresses()).max().unwrap_or(0);
    let vectors = RIGHT_HAND_SIDE_COPIES * (rhs_count * unknowns * size_of::<Complex64>()) as u128;
    plan.hold("the solver", largest.into()).hold("the right-hand sides", vectors).aside(of_threads(addresses))
}

/// Whether a matrix is quicker than so many products computed anew. Measured on two cores, in
/// products computed anew: storing takes 26 of conductors and 4 of other materials, whose blocks
/// are four times as large; a product with the stored matrix, bound by memory, 0.85, on two
/// surfaces 0.4, of other materials 0.1.
fn is_quicker_stored(scatterer: &Scatterer, shadow: Shadow, products: f64) -> bool {
    let (storing, stored) = match (scatterer.check_conductor("").is_ok(), shadow) {
        (false, _) => (4.0, 0.1),
        (true, Shadow::ExactDual) => (26.0, 0.4),
        (true, _) => (26.0, 0.85),
    };
    storing + stored * products < products
}

/// The memory of a stored coupling with what else there is, for the largest of some solvers.
fn stored_plan(
    model: &Model,
    scatterer: &Scatterer,
    at: (Wave, Shadow),
    solvers: &[&dyn Solver<Complex64>],
) -> Plan {
    let unknowns = System::unknowns(scatterer);
    let plan = lazy_plan(model, scatterer, at, solvers);
    plan.hold(format!("the coupling of {unknowns} unknowns"), System::bytes(scatterer).into())
}

/// The memory of a coupling whose products are computed anew with what else there is, for the
/// largest of some solvers.
fn lazy_plan(
    model: &Model,
    scatterer: &Scatterer,
    (wave, shadow): (Wave, Shadow),
    solvers: &[&dyn Solver<Complex64>],
) -> Plan {
    let plan = model
        .plan
        .clone()
        .hold("what is near and in view", System::lazy_bytes(scatterer, &wave, shadow).into());
    of_solvers(plan, (System::unknowns(scatterer), rhs_count(model)), solvers)
}

/// Whether the coupling for these solvers, from which so many products are expected, is stored:
/// where that is asked for, quicker, or the only way for one of them.
fn wants_matrix(
    model: &Model,
    scatterer: &Scatterer,
    at: (Wave, Shadow),
    (solvers, products): (&[&dyn Solver<Complex64>], f64),
) -> Result<bool, Error> {
    let by_products = by_products();
    let other = solvers.iter().find(|solver| !by_products.contains(&solver.name()));
    match (model.storage, other) {
        (Some(CouplingStorage::Products), Some(solver)) => {
            let what = format!("{} needs the matrix, which is not to be stored", solver.name());
            let help = format!("--storage matrix, or a solver that needs none: {}", by_products.join(", "));
            Err(Error::new(ErrorKind::Input, what).with_help(help))
        }
        (Some(storage), _) => Ok(storage == CouplingStorage::Matrix),
        (None, Some(_)) => Ok(true),
        (None, None) => {
            let quicker = is_quicker_stored(scatterer, at.1, products);
            let fits = || stored_plan(model, scatterer, at, solvers).fits(model.limit);
            Ok(quicker && System::bytes(scatterer) <= MOST_UNASKED_BYTES && fits())
        }
    }
}

/// The system for these solvers, from which so many products are expected.
pub(super) fn coupled<'a>(
    model: &Model,
    scatterer: &'a Scatterer,
    (wave, shadow): (Wave, Shadow),
    (solvers, products): (&[&dyn Solver<Complex64>], f64),
    signals: &Signals<'_>,
) -> Result<System<'a>, Error> {
    if !wants_matrix(model, scatterer, (wave, shadow), (solvers, products))? {
        return lazy(model, scatterer, (wave, shadow), solvers, signals);
    }
    let by_products = by_products().join(", ");
    let help = format!("mesh coarser, or take a solver that needs no matrix: {by_products}");
    let plan = stored_plan(model, scatterer, (wave, shadow), solvers);
    signals.admit(&plan, model.limit, &help)?;
    System::stored(scatterer, wave, shadow, Discretisation::Nystrom)
        .map_err(|error: WaveError| model.refused(&error, None))
}

/// Solves for all right-hand sides of b by a model's method.
pub(super) fn solution(
    method: &Method,
    system: &System<'_>,
    b: &Vectors,
    signals: &Signals<'_>,
) -> Result<Solution, Error> {
    match method {
        Method::Bounces(count) => bounced(system, b, *count, signals),
        Method::Solver { .. } => solved(system.coupling(), b, method, signals),
    }
}

/// The currents after so many bounces, and the residual after each.
pub(super) fn bounced(
    system: &System<'_>,
    b: &Vectors,
    count: usize,
    signals: &Signals<'_>,
) -> Result<Solution, Error> {
    let sum = Bounces::sum(system.coupling(), b, count, signals.watch).ok_or_else(Error::cancelled)?;
    let residuals: Vec<f64> = sum.residuals.iter().map(|residuals| worst(residuals)).collect();
    // A next bounce stronger than what comes from the sources: the sum is no approximation of
    // anything.
    match residuals.last() {
        Some(&last) if count > 1 && (last > 1.0 || last.is_nan()) => {
            Err(diverged("the sum of bounces", &residuals))
        }
        Some(&last) if count > 1 && last > LARGEST_SETTLED_RESIDUAL => {
            signals.watch.warn(&format!(
                "after {count} bounces {:.0} % is left: the sum may be farther off than one with fewer; take a solver for all",
                100.0 * last
            ));
            Ok(Solution { x: sum.x, residuals, reason: None })
        }
        _ => Ok(Solution { x: sum.x, residuals, reason: None }),
    }
}

/// Residual above which a sum of bounces is told to be unfinished.
const LARGEST_SETTLED_RESIDUAL: f64 = 0.1;

/// Solves x = b + K x for all right-hand sides of b by the solver of a method.
pub(super) fn solved(
    coupling: &dyn LinearOperator<Complex64>,
    b: &Vectors,
    method: &Method,
    signals: &Signals<'_>,
) -> Result<Solution, Error> {
    let Method::Solver { solver, tolerance, max_iterations } = method else {
        return Err(Error::new(ErrorKind::Input, "an equation is solved, not summed bounce by bounce"));
    };
    let stop = Stop { tolerance: *tolerance, max_iterations: *max_iterations };
    let one = Vectors::from_fn(b.dim(), b.rhs_count(), |_, _| Complex64::ONE);
    let a = SecondKind::new(coupling, one).map_err(|error| Error::new(ErrorKind::Input, error))?;
    let mut x = Vectors::zeros(b.dim(), b.rhs_count());
    let report = solver
        .solve(&a, b, &mut x, &stop, &mut signals.clone())
        .map_err(|error| Error::new(ErrorKind::Input, error))?;
    let residuals: Vec<f64> = report.history.iter().map(|entry| worst(&entry.residuals)).collect();
    match report.reason {
        StopReason::Interrupted => Err(Error::cancelled()),
        StopReason::Diverged => Err(diverged(solver.name(), &residuals)),
        reason => Ok(Solution { x, residuals, reason: Some(reason) }),
    }
}

fn worst(residuals: &[f64]) -> f64 {
    residuals
        .iter()
        .copied()
        .fold(0.0, |worst, next| if next > worst || next.is_nan() { next } else { worst })
}

fn diverged(solver: &str, residuals: &[f64]) -> Error {
    let reached = residuals.iter().copied().fold(f64::INFINITY, f64::min);
    let text = format!(
        "{solver} diverges after {} iterations (best residual {reached:.1e}); nothing was written",
        residuals.len().saturating_sub(1)
    );
    let help = "a closed body near a resonance or a cavity has no convergent series of bounces; take another \
                solver";
    Error::new(ErrorKind::NotConverged, text).with_help(help)
}
