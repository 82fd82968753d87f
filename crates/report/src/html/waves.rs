//! The page of a scene of waves: surface currents, whose phase can be let run.

use fredholm_mesh::Mesh;
use serde_json::Value;

use super::model::{ElementPhasors, ReportModel};
use super::page::{ReportBadge, ReportPage};
use super::plot::{ReportAxis, ReportPlot, ReportSeries};
use super::studies::{badges, provenance};
use super::table::{ReportCell, ReportColumn, ReportTable};
use crate::words::{count, percent};
use crate::{
    ComparisonRun, MethodAtReceiver, MethodRun, MethodsRecord, WaveComparison, WaveComparisonCase,
    WaveCurrents, WaveResiduals,
};

/// Names of the components along the axes.
const AXES: [&str; 3] = ["x", "y", "z"];
/// Share of the largest magnitude below which a current is none.
const LEAST_CURRENT: f64 = 1e-12;

/// What a page of waves says besides what it shows.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct WaveReport {
    /// What the scene is called.
    pub title: String,
    /// The method, as people call it.
    pub method: String,
    /// What runs along the history of residuals: `iterations` or `bounces`.
    pub across: String,
    /// What the user should know.
    pub warnings: Vec<String>,
    /// How far the result can be trusted, in sentences.
    pub statements: Vec<String>,
    /// Curves over angles.
    pub plots: Vec<ReportPlot>,
    /// What made it: names and values.
    pub provenance: Vec<(String, String)>,
    /// The complete options.
    pub options: Value,
    /// Version of the program.
    pub version: String,
}

impl<'a> ReportPage<'a> {
    /// The page of currents on the facets of a mesh.
    #[must_use]
    pub fn of_waves(report: WaveReport, model: ReportModel<'a>, residuals: &[WaveResiduals]) -> Self {
        let mut plots = report.plots;
        plots.insert(0, history(&report.across, residuals));
        let lead = ["Waves".to_owned(), count(model.mesh.len() as u64, "facet", "facets"), report.method];
        let warned = report.warnings.len() as u64;
        let badge =
            (warned > 0).then(|| ReportBadge { text: count(warned, "warning", "warnings"), good: false });
        Self {
            title: report.title,
            lead: lead.join(" · "),
            badges: badge.into_iter().collect(),
            model: Some(model),
            warnings: report.warnings,
            statements: report.statements,
            plots,
            provenance: report.provenance,
            options: report.options,
            version: report.version,
            ..Self::default()
        }
    }

    /// The page of solvers compared on the couplings of a scene.
    #[must_use]
    pub fn of_wave_comparison(title: &str, record: &WaveComparison) -> Self {
        let runs = || record.cases.iter().flat_map(|case| &case.runs);
        let (converged, all) = (runs().filter(|run| run.outcome == "converged").count(), runs().count());
        let frequencies = count(record.cases.len() as u64, "frequency", "frequencies");
        Self {
            title: title.to_owned(),
            lead: ["Comparison of solvers".to_owned(), frequencies].join(" · "),
            badges: badges(&format!("{converged} of {all} converged"), converged == all, &[]),
            statements: record.cases.iter().map(radius).collect(),
            plots: record.cases.iter().map(solvers_plot).collect(),
            tables: vec![solvers_table(record)],
            provenance: provenance(&record.version, &record.scene, "", &record.timings),
            options: record.options.clone(),
            version: record.version.clone(),
            ..Self::default()
        }
    }

    /// The page of methods compared on one scene, with the currents of the reference on its facets.
    #[must_use]
    pub fn of_methods(
        title: &str,
        record: &'a MethodsRecord,
        plots: Vec<ReportPlot>,
        model: Option<ReportModel<'a>>,
    ) -> Self {
        let (done, all) =
            (record.methods.iter().filter(|run| run.outcome == "done").count(), record.methods.len());
        let lead = ["Comparison of methods".to_owned(), count(all as u64, "method", "methods")];
        Self {
            title: title.to_owned(),
            lead: lead.join(" · "),
            badges: badges(&format!("{done} of {all} done"), done == all, &record.warnings),
            model,
            warnings: record.warnings.clone(),
            statements: methods_statements(record),
            plots,
            tables: vec![methods_table(record)],
            // The table has the seconds of every method.
            provenance: provenance(&record.version, &record.scene, &record.scene_sha256, &[]),
            version: record.version.clone(),
            ..Self::default()
        }
    }
}

