//! Scenes of waves, from the file to the written results.

use std::path::Path;

use fredholm_linop::{OptionError, Stop, Watch};
use fredholm_report::{
    FarRow, MethodsRecord, MonostaticRow, REPORT, ReportPage, ResultFolder, WaveComparison, WaveRow,
    write_wave_comparison,
};

use super::balance::{Balance, Reciprocity};
use super::estimate::Estimated;
use super::interpolation::Interpolated;
use super::methods::{self, WaveMethod};
use super::model::Model;
use super::record::{Outcome, Solved};
use super::{files, registry};
use crate::compare::written_out;
use crate::error::{Error, ErrorKind};
use crate::size::Bytes;
use crate::solve::{Ended, report_failure};
use crate::stages::Stages;
use crate::trial::failed;

/// What is asked of [`waves`] and [`compare_waves`]; all else says the scene.
#[derive(Clone, Copy, Debug, Default)]
pub struct WaveOptions {
    /// Memory allowed; most of what the machine has left.
    pub memory: Option<Bytes>,
    /// Whether report.html is left out.
    pub no_report: bool,
    /// Whether the coupling is stored or computed anew; what is predicted to be quicker where it is
    /// not said.
    pub storage: Option<CouplingStorage>,
}

/// Where the coupling comes from in every iteration.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum CouplingStorage {
    /// A stored matrix.
    Matrix,
    /// Products that are computed anew each time: of facets only.
    Products,
    /// A compressed matrix: of boundary elements only.
    Compressed,
    /// Multilevel fast multipoles: of boundary elements on conductors only.
    Multipole,
}

/// What is asked of [`compare_waves`] besides.
#[derive(Clone, Debug)]
pub struct WaveCompareOptions {
    /// Solvers with their options, such as `gmres:restart=100`; `all` stands for all of them.
    pub solvers: Vec<String>,
    /// Relative residual to reach.
    pub tolerance: f64,
    /// Iterations allowed.
    pub max_iterations: u32,
}

impl Default for WaveCompareOptions {
    /// All solvers, to a residual of 1e-6 in at most 1000 iterations.
    fn default() -> Self {
        Self { solvers: vec!["all".to_owned()], tolerance: 1e-6, max_iterations: 1000 }
    }
}

/// The fields of a scene of waves.
pub struct SolvedWaves<'a> {
    model: Model,
    outcome: Outcome,
    stages: Stages<'a>,
    /// Whether report.html is written.
    report: bool,
}

/// Computes the fields of a scene of waves, whose file is given.
///
/// # Errors
/// What is wrong with the scene, with line and column; [`Resources`](crate::ErrorKind::Resources)
/// before memory is taken that the limit does not allow;
/// [`NotConverged`](crate::ErrorKind::NotConverged) for a method that diverges;
/// [`Interrupted`](crate::ErrorKind::Interrupted) for a run that was cancelled.
pub fn waves<'a>(
    scene: impl AsRef<Path>,
    asked: &WaveOptions,
    watch: &'a dyn Watch,
) -> Result<SolvedWaves<'a>, Error> {
    let mut stages = Stages::new(watch);
    let mut model = load(scene.as_ref(), asked, Model::load, &mut stages)?;
    let outcome = super::compute(&model, &mut stages)?;
    let doubts = doubts(&model, &outcome);
    for doubt in &doubts {
        stages.watch.warn(doubt);
    }
    model.warnings.extend(doubts);
    stages.begin_saving()?;
    Ok(SolvedWaves { model, outcome, stages, report: !asked.no_report })
}

/// Runs solvers on the coupling of a scene of waves, whose file is given, and writes how they did
/// into a folder.
///
/// # Errors
/// As [`waves`].
pub fn compare_waves(
    scene: impl AsRef<Path>,
    asked: &WaveOptions,
    solvers: &WaveCompareOptions,
    folder: &ResultFolder,
    watch: &dyn Watch,
) -> Result<(WaveComparison, Ended), Error> {
    let mut stages = Stages::new(watch);
    let model = load(scene.as_ref(), asked, Model::load_on_facets, &mut stages)?;
    let stop = Stop { tolerance: solvers.tolerance, max_iterations: solvers.max_iterations as usize };
    let names = written_out(&solvers.solvers, &registry::names());
    let record = super::compare(&model, &names, &stop, &mut stages)?;
    stages.begin_saving()?;
    if !asked.no_report {
        let title = model.scene.title().unwrap_or(&record.scene);
        let page = ReportPage::of_wave_comparison(title, &record);
        folder.write(REPORT, |out| page.write(out)).map_err(report_failure)?;
    }
    write_wave_comparison(folder, &record).map_err(report_failure)?;
    let any = record.cases.iter().any(|case| case.runs.iter().any(failed));
    Ok((record, if any { Ended::NotConverged } else { Ended::Done }))
}

