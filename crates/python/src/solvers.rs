//! The registered solvers, for matrices and operators of Python.

use std::ops::ControlFlow;
use std::sync::atomic::{AtomicBool, Ordering};

use fredholm_linop::{
    Dense, LinearOperator, MultiVector, Observer, Progress, Report, Scalar, SecondKind, Solver, Stop,
    StopReason, Symmetry,
};
use fredholm_study::{Error, ErrorKind, Watch, build_solver, build_wave_solver};
use numpy::{Complex64, Element, PyArray2, PyReadonlyArray2, PyUntypedArrayMethods};
use pyo3::prelude::*;

use crate::arrays::moved;
use crate::failure::{failure, input};
use crate::operator::{self, Operator};
use crate::run::{How, run};

/// Name, description, requirements and options of every solver.
type Known = (&'static str, &'static str, &'static str, Vec<(&'static str, &'static str)>);

/// All solvers.
#[pyfunction]
pub(crate) fn solvers() -> Vec<Known> {
    let known = |entry: fredholm_study::SolverEntry| {
        (entry.solver.name(), entry.solver.description(), entry.requirements, entry.options.to_vec())
    };
    fredholm_study::solvers().map(known).collect()
}

/// What is asked of a solver.
#[derive(FromPyObject)]
#[pyo3(from_item_all)]
pub(crate) struct Asked {
    /// Such as `sor:omega=1.2`.
    solver: String,
    tolerance: f64,
    max_iterations: usize,
    /// Whether A is symmetric, Hermitian where it is complex; none: a matrix is looked at.
    symmetric: Option<bool>,
    /// A power of two near the size of A.
    scale: f64,
}

/// The answer, why the solver stopped, iterations, residuals of all iterations (one after the
/// other, those of all right-hand sides), products computed, and seconds.
type Found<'py, T> = (Bound<'py, PyArray2<T>>, &'static str, usize, Bound<'py, PyArray2<f64>>, u64, f64);

/// A right-hand side, or a start: unknowns × sides.
#[derive(FromPyObject)]
pub(crate) enum Vectors<'py> {
    Real(PyReadonlyArray2<'py, f64>),
    Complex(PyReadonlyArray2<'py, Complex64>),
}

/// Solves A x = b from a start on: `a` is a matrix of the same numbers as b, or a function that
/// multiplies with it.
#[pyfunction]
pub(crate) fn solve_system(
    py: Python<'_>,
    a: Bound<'_, PyAny>,
    b: Vectors<'_>,
    x: Vectors<'_>,
    asked: Asked,
    how: How,
) -> PyResult<Py<PyAny>> {
    match (b, x) {
        (Vectors::Real(b), Vectors::Real(x)) => {
            let solver = build_solver(&asked.solver).map_err(|error| input(py, error, None))?;
            System { solver: solver.solver, iterative: solver.iterative, asked }.solve(&a, &b, &x, how)
        }
        (Vectors::Complex(b), Vectors::Complex(x)) => {
            let solver = build_wave_solver(&asked.solver).map_err(|error| input(py, error, None))?;
            let iterative = build_solver(&asked.solver).is_ok_and(|entry| entry.iterative);
            System { solver, iterative, asked }.solve(&a, &b, &x, how)
        }
        _ => Err(input(py, "the start and the right-hand side are of different numbers", None)),
    }
}

/// A solver and what is asked of it.
struct System<T: Scalar> {
    solver: Box<dyn Solver<T>>,
    iterative: bool,
    asked: Asked,
}

/// Where the products come from.
enum Coupling<T> {
    Matrix(Dense<T>),
    Operator(Operator<T>),
}

impl<T: Scalar + Element> Coupling<T> {
    fn as_operator(&self) -> &dyn LinearOperator<T> {
        match self {
            Self::Matrix(matrix) => matrix,
            Self::Operator(operator) => operator,
        }
    }

    fn failed(&self) -> Option<&AtomicBool> {
        match self {
            Self::Matrix(_) => None,
            Self::Operator(operator) => Some(&operator.failed),
        }
    }
}

/// What ends a solution: Ctrl-C, or an exception of the operator.
struct Observed<'a> {
    watch: &'a dyn Watch,
    failed: Option<&'a AtomicBool>,
    tolerance: f64,
}

impl<T> Observer<T> for Observed<'_> {
    fn observe(&mut self, progress: &Progress<'_, T>) -> ControlFlow<()> {
        let record = progress.record;
        let residual = record.residuals.iter().copied().fold(0.0, f64::max);
        let share = (residual.ln() / self.tolerance.ln()).clamp(0.0, 1.0);
        self.watch.advance(share, &|| format!("iteration {}, residual {residual:.1e}", record.iteration));
        Observer::<T>::poll(self)
    }

    fn poll(&mut self) -> ControlFlow<()> {
        match self.failed {
            Some(failed) if failed.load(Ordering::Relaxed) => ControlFlow::Break(()),
            _ => self.watch.go_on(),
        }
    }
}

