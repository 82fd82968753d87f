//! What a run found, before it is written.

use fredholm_linop::StopReason;
use fredholm_report::{FarRow, MonostaticRow, WaveCurrents, WaveRow};
use serde_json::{Value, json};

use super::Model;
use super::balance::{Balance, Reciprocity};
use super::estimate::Estimated;
use super::files::is_table;
use super::interpolation::Interpolated;
use crate::summary::WAVES_FORMAT;

/// How the currents at one frequency were found.
#[derive(Clone, Debug)]
pub struct Solved {
    /// Frequency, Hz.
    pub frequency: f64,
    /// Facets of the scatterer.
    pub facets: usize,
    /// How many bounces were summed, or the solver.
    pub solution: String,
    /// Relative residual after every iteration; none where bounces are merely summed.
    pub residuals: Vec<f64>,
    /// Why the solver stopped, where one did.
    pub reason: Option<StopReason>,
}

impl Solved {
    /// Whether the residual asked for was met, or none was.
    #[must_use]
    pub fn converged(&self) -> bool {
        self.reason.is_none_or(|reason| reason == StopReason::Converged)
    }
}

/// All results.
#[derive(Clone, Debug, Default)]
pub(crate) struct Outcome {
    pub(crate) near: Vec<WaveRow>,
    pub(crate) far: Vec<FarRow>,
    pub(crate) monostatic: Vec<MonostaticRow>,
    pub(crate) currents: Vec<WaveCurrents>,
    pub(crate) solved: Vec<Solved>,
    /// Stated relative errors of E at the receivers and of their far fields.
    pub(crate) stated_errors: Vec<Estimated>,
    /// Estimated relative errors of E at the receivers from the mesh.
    pub(crate) mesh_errors: Vec<Estimated>,
    /// Half the difference between the electric and the magnetic form: what physical optics itself
    /// may be wrong by.
    pub(crate) form_errors: Vec<Estimated>,
    /// Radiated and absorbed beside supplied powers.
    pub(crate) balances: Vec<Balance>,
    /// How far sweeps are from being reciprocal.
    pub(crate) reciprocity: Vec<Reciprocity>,
    /// How the frequencies were interpolated, where they were.
    pub(crate) interpolated: Option<Interpolated>,
    /// What should be known of the results.
    pub(crate) notes: Vec<String>,
}

impl Outcome {
    /// Adds what another frequency has.
    pub(super) fn append(&mut self, other: Self) {
        self.near.extend(other.near);
        self.far.extend(other.far);
        self.monostatic.extend(other.monostatic);
        self.currents.extend(other.currents);
        self.solved.extend(other.solved);
        self.stated_errors.extend(other.stated_errors);
        self.mesh_errors.extend(other.mesh_errors);
        self.form_errors.extend(other.form_errors);
        self.balances.extend(other.balances);
        self.reciprocity.extend(other.reciprocity);
        self.notes.extend(other.notes);
    }

    /// Whether every residual asked for was met.
    pub(crate) fn converged(&self) -> bool {
        self.solved.iter().all(Solved::converged)
    }

    /// How many bounces were summed, or the solver, which may be another than that of the scene:
    /// every one of those that its frequencies took.
    pub(super) fn solution(&self, model: &Model) -> String {
        let mut names: Vec<&str> = Vec::new();
        for solved in &self.solved {
            if !names.contains(&solved.solution.as_str()) {
                names.push(&solved.solution);
            }
        }
        if names.is_empty() { model.method.name() } else { names.join("; ") }
    }

    /// Tables that are too large for text, and are arrays only.
    fn left_out(&self) -> Vec<&'static str> {
        let all = [
            ("receivers.csv", self.near.len()),
            ("far.csv", self.far.len()),
            ("monostatic.csv", self.monostatic.len()),
        ];
        all.into_iter().filter(|(_, rows)| !is_table(*rows)).map(|(name, _)| name).collect()
    }

    /// The run record.
    pub(crate) fn record(&self, model: &Model, timings: &[fredholm_report::Timing]) -> Value {
        let solved = |solved: &Solved| {
            json!({
                "frequency_hz": solved.frequency,
                "wavelength_m": fredholm_waves::medium::SPEED_OF_LIGHT / solved.frequency,
                "facets": solved.facets,
                "solution": solved.solution,
                "converged": solved.converged(),
                "residuals": solved.residuals,
            })
        };
        json!({
            "format": WAVES_FORMAT,
            "program": concat!("fredholm ", env!("CARGO_PKG_VERSION")),
            "scene": model.path(),
            "scene_sha256": model.scene.sha256(),
            "title": model.scene.title(),
            "method": model.method_name(),
            "order": model.order(),
            "shadows": model.shadows_name(),
            "solution": self.solution(model),
            "edge_currents": model.edge_currents,
            "chosen_because": model.reason,
            "receivers": model.receivers.iter().map(|receiver| &receiver.name).collect::<Vec<_>>(),
            "stated_errors": self.stated_errors.iter().map(|e| e.record(model)).collect::<Vec<_>>(),
            "estimated_mesh_errors": self.mesh_errors.iter().map(|e| e.record(model)).collect::<Vec<_>>(),
            "estimated_form_errors": self.form_errors.iter().map(|e| e.record(model)).collect::<Vec<_>>(),
            "power": self.balances.iter().map(Balance::record).collect::<Vec<_>>(),
            "reciprocity": self.reciprocity.iter().map(|r| r.record(model)).collect::<Vec<_>>(),
            "interpolated": self.interpolated.as_ref().map(Interpolated::record),
            "frequencies": self.solved.iter().map(solved).collect::<Vec<_>>(),
            "left_out_as_text": self.left_out(),
            "warnings": model.warnings,
            "timings": timings,
        })
    }
}