/// Finds the currents of a scene of waves, whose file is given, by several methods, and writes what
/// each came to into a folder. A method that the scene does not admit is left out, with the reason
/// in its place. A run that is cancelled keeps the methods that are done.
///
/// # Errors
/// As [`waves`], where no method is admitted.
pub fn compare_wave_methods(
    scene: impl AsRef<Path>,
    asked: &WaveOptions,
    methods: &[WaveMethod],
    folder: &ResultFolder,
    watch: &dyn Watch,
) -> Result<(MethodsRecord, Ended), Error> {
    let mut stages = Stages::new(watch);
    let how = (methods, asked.memory, !asked.no_report);
    let (record, met) = methods::compare(scene.as_ref(), how, folder, &mut stages)?;
    let ended = match (record.partial, met) {
        (true, _) => Ended::Interrupted,
        (false, true) => Ended::Done,
        (false, false) => Ended::NotConverged,
    };
    Ok((record, ended))
}

/// Fails where a text such as `gmres:restart=100` names no solver of complex systems with its
/// options.
///
/// # Errors
/// What is wrong with the name or the options.
pub fn check_wave_solver(text: &str) -> Result<(), OptionError> {
    registry::build(text).map(drop)
}

fn load(
    scene: &Path,
    asked: &WaveOptions,
    read: fn(&Path, Option<Bytes>) -> Result<Model, Error>,
    stages: &mut Stages,
) -> Result<Model, Error> {
    // Products are computed anew of currents on facets alone.
    let anew = asked.storage == Some(CouplingStorage::Products);
    let read = if anew { Model::load_on_facets } else { read };
    let mut model = stages.run("scene", || read(scene, asked.memory))?;
    let (storage, help) = match (asked.storage, model.galerkin) {
        (Some(CouplingStorage::Products), Some(_)) => ("computed anew", "matrix, compressed or multipole"),
        (Some(CouplingStorage::Compressed), None) => ("compressed", "matrix or products"),
        (Some(CouplingStorage::Multipole), None) => ("one by multipoles", "matrix or products"),
        _ => ("", ""),
    };
    if !storage.is_empty() {
        let what = format!("the coupling of {} is not {storage}", model.method_name());
        return Err(Error::new(ErrorKind::Input, what).with_help(format!("take --storage {help}, or none")));
    }
    model.storage = asked.storage;
    model.tell(stages);
    Ok(model)
}

/// Stated error above which a result is warned about.
const DOUBTFUL_ERROR: f64 = 0.5;
/// Share of the supplied power that may be missing, or too much, before it is warned about.
const UNBALANCED_SHARE: f64 = 0.25;

/// What should be known of results.
pub(super) fn doubts(model: &Model, outcome: &Outcome) -> Vec<String> {
    let mut doubts = outcome.notes.clone();
    let worst = outcome.stated_errors.iter().max_by(|a, b| a.relative.total_cmp(&b.relative));
    if let Some(error) = worst.filter(|error| error.relative > DOUBTFUL_ERROR) {
        let name = model.receivers.get(error.receiver).map_or("", |receiver| &receiver.name);
        doubts.push(format!(
            "the stated error at `{name}`, {} MHz, is {:.0} % of the field there: not a result; take finer edges, or another method ({})",
            error.frequency / 1e6,
            100.0 * error.relative,
            if model.shadow.is_equation() { "cfie and dual-surface-mfie have no resonances" } else { "efie, or dual-surface-mfie for closed bodies" },
        ));
    }
    let off = |balance: &&Balance| (balance.ratio() - 1.0).abs();
    let worst = outcome.balances.iter().max_by(|a, b| off(a).total_cmp(&off(b)));
    if let Some(balance) = worst.filter(|balance| off(balance) > UNBALANCED_SHARE) {
        doubts.push(format!(
            "{:.2} times the power that the sources give at {} MHz is radiated or absorbed; take finer edges, or an equation (efie, dual-surface-mfie)",
            balance.ratio(),
            balance.frequency / 1e6
        ));
    }
    doubts
}