/// What a solution came to: the coupling has what Python raised.
struct Solution<T> {
    coupling: Coupling<T>,
    x: MultiVector<T>,
    report: Result<Report, Error>,
}

impl<T: Scalar + Element> System<T> {
    fn solve(
        self,
        a: &Bound<'_, PyAny>,
        b: &PyReadonlyArray2<'_, T>,
        x: &PyReadonlyArray2<'_, T>,
        how: How,
    ) -> PyResult<Py<PyAny>> {
        let py = a.py();
        let coupling = self.coupling(a, b.shape()[0])?;
        let (b, x) = (vectors(b), vectors(x));
        let work = move |watch: &dyn Watch| Ok(self.solved(coupling, &b, x, watch));
        run(py, how, work, |solution| found(py, solution))
    }

    fn coupling(&self, a: &Bound<'_, PyAny>, dim: usize) -> PyResult<Coupling<T>> {
        let (py, scale, symmetric) = (a.py(), self.asked.scale, self.asked.symmetric);
        if let Ok(matrix) = a.extract::<PyReadonlyArray2<'_, T>>() {
            let entries = matrix.as_array();
            let made = py.detach(|| operator::dense(entries, scale, symmetric));
            return made.map(Coupling::Matrix).map_err(|error| input(py, error, None));
        }
        let symmetry = symmetric.map_or(Symmetry::General, operator::symmetry::<T>);
        Ok(Coupling::Operator(Operator::new(a.clone().unbind(), dim, scale, symmetry)))
    }

    /// Solves the system divided by the scale, which has the same answer and the same residuals.
    fn solved(
        self,
        coupling: Coupling<T>,
        b: &MultiVector<T>,
        mut x: MultiVector<T>,
        watch: &dyn Watch,
    ) -> Solution<T> {
        let report = self.report(&coupling, b, &mut x, watch);
        Solution { coupling, x, report }
    }

    fn report(
        &self,
        coupling: &Coupling<T>,
        b: &MultiVector<T>,
        x: &mut MultiVector<T>,
        watch: &dyn Watch,
    ) -> Result<Report, Error> {
        let Asked { tolerance, max_iterations, scale, .. } = self.asked;
        let ones = MultiVector::from_fn(b.dim(), b.rhs_count(), |_, _| T::one());
        let b = MultiVector::from_fn(b.dim(), b.rhs_count(), |i, l| b.row(i)[l].scale(scale.recip()));
        let input = |error| Error::new(ErrorKind::Input, error);
        let system = SecondKind::new(coupling.as_operator(), ones).map_err(input)?;
        if self.iterative && watch.begin_saving().is_break() {
            return Err(Error::cancelled());
        }
        let mut observed = Observed { watch, failed: coupling.failed(), tolerance };
        watch.begin(self.solver.name());
        let solved = self.solver.solve(&system, &b, x, &Stop { tolerance, max_iterations }, &mut observed);
        let report = solved.map_err(|error| Error::new(ErrorKind::Input, error))?;
        watch.end(self.solver.name(), report.seconds);
        Ok(report)
    }
}

fn vectors<T: Scalar + Element>(array: &PyReadonlyArray2<'_, T>) -> MultiVector<T> {
    let array = array.as_array();
    MultiVector::from_fn(array.nrows(), array.ncols(), |i, l| array[[i, l]])
}

/// What Python gets, or what it raised.
fn found<T: Scalar + Element>(py: Python<'_>, solution: Solution<T>) -> PyResult<Py<PyAny>> {
    let Solution { coupling, x, report } = solution;
    if let Coupling::Operator(operator) = &coupling
        && let Some(raised) = operator.raised()
    {
        return Err(raised);
    }
    let report = report.map_err(|error| failure(py, &error))?;
    let reason = match report.reason {
        StopReason::Converged => "converged",
        StopReason::IterationLimit => "not converged",
        StopReason::Interrupted => "interrupted",
        StopReason::Diverged => "diverged",
    };
    let (rhs_count, iterations) = (x.rhs_count(), report.history.last().map_or(0, |record| record.iteration));
    let residuals = report.history.into_iter().flat_map(|record| record.residuals).collect();
    let products = report.work.operator_applications;
    let answer = moved(py, x.as_slice().to_vec(), rhs_count)?;
    let found: Found<'_, T> =
        (answer, reason, iterations, moved(py, residuals, rhs_count)?, products, report.seconds);
    Ok(found.into_pyobject(py)?.into_any().unbind())
}
