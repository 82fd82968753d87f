//! Studies of one scene: solvers compared, spectra, meshes refined, shots, and the cross-checks.

use fredholm_report::{
    BandSpectrum, COMPARISON_FILES, ComparisonCase, ComparisonRecord, ComparisonRun, CrosscheckPower,
    CrosscheckRecord, JudgeRecord, JudgedPlace, METHODS_FILES, MethodRun, MethodsRecord, REFINEMENT_FILES,
    ReferenceRecord, RefinementRecord, SPECTRUM_FILES, ShootingRecord, SpectrumRecord, WaveComparison,
    WorstPlace,
};
use serde_json::Value;

use super::lines::{Lines, MOST_ENTRIES_TOLD, percent, times};
use super::{Made, Summarise};
use crate::size::Bytes;

impl Summarise for ComparisonRecord {
    fn made(&self) -> Made<'_> {
        Made { version: &self.version, of: &self.scene, sha256: &self.scene_sha256 }
    }

    fn shown(&self) -> Option<(&'static str, &'static str)> {
        Some(("plot", COMPARISON_FILES[2]))
    }

    fn lines(&self, lines: &mut Lines) {
        lines.add("size", format!("{} unknowns, {} stored entries", self.unknowns, self.entries));
        lines.add_some("most memory", self.peak_memory_bytes.map(|peak| Bytes(peak.into()).to_string()));
        self.cases.iter().for_each(|case| lines.table(case_table(case, self.entries)));
        self.warnings.iter().for_each(|warning| lines.add("warning", warning));
    }

    fn details(&self, lines: &mut Lines) {
        options(&self.options, lines);
    }
}

fn options(options: &Value, lines: &mut Lines) {
    lines.add("options", format!("{options:#}"));
}

fn case_table(case: &ComparisonCase, entries: u64) -> Vec<String> {
    let width = case.runs.iter().map(|run| run.solver.chars().count()).fold(8, usize::max);
    let head = [
        String::new(),
        format!(
            "reflectance up to {:.4}; errors against {} (residual {:.1e})",
            case.reflectance, case.reference, case.reference_residual
        ),
        format!(
            "{:width$}  {:>10}  {:>9}  {:>9}  {:>9}  {:>9}  outcome",
            "solver", "iterations", "readings", "seconds", "residual", "error"
        ),
    ];
    let rows = case.runs.iter().map(|run| format!("{:width$}  {}", run.solver, case_row(run, entries)));
    head.into_iter().chain(rows).collect()
}

/// Readings are entries read over entries stored.
fn case_row(run: &ComparisonRun, entries: u64) -> String {
    if run.reason.is_some() {
        return format!("{:>54}  refused", "");
    }
    let readings = run.entries as f64 / entries.max(1) as f64;
    format!(
        "{:>10}  {readings:>9.1}  {:>9.3}  {:>9.1e}  {:>9.1e}  {}",
        run.iterations, run.seconds, run.residual, run.error, run.outcome
    )
}

impl Summarise for WaveComparison {
    fn made(&self) -> Made<'_> {
        Made { version: &self.version, of: &self.scene, sha256: "" }
    }

    fn shown(&self) -> Option<(&'static str, &'static str)> {
        Some(("plot", COMPARISON_FILES[2]))
    }

    fn lines(&self, lines: &mut Lines) {
        for case in &self.cases {
            let width = case.runs.iter().map(|run| run.solver.chars().count()).fold(8, usize::max);
            let head = [
                String::new(),
                format!(
                    "{} MHz, {} unknowns, spectral radius {:.3}; errors against {}",
                    case.frequency / 1e6,
                    case.unknowns,
                    case.spectral_radius,
                    case.reference
                ),
                format!("{:width$}  iterations   residual      error  outcome", "solver"),
            ];
            let row = |run: &ComparisonRun| format!("{:width$}  {}", run.solver, wave_row(run));
            lines.table(head.into_iter().chain(case.runs.iter().map(row)));
        }
    }

    fn details(&self, lines: &mut Lines) {
        options(&self.options, lines);
    }
}

fn wave_row(run: &ComparisonRun) -> String {
    match &run.reason {
        Some(reason) => format!("{:>32}  refused: {reason}", ""),
        None => {
            format!("{:>10}  {:>9.1e}  {:>9.1e}  {}", run.iterations, run.residual, run.error, run.outcome)
        }
    }
}

