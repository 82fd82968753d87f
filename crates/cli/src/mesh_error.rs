//! The error of the mesh, from a second solution with one element a face.

use fredholm_coupling::{Means, MeshError, Radiosity, mesh_error};
use fredholm_linop::{PackedSymmetric, StopReason, Storage};

use crate::failure::Failure;
use crate::problem::{Problem, coarse};
use crate::solution::{coupling_failure, solve};
use crate::watcher::Watcher;

/// Estimates the error of a solution. There is no estimate where a face has fewer than 2 × 2 elements, or where the coarse
/// problem was not solved to the end.
pub(crate) fn estimate<S: Storage>(
    problem: &Problem,
    radiosity: &Radiosity,
    matrix: &PackedSymmetric<S>,
    means: &Means,
    watcher: Watcher,
) -> Result<Option<MeshError>, Failure> {
    let (mesh, count) = (&problem.mesh, coarse(&problem.mesh));
    if count == 0 || watcher.go_on().is_break() {
        return Ok(None);
    }
    let group: Vec<usize> = (0..mesh.len()).map(|leaf| mesh.face_of(leaf)).collect();
    let (faces, exchange) = radiosity.coarsen(matrix, &group, count).map_err(coupling_failure)?;
    let (x, report) = solve(problem, &faces, &exchange, watcher)?;
    if report.reason != StopReason::Converged {
        return Ok(None);
    }
    let fine = radiosity.grouped(&means.irradiance, &group, faces.elements());
    let coarse = faces.means(&exchange, &x).irradiance;
    let fewest = (0..count).map(|face| mesh.leaves_of_face(face).len()).min().unwrap_or(1);
    let refinement = (fewest as f64).sqrt();
    Ok(Some(mesh_error(&fine, &coarse, faces.elements(), refinement)))
}
