//! The computation: exchanges, rows, closure, points.

use std::ops::ControlFlow;

use fredholm_coupling::{Assembled, Closed, MethodCounts, aggregate, assemble, enforce_closure, reciprocity};
use fredholm_linop::{LinearOperator, PackedSymmetric};
use fredholm_mesh::Patch;
use fredholm_report::{ClosureChange, SurfaceData, ViewFactors, ViewPoints};

use super::problem::Problem;
use crate::failure::{Ending, Failure};
use crate::solution::coupling_failure;
use crate::stages::Stages;

/// Stated errors of a row below this are rounding.
const ROUNDING: f64 = 1e-13;

/// A computed matrix.
pub(super) struct Solution {
    pub(super) factors: ViewFactors,
    /// Largest estimated error of a form factor between elements.
    pub(super) pair_error: f64,
    pub(super) reciprocity: Option<f64>,
    pub(super) methods: MethodCounts,
    pub(super) enforced: Option<ClosureChange>,
}

pub(super) fn compute(problem: &Problem, stages: &mut Stages) -> Result<Solution, Failure> {
    let assembled = exchanges(problem, stages)?;
    let (pair_error, methods) = (assembled.largest, assembled.methods);
    let area = problem.areas();
    let error = problem.per_row(assembled.error.iter().copied());
    let row_error: Vec<f64> = error.iter().zip(&area).map(|(error, area)| error / area).collect();
    let mut matrix = merged(problem, assembled.matrix)?;
    let mut enforced = None;
    if problem.options.close {
        let closed = stages.run("closure", || close(problem, &matrix, &area, &row_error))?;
        enforced = Some(change(&matrix, &area, &row_error, &closed));
        matrix = closed.matrix;
    }
    let (names, emissivity) = (problem.rows.names.clone(), problem.rows.emissivity.clone());
    let surfaces = SurfaceData { names, area, emissivity, row_error };
    let row = |i: usize, row: &mut [f64]| matrix.row(i, 0, row);
    let mut factors = ViewFactors::new(surfaces, problem.options.threshold, row);
    drop(matrix);
    factors.points = points(problem, stages)?;
    let reciprocity = stages.run("errors", || Ok(reciprocity(&problem.integrator())))?;
    Ok(Solution { factors, pair_error, reciprocity, methods, enforced })
}

fn exchanges(problem: &Problem, stages: &mut Stages) -> Result<Assembled<f64>, Failure> {
    let (console, interrupt) = (stages.console, stages.interrupt);
    let go_on = || if interrupt.requested() { ControlFlow::Break(()) } else { ControlFlow::Continue(()) };
    let watch = |done: u64, total: u64| {
        console.advance(done as f64 / total.max(1) as f64, &|| format!("{done} of {total} pairs"));
        go_on()
    };
    stages.run("assembly", || assemble(&problem.integrator(), &watch).map_err(coupling_failure))
}

/// The exchanges of the rows, m².
fn merged(problem: &Problem, matrix: PackedSymmetric<f64>) -> Result<PackedSymmetric<f64>, Failure> {
    if problem.is_unmerged() {
        return Ok(matrix);
    }
    let rows = &problem.rows;
    aggregate(&matrix, &rows.row_of, rows.names.len()).map_err(|error| Failure::new(Ending::Input, error))
}

fn close(
    problem: &Problem,
    matrix: &PackedSymmetric<f64>,
    area: &[f64],
    row_error: &[f64],
) -> Result<Closed, Failure> {
    enforce_closure(matrix, area, row_error).map_err(|error| {
        use fredholm_coupling::ClosureError::{Infeasible, Open};
        let (Open { row, .. } | Infeasible { row, .. }) = error else {
            return Failure::new(Ending::Input, error);
        };
        let text = format!(
            "--close: {error}\n  help: row {row} is `{}`; leave out --close, or add --sky",
            problem.rows.names[row]
        );
        Failure::new(Ending::Input, text)
    })
}

/// How far the closed matrix is from the one computed.
fn change(matrix: &PackedSymmetric<f64>, area: &[f64], row_error: &[f64], closed: &Closed) -> ClosureChange {
    let largest = |values: &mut dyn Iterator<Item = f64>| values.reduce(f64::max);
    let sums = matrix.row_sums();
    let over = closed.change.iter().zip(row_error).filter(|(_, error)| **error > ROUNDING);
    ClosureChange {
        closure_before: largest(&mut sums.iter().zip(area).map(|(sum, area)| (sum / area - 1.0).abs())),
        largest: Some(closed.largest),
        row_max: largest(&mut closed.change.iter().copied()),
        over_stated: largest(&mut over.map(|(change, error)| change / error)),
        steps: closed.steps as u64,
    }
}

fn points(problem: &Problem, stages: &mut Stages) -> Result<Option<ViewPoints>, Failure> {
    if problem.receivers.is_empty() {
        return Ok(None);
    }
    let interrupt = stages.interrupt;
    let go_on = || if interrupt.requested() { ControlFlow::Break(()) } else { ControlFlow::Continue(()) };
    let patches: Vec<&Patch> = problem.patches().collect();
    let seen = || problem.targets(&patches).factors(&problem.receivers, &go_on).map_err(coupling_failure);
    let factors = stages.run("points", seen)?;
    let points = problem.receivers.iter().map(|receiver| receiver.point.to_array()).collect();
    let normals = problem.receivers.iter().map(|receiver| receiver.normal.to_array()).collect();
    Ok(Some(ViewPoints { points, normals, factors }))
}
