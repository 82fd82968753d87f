//! The computation by any discretisation: assembly, solution, and the iterated irradiance, which
//! values and errors are taken from.

use fredholm_coupling::{Energy, Extent, Means, Radiosity, exposed_shares};
use fredholm_discretisation::{DiscretisationError, ElementMeans, Light, Lit};
use fredholm_linop::{LinopError, MultiVector};
use fredholm_mesh::Patch;

use crate::error::{Error, ErrorKind};
use crate::options::SolveSettings;
use crate::problem::{Problem, prepare};
use crate::solution::{Solution, coupling_failure, solve_failure, worth_saving};
use crate::stages::Stages;
use crate::watcher::Watcher;

/// Assembles and solves.
pub(crate) fn compute(
    problem: &Problem,
    options: &SolveSettings,
    stages: &mut Stages,
) -> Result<Solution, Error> {
    let watcher = Watcher::new(stages, options);
    let light = light(problem)?.watched(stages.watch);
    let system = stages.run("assembly", || light.discretise(&*problem.discretisation).map_err(failure))?;
    if problem.solver.iterative {
        stages.begin_saving()?;
    }
    let (solver, stop) = (&*problem.solver.solver, watcher.stop());
    let mut observer = watcher;
    let solve = || light.solve_system(system, solver, &stop, &mut observer).map_err(failure);
    let lit = stages.run("solution", solve)?;
    stages.begin_saving()?;
    worth_saving(lit.report())?;
    stages.run("errors", || assess(problem, &lit, watcher))
}

fn light(problem: &Problem) -> Result<Light<'_>, Error> {
    let reflectance = problem.multivector(problem.scene.reflectance(&problem.mesh))?;
    let exitance = problem.multivector(problem.scene.exitance(&problem.mesh))?;
    let tolerance = problem.options.form_factor_tolerance;
    Light::new(&problem.mesh, &problem.occluders, reflectance, exitance, tolerance).map_err(failure)
}

/// What follows from a solution, and how far it is to be trusted. Whoever has pressed Ctrl-C does
/// not wait for it.
fn assess(problem: &Problem, lit: &Lit, watcher: Watcher) -> Result<Solution, Error> {
    let patches: Vec<Patch> = problem.mesh.patches().copied().collect();
    let exposed = exposed_shares(&problem.patches(), &prepare(&patches)?);
    let Some(found) = lit.assess_while(watcher.watch) else {
        return Ok(unassessed(lit, exposed));
    };
    let means = means(found.means);
    let closure: Vec<f64> =
        found.seen.iter().zip(&exposed).map(|(&seen, &share)| closed(seen, share)).collect();
    let energy = energy(problem, &means, &exposed, &closure)?;
    Ok(Solution {
        means,
        means_of: "H B_h, at Gauss points",
        closure,
        energy,
        field_error: Some(found.error.relative_l2),
        ..unassessed(lit, exposed)
    })
}

/// A solution of which nothing is known but itself.
fn unassessed(lit: &Lit, exposed: Vec<f64>) -> Solution {
    let (means_of, report) = ("the irradiance as polynomials", lit.report().clone());
    let entries = lit.system().coupling().entries();
    Solution { entries, ..Solution::unassessed(means(lit.means()), means_of, report, exposed) }
}

fn means(ElementMeans { irradiance, radiosity }: ElementMeans) -> Means {
    Means { irradiance, radiosity }
}

/// What is buried loses nothing.
fn closed(seen: f64, share: f64) -> f64 {
    if share > 0.0 { seen } else { 1.0 }
}

/// The balance of every band: the exposed part of an element has radiosity M + ρ E/w.
fn energy(problem: &Problem, means: &Means, exposed: &[f64], closure: &[f64]) -> Result<Vec<Energy>, Error> {
    let reflectance = problem.multivector(problem.scene.reflectance(&problem.mesh))?;
    let exitance = problem.multivector(problem.scene.exitance(&problem.mesh))?;
    let x = MultiVector::from_fn(exitance.dim(), exitance.rhs_count(), |i, band| {
        let reflected = reflectance.row(i)[band] * means.irradiance.row(i)[band];
        exitance.row(i)[band] + if exposed[i] > 0.0 { reflected / exposed[i] } else { 0.0 }
    });
    let extent =
        |(patch, share): (&Patch, &f64)| Extent { area: patch.area(), exposed: share * patch.area() };
    let extents = problem.mesh.patches().zip(exposed).map(extent).collect();
    let radiosity = Radiosity::new(extents, reflectance, exitance).map_err(coupling_failure)?;
    Ok(radiosity.energy(&x, means, closure))
}

fn failure(error: DiscretisationError) -> Error {
    match error {
        DiscretisationError::Solve(error) => solve_failure(error),
        DiscretisationError::Coupling(error) => coupling_failure(error),
        DiscretisationError::Linop(LinopError::Memory { .. }) => Error::new(ErrorKind::Resources, error),
        _ => Error::new(ErrorKind::Input, error),
    }
}