impl Summarise for MethodsRecord {
    fn made(&self) -> Made<'_> {
        Made { version: &self.version, of: &self.scene, sha256: &self.scene_sha256 }
    }

    fn shown(&self) -> Option<(&'static str, &'static str)> {
        Some(("table", METHODS_FILES[0]))
    }

    fn lines(&self, lines: &mut Lines) {
        let width = self.methods.iter().map(|run| run.method.chars().count()).fold(8, usize::max);
        let head = [
            String::new(),
            format!("largest over receivers and frequencies; differences from {}", self.reference),
            format!("{:width$}   stated  difference  levels, dB   seconds  outcome", "method"),
        ];
        let row = |run: &MethodRun| format!("{:width$}  {}", run.method, method_row(run));
        lines.table(head.into_iter().chain(self.methods.iter().map(row)));
        lines.add_some("partial", self.partial.then(|| "cancelled before all methods were done".to_owned()));
        self.warnings.iter().for_each(|warning| lines.add("warning", warning));
    }

    fn details(&self, lines: &mut Lines) {
        let places = self.methods.iter().flat_map(|run| run.receivers.iter().map(move |at| (run, at)));
        let percent = |value: Option<f64>| value.map_or_else(|| "unknown".to_owned(), percent);
        for (run, at) in places {
            let difference =
                at.difference.map(|difference| format!(", differs by {}", self::percent(difference)));
            let text = format!(
                "{} at {}, {} MHz: states {}{}",
                run.method,
                at.receiver,
                at.frequency / 1e6,
                percent(at.stated_error),
                difference.unwrap_or_default()
            );
            lines.add("method", text);
        }
    }
}

fn method_row(run: &MethodRun) -> String {
    if let Some(reason) = &run.reason {
        return format!("{:>40}  refused: {reason}", "");
    }
    let shown = |value: Option<f64>, scale: f64, unit: &str| {
        value.map_or_else(|| "–".to_owned(), |value| format!("{:.2}{unit}", scale * value))
    };
    let stated = shown(run.worst(|at| at.stated_error), 100.0, " %");
    let difference = shown(run.worst(|at| at.difference), 100.0, " %");
    let levels = shown(run.worst(|at| at.level_difference), 1.0, "");
    format!("{stated:>9}  {difference:>10}  {levels:>10}  {:>8.2}  {}", run.seconds, run.outcome)
}

impl Summarise for SpectrumRecord {
    fn made(&self) -> Made<'_> {
        Made { version: &self.version, of: &self.scene, sha256: &self.scene_sha256 }
    }

    fn shown(&self) -> Option<(&'static str, &'static str)> {
        Some(("plot", SPECTRUM_FILES[1]))
    }

    fn lines(&self, lines: &mut Lines) {
        lines.add("unknowns", format!("{} in each band, {} methods", self.unknowns, self.method));
        self.bands.iter().take(MOST_ENTRIES_TOLD).for_each(|band| spectrum(band, lines));
        lines.add_some("", more(self.bands.len(), SPECTRUM_FILES[2]));
    }

    fn details(&self, _: &mut Lines) {}
}

/// Of how many bands nothing was told.
fn more(bands: usize, file: &str) -> Option<String> {
    (bands > MOST_ENTRIES_TOLD).then(|| format!("and {} bands more: see {file}", bands - MOST_ENTRIES_TOLD))
}

fn spectrum(band: &BandSpectrum, lines: &mut Lines) {
    let jacobi = band.jacobi_radius.map(|radius| format!(", ρ(J) {radius:.6}")).unwrap_or_default();
    lines.add(
        &band.band,
        format!("ρ(RF) {:.6}{jacobi}, ρ(L₁) {:.6}", band.reflection_radius, band.gauss_seidel_radius),
    );
    let conditions = [("Φ", band.condition_phi), ("Ψ", band.condition_psi), ("Θ", band.condition_theta)];
    let conditions = conditions.into_iter().filter_map(|(name, value)| Some(format!("{name} {:.4}", value?)));
    lines.add("  cond₂", conditions.collect::<Vec<_>>().join(", "));
    let told = |name: &str, value: Option<bool>| {
        value.map(|yes| format!("{name}: {}", if yes { "yes" } else { "no" }))
    };
    let properties = [
        told("M-matrix", band.m_matrix),
        told("Stieltjes", band.stieltjes),
        told("irreducible", band.irreducible),
        band.symmetry_defect.map(|defect| format!("symmetry defect of Ψ {defect:.1e}")),
        band.largest_imaginary.map(|imaginary| format!("largest imaginary part {imaginary:.1e}")),
    ];
    let properties: Vec<String> = properties.into_iter().flatten().collect();
    lines.add_some("  properties", (!properties.is_empty()).then(|| properties.join(", ")));
    let field =
        band.field_of_values.map(|[low, high, across]| format!("{low:.4} … {high:.4}, ± {across:.4} i"));
    lines.add_some("  values in", field);
}

