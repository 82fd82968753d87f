//! The record of a run, `run.json`.

use std::collections::BTreeMap;

use fredholm_coupling::MethodCounts;
use fredholm_linop::{Report, StopReason, Work};
use fredholm_report::{
    Closure, Counts, Energy, Field, FieldError, FormFactorError, Hierarchy, History, MeshError, Received,
    RunRecord, wanted_files,
};
use serde_json::Value;

use crate::memory;
use crate::openness::{LEAST_ROW_SUM, openness};
use crate::options::SolveSettings;
use crate::pictures;
use crate::problem::Problem;
use crate::rays::Rays;
use crate::solution::{Solution, reason};
use crate::stages::Stages;

/// Estimated error of a row of form factors that may be rounding alone.
const ROUNDING: f64 = 1e-11;

/// Everything that is worth knowing of a run.
pub(crate) fn record(
    problem: &Problem,
    options: &SolveSettings,
    solution: &Solution,
    stages: &Stages,
) -> RunRecord {
    let report = &solution.report;
    RunRecord {
        version: env!("CARGO_PKG_VERSION").to_owned(),
        scene: problem.scene.path().display().to_string(),
        scene_sha256: problem.scene.sha256().to_owned(),
        options: serde_json::to_value(options).unwrap_or(Value::Null),
        bands: problem.scene.bands().to_vec(),
        counts: counts(problem, solution),
        timings: stages.timings().to_vec(),
        predicted_memory_bytes: u64::try_from(problem.plan.peak().0).ok(),
        peak_memory_bytes: memory::peak_bytes(),
        discretisation: options.problem.discretisation.clone(),
        means: solution.means_of.to_owned(),
        solver: options.problem.solver.clone(),
        tolerance: solution.rays.is_none().then_some(options.tolerance),
        history: history(report, problem.scene.bands().len()),
        work: work(&report.work, solution.rays.as_ref()),
        stop_reason: reason(report.reason).to_owned(),
        received: field(problem, solution).map_or_else(Vec::new, |field| received(&field)),
        closure: openness(closure(problem, &solution.closure), problem, &solution.exposed, &solution.closure),
        form_factor_error: form_factor_error(options, solution),
        pairs: solution.methods.as_ref().map(pairs).unwrap_or_default(),
        mesh_error: solution.mesh_error.as_ref().map(mesh_error),
        hierarchy: solution.hierarchy.clone(),
        field_error: solution.field_error.clone().map(|relative_l2| FieldError { relative_l2 }),
        reciprocity: solution.reciprocity,
        choice: options.choice.clone(),
        energy: energy(problem, solution),
        files: wanted_files(&pictures::wanted(options, solution)).map(str::to_owned).collect(),
        warnings: problem.warnings.iter().cloned().chain(remarks(options, solution)).collect(),
        partial: report.reason == StopReason::Interrupted,
        ..RunRecord::default()
    }
}

/// What the user should know of the solution.
pub(crate) fn remarks(options: &SolveSettings, solution: &Solution) -> impl Iterator<Item = String> {
    let own = [unfinished(solution), inexact(options, solution), coarse(solution), large(solution)];
    own.into_iter().flatten().chain(solution.replaced.clone())
}

fn unfinished(solution: &Solution) -> Option<String> {
    let text = match solution.report.reason {
        StopReason::Converged => return None,
        StopReason::Interrupted if solution.hierarchy.is_some() => {
            "interrupted: the results are those of the last round, marked partial; `fredholm resume DIR`, with the folder of the results, goes on from there"
        }
        StopReason::Interrupted if solution.rays.is_some() => {
            "interrupted: the results are those of the rays so far, marked partial"
        }
        StopReason::Interrupted => "interrupted: the results are those of the last iterate, marked partial",
        StopReason::IterationLimit | StopReason::Diverged => {
            "the tolerance was not met; allow more with --max-iterations or --tolerance, or choose another --solver"
        }
    };
    Some(text.to_owned())
}

/// Whether the accuracy was not reached.
fn coarse(solution: &Solution) -> Option<String> {
    let hierarchy = solution.hierarchy.as_ref().filter(|_| !solution.is_accurate())?;
    let Hierarchy { accuracy, stated, limited, goal, .. } = hierarchy;
    let whose = if goal.is_some() { "mean irradiance of the goal" } else { "irradiance" };
    let reached = stated.map_or_else(|| "not known".to_owned(), |error| format!("{error:.1e}"));
    let why = match solution.report.reason {
        _ if *limited => "the memory did not allow finer links; allow more with --memory",
        StopReason::Converged => "the rounds ran out",
        StopReason::Interrupted => "the run was interrupted",
        StopReason::IterationLimit | StopReason::Diverged => "the solver did not converge",
    };
    Some(format!(
        "the estimated error of the {whose} is {reached}, where {accuracy:.1e} was asked for: {why}"
    ))
}

/// Stated error of the irradiance that is worth a warning.
pub(crate) const ERROR_WORTH_A_WARNING: f64 = 0.1;

/// Whether constants on the elements are far off.
fn large(solution: &Solution) -> Option<String> {
    let error =
        solution.mesh_error.as_ref().filter(|_| solution.hierarchy.is_none() && solution.rays.is_none())?;
    let worst = error.relative_l2.iter().copied().fold(0.0, f64::max);
    (worst > ERROR_WORTH_A_WARNING).then(|| {
        format!(
            "the irradiance of the faces may be {:.0} % off: light changes much across the elements\n  \
             help: --accuracy 1% chooses elements that suffice, or use more (elements_per_face, divide, largest_edge in the scene)",
            100.0 * worst
        )
    })
}

