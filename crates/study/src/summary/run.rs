//! A run that has solved or traced a scene of light, or traced fields.

use std::fmt::Write;

use fredholm_report::{Closure, Counts, Energy, IMAGE, Received, RunRecord};

use super::lines::{Lines, MOST_ENTRIES_TOLD, extent, number, percent, times, value};
use super::{Made, Summarise};
use crate::size::Bytes;

/// Error that is worth a word on how to make it smaller.
const ERROR_WORTH_A_WORD: f64 = 0.05;

impl Summarise for RunRecord {
    fn made(&self) -> Made<'_> {
        Made { version: &self.version, of: &self.scene, sha256: &self.scene_sha256 }
    }

    fn shown(&self) -> Option<(&'static str, &'static str)> {
        self.files.iter().any(|name| name == IMAGE).then_some(("picture", IMAGE))
    }

    /// The answer, its error and what makes that smaller, then the figures that say whether to
    /// trust it.
    fn lines(&self, lines: &mut Lines) {
        answer(self, lines);
        lines.add_some("size", (self.counts.elements > 0).then(|| counts(&self.counts)));
        lines.add_some("way", self.choice.clone());
        lines.add("solution", solution(self));
        closure(self, lines);
        lines.add_some("form factors", form_factors(self));
        lines.add_some("reciprocity", reciprocity(self));
        lines.add_some("time", (!self.timings.is_empty()).then(|| times(&self.timings)));
        self.warnings.iter().for_each(|warning| lines.add("warning", warning));
    }

    fn details(&self, lines: &mut Lines) {
        lines.add("state", if self.partial { "partial: the run was interrupted" } else { "complete" });
        lines.add("bands", self.bands.join(", "));
        lines.add_some("peak memory", self.peak_memory_bytes.map(|bytes| Bytes(bytes.into()).to_string()));
        let work: Vec<_> = self.work.iter().map(|(name, count)| format!("{name} {count}")).collect();
        lines.add_some("work", (!work.is_empty()).then(|| work.join(", ")));
        lines.add_some("files", (!self.files.is_empty()).then(|| self.files.join(", ")));
        self.energy.iter().for_each(|energy| lines.add_some("energy", balance(energy)));
        lines.add("options", format!("{:#}", self.options));
    }
}

/// What the scene receives, how far that is right, and how to come closer.
fn answer(run: &RunRecord, lines: &mut Lines) {
    if let Some(goal) = run.hierarchy.as_ref().and_then(|hierarchy| hierarchy.goal.as_ref()) {
        let means = run.bands.iter().zip(&goal.irradiance).map(|(band, mean)| in_band(run, band, *mean));
        let means = listed(means, run.bands.len());
        lines.add("answer", format!("mean irradiance of {}: {means} W/m²", goal.surfaces.join(", ")));
    } else if !run.received.is_empty() {
        lines.add("answer", received(run));
    }
    let stated = stated(run);
    lines.add("stated error", &stated.text);
    lines.add_some("to be closer", stated.closer);
}

/// The mean of every band, and how far the faces are apart.
fn received(run: &RunRecord) -> String {
    let of = |band: &Received| {
        let Received { band, mean, least, most } = band;
        format!("{} (faces {} to {})", in_band(run, band, *mean), value(*least), value(*most))
    };
    format!("mean irradiance {} W/m²", listed(run.received.iter().map(of), run.received.len()))
}

/// A value with the name of its band, where there are several.
fn in_band(run: &RunRecord, band: &str, mean: f64) -> String {
    if run.bands.len() > 1 { format!("{band} {}", value(mean)) } else { value(mean) }
}

/// The first of many.
fn listed(items: impl Iterator<Item = String>, count: usize) -> String {
    let shown: Vec<String> = items.take(MOST_ENTRIES_TOLD).collect();
    let more = count.saturating_sub(MOST_ENTRIES_TOLD);
    let more = if more > 0 { format!(" and {more} bands more, in run.json,") } else { String::new() };
    shown.join(", ") + &more
}

/// What is stated of the error, and what makes it smaller.
struct Stated {
    text: String,
    closer: Option<String>,
}

fn stated(run: &RunRecord) -> Stated {
    let worst = |errors: &[f64]| errors.iter().copied().reduce(f64::max);
    if let Some(hierarchy) = &run.hierarchy {
        let (what, rest) = match &hierarchy.goal {
            Some(goal) => (
                format!("the mean irradiance of {}", goal.surfaces.join(", ")),
                "; only that was asked for, all else may be far less exact",
            ),
            None => ("the irradiance of the faces".to_owned(), ""),
        };
        let text = hierarchy.stated.map_or_else(
            || format!("not known: that of {what} takes the change from one round to the next{rest}"),
            |error| {
                let asked = percent(hierarchy.accuracy);
                format!(
                    "{} of {what} (L2, worst band; estimate; {asked} was asked for){rest}",
                    percent(error)
                )
            },
        );
        let reached = hierarchy.stated.is_some_and(|error| error <= hierarchy.accuracy);
        return Stated { text, closer: if reached { finer(hierarchy.stated) } else { further(run) } };
    }
    if let Some(error) = run.standard_error {
        let what = if run.received.is_empty() { "the fields" } else { "the irradiance of the faces" };
        let text = format!("{} of {what} (standard error, L2)", percent(error));
        let half = percent(error / 2.0).replace(' ', "");
        let closer = format!("--continue with --to {half}: four times as many samples halve the error");
        return Stated { text, closer: (error > ERROR_WORTH_A_WORD).then_some(closer) };
    }
    if let Some(worst) = run.field_error.as_ref().and_then(|error| worst(&error.relative_l2)) {
        let text = format!(
            "{} of the irradiance as polynomials (L2, worst band; estimate); means over elements are closer",
            percent(worst)
        );
        return Stated { text, closer: (worst > ERROR_WORTH_A_WORD).then(|| "use more elements".to_owned()) };
    }
    if let Some(worst) = run.mesh_error.as_ref().and_then(|error| worst(&error.relative_l2)) {
        let text = format!("{} of the irradiance of the faces (L2, worst band; estimate)", percent(worst));
        return Stated { text, closer: finer(Some(worst)) };
    }
    let why = match run.stop_reason.as_str() {
        "converged" => "what the form factors lose or add has no end",
        _ => "that takes a solution within the tolerance",
    };
    Stated { text: format!("not known: {why}"), closer: further(run) }
}

