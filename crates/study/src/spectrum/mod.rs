//! Analysis of the matrix of a scene: eigenvalues, radii, conditions, properties.

mod analysis;

use fredholm_direct::{spectrum_bytes, thread_addresses};
use fredholm_linop::{SecondKind, Stop, Storage, Watch};
use fredholm_report::{ResultFolder, SPECTRUM_FORMAT, SpectrumRecord, write_spectrum};
use fredholm_scene::Scene;

use crate::error::{Error, ErrorKind};
use crate::memory::Plan;
use crate::options::{Precision, ProblemOptions, SceneSource};
use crate::prediction::of_threads;
use crate::problem::Problem;
use crate::registry;
use crate::size::Bytes;
use crate::solution::{form_factors, system};
use crate::solve::{Ended, report_failure, title};
use crate::stages::Stages;
use crate::watcher::Watcher;

/// What is asked of [`spectrum`].
#[derive(Clone, Debug)]
pub struct SpectrumOptions {
    /// Most unknowns for dense methods; beyond, there are estimates by the Lanczos process.
    pub dense: usize,
    /// Steps of the Lanczos process.
    pub steps: u32,
    /// Whether report.html is left out.
    pub no_report: bool,
    /// Threads of the run; see [`ProblemOptions`].
    pub threads: Option<u16>,
    /// Error asked for in a row of form factors; see [`ProblemOptions`].
    pub form_factor_tolerance: Option<f64>,
    /// Memory allowed; see [`ProblemOptions`].
    pub memory: Option<Bytes>,
}

impl Default for SpectrumOptions {
    fn default() -> Self {
        Self {
            dense: 2000,
            steps: 60,
            no_report: false,
            threads: None,
            form_factor_tolerance: None,
            memory: None,
        }
    }
}

impl SpectrumOptions {
    fn problem(&self) -> ProblemOptions {
        ProblemOptions {
            threads: self.threads,
            discretisation: None,
            solver: Some(registry::USUAL_SOLVER.to_owned()),
            form_factor_tolerance: self.form_factor_tolerance,
            storage: None,
            memory: self.memory,
        }
    }
}

/// Analyses the matrix of a scene and writes what was found into a folder.
///
/// # Errors
/// What is wrong with the scene or the options; [`ErrorKind::Resources`] before memory is taken
/// that the limit does not allow; [`ErrorKind::Interrupted`] for a run that was cancelled.
pub fn spectrum(
    source: impl Into<SceneSource>,
    asked: &SpectrumOptions,
    folder: &ResultFolder,
    watch: &dyn Watch,
) -> Result<(SpectrumRecord, Ended), Error> {
    spectrum_scene(&source.into(), asked, folder, watch)
}

/// [`spectrum`], compiled once and not for each kind of source.
fn spectrum_scene(
    source: &SceneSource,
    asked: &SpectrumOptions,
    folder: &ResultFolder,
    watch: &dyn Watch,
) -> Result<(SpectrumRecord, Ended), Error> {
    let mut stages = Stages::new(watch);
    let dense = |plan: Plan, _: &Scene, n: usize| {
        if n > asked.dense {
            return plan;
        }
        plan.hold("dense methods", spectrum_bytes(n).into()).aside(of_threads(thread_addresses()))
    };
    let problem = Problem::load(source, &asked.problem(), &dense, &mut stages)?;
    problem.require_radiosity("spectrum")?;
    let record = match problem.options.storage {
        Precision::F64 => analysed::<f64>(asked, &problem, &mut stages),
        Precision::F32 => analysed::<f32>(asked, &problem, &mut stages),
    }?;
    stages.begin_saving()?;
    let title = title(&problem.scene);
    write_spectrum(folder, &record, (!asked.no_report).then_some(&title)).map_err(report_failure)?;
    let ended = if stages.is_cancelled() { Ended::Interrupted } else { Ended::Done };
    Ok((record, ended))
}

fn analysed<S: Storage>(
    asked: &SpectrumOptions,
    problem: &Problem,
    stages: &mut Stages,
) -> Result<SpectrumRecord, Error> {
    let watcher = Watcher::to(stages, Stop { tolerance: 0.0, max_iterations: 0 });
    let assembled = stages.run("assembly", || form_factors::<S>(problem, watcher))?;
    let radiosity = stages.run("exposure", || system(problem, &assembled.matrix))?;
    let system = SecondKind::new(&assembled.matrix, radiosity.scaling())
        .map_err(|error| Error::new(ErrorKind::Input, error))?;
    let dense = problem.unknowns <= asked.dense;
    let bands = if dense {
        analysis::exact(&system, problem.scene.bands(), stages)?
    } else {
        analysis::estimated(&system, problem.scene.bands(), asked.steps as usize, stages)?
    };
    let scene = &problem.scene;
    Ok(SpectrumRecord {
        format: SPECTRUM_FORMAT.to_owned(),
        version: env!("CARGO_PKG_VERSION").to_owned(),
        scene: scene.path().display().to_string(),
        scene_sha256: scene.sha256().to_owned(),
        unknowns: problem.unknowns as u64,
        method: if dense { "dense" } else { "lanczos" }.to_owned(),
        bands,
        timings: stages.timings().to_vec(),
    })
}
