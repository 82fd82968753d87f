//! The page of a solved scene.

use super::model::ReportModel;
use super::page::{ReportBadge, ReportPage};
use super::plot::{ReportAxis, ReportPlot, ReportSeries};
use super::table::{ReportCell, ReportColumn, ReportTable};
use crate::mean::Means;
use crate::words::{count, number, percent};
use crate::{Closure, Energy, Field, Hierarchy, MeshError, Picture, RunRecord, Timing};

impl<'a> ReportPage<'a> {
    /// The page of a solved scene, called `title`. The model shows the field; the picture stands
    /// for it where three dimensions cannot be shown.
    #[must_use]
    pub fn of_run(
        title: &str,
        field: &Field<'a>,
        run: &'a RunRecord,
        model: ReportModel<'a>,
        picture: Option<&'a Picture>,
    ) -> Self {
        Self {
            title: title.to_owned(),
            lead: lead(run),
            badges: badges(run),
            bands: field.bands(),
            model: Some(model),
            picture,
            warnings: run.warnings.clone(),
            statements: statements(run),
            plots: vec![convergence(run)],
            tables: [surfaces(field), energy(&run.energy)].into_iter().flatten().collect(),
            provenance: provenance(run),
            options: run.options.clone(),
            version: run.version.clone(),
            ..Self::default()
        }
    }
}

fn lead(run: &RunRecord) -> String {
    let counts = &run.counts;
    let parts = [
        "Diffuse light".to_owned(),
        count(counts.surfaces, "surface", "surfaces"),
        count(counts.elements, "element", "elements"),
        count(counts.bands, "band", "bands"),
        run.solver.clone(),
    ];
    parts.join(" · ")
}

fn badges(run: &RunRecord) -> Vec<ReportBadge> {
    let partial = run.partial.then(|| ReportBadge { text: "partial".to_owned(), good: false });
    let stop = ReportBadge { text: run.stop_reason.clone(), good: run.stop_reason == "converged" };
    let warned = run.warnings.len() as u64;
    let warned =
        (warned > 0).then(|| ReportBadge { text: count(warned, "warning", "warnings"), good: false });
    [Some(stop), partial, warned].into_iter().flatten().collect()
}

/// How far a run can be trusted.
fn statements(run: &RunRecord) -> Vec<String> {
    let mut said = vec![solved(run)];
    said.extend(run.choice.iter().map(|choice| format!("The way to the accuracy: {choice}.")));
    said.extend(run.hierarchy.as_ref().map(accuracy));
    said.extend(run.mesh_error.as_ref().map(|error| elements(error, &run.bands)));
    if let Some(error) = &run.field_error {
        let worst = error.relative_l2.iter().copied().fold(0.0, f64::max);
        said.push(format!(
            "As polynomials on the elements, the irradiance is off by \
            about {} (L2 over the surfaces, worst band).",
            percent(worst)
        ));
    }
    said.extend(form_factors(run));
    said.extend(closure(run));
    if let Some(violation) = run.reciprocity {
        said.push(format!(
            "Aᵢ Fᵢⱼ = Aⱼ Fⱼᵢ holds within {} among the partly occluded pairs that were checked.",
            number(violation)
        ));
    }
    said.extend(run.energy.iter().filter_map(balance).reduce(f64::max).map(|worst| {
        format!(
            "Emitted power is what is absorbed and what leaves through openings, within {} of it.",
            percent(worst)
        )
    }));
    said
}

fn solved(run: &RunRecord) -> String {
    let iterations = run.history.iterations.last().copied().unwrap_or(0);
    let last = run.history.residual.iter().filter_map(|band| band.last().copied());
    let residual = last.reduce(f64::max).map_or_else(String::new, |residual| {
        format!(": relative residual {} in the worst band", number(residual))
    });
    let asked = run.tolerance.map(|t| format!(", {} asked for", number(t))).unwrap_or_default();
    let done = count(iterations, "iteration", "iterations");
    format!("The solver {} ended as “{}” after {done}{residual}{asked}.", run.solver, run.stop_reason)
}

fn accuracy(hierarchy: &Hierarchy) -> String {
    let stated = hierarchy.stated.map_or_else(
        || "what was reached is not known".to_owned(),
        |error| format!("the estimate is {}", percent(error)),
    );
    let of = match &hierarchy.goal {
        Some(goal) => format!("the mean irradiance of {}", goal.surfaces.join(", ")),
        None => "the irradiance of the faces (L2)".to_owned(),
    };
    format!("An error of {} was asked for in {of}; {stated}.", percent(hierarchy.accuracy))
}

