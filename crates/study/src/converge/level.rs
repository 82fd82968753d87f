//! A solved level: means of the irradiance over the faces, which all levels have in common, and
//! over the surfaces. W/m².

use fredholm_linop::{MultiVector, StopReason};
use fredholm_mesh::{Mesh, Patch};
use fredholm_report::{RefinementLevel, Timing};

use crate::problem::Problem;
use crate::solution::{Solution, reason};

/// What is kept of a level.
pub(super) struct Level {
    pub(super) reason: StopReason,
    /// Means over the faces, faces × bands.
    pub(super) faces: MultiVector<f64>,
    /// Means over the surfaces, surfaces × bands.
    surfaces: MultiVector<f64>,
    elements: usize,
    unknowns: usize,
    h: f64,
    row_error: Option<f64>,
    timings: Vec<Timing>,
}

impl Level {
    pub(super) fn new(problem: &Problem, solution: &Solution, timings: &[Timing]) -> Self {
        let (mesh, irradiance) = (&problem.mesh, &solution.means.irradiance);
        Self {
            reason: solution.report.reason,
            faces: means(mesh, irradiance, mesh.faces().len(), |leaf| mesh.face_of(leaf)),
            surfaces: means(mesh, irradiance, mesh.surfaces().len(), |leaf| mesh.surface_of(leaf)),
            elements: mesh.len(),
            unknowns: problem.unknowns,
            h: mesh.patches().map(Patch::diameter).fold(0.0, f64::max),
            row_error: solution.row_error.iter().copied().reduce(f64::max),
            timings: timings.to_vec(),
        }
    }

    /// What the record tells of it.
    pub(super) fn record(&self, level: usize) -> RefinementLevel {
        RefinementLevel {
            level: level as u64,
            elements: self.elements as u64,
            unknowns: self.unknowns as u64,
            h: self.h,
            seconds: self.timings.iter().map(|timing| timing.seconds).sum(),
            timings: self.timings.clone(),
            stop_reason: reason(self.reason).to_owned(),
            row_error: self.row_error,
            irradiance: (0..self.surfaces.dim()).map(|surface| self.surfaces.row(surface).to_vec()).collect(),
        }
    }
}

/// Area means over groups of leaves; 0 for a group without leaves.
fn means(
    mesh: &Mesh,
    values: &MultiVector<f64>,
    groups: usize,
    group: impl Fn(usize) -> usize,
) -> MultiVector<f64> {
    let mut sums = MultiVector::<f64>::zeros(groups, values.rhs_count());
    let mut areas = vec![0.0; groups];
    for (leaf, patch) in mesh.patches().enumerate() {
        let area = patch.area();
        areas[group(leaf)] += area;
        let sums = sums.row_mut(group(leaf)).iter_mut().zip(values.row(leaf));
        sums.for_each(|(sum, value)| *sum += area * value);
    }
    MultiVector::from_fn(groups, values.rhs_count(), |i, band| {
        if areas[i] > 0.0 { sums.row(i)[band] / areas[i] } else { 0.0 }
    })
}
