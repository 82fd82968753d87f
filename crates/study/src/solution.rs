//! The computation itself: assembly, solution, and what is known of their errors.

use fredholm_coupling::{
    Assembled, CouplingError, Energy, Means, MeshError, MethodCounts, Radiosity, assemble, exposed_shares,
    extents, reciprocity,
};
use fredholm_linop::{
    MultiVector, PackedSymmetric, Report, SecondKind, SolveError, Solver, StopReason, Storage,
};
use fredholm_mesh::Patch;
use fredholm_report::Hierarchy;

use crate::discretised;
use crate::error::{Error, ErrorKind};
use crate::lit_by::{self, Senders};
use crate::mesh_error;
use crate::options::Precision;
use crate::options::SolveSettings;
use crate::pictures;
use crate::problem::{Problem, prepare};
use crate::rays::Rays;
use crate::stages::Stages;
use crate::watcher::Watcher;

/// A solved problem.
pub(crate) struct Solution {
    /// Irradiance and radiosity of the elements, W/m².
    pub(crate) means: Means,
    /// The part of the irradiance that comes straight from what emits, W/m², as the same equation
    /// has it; none where the method does not tell it apart.
    pub(crate) direct: Option<MultiVector<f64>>,
    /// What the solver did.
    pub(crate) report: Report,
    /// What the values of elements are means of.
    pub(crate) means_of: &'static str,
    /// Stored entries of the operator.
    pub(crate) entries: u64,
    /// Row sum of the form factors of every element; empty where it was not computed.
    pub(crate) closure: Vec<f64>,
    /// Estimated error of the row sum of every element; empty where the method states none.
    pub(crate) row_error: Vec<f64>,
    /// Largest estimated error of a form factor.
    pub(crate) pair_error: Option<f64>,
    /// Largest violation of reciprocity among the pairs checked.
    pub(crate) reciprocity: Option<f64>,
    /// Pairs per method.
    pub(crate) methods: Option<MethodCounts>,
    /// Exposed share of every element.
    pub(crate) exposed: Vec<f64>,
    /// Balance of every band; empty where it was not computed.
    pub(crate) energy: Vec<Energy>,
    /// Estimated error of the irradiance of the faces.
    pub(crate) mesh_error: Option<MeshError>,
    /// What hierarchical radiosity did, where it did.
    pub(crate) hierarchy: Option<Hierarchy>,
    /// Elements, clusters and links of hierarchical radiosity, where it did it.
    pub(crate) tree: Option<pictures::Hierarchy>,
    /// The elements that light every element most, by the matrix; empty where there is none.
    pub(crate) senders: Vec<Senders>,
    /// What rays came to, where rows are of rays.
    pub(crate) rays: Option<Rays>,
    /// Relative error of the field as polynomials, per band.
    pub(crate) field_error: Option<Vec<f64>>,
    /// Which solver took the place of the one asked for, and why.
    pub(crate) replaced: Option<String>,
}

impl Solution {
    /// A solution of which nothing is known but itself.
    pub(crate) fn unassessed(
        means: Means,
        means_of: &'static str,
        report: Report,
        exposed: Vec<f64>,
    ) -> Self {
        Self {
            means,
            means_of,
            report,
            exposed,
            direct: None,
            entries: 0,
            closure: Vec::new(),
            row_error: Vec::new(),
            pair_error: None,
            reciprocity: None,
            methods: None,
            energy: Vec::new(),
            mesh_error: None,
            hierarchy: None,
            tree: None,
            senders: Vec::new(),
            rays: None,
            field_error: None,
            replaced: None,
        }
    }

    /// Whether the accuracy asked for was reached, where one was.
    pub(crate) fn is_accurate(&self) -> bool {
        let stated = self.mesh_error.as_ref().map(|error| error.relative_l2.iter().copied());
        let worst = stated.and_then(|errors| errors.reduce(f64::max));
        let known = |stated: Option<f64>, accuracy: f64| stated.is_some_and(|error| error <= accuracy);
        self.hierarchy.as_ref().is_none_or(|h| known(h.stated, h.accuracy))
            && self.rays.as_ref().is_none_or(|rays| known(worst, rays.accuracy))
    }
}

/// Assembles and solves.
pub(crate) fn compute(
    problem: &Problem,
    options: &SolveSettings,
    stages: &mut Stages,
) -> Result<Solution, Error> {
    match options.problem.storage {
        _ if !problem.is_radiosity() => discretised::compute(problem, options, stages),
        Precision::F64 => radiosity::<f64>(problem, options, stages),
        Precision::F32 => radiosity::<f32>(problem, options, stages),
    }
}

/// Constants on the elements, the matrix of form factors stored as `S`.
fn radiosity<S: Storage>(
    problem: &Problem,
    options: &SolveSettings,
    stages: &mut Stages,
) -> Result<Solution, Error> {
    let watcher = Watcher::new(stages, options);
    let assembled = stages.run("assembly", || form_factors::<S>(problem, watcher))?;
    let radiosity = stages.run("exposure", || system(problem, &assembled.matrix))?;
    if problem.solver.iterative {
        stages.begin_saving()?;
    }
    let solved = stages.run("solution", || solve(problem, &radiosity, &assembled.matrix, watcher))?;
    stages.begin_saving()?;
    worth_saving(&solved.1)?;
    stages.run("errors", || {
        let solution = assess((problem, options), &radiosity, &assembled, solved, watcher)?;
        if options.no_report {
            return Ok(solution);
        }
        let senders = lit_by::by_matrix(&assembled.matrix, &problem.mesh, &solution.means);
        Ok(Solution { senders, ..solution })
    })
}

