//! All solvers on one system, with their errors against the best answer there is.

use fredholm_coupling::Radiosity;
use fredholm_linop::{MultiVector, PackedSymmetric, SecondKind, Storage};
use fredholm_report::{ComparisonCase, ComparisonRun};

use super::CompareOptions;
use super::trial::{Bench, Outcome, distance};
use crate::error::{Error, ErrorKind};
use crate::problem::Problem;
use crate::registry;
use crate::stages::Stages;
use crate::watcher::Watcher;

/// The solver that errors are measured against, where it fits.
const REFERENCE_SOLVER: &str = "lu";
/// Most unknowns for which it is run only to be the reference.
const MOST_REFERENCE_UNKNOWNS: usize = 20_000;

/// Runs all solvers on the system whose reflectances are scaled by `factor`.
pub(super) fn case<S: Storage>(
    asked: &CompareOptions,
    problem: &Problem,
    (radiosity, matrix): (&Radiosity, &PackedSymmetric<S>),
    factor: f64,
    stages: &mut Stages,
) -> Result<ComparisonCase, Error> {
    let mut scaling = radiosity.scaling();
    scaling.as_mut_slice().iter_mut().for_each(|d| *d *= factor);
    let system = SecondKind::new(matrix, scaling).map_err(|error| Error::new(ErrorKind::Input, error))?;
    tell(asked, problem, stages);
    let bench = Bench {
        system: &system,
        b: radiosity.exitance(),
        memory: left(problem),
        limit: problem.options.memory_limit(),
        watcher: Watcher::to(stages, asked.stop()),
    };
    let outcomes: Vec<Outcome> =
        asked.solvers().iter().map(|text| run(&bench, text, stages)).collect::<Result<_, _>>()?;
    let reference = reference(&bench, &outcomes, stages)?;
    let reflectance = factor * largest(problem);
    Ok(judged(reflectance, outcomes, reference.as_ref()))
}

/// Bytes that are allowed besides those of everything but the solver.
fn left(problem: &Problem) -> u128 {
    let (limit, peak) = (problem.options.memory_limit().bytes(), problem.plan.peak());
    limit.0.saturating_sub(peak.0)
}

/// Says what will be held with the solver of those that fit that takes most.
fn tell(asked: &CompareOptions, problem: &Problem, stages: &Stages) {
    let names = asked.solvers().into_iter().chain([REFERENCE_SOLVER.to_owned()]);
    let (unknowns, bands) = (problem.unknowns, problem.scene.bands().len());
    let bytes =
        |text: String| registry::build(&text).ok().map(|entry| entry.solver.bytes(unknowns, bands).into());
    let most = names.filter_map(bytes).filter(|&bytes: &u128| bytes <= left(problem)).max().unwrap_or(0);
    let limit = problem.options.memory_limit();
    stages.tell(&problem.prediction.with_solver(most).plan(), limit);
}

/// Largest reflectance of any material in any band.
pub(super) fn largest(problem: &Problem) -> f64 {
    let materials = problem.scene.materials().iter();
    materials.flat_map(|material| material.reflectance.iter().copied()).fold(0.0, f64::max)
}

fn run(bench: &Bench, text: &str, stages: &mut Stages) -> Result<Outcome, Error> {
    let entry = registry::build(text).map_err(|error| Error::new(ErrorKind::Input, error))?;
    stages.run(text, || bench.run(text, &entry))
}

/// The answer: LU's, run where it is not among the solvers, or that of the smallest residual.
fn reference(
    bench: &Bench,
    outcomes: &[Outcome],
    stages: &mut Stages,
) -> Result<Option<(ComparisonRun, MultiVector<f64>)>, Error> {
    let solved = |outcome: &Outcome| Some((outcome.run.clone(), outcome.x.clone()?));
    if let Some(outcome) =
        outcomes.iter().find(|outcome| outcome.run.solver == REFERENCE_SOLVER && outcome.x.is_some())
    {
        return Ok(solved(outcome));
    }
    if bench.b.dim() <= MOST_REFERENCE_UNKNOWNS {
        let outcome = run(bench, REFERENCE_SOLVER, stages)?;
        if outcome.x.is_some() {
            return Ok(solved(&outcome));
        }
    }
    let finite = outcomes.iter().filter(|outcome| outcome.x.is_some() && outcome.run.residual.is_finite());
    let best = finite.min_by(|u, v| u.run.residual.total_cmp(&v.run.residual));
    Ok(best.and_then(solved))
}

fn judged(
    reflectance: f64,
    outcomes: Vec<Outcome>,
    reference: Option<&(ComparisonRun, MultiVector<f64>)>,
) -> ComparisonCase {
    let error = |x: &Option<MultiVector<f64>>| match (x, reference) {
        (Some(x), Some((_, answer))) => distance(x, answer),
        _ => f64::NAN,
    };
    let runs =
        outcomes.into_iter().map(|Outcome { run, x }| ComparisonRun { error: error(&x), ..run }).collect();
    ComparisonCase {
        reflectance,
        reference: reference.map_or("none", |(run, _)| run.solver.as_str()).to_owned(),
        reference_residual: reference.map_or(f64::NAN, |(run, _)| run.residual),
        runs,
    }
}
