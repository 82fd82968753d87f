//! The computation: exchanges, rows, closure, points.

use std::collections::BTreeMap;

use fredholm_coupling::{
    Assembled, Closed, aggregate, assemble_with_errors, enforce_closure, reciprocity, sky_exchanges, with_sky,
};
use fredholm_linop::{LinearOperator, PackedSymmetric, Steps};
use fredholm_mesh::Patch;
use fredholm_report::{ClosureChange, SurfaceData, ViewFactors, ViewPoints};

use super::problem::Problem;
use crate::error::{Error, ErrorKind};
use crate::record::pairs as by_method;
use crate::solution::coupling_failure;
use crate::stages::Stages;

/// Stated errors of a row below this are rounding.
const ROUNDING: f64 = 1e-13;

/// A computed matrix.
pub(super) struct Solution {
    pub(super) factors: ViewFactors,
    /// Largest estimated error of a form factor between elements.
    pub(super) largest: f64,
    pub(super) reciprocity: Option<f64>,
    /// Pairs by method.
    pub(super) pairs: BTreeMap<String, u64>,
    pub(super) enforced: Option<ClosureChange>,
}

pub(super) fn compute(problem: &Problem, stages: &mut Stages) -> Result<Solution, Error> {
    let (assembled, errors) = exchanges(problem, stages)?;
    let (largest, pairs) = (assembled.largest, pairs(problem, &assembled));
    let Rows { matrix, pair_error, row_error } = rows(problem, assembled, errors, stages)?;
    let area = problem.areas();
    let (matrix, enforced) = closed(problem, matrix, &area, &row_error, stages)?;
    let (names, emissivity) = (problem.rows.names.clone(), problem.rows.emissivity.clone());
    let (sky, sky_area) = (problem.surface_rows(), area.last().copied().unwrap_or_default());
    let surfaces = SurfaceData { names, area, emissivity, row_error };
    let row = |i: usize, row: &mut [f64], errors: &mut [f64]| {
        matrix.row(i, 0, row);
        pair_error.row(i, 0, errors);
        // The sky sees itself, and the backs of surfaces, wherever it sees no front: as exactly as
        // it sees them.
        if i == sky {
            row[sky] = sky_area - row.iter().sum::<f64>();
            errors[sky] = errors.iter().sum();
        }
    };
    let mut factors = ViewFactors::new(surfaces, problem.options.threshold, row);
    factors.points = points(problem, stages)?;
    let reciprocity = stages.run("errors", || Ok(agreement(problem)))?;
    Ok(Solution { factors, largest, reciprocity, pairs, enforced })
}

/// Exchanges of the rows, the sky's included, the errors stated for them (m²), and those of the
/// sums of F.
struct Rows {
    matrix: PackedSymmetric<f64>,
    pair_error: PackedSymmetric<f64>,
    row_error: Vec<f64>,
}

fn rows(
    problem: &Problem,
    assembled: Assembled<f64>,
    errors: PackedSymmetric<f64>,
    stages: &mut Stages,
) -> Result<Rows, Error> {
    let mut found = Rows {
        matrix: merged(problem, assembled.matrix)?,
        pair_error: merged(problem, errors)?,
        row_error: problem.per_row(assembled.error.into_iter()),
    };
    if let Some(integrator) = problem.sky_integrator() {
        let surfaces = problem.row_of().len();
        let watch = stages.watch;
        let sky =
            stages.run("sky", || sky_exchanges(&integrator, surfaces, watch).map_err(coupling_failure))?;
        found.add_sky(problem, &sky)?;
    }
    found.row_error.iter_mut().zip(problem.areas()).for_each(|(error, area)| *error /= area);
    Ok(found)
}

impl Rows {
    /// Adds the last row, from what the elements exchange with the sky and the errors of that.
    fn add_sky(&mut self, problem: &Problem, found: &[[f64; 2]]) -> Result<(), Error> {
        let input = |error| Error::new(ErrorKind::Input, error);
        let surfaces = problem.surface_rows();
        let [sky, error] = [0, 1].map(|k| problem.per_row(found.iter().map(|pair| pair[k])));
        self.matrix = with_sky(&self.matrix, &sky[..surfaces]).map_err(input)?;
        self.pair_error = with_sky(&self.pair_error, &error[..surfaces]).map_err(input)?;
        self.row_error.iter_mut().zip(&error).for_each(|(row, error)| *row += error);
        self.row_error[surfaces] = error.iter().sum();
        Ok(())
    }
}

