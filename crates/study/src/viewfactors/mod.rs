//! The view-factor matrix of a scene or a mesh file.

mod compute;
mod method;
mod options;
mod plan;
mod problem;
mod record;
mod target;

use fredholm_linop::Watch;
use fredholm_report::{ReportError, ViewFactorsRecord, write_view_factors};

pub use options::{MatrixRows, ViewFactorOptions};
pub use record::{closure, largest, point_closure};
pub use target::MatrixFiles;

use crate::error::{Error, ErrorKind};
use crate::solve::Ended;
use crate::stages::Stages;
use compute::compute;
use problem::Problem;
use record::record;

/// Name of the row of the sky.
pub const SKY: &str = "sky";

/// The names of the methods: `auto`, the fast assembly, and those that compute one pair after the
/// other, for study.
#[must_use]
pub fn view_factor_methods() -> Vec<&'static str> {
    method::names()
}

/// Computes the view factors that the options ask for and writes them. The record returned has the
/// time of writing too.
///
/// # Errors
/// What is wrong with the input or the options; [`ErrorKind::Resources`] before memory is taken
/// that the limit does not allow; [`ErrorKind::Interrupted`] for a run that was cancelled.
pub fn view_factors(
    asked: &ViewFactorOptions,
    files: &MatrixFiles,
    watch: &dyn Watch,
) -> Result<(ViewFactorsRecord, Ended), Error> {
    let mut stages = Stages::new(watch);
    let problem = Problem::load(asked, files, &mut stages)?;
    let solution = compute(&problem, &mut stages)?;
    let record = record(asked, &problem, &solution, &stages);
    stages.begin_saving()?;
    let write = || write_view_factors(&files.files, files.format, &solution.factors, &record);
    stages.run("results", || write().map_err(report_failure))?;
    let record = ViewFactorsRecord { timings: stages.timings().to_vec(), ..record };
    let ended = if stages.is_cancelled() { Ended::Interrupted } else { Ended::Done };
    Ok((record, ended))
}

fn report_failure(error: ReportError) -> Error {
    let kind = if matches!(error, ReportError::Write { .. }) { ErrorKind::Files } else { ErrorKind::Input };
    Error::new(kind, error)
}
