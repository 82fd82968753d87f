//! The view-factor matrix of a scene or a mesh file.

mod compute;
mod method;
mod options;
mod plan;
mod problem;
mod record;
mod target;

use fredholm_linop::Watch;
use fredholm_report::{MatrixFormat, ReportError, ViewFactors, ViewFactorsRecord, write_view_factors};

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

/// The names of the methods: `row-budget`, the usual one, to a tolerance of rows, `auto`, to a
/// tolerance of pairs, and those that compute one pair after the other, for study.
#[must_use]
pub fn view_factor_methods() -> Vec<&'static str> {
    method::names()
}

/// View factors that were computed, and how.
#[derive(Clone, Debug)]
pub struct SolvedViewFactors {
    /// The matrix.
    pub factors: ViewFactors,
    /// The record of the run.
    pub record: ViewFactorsRecord,
    /// Whether the page for the browser is left out.
    pub no_report: bool,
}

/// Computes the view factors that the options ask for and writes nothing.
///
/// # Errors
/// As [`view_factors`].
pub fn solve_view_factors(asked: &ViewFactorOptions, watch: &dyn Watch) -> Result<SolvedViewFactors, Error> {
    let mut stages = Stages::new(watch);
    let found = solved(asked, &mut stages)?;
    stages.check()?;
    Ok(found)
}

impl SolvedViewFactors {
    /// Writes the matrix, and what comes beside it.
    ///
    /// # Errors
    /// [`ErrorKind::Files`] with the file that could not be written.
    pub fn write(&self, files: &MatrixFiles) -> Result<(), Error> {
        let record = recorded(&self.record, files);
        write_view_factors(
            (&files.place, &files.files),
            files.format,
            &self.factors,
            &record,
            !self.no_report,
        )
        .map_err(report_failure)
    }
}

/// The record with where the matrix is written, and in which form.
fn recorded(record: &ViewFactorsRecord, files: &MatrixFiles) -> ViewFactorsRecord {
    let format = match files.format {
        MatrixFormat::Npz => "npz",
        MatrixFormat::Csv => "csv",
        MatrixFormat::View3d => "view3d",
    };
    let mut record = record.clone();
    if let Some(options) = record.options.as_object_mut() {
        options.insert("format".to_owned(), format.into());
        options.insert("output".to_owned(), files.files.matrix.display().to_string().into());
    }
    record
}

fn solved(asked: &ViewFactorOptions, stages: &mut Stages) -> Result<SolvedViewFactors, Error> {
    let problem = Problem::load(asked, stages)?;
    let solution = compute(&problem, stages)?;
    let record = record(asked, &problem, &solution, stages);
    Ok(SolvedViewFactors { factors: solution.factors, record, no_report: asked.no_report })
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
    let found = solved(asked, &mut stages)?;
    stages.begin_saving()?;
    stages.run("results", || found.write(files))?;
    let record = ViewFactorsRecord { timings: stages.timings().to_vec(), ..recorded(&found.record, files) };
    let ended = if stages.is_cancelled() { Ended::Interrupted } else { Ended::Done };
    Ok((record, ended))
}

fn report_failure(error: ReportError) -> Error {
    let kind = if matches!(error, ReportError::Write { .. }) { ErrorKind::Files } else { ErrorKind::Input };
    Error::new(kind, error)
}
