//! `fredholm viewfactors`.

mod args;
mod compute;
mod method;
mod options;
mod plan;
mod problem;
mod record;
mod summary;
mod target;

use fredholm_report::{ReportError, ViewFactorsRecord, write_view_factors};

pub(crate) use args::{Plane, ViewFactorsArgs, plane, point};
pub(super) use summary::{describe_matrix, describe_record};

use crate::failure::{Ending, Failure};
use crate::interrupt::Interrupt;
use crate::stages::Stages;
use crate::summary::Lines;
use crate::{console, memory, output, threads};
use compute::compute;
use problem::Problem;
use record::record;
use target::Target;

/// Computes the matrix and writes it.
pub(crate) fn view_factors(args: &ViewFactorsArgs) -> Result<Ending, Failure> {
    let interrupt = Interrupt::install(args.log.log)?;
    let target = Target::new(args)?;
    let console = console::choose(args.log);
    let stages = Stages::new(&*console, &interrupt);
    memory::tell(args.memory, &*console);
    let ended = threads::pool(args.threads)?.install(|| run(args, &target, stages));
    memory::conclude(&*console);
    ended
}

fn run(args: &ViewFactorsArgs, target: &Target, mut stages: Stages) -> Result<Ending, Failure> {
    let problem = Problem::load(args, target, &mut stages)?;
    let solution = compute(&problem, &mut stages)?;
    let record = record(args, &problem, &solution, &stages);
    stages.interrupt.begin_saving()?;
    let write = || write_view_factors(&target.files, target.format, &solution.factors, &record);
    stages.run("results", || write().map_err(report_failure))?;
    record.warnings.iter().for_each(|warning| stages.console.warn(warning));
    // The summary, other than the file, can tell the time of writing.
    let record = ViewFactorsRecord { timings: stages.timings().to_vec(), ..record };
    if !args.log.quiet {
        summarise(target, &record)?;
    }
    Ok(if stages.interrupt.requested() { Ending::Interrupted } else { Ending::Done })
}

fn summarise(target: &Target, record: &ViewFactorsRecord) -> Result<(), Failure> {
    let mut lines = Lines::default();
    lines.add("picture", target.files.picture.display().to_string());
    summary::quality(record, &mut lines);
    output::print(&lines.under(&format!("{} → {}", record.input, target.files.matrix.display())))
}

fn report_failure(error: ReportError) -> Failure {
    let ending = if matches!(error, ReportError::Write { .. }) { Ending::Files } else { Ending::Input };
    Failure::new(ending, error)
}