impl Summarise for RefinementRecord {
    fn made(&self) -> Made<'_> {
        Made { version: &self.version, of: &self.scene, sha256: &self.scene_sha256 }
    }

    fn shown(&self) -> Option<(&'static str, &'static str)> {
        Some(("plot", REFINEMENT_FILES[1]))
    }

    fn lines(&self, lines: &mut Lines) {
        lines.add("discretisation", &self.discretisation);
        (0..self.levels.len()).for_each(|at| lines.add(&format!("level {at}"), level(self, at)));
        self.bands.iter().take(MOST_ENTRIES_TOLD).for_each(|band| lines.add(&band.band, &band.verdict));
        lines.add_some("", more(self.bands.len(), REFINEMENT_FILES[2]));
        self.warnings.iter().for_each(|warning| lines.add("warning", warning));
    }

    fn details(&self, lines: &mut Lines) {
        options(&self.options, lines);
    }
}

/// A level, with the worst band's difference to the finest and, where there is one, the smallest
/// order.
fn level(record: &RefinementRecord, at: usize) -> String {
    let level = &record.levels[at];
    let differences = record.bands.iter().filter_map(|band| band.differences.get(at).copied());
    let worst = differences.fold(0.0, f64::max);
    let finest = at + 1 == record.levels.len();
    let distance = if finest { String::new() } else { format!(", {worst:.1e} from the finest") };
    let orders = record.bands.iter().filter_map(|band| band.orders.get(at).copied().flatten());
    let order = orders.reduce(f64::min).map(|order| format!(", order {order:.2}")).unwrap_or_default();
    format!(
        "{} elements, {} unknowns, h {:.4} m, {:.2} s{distance}{order}",
        level.elements, level.unknowns, level.h, level.seconds
    )
}

impl Summarise for ShootingRecord {
    fn made(&self) -> Made<'_> {
        Made { version: &self.version, of: &self.scene, sha256: &self.scene_sha256 }
    }

    fn shown(&self) -> Option<(&'static str, &'static str)> {
        self.drawn.then_some(("picture", fredholm_report::IMAGE))
    }

    fn lines(&self, lines: &mut Lines) {
        lines.add("shots", shots(self));
        lines.add("stated error", shooting_error(self));
        lines.add(
            "size",
            format!("{} elements, {} of them and of their groups can shoot", self.elements, self.groups),
        );
        lines.add("form factors", format!("estimated error of one {:.1e} at most", self.form_factor_error));
        lines
            .add_some("memory", self.peak_memory_bytes.map(|peak| format!("{} at most", Bytes(peak.into()))));
        lines.add("time", times(&self.timings));
    }

    fn details(&self, lines: &mut Lines) {
        lines.add("bands", self.bands.join(", "));
        self.warnings.iter().for_each(|warning| lines.add("warning", warning));
        options(&self.options, lines);
    }
}

/// The stated error in the worst band.
fn shooting_error(record: &ShootingRecord) -> String {
    let worst = record.mesh_error.as_ref().and_then(|e| e.relative_l2.iter().copied().reduce(f64::max));
    worst.map_or_else(
        || "not known: that takes a run that was not interrupted".to_owned(),
        |worst| {
            format!(
                "{} of the irradiance of the faces (mesh and unshot light; L2, worst band; estimate)",
                percent(worst)
            )
        },
    )
}

fn shots(record: &ShootingRecord) -> String {
    let Some(last) = record.shots.last() else { return "none: nothing shines".to_owned() };
    let state = if record.reached { "" } else { ", which is less than was asked for" };
    format!(
        "{} from {} columns in {:.2} s: {:.2} % of the power distributed{state}",
        record.shots.len(),
        last.columns,
        last.seconds,
        100.0 * last.distributed
    )
}

impl Summarise for CrosscheckRecord {
    fn made(&self) -> Made<'_> {
        Made { version: &self.version, of: &self.scene, sha256: &self.scene_sha256 }
    }

    fn lines(&self, lines: &mut Lines) {
        let verdict = match self.verdict.as_str() {
            "undecided" => "undecided: too little was sampled to say that they agree".to_owned(),
            verdict => format!("they {verdict}"),
        };
        lines.add(
            "verdict",
            format!(
                "{verdict}: {}",
                apart(self.significant, self.places, self.significance, &self.correction)
            ),
        );
        lines.add_some("power", self.power.as_ref().map(|found| power(found, ["surface", "face"])));
        lines.add(
            "scores",
            format!("mean {:.3}, mean of squares {:.3}", self.score_mean, self.score_variance),
        );
        self.worst.iter().for_each(|place| lines.add("worst", worst(place)));
        lines.add(
            "traced",
            format!(
                "{}, {} batches, standard error {:.2} %",
                self.method,
                self.batches,
                100.0 * self.relative_error
            ),
        );
        lines.add("time", times(&self.timings));
    }

    fn details(&self, lines: &mut Lines) {
        lines.add("solver", &self.solver);
        lines.add("seed", self.seed.to_string());
    }
}

