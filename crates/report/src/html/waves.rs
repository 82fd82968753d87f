//! The page of a scene of waves: surface currents, whose phase can be let run.

use fredholm_mesh::Mesh;
use serde_json::Value;

use super::model::{ElementPhasors, ReportModel};
use super::page::{ReportBadge, ReportPage};
use super::plot::{ReportAxis, ReportPlot, ReportSeries};
use crate::words::count;
use crate::{WaveCurrents, WaveResiduals};

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
