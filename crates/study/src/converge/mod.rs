//! A scene on finer and finer meshes: the order of the error, and how much of it is left.

mod level;
mod study;

use std::sync::Arc;

use fredholm_linop::{StopReason, Watch};
use fredholm_report::{RefinementRecord, ResultFolder, write_refinement};
use fredholm_scene::Scene;

use crate::error::{Error, ErrorKind};
use crate::memory::Plan;
use crate::options::{ProblemOptions, ProblemSettings, Recorded, SceneSource, SolveSettings, StopOptions};
use crate::prediction::BYTES_OF_AN_ELEMENT;
use crate::problem::Problem;
use crate::solution::compute;
use crate::solve::{Ended, report_failure, title};
use crate::stages::Stages;
use level::Level;

/// What is asked of [`converge`].
#[derive(Clone, Debug)]
pub struct ConvergeOptions {
    /// Number of meshes: that of the scene, and finer ones.
    pub levels: u8,
    /// Whether report.html is left out.
    pub no_report: bool,
    /// What decides the size and the effort.
    pub problem: ProblemOptions,
    /// When a solution ends.
    pub stop: StopOptions,
    /// What else the record of the run is to say.
    pub recorded: Recorded,
}

impl Default for ConvergeOptions {
    /// Three levels, the fewest that show an order.
    fn default() -> Self {
        let (problem, stop) = (ProblemOptions::default(), StopOptions::default());
        Self { levels: 3, no_report: false, problem, stop, recorded: Recorded::new() }
    }
}

/// Solves a scene on finer and finer meshes and writes what that tells into a folder.
///
/// # Errors
/// What is wrong with the scene or the options; what does not fit the memory, before anything is
/// computed; [`ErrorKind::Interrupted`] for a run that was cancelled.
pub fn converge(
    source: impl Into<SceneSource>,
    asked: &ConvergeOptions,
    folder: &ResultFolder,
    watch: &dyn Watch,
) -> Result<(RefinementRecord, Ended), Error> {
    converge_scene(&source.into(), asked, folder, watch)
}

/// [`converge`], compiled once and not for each kind of source.
fn converge_scene(
    source: &SceneSource,
    asked: &ConvergeOptions,
    folder: &ResultFolder,
    watch: &dyn Watch,
) -> Result<(RefinementRecord, Ended), Error> {
    let mut stages = Stages::new(watch);
    let problems = problems(source, asked, &mut stages)?;
    let Some(coarsest) = problems.first() else {
        let error = Error::new(ErrorKind::Input, "a study of convergence without a level");
        return Err(error.with_help("ask for 3 levels or more"));
    };
    let settings = SolveSettings::new(coarsest.options.clone(), asked.stop, coarsest.scene.solve());
    let (output, recorded) = (folder.path().display().to_string(), asked.recorded.clone());
    let settings = SolveSettings { output, recorded, ..settings };
    let solve = |(number, problem)| solved(number, problem, &settings, &stages);
    let levels: Vec<Level> = problems.iter().enumerate().map(solve).collect::<Result<_, _>>()?;
    let record = study::record(coarsest, &settings, &levels);
    stages.begin_saving()?;
    let title = (!asked.no_report).then(|| title(&coarsest.scene));
    write_refinement(folder, &record, title.as_deref()).map_err(report_failure)?;
    let ended = ended(&levels, &stages);
    Ok((record, ended))
}

/// The problems of all levels: what does not fit the memory is refused before anything is computed.
fn problems(
    source: &SceneSource,
    asked: &ConvergeOptions,
    stages: &mut Stages,
) -> Result<Vec<Problem>, Error> {
    let scene = source.load(asked.problem.memory, stages)?;
    let settings = ProblemSettings::new(&asked.problem, scene.solve());
    // Each of the coarser meshes has a quarter of the elements of the next.
    let others =
        |plan: Plan, _: &Scene, n: usize| plan.hold("coarser meshes", n as u128 * BYTES_OF_AN_ELEMENT / 3);
    let problem = |level: u8| {
        let refinement = 1_usize.checked_shl(level.into()).unwrap_or(usize::MAX);
        let mut stages = stages.part(&format!("level {level}"));
        let refined =
            Problem::refined(Arc::clone(&scene), settings.clone(), (refinement, &others), &mut stages);
        refined.map_err(|error| located(error, level))
    };
    (0..asked.levels).map(problem).collect()
}

/// Says which level it was, where that is not the scene itself.
fn located(error: Error, level: u8) -> Error {
    if level == 0 {
        return error;
    }
    let advice = if error.kind() == ErrorKind::Resources {
        format!(" (fits: --levels {level})")
    } else {
        String::new()
    };
    error.within(&format!("level {level}{advice}"))
}

fn solved(
    number: usize,
    problem: &Problem,
    settings: &SolveSettings,
    stages: &Stages,
) -> Result<Level, Error> {
    let mut stages = stages.part(&format!("level {number}"));
    let solution = compute(problem, settings, &mut stages)?;
    // A stopped solution is none.
    stages.check()?;
    Ok(Level::new(problem, &solution, stages.timings()))
}

fn ended(levels: &[Level], stages: &Stages) -> Ended {
    match levels.iter().all(|level| level.reason == StopReason::Converged) {
        _ if stages.is_cancelled() => Ended::Interrupted,
        true => Ended::Done,
        false => Ended::NotConverged,
    }
}