/// What the bounces of a coupling do, and what errors are measured against.
fn radius(case: &WaveComparisonCase) -> String {
    let ends = if case.spectral_radius < 1.0 { "converges" } else { "diverges" };
    format!(
        "At {} MHz there are {}; the spectral radius is about {:.3}, so that the sum of bounces {ends}. Errors are measured against {}.",
        case.frequency / 1e6,
        count(case.unknowns, "unknown", "unknowns"),
        case.spectral_radius,
        case.reference
    )
}

fn solvers_plot(case: &WaveComparisonCase) -> ReportPlot {
    let ran = || case.runs.iter().filter(|run| run.history.residual.len() > 1);
    let over = |label: &str, across: &dyn Fn(&ComparisonRun) -> Vec<f64>| {
        let line = |run: &ComparisonRun| ReportSeries {
            name: run.solver.clone(),
            colour: None,
            dashed: false,
            x: across(run),
            y: run.history.residual.clone(),
        };
        (ReportAxis { label: label.to_owned(), logarithmic: false }, ran().map(line).collect())
    };
    let steps = |run: &ComparisonRun| (0..run.history.residual.len()).map(|step| step as f64).collect();
    ReportPlot {
        title: format!("Residuals, {} MHz", case.frequency / 1e6),
        note: "The relative residual ‖b − x + K x‖₂/‖b‖₂. Point at a line to see it alone.".to_owned(),
        across: vec![over("iterations", &steps), over("seconds", &|run| run.history.seconds.clone())],
        up: ReportAxis { label: "relative residual".to_owned(), logarithmic: true },
        polar: None,
    }
}

fn solvers_table(record: &WaveComparison) -> ReportTable {
    let columns = ["Solver", "Outcome", "Frequency, MHz", "Iterations", "Seconds", "Residual", "Error"];
    let row = |case: &WaveComparisonCase, run: &ComparisonRun| {
        let outcome =
            run.reason.as_ref().map_or_else(|| run.outcome.clone(), |why| format!("{}: {why}", run.outcome));
        let ran = run.reason.is_none();
        let numbers = [run.iterations as f64, run.seconds, run.residual, run.error];
        let numbers = numbers.map(|value| ReportCell::Number((ran && value.is_finite()).then_some(value)));
        let first = ReportCell::Number(Some(case.frequency / 1e6));
        let words = [run.solver.clone(), outcome].map(ReportCell::Text);
        words.into_iter().chain([first]).chain(numbers).collect::<Vec<_>>()
    };
    ReportTable {
        title: "Solvers".to_owned(),
        note: "Residual and error ‖x − x*‖₂/‖x*‖₂ at the end.".to_owned(),
        columns: columns.map(ReportColumn::new).into(),
        rows: record.cases.iter().flat_map(|case| case.runs.iter().map(move |run| row(case, run))).collect(),
    }
}

/// What the methods are compared with, and how far each is from it.
fn methods_statements(record: &MethodsRecord) -> Vec<String> {
    let least = |run: &MethodRun| run.worst(|at| at.stated_error);
    let reference = record.methods.iter().find(|run| run.method == record.reference);
    let stated = match reference.and_then(least) {
        Some(error) => format!(", which states an error of at most {} of itself", percent(error)),
        None => ", although it states no error of itself".to_owned(),
    };
    let partial = record.partial.then(|| "The run was cancelled before all methods were done.".to_owned());
    let first = format!("Differences are those from {}{stated}.", record.reference);
    let others = record.methods.iter().filter_map(|run| {
        let difference = percent(run.worst(|at| at.difference)?);
        let stated = match least(run) {
            Some(error) => format!("states at most {}", percent(error)),
            None => "states no error".to_owned(),
        };
        Some(format!("{} differs by at most {difference} and {stated}.", run.method))
    });
    partial.into_iter().chain([first]).chain(others).collect()
}

