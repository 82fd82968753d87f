//! `fredholm check`.

use crate::args::CheckArgs;
use crate::failure::{Ending, Failure};
use crate::interrupt::Interrupt;
use crate::problem::{Problem, with_results};
use crate::sample;
use crate::stages::Stages;
use crate::summary::{Lines, extent};
use crate::{console, memory, output, threads};

/// Validates a scene and predicts what its solution will take.
pub(crate) fn check(args: &CheckArgs) -> Result<Ending, Failure> {
    let interrupt = Interrupt::install(args.log.log)?;
    let console = console::choose(args.log);
    let mut stages = Stages::new(&*console, &interrupt);
    memory::tell(args.problem.memory, &*console);
    let ended = threads::pool(args.problem.threads)?.install(|| report(args, &mut stages));
    memory::conclude(&*console);
    ended
}

fn report(args: &CheckArgs, stages: &mut Stages) -> Result<Ending, Failure> {
    let problem =
        Problem::load(&args.problem, &|plan, scene, n| with_results(plan, scene, n, (1, 0)), stages)?;
    // The sample is one of pairs of elements.
    let seconds = if problem.is_radiosity() {
        Some(stages.run("sample", || Ok(sample::assembly_seconds(&problem)))?)
    } else {
        None
    };
    if args.log.quiet {
        return Ok(Ending::Done);
    }
    let mut lines = Lines::default();
    geometry(&problem, &mut lines);
    lines
        .add("unknowns", format!("{} in each band, by {}", problem.unknowns, problem.options.discretisation));
    lines.add("memory", format!("{}: {}", problem.plan.peak(), problem.plan));
    lines.add("memory limit", problem.options.memory_limit().to_string());
    let (threads, solver) = (problem.options.threads, &problem.options.solver);
    lines.add_some(
        "time",
        seconds.map(|seconds| {
            format!("about {seconds:.1} s for the form factors on {threads} threads, then {solver}")
        }),
    );
    problem.warnings.iter().for_each(|warning| lines.add("warning", warning));
    output::print(&lines.under(&format!("{}: a valid scene", problem.scene.path().display())))?;
    Ok(Ending::Done)
}

fn geometry(problem: &Problem, lines: &mut Lines) {
    let (scene, mesh) = (&problem.scene, &problem.mesh);
    if let Some(title) = scene.title() {
        lines.add("title", title);
    }
    lines.add("bands", scene.bands().join(", "));
    let [elements, faces, surfaces] =
        [mesh.len(), mesh.faces().len(), mesh.surfaces().len()].map(|count| count as u64);
    lines.add("size", extent(elements, faces, surfaces));
    lines.add("occluders", format!("{} flat pieces", mesh.occluders().len()));
}