pub(super) fn elements(error: &MeshError, bands: &[String]) -> String {
    let worst = error.relative_l2.iter().copied().enumerate().max_by(|a, b| a.1.total_cmp(&b.1));
    let Some((band, relative)) = worst else {
        return "The error that comes from the size of the elements is not known.".to_owned();
    };
    let band = bands.get(band).filter(|_| bands.len() > 1);
    let band = band.map(|name| format!(" in band {name}")).unwrap_or_default();
    let largest = error.largest.iter().copied().fold(0.0, f64::max);
    format!(
        "From the size of the elements, the irradiance of the faces is off by about \
            {} (L2 over the faces{band}); of one face by {} W/m² at most.",
        percent(relative),
        number(largest)
    )
}

fn form_factors(run: &RunRecord) -> Option<String> {
    let error = &run.form_factor_error;
    let row = error.row_max?;
    let asked = error.tolerance.map(|t| format!(", {} asked for", number(t))).unwrap_or_default();
    Some(format!("The form factors of a row are off by about {} together at most{asked}.", number(row)))
}

/// Where light goes that row sums lack, or how far they are from 1 where nothing is open; and what
/// sees nothing.
fn closure(run: &RunRecord) -> Option<String> {
    let found = &run.closure;
    let ends = [(found.open, "is empty"), (found.backs, "is backs of one-sided surfaces, which are black")];
    let ends: Vec<String> = ends
        .into_iter()
        .filter_map(|(share, what)| share.filter(|&share| share > 0.0).map(|share| (share, what)))
        .map(|(share, what)| format!("{} {what}", percent(share)))
        .collect();
    let seen = if ends.is_empty() {
        row_sums(found)?
    } else {
        let missing = found.missing.map(|m| format!("; the form factors lack {}", percent(m)));
        format!("Of what the surfaces see, {}{}.", ends.join(", "), missing.unwrap_or_default())
    };
    let blind = found.blind.filter(|&share| share > 0.0);
    let blind = blind.map(|share| {
        format!(
            " {} of the area sees nothing: other surfaces stand on it, it lies on one, or it looks into \
             the void.",
            percent(share)
        )
    });
    Some(seen + &blind.unwrap_or_default())
}

fn row_sums(found: &Closure) -> Option<String> {
    let largest = found.max?;
    let mean = found.mean.map(|m| format!(", by {} in the mean", number(m))).unwrap_or_default();
    let place = found.worst_surface.as_ref();
    let place = place.map(|name| format!(", most on surface {name}")).unwrap_or_default();
    let open = if found.rays.is_none() { "; openings count as well" } else { "" };
    Some(format!(
        "Row sums of the form factors differ from 1 by {} at most{mean}{place}{open}.",
        number(largest)
    ))
}

/// What is missing in the balance of a band, over what is emitted.
fn balance(energy: &Energy) -> Option<f64> {
    let (emitted, absorbed, escaped) = (energy.emitted?, energy.absorbed?, energy.escaped?);
    (emitted > 0.0).then(|| (emitted - absorbed - escaped).abs() / emitted)
}

/// Residuals over iterations and over seconds.
pub(super) fn convergence(run: &RunRecord) -> ReportPlot {
    let iterations: Vec<f64> = run.history.iterations.iter().map(|&i| i as f64).collect();
    let over = |label: &str, across: &[f64]| {
        let axis = ReportAxis { label: label.to_owned(), logarithmic: false };
        let line = |(band, residual): (&String, &Vec<f64>)| ReportSeries {
            name: if run.bands.len() > 1 { band.clone() } else { "residual".to_owned() },
            colour: None,
            dashed: false,
            x: across.to_vec(),
            y: residual.clone(),
        };
        let mut lines: Vec<ReportSeries> = run.bands.iter().zip(&run.history.residual).map(line).collect();
        if let (Some(level), Some(first), Some(last)) = (run.tolerance, across.first(), across.last()) {
            lines.push(level_line("asked for", level, [*first, *last]));
        }
        (axis, lines)
    };
    ReportPlot {
        title: "Convergence".to_owned(),
        note: "The relative residual ‖b − A x‖₂/‖b‖₂ of each band on the \
            way. Drag to enlarge, double click to go back."
            .to_owned(),
        across: vec![over("iterations", &iterations), over("seconds", &run.history.seconds)],
        up: ReportAxis { label: "relative residual".to_owned(), logarithmic: true },
        polar: None,
    }
}