fn methods_table(record: &MethodsRecord) -> ReportTable {
    let columns = [
        "Method",
        "Outcome",
        "Receiver",
        "Frequency, MHz",
        "Stated error, %",
        "Difference, %",
        "Levels differ by, dB",
        "Facets",
        "Seconds",
    ];
    let row = |run: &MethodRun, at: Option<&MethodAtReceiver>| {
        let outcome =
            run.reason.as_ref().map_or_else(|| run.outcome.clone(), |why| format!("{}: {why}", run.outcome));
        let receiver = at.map_or_else(String::new, |at| at.receiver.clone());
        let hundredfold = |value: Option<f64>| value.map(|value| 100.0 * value);
        let numbers = [
            at.map(|at| at.frequency / 1e6),
            at.and_then(|at| hundredfold(at.stated_error)),
            at.and_then(|at| hundredfold(at.difference)),
            at.and_then(|at| at.level_difference),
            at.map(|_| run.facets as f64),
            at.map(|_| run.seconds),
        ];
        let words = [run.method.clone(), outcome, receiver].map(ReportCell::Text);
        words.into_iter().chain(numbers.map(ReportCell::Number)).collect::<Vec<_>>()
    };
    let rows = record.methods.iter().flat_map(|run| {
        let none = run.receivers.is_empty().then(|| row(run, None));
        none.into_iter().chain(run.receivers.iter().map(move |at| row(run, Some(at))))
    });
    ReportTable {
        title: "Methods".to_owned(),
        note: format!(
            "Difference of the scattered field from that of {}, relative to it, L² over the points or directions; levels where it is within 20 dB of its largest.",
            record.reference
        ),
        columns: columns.map(ReportColumn::new).into(),
        rows: rows.collect(),
    }
}

/// The currents J and M of each frequency: magnitude, and the component that is largest over the
/// whole surface.
#[must_use]
pub fn current_phasors(mesh: &Mesh, currents: &[WaveCurrents]) -> Vec<ElementPhasors> {
    let kinds = [("J", "A/m", 0), ("M", "V/m", 6)];
    let of = |set: &WaveCurrents, (symbol, unit, start): (&str, &str, usize)| {
        let parts = |row: &[f64; 12]| -> [f64; 6] { std::array::from_fn(|i| row[start + i]) };
        let rows: Vec<[f64; 6]> = set.values.iter().map(parts).collect();
        let magnitude = |row: &[f64; 6]| row.iter().map(|x| x * x).sum::<f64>().sqrt();
        let power = |axis: usize| -> f64 {
            let weighted = rows.iter().zip(mesh.patches());
            weighted
                .map(|(row, patch)| patch.area() * (row[2 * axis].powi(2) + row[2 * axis + 1].powi(2)))
                .sum()
        };
        let strongest = (0..3).max_by(|&a, &b| power(a).total_cmp(&power(b))).unwrap_or(0);
        ElementPhasors {
            name: format!("Current {symbol}, {}", set.name),
            symbol: symbol.to_owned(),
            component: format!("{symbol}{}", AXES[strongest]),
            unit: unit.to_owned(),
            values: rows.iter().map(|row| [row[2 * strongest], row[2 * strongest + 1]]).collect(),
            magnitude: rows.iter().map(magnitude).collect(),
        }
    };
    let largest = |phasors: &ElementPhasors| phasors.magnitude.iter().copied().fold(0.0, f64::max);
    let all = currents.iter().flat_map(|set| kinds.map(|kind| of(set, kind)));
    all.filter(|phasors| largest(phasors) > LEAST_CURRENT).collect()
}

