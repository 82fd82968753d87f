//! `fredholm converge`.

mod level;
mod study;
mod summary;

use std::path::{Path, PathBuf};
use std::sync::Arc;

use fredholm_linop::StopReason;
use fredholm_report::write_refinement;
use fredholm_scene::Scene;

use super::solve::{report_failure, title};
use crate::args::ConvergeArgs;
use crate::console::Console;
use crate::failure::{Ending, Failure};
use crate::interrupt::Interrupt;
use crate::memory::Plan;
use crate::options::{Options, ProblemOptions};
use crate::prediction::MESH;
use crate::problem::{Problem, scene_failure};
use crate::solution::compute;
use crate::stages::Stages;
use crate::{console, folder, memory, threads};
use level::Level;

/// Solves a scene on finer and finer meshes and writes what that tells.
pub(crate) fn converge(args: &ConvergeArgs) -> Result<Ending, Failure> {
    let interrupt = Interrupt::install(args.log.log)?;
    folder::probe(&folder(args), "-o DIR")?;
    let console = console::choose(args.log);
    memory::tell(args.problem.memory, &*console);
    let ended = threads::pool(args.problem.threads)?.install(|| run(args, &*console, &interrupt));
    memory::conclude(&*console);
    ended
}

/// The folder for the results.
fn folder(args: &ConvergeArgs) -> PathBuf {
    folder::of(args.output.as_ref(), &args.problem.scene)
}

fn run(args: &ConvergeArgs, console: &dyn Console, interrupt: &Interrupt) -> Result<Ending, Failure> {
    let problems = problems(args, console, interrupt)?;
    let (scene, folder) = (&problems[0].scene, folder(args));
    let options = Options::new(problems[0].options.clone(), args.stop, scene.solve(), &folder, args.log);
    let solve = |(number, problem)| solved(number, problem, &options, console, interrupt);
    let levels: Vec<Level> = problems.iter().enumerate().map(solve).collect::<Result<_, _>>()?;
    let record = study::record(&problems[0], &options, &levels);
    interrupt.begin_saving()?;
    let title = (!args.no_report).then(|| title(scene));
    write_refinement(&folder, &record, title.as_deref()).map_err(report_failure)?;
    record.warnings.iter().for_each(|warning| console.warn(warning));
    if !args.log.quiet {
        summary::print(&folder, &record)?;
    }
    Ok(ending(&levels, interrupt))
}

/// The problems of all levels: what does not fit the memory is refused before anything is computed.
fn problems(
    args: &ConvergeArgs,
    console: &dyn Console,
    interrupt: &Interrupt,
) -> Result<Vec<Problem>, Failure> {
    let mut stages = Stages::new(console, interrupt);
    let path: &Path = &args.problem.scene;
    let scene = Arc::new(stages.run("scene", || Scene::load(path).map_err(scene_failure))?);
    let options = ProblemOptions::new(&args.problem, scene.solve());
    // Each of the coarser meshes has a quarter of the elements of the next.
    let others = |plan: Plan, _: &Scene, n: usize| plan.hold("coarser meshes", n as u128 * MESH / 3);
    let problem = |level: u8| {
        let (name, refinement) = (format!("level {level}"), 1_usize << level);
        let mut stages = Stages::part(console, interrupt, &name);
        let refined =
            Problem::refined(Arc::clone(&scene), options.clone(), (refinement, &others), &mut stages);
        refined.map_err(|failure| located(failure, level))
    };
    (0..args.levels).map(problem).collect()
}

/// Says which level it was, where that is not the scene itself.
fn located(failure: Failure, level: u8) -> Failure {
    if level == 0 {
        return failure;
    }
    let advice = if failure.ending == Ending::Resources {
        format!(" (fits: --levels {level})")
    } else {
        String::new()
    };
    failure.within(&format!("level {level}{advice}"))
}

fn solved(
    number: usize,
    problem: &Problem,
    options: &Options,
    console: &dyn Console,
    interrupt: &Interrupt,
) -> Result<Level, Failure> {
    let mut stages = Stages::part(console, interrupt, &format!("level {number}"));
    let solution = compute(problem, options, &mut stages)?;
    // A stopped solution is none.
    interrupt.check()?;
    Ok(Level::new(problem, &solution, stages.timings()))
}

fn ending(levels: &[Level], interrupt: &Interrupt) -> Ending {
    match levels.iter().all(|level| level.reason == StopReason::Converged) {
        _ if interrupt.requested() => Ending::Interrupted,
        true => Ending::Done,
        false => Ending::NotConverged,
    }
}