impl SolvedWaves<'_> {
    /// Radiated and absorbed beside supplied powers, where they are cheap to compute.
    #[must_use]
    pub fn balances(&self) -> &[Balance] {
        &self.outcome.balances
    }

    /// How far the monostatic sweeps are from being reciprocal.
    #[must_use]
    pub fn reciprocity(&self) -> &[Reciprocity] {
        &self.outcome.reciprocity
    }

    /// The same without its watch, for a caller that keeps the result longer than that.
    #[must_use]
    pub fn unwatched(self) -> SolvedWaves<'static> {
        let Self { model, outcome, stages, report } = self;
        SolvedWaves { model, outcome, stages: stages.unwatched(), report }
    }

    /// What is worth knowing of the run so far, as `run.json` has it.
    #[must_use]
    pub fn record(&self) -> serde_json::Value {
        self.outcome.record(&self.model, self.stages.timings())
    }

    /// The fields at the points of the receivers, V/m and A/m.
    #[must_use]
    pub fn near(&self) -> &[WaveRow] {
        &self.outcome.near
    }

    /// The far fields in the directions of the receivers.
    #[must_use]
    pub fn far(&self) -> &[FarRow] {
        &self.outcome.far
    }

    /// What the waves of monostatic receivers send back.
    #[must_use]
    pub fn monostatic(&self) -> &[MonostaticRow] {
        &self.outcome.monostatic
    }

    /// The name of a receiver by its number, as rows have it.
    #[must_use]
    pub fn receiver(&self, number: usize) -> Option<&str> {
        self.model.receivers.get(number).map(|receiver| receiver.name.as_str())
    }

    /// The method as scenes name it, with what blocks waves where that is a choice.
    #[must_use]
    pub fn method(&self) -> String {
        self.model.method_in_words()
    }

    /// How many bounces were summed, or the solver.
    #[must_use]
    pub fn solution(&self) -> String {
        self.outcome.solution(&self.model)
    }

    /// Why this method was taken, where the scene left it open.
    #[must_use]
    pub fn reason(&self) -> Option<&str> {
        self.model.reason.as_deref()
    }

    /// Whether edge currents are added.
    #[must_use]
    pub fn edge_currents(&self) -> bool {
        self.model.edge_currents
    }

    /// How the currents at each frequency were found.
    #[must_use]
    pub fn frequencies(&self) -> &[Solved] {
        &self.outcome.solved
    }

    /// How the frequencies were interpolated, where the scene allows it.
    #[must_use]
    pub fn interpolated(&self) -> Option<&Interpolated> {
        self.outcome.interpolated.as_ref()
    }

    /// Stated relative errors of the scattered fields at the receivers and of their far fields,
    /// where they are known.
    #[must_use]
    pub fn stated_errors(&self) -> &[Estimated] {
        &self.outcome.stated_errors
    }

    /// Estimated errors of the scattered fields at the receivers from the mesh, where the scene
    /// asks for estimates.
    #[must_use]
    pub fn mesh_errors(&self) -> &[Estimated] {
        &self.outcome.mesh_errors
    }

    /// Half the difference between the electric and the magnetic form of physical optics, where the
    /// scene asks for estimates.
    #[must_use]
    pub fn form_errors(&self) -> &[Estimated] {
        &self.outcome.form_errors
    }

    /// How the study ended: whether the residuals asked for were met.
    #[must_use]
    pub fn ended(&self) -> Ended {
        if self.outcome.converged() { Ended::Done } else { Ended::NotConverged }
    }

    /// Writes all results into a folder.
    ///
    /// # Errors
    /// [`Files`](crate::ErrorKind::Files) with the file that could not be written; the folder then
    /// has no `run.json`.
    pub fn write(&mut self, folder: &ResultFolder) -> Result<(), Error> {
        let timings = self.stages.timings().to_vec();
        let Self { model, outcome, stages, report } = self;
        stages.run("results", || {
            files::write(folder, model, outcome, &timings, *report).map_err(report_failure)
        })
    }
}