fn history(across: &str, residuals: &[WaveResiduals]) -> ReportPlot {
    let line = |set: &WaveResiduals| ReportSeries {
        name: format!("{} MHz", set.frequency / 1e6),
        colour: None,
        dashed: false,
        x: (0..set.values.len()).map(|step| step as f64).collect(),
        y: set.values.clone(),
    };
    ReportPlot {
        title: "Convergence".to_owned(),
        note: "The relative residual on the way.".to_owned(),
        across: vec![(
            ReportAxis { label: across.to_owned(), logarithmic: false },
            residuals.iter().map(line).collect(),
        )],
        up: ReportAxis { label: "relative residual".to_owned(), logarithmic: true },
        polar: None,
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::field::tests::sample;

    #[test]
    fn the_strongest_component_is_shown_and_the_magnitude_of_all() {
        let mut row = [0.0; 12];
        (row[0], row[3], row[4]) = (1.0, -3.0, 2.0);
        let currents = WaveCurrents { name: "1 MHz".to_owned(), values: vec![row; 3] };
        let found = current_phasors(&sample(), &[currents]);
        // There is no magnetic current.
        assert_eq!(found.len(), 1);
        assert_eq!((found[0].symbol.as_str(), found[0].component.as_str()), ("J", "Jy"));
        assert_eq!(found[0].values, [[0.0, -3.0]; 3]);
        assert!((found[0].magnitude[2] - 14.0_f64.sqrt()).abs() < 1e-15);
    }

    #[test]
    fn a_page_of_solvers_says_whether_bounces_converge() {
        let run = |outcome: &str, reason: Option<&str>| ComparisonRun {
            solver: "neumann".to_owned(),
            outcome: outcome.to_owned(),
            reason: reason.map(str::to_owned),
            iterations: 7,
            ..ComparisonRun::default()
        };
        let runs = vec![run("diverged", None), run("refused", Some("not symmetric"))];
        let case = WaveComparisonCase {
            frequency: 1e9,
            unknowns: 40,
            spectral_radius: 1.12,
            reference: "gmres".to_owned(),
            runs,
        };
        let record = WaveComparison { cases: vec![case], ..WaveComparison::default() };
        let page = ReportPage::of_wave_comparison("Cube", &record);
        assert_eq!(page.badges[0].text, "0 of 2 converged");
        assert!(page.statements[0].contains("1.120, so that the sum of bounces diverges"));
        let rows = &page.tables[0].rows;
        assert_eq!(
            (rows[0][3].clone(), rows[1][3].clone()),
            (ReportCell::Number(Some(7.0)), ReportCell::Number(None))
        );
    }

    #[test]
    fn a_page_of_methods_says_what_each_is_worth() {
        let at = |difference: Option<f64>| MethodAtReceiver {
            receiver: "far".to_owned(),
            frequency: 1e9,
            stated_error: difference.is_none().then_some(0.01),
            difference,
            level_difference: difference,
        };
        let run = |method: &str, receivers| MethodRun {
            method: method.to_owned(),
            outcome: "done".to_owned(),
            receivers,
            ..MethodRun::default()
        };
        let refused = MethodRun {
            method: "cfie".to_owned(),
            outcome: "refused".to_owned(),
            reason: Some("the body is open".to_owned()),
            ..MethodRun::default()
        };
        let methods = vec![run("efie", vec![at(None)]), run("iterated", vec![at(Some(0.2))]), refused];
        let record = MethodsRecord { reference: "efie".to_owned(), methods, ..MethodsRecord::default() };
        let said = methods_statements(&record);
        assert_eq!(said.len(), 2);
        assert!(said[0].contains("efie, which states an error of at most 1 % of itself"), "{said:?}");
        assert!(said[1].contains("iterated differs by at most 20 % and states no error"), "{said:?}");
        let table = methods_table(&record);
        assert_eq!((table.rows.len(), table.rows[1][5].clone()), (3, ReportCell::Number(Some(20.0))));
        assert_eq!(table.rows[2][1], ReportCell::Text("refused: the body is open".to_owned()));
    }

    #[test]
    fn a_page_of_waves_carries_its_phasors() {
        let mesh = sample();
        let currents = WaveCurrents { name: "1 MHz".to_owned(), values: vec![[1.0; 12]; 3] };
        let phasors = current_phasors(&mesh, &[currents]);
        let model = ReportModel { phasors: &phasors, ..ReportModel::bare(&mesh) };
        let report = WaveReport { title: "Plate".to_owned(), ..WaveReport::default() };
        let mut out = Vec::new();
        ReportPage::of_waves(report, model, &[]).write(&mut out).unwrap();
        let text = String::from_utf8(out).unwrap();
        assert!(text.contains("\"component\":\"Jz\"") && text.contains("\"component\":\"Mz\""));
        assert!(!text.contains("class=\"plot\""), "there is no history to draw");
    }
}
