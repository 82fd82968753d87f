//! From incident currents to all bounces, by the method that the scene asks for.

use fredholm_linop::{LinearOperator, MultiVector, SecondKind, Solver, Stop, StopReason};
use fredholm_scene::waves::Places;
use fredholm_waves::{
    Bounces, Complex64, Discretisation, NystromCoupling, Scatterer, Shadow, System, Wave, WaveError,
};

use super::CouplingStorage;
use super::Model;
use super::memory::COUPLED;
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

/// The system of a model's method; none where one bounce is all.
pub(super) fn system<'a>(
    model: &Model,
    scatterer: &'a Scatterer,
    (wave, shadow): (Wave, Shadow),
    signals: &Signals<'_>,
) -> Result<Option<System<'a>>, Error> {
    match &model.method {
        Method::Bounces(1) => Ok(None),
        Method::Bounces(_) => lazy(model, scatterer, (wave, shadow), signals).map(Some),
        Method::Solver { solver, .. } => {
            let products = EXPECTED * incident_waves(model);
            coupled(model, scatterer, (wave, shadow), (&[&**solver], products), signals).map(Some)
        }
    }
}

/// The system whose products are computed anew each time.
pub(super) fn lazy<'a>(
    model: &Model,
    scatterer: &'a Scatterer,
    (wave, shadow): (Wave, Shadow),
    signals: &Signals<'_>,
) -> Result<System<'a>, Error> {
    let help = "mesh coarser, or ask for one bounce";
    let plan = coupling(model.plan.clone(), scatterer, shadow);
    plan.admit(model.limit, help)?;
    plan.tell(model.limit, signals.watch);
    System::lazy(scatterer, wave, shadow).map_err(|error: WaveError| model.refused(&error, None))
}

/// Iterations that are expected of a solver, before anything is known.
const EXPECTED: f64 = 40.0;
/// Bytes of a matrix that is stored without being asked for, where products would do.
const UNASKED: u64 = 1 << 30;

/// Incident waves of a run.
fn incident_waves(model: &Model) -> f64 {
    let sweep = |receiver: &super::model::Receiver| match &receiver.places {
        Places::Monostatic(angles) => 2 * angles.len(),
        _ => 0,
    };
    let swept: usize = model.receivers.iter().map(sweep).sum();
    (swept + usize::from(model.has_bistatic())) as f64
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
    shadow: Shadow,
    solvers: &[&dyn Solver<Complex64>],
) -> Plan {
    let unknowns = System::unknowns(scatterer);
    let solver = solvers
        .iter()
        .map(|solver| solver.bytes(unknowns, incident_waves(model) as usize))
        .max()
        .unwrap_or(0);
    let addresses = solvers.iter().map(|solver| solver.addresses()).max().unwrap_or(0);
    coupling(model.plan.clone(), scatterer, shadow)
        .hold(format!("the coupling of {unknowns} unknowns"), System::bytes(scatterer).into())
        .hold("the solver", solver.into())
        .aside(of_threads(addresses))
}

/// Whether the coupling for these solvers, from which so many products are expected, is stored:
/// where that is asked for, quicker, or the only way for one of them.
fn wants_matrix(
    model: &Model,
    scatterer: &Scatterer,
    shadow: Shadow,
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
            let quicker = is_quicker_stored(scatterer, shadow, products);
            let fits = || stored_plan(model, scatterer, shadow, solvers).fits(model.limit);
            Ok(quicker && System::bytes(scatterer) <= UNASKED && fits())
        }
    }
}

/// Whether a run of the model stores its coupling for a solver.
pub(super) fn is_stored(
    model: &Model,
    scatterer: &Scatterer,
    shadow: Shadow,
    solver: &dyn Solver<Complex64>,
) -> Result<bool, Error> {
    wants_matrix(model, scatterer, shadow, (&[solver], EXPECTED * incident_waves(model)))
}

/// The system for these solvers, from which so many products are expected.
pub(super) fn coupled<'a>(
    model: &Model,
    scatterer: &'a Scatterer,
    (wave, shadow): (Wave, Shadow),
    (solvers, products): (&[&dyn Solver<Complex64>], f64),
    signals: &Signals<'_>,
) -> Result<System<'a>, Error> {
    if !wants_matrix(model, scatterer, shadow, (solvers, products))? {
        return lazy(model, scatterer, (wave, shadow), signals);
    }
    let by_products = by_products().join(", ");
    let help = format!("mesh coarser, or take a solver that needs no matrix: {by_products}");
    let plan = stored_plan(model, scatterer, shadow, solvers);
    plan.admit(model.limit, &help)?;
    plan.tell(model.limit, signals.watch);
    System::stored(scatterer, wave, shadow, Discretisation::Nystrom)
        .map_err(|error: WaveError| model.refused(&error, None))
}

/// What a coupling takes besides its matrix.
fn coupling(plan: Plan, scatterer: &Scatterer, shadow: Shadow) -> Plan {
    let facets = scatterer.facets().len() as u128;
    plan.hold(
        "what is near and in view",
        facets * COUPLED + u128::from(NystromCoupling::bytes(scatterer, shadow)),
    )
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
        Some(&last) if count > 1 && last > UNSETTLED => {
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
const UNSETTLED: f64 = 0.1;

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