/// How an error that is stated becomes smaller.
fn finer(stated: Option<f64>) -> Option<String> {
    let error = stated.filter(|&error| error > ERROR_WORTH_A_WORD)?;
    let asked = percent(error / 4.0).replace(' ', "");
    Some(format!("--accuracy {asked} chooses elements that suffice"))
}

/// How a run that missed what it was asked for gets there.
fn further(run: &RunRecord) -> Option<String> {
    let limited = run.hierarchy.as_ref().is_some_and(|hierarchy| hierarchy.limited);
    let text = match run.stop_reason.as_str() {
        _ if limited => "allow more with --memory; the links did not fit",
        _ if run.partial && run.hierarchy.is_some() => {
            "`fredholm resume DIR`, with the folder of the results"
        }
        _ if run.partial => "run it again, with more time",
        "converged" => return None,
        _ => "allow more with --max-iterations, or choose another --solver",
    };
    Some(text.to_owned())
}

fn counts(counts: &Counts) -> String {
    let Counts { surfaces, faces, elements, bands, .. } = *counts;
    let other = counts.unknowns != elements && counts.unknowns > 0;
    let unknowns = if other { format!(", {} unknowns", counts.unknowns) } else { String::new() };
    format!("{}, {}{unknowns}", extent(elements, faces, surfaces), number(bands, "band"))
}

fn solution(run: &RunRecord) -> String {
    if run.history.iterations.is_empty() {
        let [paths, rays] =
            ["paths", "rays"].map(|of| run.work.get(of).map(|n| format!(", {n} {of}")).unwrap_or_default());
        return format!("{} by {}{paths}{rays}; no system of equations", run.stop_reason, run.solver);
    }
    let iterations = run.history.iterations.last().copied().unwrap_or(0);
    let last = run.history.residual.iter().filter_map(|band| band.last());
    let residual = last.fold(0.0, |worst: f64, &r| if r > worst || r.is_nan() { r } else { worst });
    let asked = run.tolerance.map(|t| format!(" (asked: {t:.1e})")).unwrap_or_default();
    let (solver, reason) = (&run.solver, &run.stop_reason);
    let rays = run.work.get("rays").map(|n| format!("; {n} rays")).unwrap_or_default();
    let count = number(iterations, "iteration");
    format!("{reason} after {count} of {solver}, residual {residual:.1e}{asked}{rays}")
}

/// Whether the scene is open, what of it is buried, and how far row sums are off besides.
fn closure(run: &RunRecord, lines: &mut Lines) {
    let found = &run.closure;
    let off = row_sums(found);
    match (found.open, found.backs, found.rays) {
        (Some(open), Some(backs), Some(rays)) if open + backs > 0.0 => {
            lines.add("openings", openings(found, [open, backs], rays));
        }
        (Some(_), Some(_), Some(rays)) => {
            lines.add("openings", format!("none: of {rays} rays all meet lit sides of surfaces"));
            let links = if run.hierarchy.is_some() { ", which coarse links leave" } else { "" };
            lines.add_some("closure", off.map(|off| format!("{off}{links}")));
        }
        _ => lines.add_some("closure", off),
    }
    let blind = found.blind.filter(|&share| share > 0.0);
    let why = "other surfaces stand on it, it lies on one, or it looks into the void";
    lines.add_some("sees nothing", blind.map(|share| format!("{} of the area: {why}", percent(share))));
}

fn openings(closure: &Closure, [open, backs]: [f64; 2], rays: u64) -> String {
    let ends = [(open, "is empty"), (backs, "is backs of one-sided surfaces, which are black")];
    let ends: Vec<String> = ends
        .iter()
        .filter(|(share, _)| *share > 0.0)
        .map(|(share, what)| format!("{} {what}", percent(*share)))
        .collect();
    let factors = closure.missing.map(|missing| format!("; the form factors lack {}", percent(missing)));
    format!("of what the surfaces see, {} ({rays} rays){}", ends.join(", "), factors.unwrap_or_default())
}

/// How far row sums are from 1, in a scene where they should be 1.
fn row_sums(closure: &Closure) -> Option<String> {
    let mut text = format!("row sums of the form factors differ from 1 by {:.1e} at most", closure.max?);
    if let Some(surface) = &closure.worst_surface {
        // Writing to a string cannot fail.
        let _ = write!(text, " (on {surface})");
    }
    if let Some(mean) = closure.mean {
        let _ = write!(text, ", {mean:.1e} on average");
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

fn reciprocity(run: &RunRecord) -> Option<String> {
    Some(format!("both orders of integration agree within {:.1e} (largest of a sample)", run.reciprocity?))
}