/// Row errors, in tolerances, that are reported: the stated errors of exact pairs of a row add up to
/// about twice the tolerance.
const REPORTED_ROW_ERROR: f64 = 3.0;

/// Whether the form factors came out less exact than asked for.
fn inexact(options: &SolveSettings, solution: &Solution) -> Option<String> {
    let asked = options.problem.form_factor_tolerance;
    let error = solution.row_error.iter().copied().fold(0.0, f64::max);
    (error > (REPORTED_ROW_ERROR * asked).max(ROUNDING)).then(|| {
        format!(
            "the estimated error of a row of form factors is {error:.1e}, where {asked:.1e} was asked for; \
             cut the surfaces more finely where they almost touch"
        )
    })
}

fn counts(problem: &Problem, solution: &Solution) -> Counts {
    let mesh = &problem.mesh;
    Counts {
        surfaces: mesh.surfaces().len() as u64,
        faces: mesh.faces().len() as u64,
        elements: mesh.len() as u64,
        unknowns: problem.unknowns as u64,
        occluders: mesh.occluders().len() as u64,
        bands: problem.scene.bands().len() as u64,
        matrix_entries: solution.entries,
    }
}

fn history(report: &Report, bands: usize) -> History {
    let records = || report.history.iter();
    History {
        iterations: records().map(|record| record.iteration as u64).collect(),
        seconds: records().map(|record| record.seconds).collect(),
        residual: (0..bands).map(|band| records().map(|r| r.residuals[band]).collect()).collect(),
    }
}

fn work(work: &Work, rays: Option<&Rays>) -> BTreeMap<String, u64> {
    let counters = [
        ("operator_applications", work.operator_applications),
        ("row_visits", work.row_visits),
        ("column_visits", work.column_visits),
        ("entries_touched", work.entries_touched),
    ];
    let rays = rays.map(|rays| ("rays", rays.cast));
    counters.into_iter().chain(rays).map(|(name, count)| (name.to_owned(), count)).collect()
}

/// The irradiance of the faces of a field, band by band.
pub(crate) fn received(field: &Field<'_>) -> Vec<Received> {
    let (faces, [irradiance, _]) = (field.mesh().faces(), field.face_means());
    let (bands, area) = (field.bands(), faces.iter().map(|face| face.area).sum::<f64>());
    let of = |(at, band): (usize, &String)| {
        let all = || irradiance.iter().skip(at).step_by(bands.len()).copied();
        Received {
            band: band.clone(),
            mean: all().zip(faces).map(|(e, face)| e * face.area).sum::<f64>() / area,
            least: all().fold(f64::INFINITY, f64::min),
            most: all().fold(0.0, f64::max),
        }
    };
    if faces.is_empty() { Vec::new() } else { bands.iter().enumerate().map(of).collect() }
}

fn field<'a>(problem: &'a Problem, solution: &'a Solution) -> Option<Field<'a>> {
    let (irradiance, radiosity) = (solution.means.irradiance.as_slice(), solution.means.radiosity.as_slice());
    Field::new(&problem.mesh, problem.scene.bands(), irradiance, radiosity).ok()
}

fn closure(problem: &Problem, closure: &[f64]) -> Closure {
    let mut found = Closure::default();
    if closure.is_empty() {
        return found;
    }
    let (mut sum, mut area) = (0.0, 0.0);
    for (element, (patch, row)) in problem.mesh.patches().zip(closure).enumerate() {
        // What sees nothing has no error.
        if *row <= LEAST_ROW_SUM {
            continue;
        }
        let defect = (row - 1.0).abs();
        sum += patch.area() * defect;
        area += patch.area();
        if found.max.is_none_or(|max| defect > max) {
            found.max = Some(defect);
            found.worst_element = Some(element as u64);
        }
    }
    let surface = found.worst_element.map(|element| problem.mesh.surface_of(element as usize));
    found.worst_surface = surface.map(|surface| problem.mesh.surfaces()[surface].name.clone());
    found.mean = (area > 0.0).then_some(sum / area);
    found
}

/// An error as the record has it.
pub(crate) fn mesh_error(error: &fredholm_coupling::MeshError) -> MeshError {
    MeshError { relative_l2: error.relative_l2.clone(), largest: error.largest.clone() }
}

/// Pairs by the name of the method.
pub(crate) fn pairs(methods: &MethodCounts) -> BTreeMap<String, u64> {
    let counts = [
        ("hidden", methods.hidden),
        ("gauss", methods.gauss),
        ("contour", methods.contour),
        ("clipped", methods.clipped),
        ("sampled", methods.sampled),
        ("segments", methods.segments),
    ];
    counts.map(|(name, count)| (name.to_owned(), count)).into()
}

fn form_factor_error(options: &SolveSettings, solution: &Solution) -> FormFactorError {
    FormFactorError {
        tolerance: solution.pair_error.map(|_| options.problem.form_factor_tolerance),
        max: solution.pair_error,
        row_max: solution.row_error.iter().copied().reduce(f64::max),
    }
}

fn energy(problem: &Problem, solution: &Solution) -> Vec<Energy> {
    let balance = |(band, energy): (&String, &fredholm_coupling::Energy)| Energy {
        band: band.clone(),
        emitted: Some(energy.emitted),
        absorbed: Some(energy.absorbed),
        escaped: Some(energy.escaped),
    };
    problem.scene.bands().iter().zip(&solution.energy).map(balance).collect()
}
