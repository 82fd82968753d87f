//! Solvers on one system: iterations, work, time and errors.

mod case;
mod sweep;
mod trial;

pub use sweep::reflectance_sweep;

use fredholm_coupling::Radiosity;
use fredholm_linop::{OptionError, PackedSymmetric, Stop, Storage, Watch};
use fredholm_report::{COMPARISON_FORMAT, ComparisonCase, ComparisonRecord, ResultFolder, write_comparison};
use fredholm_scene::Scene;
use serde_json::json;

use crate::error::{Error, ErrorKind};
use crate::memory::{self, Plan};
use crate::options::{Precision, ProblemOptions, SceneSource};
use crate::problem::Problem;
use crate::registry;
use crate::size::Bytes;
use crate::solution::{form_factors, system};
use crate::solve::{Ended, report_failure, title};
use crate::stages::Stages;
use crate::trial::failed;
use crate::watcher::Watcher;

/// What is asked of [`compare`].
#[derive(Clone, Debug)]
pub struct CompareOptions {
    /// Solvers with their options, such as `sor:omega=1.2`; `all` stands for all of them.
    pub solvers: Vec<String>,
    /// Relative residual ‖b − A x‖₂/‖b‖₂ to reach in every band.
    pub tolerance: f64,
    /// Iterations allowed.
    pub max_iterations: u32,
    /// Largest reflectances, to which all reflectances of the scene are scaled in turn; none: as
    /// they are.
    pub sweep: Option<Vec<f64>>,
    /// Whether report.html is left out.
    pub no_report: bool,
    /// Threads of the run; see [`ProblemOptions`].
    pub threads: Option<u16>,
    /// Error asked for in a row of form factors; see [`ProblemOptions`].
    pub form_factor_tolerance: Option<f64>,
    /// Number format of the stored matrix; see [`ProblemOptions`].
    pub storage: Option<Precision>,
    /// Memory allowed; see [`ProblemOptions`].
    pub memory: Option<Bytes>,
}

impl Default for CompareOptions {
    /// All solvers, to a residual of 1e-10 in at most 1000 iterations.
    fn default() -> Self {
        Self {
            solvers: vec!["all".to_owned()],
            tolerance: 1e-10,
            max_iterations: 1000,
            sweep: None,
            no_report: false,
            threads: None,
            form_factor_tolerance: None,
            storage: None,
            memory: None,
        }
    }
}

impl CompareOptions {
    /// The problem, with the solver of the least memory: what the others need is looked at one by
    /// one.
    fn problem(&self) -> ProblemOptions {
        ProblemOptions {
            threads: self.threads,
            discretisation: None,
            solver: Some(registry::USUAL_SOLVER.to_owned()),
            form_factor_tolerance: self.form_factor_tolerance,
            storage: self.storage,
            memory: self.memory,
        }
    }

    /// When a solver ends by itself.
    fn stop(&self) -> Stop {
        Stop { tolerance: self.tolerance, max_iterations: self.max_iterations as usize }
    }

    /// The solvers asked for, `all` written out, each once.
    fn solvers(&self) -> Vec<String> {
        written_out(&self.solvers, &registry::names())
    }
}

/// What of a list of solvers is asked for, `all` written out, each once.
pub(crate) fn written_out(asked: &[String], all: &[&str]) -> Vec<String> {
    let mut solvers: Vec<String> = Vec::new();
    for text in asked {
        let named = if text == "all" { all } else { &[text.as_str()][..] };
        for name in named {
            if solvers.iter().all(|known| known != name) {
                solvers.push((*name).to_owned());
            }
        }
    }
    solvers
}

/// Fails where a text such as `sor:omega=1.2` names no solver of real systems with its options.
///
/// # Errors
/// What is wrong with the name or the options.
pub fn check_solver(text: &str) -> Result<(), OptionError> {
    registry::build(text).map(drop)
}

/// Runs solvers on the system of a scene and writes how they did into a folder.
///
/// # Errors
/// What is wrong with the scene or the options; [`ErrorKind::Resources`] before memory is taken
/// that the limit does not allow; [`ErrorKind::Interrupted`] for a run that was cancelled.
pub fn compare(
    source: impl Into<SceneSource>,
    asked: &CompareOptions,
    folder: &ResultFolder,
    watch: &dyn Watch,
) -> Result<(ComparisonRecord, Ended), Error> {
    compare_scene(&source.into(), asked, folder, watch)
}

