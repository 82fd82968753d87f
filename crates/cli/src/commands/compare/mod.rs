//! `fredholm compare`.

mod args;
mod case;
mod summary;
mod trial;

use std::path::Path;

use fredholm_coupling::Radiosity;
use fredholm_linop::{PackedSymmetric, Storage};
use fredholm_report::{COMPARISON_FORMAT, ComparisonCase, ComparisonRecord, write_comparison};
use fredholm_scene::Scene;
use serde_json::json;

pub(crate) use args::CompareArgs;

use super::solve::{report_failure, title};
use crate::args::Precision;
use crate::failure::{Ending, Failure};
use crate::interrupt::Interrupt;
use crate::memory::{self, Plan};
use crate::options::RADIOSITY;
use crate::problem::Problem;
use crate::solution::{form_factors, system};
use crate::stages::Stages;
use crate::start::Start;
use crate::trial::failed;
use crate::watcher::Watcher;

/// Runs solvers on the same system and writes how they did.
pub(crate) fn compare(args: &CompareArgs) -> Result<Ending, Failure> {
    let start = Start {
        scene: &args.scene,
        output: args.output.as_ref(),
        threads: args.threads,
        memory: args.memory,
        log: args.log,
    };
    start.run(|folder, stages| run(args, folder, stages))
}

fn run(args: &CompareArgs, folder: &Path, stages: &mut Stages) -> Result<Ending, Failure> {
    let answers = args.solvers().len() as u128 * 8;
    let more = |plan: Plan, scene: &Scene, n: usize| {
        plan.hold("the answers of the solvers", answers * n as u128 * scene.bands().len() as u128)
    };
    let problem = Problem::load(&args.problem(), &more, stages)?;
    if !problem.is_radiosity() {
        let text = format!(
            "compare works on the matrix of form factors, which is {RADIOSITY}; the scene asks for {}",
            problem.options.discretisation
        );
        return Err(Failure::new(Ending::Input, text));
    }
    let record = match problem.options.storage {
        Precision::F64 => compared::<f64>(args, &problem, stages),
        Precision::F32 => compared::<f32>(args, &problem, stages),
    }?;
    stages.interrupt.begin_saving()?;
    let title = (!args.no_report).then(|| title(&problem.scene));
    write_comparison(folder, &record, title.as_deref()).map_err(report_failure)?;
    record.warnings.iter().for_each(|warning| stages.console.warn(warning));
    if !args.log.quiet {
        summary::print(folder, &record)?;
    }
    Ok(ending(&record, stages.interrupt))
}

/// Assembles, and runs all solvers in all cases.
fn compared<S: Storage>(
    args: &CompareArgs,
    problem: &Problem,
    stages: &mut Stages,
) -> Result<ComparisonRecord, Failure> {
    let watcher = Watcher::to(stages, args.stop());
    let assembled = stages.run("assembly", || form_factors::<S>(problem, watcher))?;
    let radiosity = stages.run("exposure", || system(problem, &assembled.matrix))?;
    let cases = cases(args, problem, (&radiosity, &assembled.matrix), stages)?;
    Ok(record(args, problem, cases, stages))
}

fn cases<S: Storage>(
    args: &CompareArgs,
    problem: &Problem,
    system: (&Radiosity, &PackedSymmetric<S>),
    stages: &mut Stages,
) -> Result<Vec<ComparisonCase>, Failure> {
    let Some(sweep) = &args.sweep else {
        return Ok(vec![case::case(args, problem, system, 1.0, stages)?]);
    };
    let largest = case::largest(problem);
    if largest == 0.0 {
        let text = "there is nothing to scale: every material has reflectance 0";
        return Err(Failure::new(Ending::Input, text));
    }
    let mut cases = Vec::new();
    for value in &sweep.0 {
        let mut stages = Stages::part(stages.console, stages.interrupt, &format!("reflectance {value:.4}"));
        cases.push(case::case(args, problem, system, value / largest, &mut stages)?);
    }
    Ok(cases)
}

fn record(
    args: &CompareArgs,
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
            "solvers": args.solvers(),
            "tolerance": args.to,
            "max_iterations": args.max_iterations,
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

fn ending(record: &ComparisonRecord, interrupt: &Interrupt) -> Ending {
    match record.cases.iter().any(|case| case.runs.iter().any(failed)) {
        _ if interrupt.requested() => Ending::Interrupted,
        true => Ending::NotConverged,
        false => Ending::Done,
    }
}