/// Agreement of the two orders of integration, which the other methods do not have.
fn agreement(problem: &Problem) -> Option<f64> {
    if problem.method.is_some() { None } else { reciprocity(&problem.integrator()) }
}

/// Pairs by method: auto tells which ones it took.
fn pairs(problem: &Problem, assembled: &Assembled<f64>) -> BTreeMap<String, u64> {
    if problem.method.is_none() {
        return by_method(&assembled.methods);
    }
    let n = problem.row_of().len() as u64;
    BTreeMap::from([(problem.options.method.clone(), n * n.saturating_sub(1) / 2)])
}

/// Exchanges of the elements and the error stated for each, m².
fn exchanges(
    problem: &Problem,
    stages: &mut Stages,
) -> Result<(Assembled<f64>, PackedSymmetric<f64>), Error> {
    if let Some(method) = &problem.method {
        let rows = Steps::new(stages.watch, problem.row_of().len() as u64, "rows");
        let patches = problem.elements();
        let describe = |element| problem.describe(element);
        let assemble = || method.assemble(&patches, &problem.occluders, &describe, &rows);
        return stages.run("assembly", assemble);
    }
    let watch = stages.watch;
    stages.run("assembly", || assemble_with_errors(&problem.integrator(), watch).map_err(coupling_failure))
}

/// The exchanges of the rows, m².
fn merged(problem: &Problem, matrix: PackedSymmetric<f64>) -> Result<PackedSymmetric<f64>, Error> {
    if problem.is_unmerged() {
        return Ok(matrix);
    }
    aggregate(&matrix, problem.row_of(), problem.surface_rows())
        .map_err(|error| Error::new(ErrorKind::Input, error))
}

/// The matrix with closed rows, where that is asked for.
fn closed(
    problem: &Problem,
    matrix: PackedSymmetric<f64>,
    area: &[f64],
    row_error: &[f64],
    stages: &mut Stages,
) -> Result<(PackedSymmetric<f64>, Option<ClosureChange>), Error> {
    if !problem.options.close {
        return Ok((matrix, None));
    }
    let closed = stages.run("closure", || close(problem, &matrix, area, row_error))?;
    let change = change(&matrix, area, row_error, &closed, problem.surface_rows());
    Ok((closed.matrix, Some(change)))
}

fn close(
    problem: &Problem,
    matrix: &PackedSymmetric<f64>,
    area: &[f64],
    row_error: &[f64],
) -> Result<Closed, Error> {
    enforce_closure(matrix, area, row_error, problem.surface_rows()).map_err(|error| {
        use fredholm_coupling::ClosureError::{Infeasible, Open};
        let (Open { row, .. } | Infeasible { row, .. }) = error else {
            return Error::new(ErrorKind::Input, error);
        };
        let help = format!("row {row} is `{}`; leave out --close, or add --sky", problem.rows.names[row]);
        Error::new(ErrorKind::Input, format!("--close: {error}")).with_help(help)
    })
}

/// How far the closed matrix is from the one computed, over the first `closing` rows.
fn change(
    matrix: &PackedSymmetric<f64>,
    area: &[f64],
    row_error: &[f64],
    closed: &Closed,
    closing: usize,
) -> ClosureChange {
    let largest = |values: &mut dyn Iterator<Item = f64>| values.reduce(f64::max);
    let sums = matrix.row_sums();
    let over = closed.change[..closing].iter().zip(row_error).filter(|(_, error)| **error > ROUNDING);
    ClosureChange {
        closure_before: largest(
            &mut sums[..closing].iter().zip(area).map(|(sum, area)| (sum / area - 1.0).abs()),
        ),
        largest: Some(closed.largest),
        row_max: largest(&mut closed.change[..closing].iter().copied()),
        over_stated: largest(&mut over.map(|(change, error)| change / error)),
        steps: closed.steps as u64,
    }
}

fn points(problem: &Problem, stages: &mut Stages) -> Result<Option<ViewPoints>, Error> {
    if problem.receivers.is_empty() {
        return Ok(None);
    }
    let watch = stages.watch;
    let patches: Vec<&Patch> = problem.patches().collect();
    let seen = || problem.targets(&patches).factors(&problem.receivers, watch).map_err(coupling_failure);
    let factors = stages.run("points", seen)?;
    let points = problem.receivers.iter().map(|receiver| receiver.point.to_array()).collect();
    let normals = problem.receivers.iter().map(|receiver| receiver.normal.to_array()).collect();
    Ok(Some(ViewPoints { points, normals, factors }))
}
