//! What a run came to, in words.

use std::fmt::Write;

use fredholm_report::{Closure, Counts, Energy, RunRecord, Timing};
use fredholm_study::Bytes;

use crate::output::visible;

/// Row sums that differ more from 1 are those of an open scene.
const OPEN: f64 = 0.01;

/// Lines with a label each.
#[derive(Debug, Default)]
pub(crate) struct Lines(String);

impl Lines {
    /// Adds a line; what has more lines is indented under its label.
    pub(crate) fn add(&mut self, label: &str, text: impl AsRef<str>) {
        let text = visible(text.as_ref()).replace('\n', &format!("\n{:18}", ""));
        // Writing to a string cannot fail.
        let _ = writeln!(self.0, "  {label:<16}{text}");
    }

    /// Adds a line where there is something to say.
    pub(crate) fn add_some(&mut self, label: &str, text: Option<String>) {
        if let Some(text) = text {
            self.add(label, text);
        }
    }

    /// The lines under a heading.
    pub(crate) fn under(self, heading: &str) -> String {
        format!("{heading}\n{}", self.0)
    }
}

/// The summary at the end of a run: the figures that say whether to trust it.
pub(crate) fn quality(run: &RunRecord, lines: &mut Lines) {
    lines.add("size", counts(&run.counts));
    lines.add_some("way", run.choice.clone());
    lines.add("solution", solution(run));
    lines.add_some("closure", closure(&run.closure));
    lines.add_some("form factors", form_factors(run));
    lines.add_some("reciprocity", reciprocity(run));
    lines.add("mesh error", goal(run).or_else(|| field_error(run)).unwrap_or_else(|| mesh_error(run)));
    lines.add_some("time", (!run.timings.is_empty()).then(|| times(&run.timings)));
    run.warnings.iter().for_each(|warning| lines.add("warning", warning));
}

/// Everything a record tells.
pub(crate) fn provenance(run: &RunRecord, lines: &mut Lines) {
    lines.add("made by", format!("fredholm {}", run.version));
    lines.add("scene", &run.scene);
    lines.add("scene sha256", &run.scene_sha256);
    lines.add("state", if run.partial { "partial: the run was interrupted" } else { "complete" });
    lines.add("bands", run.bands.join(", "));
    quality(run, lines);
    lines.add_some("peak memory", run.peak_memory_bytes.map(|bytes| Bytes(bytes.into()).to_string()));
    let work: Vec<_> = run.work.iter().map(|(name, count)| format!("{name} {count}")).collect();
    lines.add("work", work.join(", "));
    lines.add_some("files", (!run.files.is_empty()).then(|| run.files.join(", ")));
    run.energy.iter().for_each(|energy| lines.add_some("energy", balance(energy)));
    lines.add("options", format!("{:#}", run.options));
}

fn counts(counts: &Counts) -> String {
    let Counts { surfaces, faces, elements, bands, .. } = *counts;
    let unknowns =
        if counts.unknowns == elements { String::new() } else { format!(", {} unknowns", counts.unknowns) };
    format!("{}, {}{unknowns}", extent(elements, faces, surfaces), number(bands, "band"))
}

/// How many elements there are, and on what.
pub(crate) fn extent(elements: u64, faces: u64, surfaces: u64) -> String {
    let [elements, faces, surfaces] =
        [(elements, "element"), (faces, "face"), (surfaces, "surface")].map(|(n, thing)| number(n, thing));
    format!("{elements} on {faces} of {surfaces}")
}

fn number(count: u64, thing: &str) -> String {
    format!("{count} {thing}{}", if count == 1 { "" } else { "s" })
}

fn solution(run: &RunRecord) -> String {
    if let (true, Some(paths)) = (run.history.iterations.is_empty(), run.work.get("paths")) {
        return format!("{} after {paths} paths, without a system of equations", run.stop_reason);
    }
    let iterations = run.history.iterations.last().copied().unwrap_or(0);
    let last = run.history.residual.iter().filter_map(|band| band.last());
    let residual = last.fold(0.0, |worst: f64, &r| if r > worst || r.is_nan() { r } else { worst });
    let asked = run.tolerance.map(|t| format!(" (asked: {t:.1e})")).unwrap_or_default();
    let (solver, reason) = (&run.solver, &run.stop_reason);
    format!("{reason} after {} of {solver}, residual {residual:.1e}{asked}", number(iterations, "iteration"))
}

fn closure(closure: &Closure) -> Option<String> {
    let mut text = format!("row sums of the form factors differ from 1 by {:.1e} at most", closure.max?);
    if let Some(surface) = &closure.worst_surface {
        let _ = write!(text, " (on {surface})");
    }
    if let Some(mean) = closure.mean {
        let _ = write!(text, ", {mean:.1e} on average");
    }
    if closure.max > Some(OPEN) {
        text.push_str("; in an open scene, light escapes");
    }
    Some(text)
}

fn form_factors(run: &RunRecord) -> Option<String> {
    let error = &run.form_factor_error;
    let mut text = format!("estimated error of a row {:.1e} at most", error.row_max?);
    if let Some(tolerance) = error.tolerance {
        let _ = write!(text, " (asked: {tolerance:.1e})");
    }
    Some(text)
}

fn balance(energy: &Energy) -> Option<String> {
    let (emitted, absorbed) = (energy.emitted?, energy.absorbed?);
    let escaped = energy.escaped.map(|power| format!(", escaped {power:.6} W")).unwrap_or_default();
    Some(format!("{}: emitted {emitted:.6} W, absorbed {absorbed:.6} W{escaped}", energy.band))
}

/// The stages and their times.
pub(crate) fn times(timings: &[Timing]) -> String {
    let stages: Vec<_> = timings.iter().map(|t| format!("{} {:.2} s", t.stage, t.seconds)).collect();
    stages.join(", ")
}

fn reciprocity(run: &RunRecord) -> Option<String> {
    Some(format!("both orders of integration agree within {:.1e} (largest of a sample)", run.reciprocity?))
}

/// The error of the goal in the worst band.
fn goal(run: &RunRecord) -> Option<String> {
    let hierarchy = run.hierarchy.as_ref()?;
    let surfaces = hierarchy.goal.as_ref()?.surfaces.join(", ");
    let error = hierarchy.stated.map_or_else(
        || format!("that of the mean irradiance of {surfaces} is not estimated"),
        |error| {
            format!("the mean irradiance of {surfaces} is right within {error:.1e} (worst band; estimate)")
        },
    );
    Some(format!("{error}; only that was asked for, all else may be far less exact"))
}

/// The error of the field as polynomials in the worst band.
fn field_error(run: &RunRecord) -> Option<String> {
    let worst = run.field_error.as_ref()?.relative_l2.iter().copied().reduce(f64::max)?;
    Some(format!(
        "the irradiance as polynomials is right within {worst:.1e} (L2, worst band; estimate), means over elements are closer"
    ))
}

/// The error of the mesh in the worst band.
fn mesh_error(run: &RunRecord) -> String {
    let worst = run.mesh_error.as_ref().and_then(|e| e.relative_l2.iter().copied().reduce(f64::max));
    let missing = match run.stop_reason.as_str() {
        _ if run.hierarchy.is_some() => "that takes the change from one round of refinement to the next",
        "converged" => "what the form factors lose or add has no end",
        _ => "that takes a solution within the tolerance",
    };
    worst.map_or_else(
        || format!("not estimated: {missing}"),
        |worst| format!("the irradiance of the faces is right within {worst:.1e} (L2, worst band; estimate)"),
    )
}