/// [`compare`], compiled once and not for each kind of source.
fn compare_scene(
    source: &SceneSource,
    asked: &CompareOptions,
    folder: &ResultFolder,
    watch: &dyn Watch,
) -> Result<(ComparisonRecord, Ended), Error> {
    let mut stages = Stages::new(watch);
    let answers = asked.solvers().len() as u128 * 8;
    let more = |plan: Plan, scene: &Scene, n: usize| {
        plan.hold("the answers of the solvers", answers * n as u128 * scene.bands().len() as u128)
    };
    let problem = Problem::load(source, &asked.problem(), &more, &mut stages)?;
    problem.require_radiosity("compare")?;
    let record = match problem.options.storage {
        Precision::F64 => compared::<f64>(asked, &problem, &mut stages),
        Precision::F32 => compared::<f32>(asked, &problem, &mut stages),
    }?;
    stages.begin_saving()?;
    let title = (!asked.no_report).then(|| title(&problem.scene));
    write_comparison(folder, &record, title.as_deref()).map_err(report_failure)?;
    let ended = ended(&record, &stages);
    Ok((record, ended))
}

/// Assembles, and runs all solvers in all cases.
fn compared<S: Storage>(
    asked: &CompareOptions,
    problem: &Problem,
    stages: &mut Stages,
) -> Result<ComparisonRecord, Error> {
    let watcher = Watcher::to(stages, asked.stop());
    let assembled = stages.run("assembly", || form_factors::<S>(problem, watcher))?;
    let radiosity = stages.run("exposure", || system(problem, &assembled.matrix))?;
    let cases = cases(asked, problem, (&radiosity, &assembled.matrix), stages)?;
    Ok(record(asked, problem, cases, stages))
}

fn cases<S: Storage>(
    asked: &CompareOptions,
    problem: &Problem,
    system: (&Radiosity, &PackedSymmetric<S>),
    stages: &mut Stages,
) -> Result<Vec<ComparisonCase>, Error> {
    let Some(sweep) = &asked.sweep else {
        return Ok(vec![case::case(asked, problem, system, 1.0, stages)?]);
    };
    let largest = case::largest(problem);
    if largest == 0.0 {
        let text = "there is nothing to scale: every material has reflectance 0";
        return Err(Error::new(ErrorKind::Input, text));
    }
    let mut cases = Vec::new();
    for value in sweep {
        let mut stages = stages.part(&format!("reflectance {value:.4}"));
        cases.push(case::case(asked, problem, system, value / largest, &mut stages)?);
    }
    Ok(cases)
}

fn record(
    asked: &CompareOptions,
    problem: &Problem,
    cases: Vec<ComparisonCase>,
    stages: &Stages,
) -> ComparisonRecord {
    let (scene, options) = (&problem.scene, &problem.options);
    let unknowns = problem.unknowns as u64;
    ComparisonRecord {
        format: COMPARISON_FORMAT.to_owned(),
        version: env!("CARGO_PKG_VERSION").to_owned(),
        scene: scene.path().display().to_string(),
        scene_sha256: scene.sha256().to_owned(),
        options: json!({
            "solvers": asked.solvers(),
            "tolerance": asked.tolerance,
            "max_iterations": asked.max_iterations,
            "form_factor_tolerance": options.form_factor_tolerance,
            "storage": options.storage,
            "threads": options.threads,
            "memory_limit_bytes": options.memory_limit_bytes,
            "start": "x = 0",
        }),
        bands: scene.bands().to_vec(),
        unknowns,
        entries: unknowns * (unknowns + 1) / 2,
        warnings: warnings(problem, &cases),
        cases,
        timings: stages.timings().to_vec(),
        peak_memory_bytes: memory::peak_bytes(),
    }
}

/// Solvers that did not come to an end, and those that were refused, with the reason.
fn warnings(problem: &Problem, cases: &[ComparisonCase]) -> Vec<String> {
    let mut warnings = problem.warnings.clone();
    for case in cases {
        let place =
            if cases.len() > 1 { format!(" at reflectance {}", case.reflectance) } else { String::new() };
        for run in case.runs.iter().filter(|run| failed(run)) {
            warnings
                .push(format!("{}{place}: {} after {} iterations", run.solver, run.outcome, run.iterations));
        }
        let refused = case.runs.iter().filter_map(|run| Some((run, run.reason.as_ref()?)));
        warnings.extend(refused.map(|(run, reason)| format!("{}{place} was refused: {reason}", run.solver)));
    }
    warnings
}

fn ended(record: &ComparisonRecord, stages: &Stages) -> Ended {
    match record.cases.iter().any(|case| case.runs.iter().any(failed)) {
        _ if stages.is_cancelled() => Ended::Interrupted,
        true => Ended::NotConverged,
        false => Ended::Done,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn solvers_are_checked_before_anything_is_computed() {
        assert!(check_solver("sor:omega=1.2").is_ok());
        assert!(check_solver("magic").is_err() && check_solver("sor:omega=3").is_err());
        let asked = ["sor", "all", "sor"].map(str::to_owned);
        assert_eq!(written_out(&asked, &["lu", "sor"]), ["sor", "lu"]);
    }
}