/// Fails where the run was stopped before the first iterate.
pub(crate) fn worth_saving(report: &Report) -> Result<(), Error> {
    let iterations = report.history.last().map_or(0, |record| record.iteration);
    if report.reason == StopReason::Interrupted && iterations == 0 { Err(Error::cancelled()) } else { Ok(()) }
}

pub(crate) fn form_factors<S: Storage>(problem: &Problem, watcher: Watcher) -> Result<Assembled<S>, Error> {
    let integrator = problem.integrator();
    assemble(&integrator, watcher.watch).map_err(coupling_failure)
}

/// What follows from a solution, and how far it is to be trusted.
fn assess<S: Storage>(
    (problem, options): (&Problem, &SolveSettings),
    radiosity: &Radiosity,
    assembled: &Assembled<S>,
    (x, report): (MultiVector<f64>, Report),
    watcher: Watcher,
) -> Result<Solution, Error> {
    let matrix = &assembled.matrix;
    let means = radiosity.means(matrix, &x);
    let mesh_error = if options.no_mesh_error {
        None
    } else {
        mesh_error::estimate(problem, radiosity, assembled, (&x, &report), watcher)?
    };
    let closure = radiosity.closure(matrix);
    let energy = radiosity.energy(&x, &means, &closure);
    let row_error = assembled.error.iter().zip(problem.mesh.patches()).map(|(e, p)| e / p.area()).collect();
    let exposed = radiosity.elements().iter().map(|size| size.exposed / size.area).collect();
    Ok(Solution {
        means,
        direct: Some(radiosity.means(matrix, radiosity.exitance()).irradiance),
        report,
        // The means of a Galerkin solution with constants are those of H B_h.
        means_of: "H B_h, from form factors",
        entries: entries(problem.mesh.len()),
        closure,
        row_error,
        pair_error: Some(assembled.largest),
        reciprocity: reciprocity(&problem.integrator()),
        methods: Some(assembled.methods),
        exposed,
        energy,
        mesh_error,
        hierarchy: None,
        tree: None,
        senders: Vec::new(),
        rays: None,
        field_error: None,
        replaced: None,
    })
}

/// Entries of a packed triangle.
fn entries(elements: usize) -> u64 {
    let n = elements as u64;
    n * (n + 1) / 2
}

/// The system for the exposed parts of the elements.
pub(crate) fn system<S: Storage>(problem: &Problem, matrix: &PackedSymmetric<S>) -> Result<Radiosity, Error> {
    let patches: Vec<Patch> = problem.mesh.patches().copied().collect();
    let shares = exposed_shares(&problem.patches(), &prepare(&patches)?);
    let extents = extents(&problem.patches(), &shares, &matrix.row_sums());
    let reflectance = problem.multivector(problem.scene.reflectance(&problem.mesh))?;
    let exitance = problem.multivector(problem.scene.exitance(&problem.mesh))?;
    Radiosity::new(extents, reflectance, exitance).map_err(coupling_failure)
}

/// Solves from B = M on.
pub(crate) fn solve<S: Storage>(
    problem: &Problem,
    radiosity: &Radiosity,
    matrix: &PackedSymmetric<S>,
    watcher: Watcher,
) -> Result<(MultiVector<f64>, Report), Error> {
    solve_with(&*problem.solver.solver, radiosity, matrix, watcher)
}

/// Solves from B = M on, with this solver.
pub(crate) fn solve_with<S: Storage>(
    solver: &dyn Solver<f64>,
    radiosity: &Radiosity,
    matrix: &PackedSymmetric<S>,
    mut watcher: Watcher,
) -> Result<(MultiVector<f64>, Report), Error> {
    let system = SecondKind::new(matrix, radiosity.scaling()).map_err(|e| Error::new(ErrorKind::Input, e))?;
    let exitance = radiosity.exitance();
    let mut x = exitance.clone();
    let report =
        solver.solve(&system, exitance, &mut x, &watcher.stop(), &mut watcher).map_err(solve_failure)?;
    Ok((x, report))
}

pub(crate) fn coupling_failure(error: CouplingError) -> Error {
    match error {
        CouplingError::Interrupted { .. } => Error::cancelled(),
        CouplingError::Allocation { .. } => Error::new(ErrorKind::Resources, error),
        _ => Error::new(ErrorKind::Input, error),
    }
}

pub(crate) fn solve_failure(error: SolveError) -> Error {
    let ending = match error {
        SolveError::Singular { .. } => ErrorKind::NotConverged,
        SolveError::Linop(fredholm_linop::LinopError::Memory { .. }) => ErrorKind::Resources,
        _ => ErrorKind::Input,
    };
    Error::new(ending, error)
}

/// The reason in the words of the record.
pub(crate) fn reason(reason: StopReason) -> &'static str {
    match reason {
        StopReason::Converged => "converged",
        StopReason::IterationLimit => "not converged",
        StopReason::Interrupted => "interrupted",
        StopReason::Diverged => "diverged",
    }
}