/// A level to compare with.
pub(super) fn level_line(name: &str, level: f64, ends: [f64; 2]) -> ReportSeries {
    ReportSeries { name: name.to_owned(), colour: None, dashed: true, x: ends.to_vec(), y: vec![level; 2] }
}

/// Means and powers of the surfaces, over all bands where they are powers.
pub(super) fn surfaces(field: &Field<'_>) -> Option<ReportTable> {
    let mesh = field.mesh();
    let bands = 0..field.bands().len();
    let means = |values| Means::new(field, values, mesh.surfaces().len(), |leaf| mesh.surface_of(leaf));
    let (e, b, m) = (means(field.irradiance()), means(field.radiosity()), field.exitance().map(means));
    let mut columns: Vec<ReportColumn> = ["Surface", "Area, m²"].map(ReportColumn::new).into();
    for (title, name) in [("Irradiance, W/m²", "irradiance"), ("Radiosity, W/m²", "radiosity")] {
        columns.push(ReportColumn { title: title.to_owned(), of_band: Some(name) });
    }
    if m.is_some() {
        columns.extend(["Emitted, W", "Absorbed, W"].map(ReportColumn::new));
    }
    let total = |means: &Means, surface| bands.clone().map(|band| means.integral(surface, band)).sum::<f64>();
    let row = |(i, surface): (usize, &fredholm_mesh::Surface)| {
        let numbers = [e.area(i), e.mean(i, 0), b.mean(i, 0)];
        let powers = m.as_ref().map(|m| {
            let emitted = total(m, i);
            [emitted, total(&e, i) - (total(&b, i) - emitted)]
        });
        let numbers = numbers.into_iter().chain(powers.into_iter().flatten());
        let cells = numbers.map(|value| ReportCell::Number(Some(value)));
        std::iter::once(ReportCell::Text(surface.name.clone())).chain(cells).collect()
    };
    let note = "Irradiance and radiosity are means over a surface in the band \
        that is chosen above; powers are sums over all bands.";
    Some(ReportTable {
        title: "Surfaces".to_owned(),
        note: note.to_owned(),
        columns,
        rows: mesh.surfaces().iter().enumerate().map(row).collect(),
    })
    .filter(|_| !field.bands().is_empty())
}

fn energy(bands: &[Energy]) -> Option<ReportTable> {
    let row = |energy: &Energy| {
        let numbers =
            [energy.emitted, energy.absorbed, energy.escaped, balance(energy)].map(ReportCell::Number);
        std::iter::once(ReportCell::Text(energy.band.clone())).chain(numbers).collect()
    };
    let columns = ["Band", "Emitted, W", "Absorbed, W", "Through openings, W", "Imbalance, relative"];
    Some(ReportTable {
        title: "Energy".to_owned(),
        note: "What is emitted is absorbed or leaves through openings.".to_owned(),
        columns: columns.map(ReportColumn::new).into(),
        rows: bands.iter().map(row).collect(),
    })
    .filter(|table| !table.rows.is_empty())
}

fn provenance(run: &RunRecord) -> Vec<(String, String)> {
    let counts = &run.counts;
    let memory = |bytes: u64| format!("{} MB", number(bytes as f64 / 1e6));
    let mut known = vec![
        ("Program", format!("Fredholm {}", run.version)),
        ("Scene", run.scene.clone()),
        ("SHA-256 of the scene", run.scene_sha256.clone()),
        ("Discretisation", run.discretisation.clone()),
        ("Values of elements", run.means.clone()),
        ("Solver", run.solver.clone()),
        ("Unknowns", format!("{} in each band", count(counts.unknowns, "", "").trim())),
        ("Matrix", count(counts.matrix_entries, "entry", "entries")),
    ];
    known.extend(run.peak_memory_bytes.map(|bytes| ("Most memory", memory(bytes))));
    known.extend((!run.timings.is_empty()).then(|| ("Time", times(&run.timings))));
    known.retain(|(_, value)| !value.is_empty());
    known.into_iter().map(|(name, value)| (name.to_owned(), value)).collect()
}

/// Stages with their seconds.
pub(super) fn times(timings: &[Timing]) -> String {
    let total: f64 = timings.iter().map(|timing| timing.seconds).sum();
    let stage = |timing: &Timing| format!("{} {} s", timing.stage, number(timing.seconds));
    let stages: Vec<String> = timings.iter().map(stage).collect();
    format!("{} s: {}", number(total), stages.join(", "))
}