/// How many places are apart.
fn apart(significant: usize, places: usize, significance: f64, correction: &str) -> String {
    format!("{significant} of {places} places apart at {significance} ({correction})")
}

/// What would have been found.
fn power(power: &CrosscheckPower, [several, one]: [&str; 2]) -> String {
    let percent =
        |part: Option<f64>| part.map_or_else(|| "any".to_owned(), |x| format!("{:.2} %", 100.0 * x));
    format!(
        "a deviation of the whole by {} would have been found nine times out of ten, of a typical {several} by {}, of a typical {one} by {}",
        percent(power.whole),
        percent(power.surface),
        percent(power.face)
    )
}

/// One of the places farthest apart, in words.
fn worst(place: &WorstPlace) -> String {
    let ([x, y, z], relative) = (place.centroid, 100.0 * place.relative);
    let (score, number, of) = (place.z, place.face, &place.surface);
    let head = format!("z = {score:+.2}, {relative:+.2} %");
    let at = format!("at ({x:.3}, {y:.3}, {z:.3})");
    match place.kind.as_str() {
        "whole" => format!("{head}: the whole, band {}", place.band),
        "surface" => format!("{head}: surface {of}, band {}", place.band),
        "face" => format!("{head}: face {number} of {of}, {at}, band {}", place.band),
        kind => format!("{head}: {kind} {number} of {of}, {at}, {}", place.band),
    }
}

impl Summarise for JudgeRecord {
    fn made(&self) -> Made<'_> {
        Made { version: &self.version, of: &self.bundle, sha256: &self.scene_sha256 }
    }

    fn lines(&self, lines: &mut Lines) {
        let said = match self.verdict.as_str() {
            "agree" => "agrees",
            "disagree" => "disagrees",
            _ => "undecided: too little was sampled to say that it agrees",
        };
        lines.add(
            "verdict",
            format!("{said}: {}", apart(self.significant, self.places, self.significance, &self.correction)),
        );
        let pixels = self.quantity.contains("pixel");
        lines.add("power", power(&self.power, if pixels { ["tile", "pixel"] } else { ["surface", "face"] }));
        lines.add(
            "scores",
            format!("mean {:.3}, mean of squares {:.3}", self.score_mean, self.score_variance),
        );
        self.worst.iter().for_each(|place| lines.add("worst", judged(place)));
        lines.add(
            "compared",
            format!("{}, independent runs: {}, error from: {}", self.quantity, self.seeds, self.error_from),
        );
    }

    fn details(&self, lines: &mut Lines) {
        lines.add("files", self.files.join(", "));
    }
}

/// One of the places farthest apart, in words.
fn judged(place: &JudgedPlace) -> String {
    let ([known, _], [found, _]) = (place.reference, place.found);
    let relative =
        if known == 0.0 { String::new() } else { format!(", {:+.2} %", 100.0 * (found / known - 1.0)) };
    format!("z = {:+.2}{relative}: {}, band {}", place.z, place.name, place.band)
}

impl Summarise for ReferenceRecord {
    fn made(&self) -> Made<'_> {
        Made { version: &self.version, of: &self.scene, sha256: &self.scene_sha256 }
    }

    fn lines(&self, lines: &mut Lines) {
        lines.add("stated error", format!("{:.3} % (L2 over faces)", 100.0 * self.relative_error));
        lines.add("median face", format!("{:.3} % of its own value", 100.0 * self.median_error));
        lines.add("values", format!("{} faces, {} bands", self.faces, self.bands.len()));
        let seen = &self.pixels;
        let picture =
            format!("{} × {} pixels, {:.3} % (L2)", seen.width, seen.height, 100.0 * seen.relative_error);
        lines.add("picture", picture);
        lines.add("time", times(&self.timings));
    }

    fn details(&self, lines: &mut Lines) {
        lines.add("bands", self.bands.join(", "));
        lines.add("method", &self.method);
        lines.add("seed", self.seed.to_string());
        self.conventions.iter().for_each(|text| lines.add("convention", text));
    }
}
