//! The files of a study. The record is written last: where it stands, the files beside it belong
//! together.

use std::path::PathBuf;

use super::csv::write_refinement_csv;
use super::plot::write_refinement_plot;
use super::record::RefinementRecord;
use crate::{REPORT, ReportError, ReportPage, ResultFolder};

/// Names of the files of a study, in the order in which they are written.
pub const REFINEMENT_FILES: [&str; 3] = ["converge.csv", "converge.svg", "converge.json"];

/// Writes all files of a study into a folder and returns their paths; with a title, `report.html`
/// too.
///
/// # Errors
/// [`ReportError::Write`] with the file or folder that could not be written. The folder then has no
/// `converge.json`.
pub fn write_refinement(
    folder: &ResultFolder,
    record: &RefinementRecord,
    title: Option<&str>,
) -> Result<Vec<PathBuf>, ReportError> {
    let [table, plot, last] = REFINEMENT_FILES;
    let table = folder.write(table, |out| write_refinement_csv(record, out))?;
    let plot = folder.write(plot, |out| write_refinement_plot(record, out))?;
    if let Some(title) = title {
        folder.write(REPORT, |out| ReportPage::of_refinement(title, record).write(out))?;
    }
    Ok(vec![table, plot, folder.write(last, |out| record.write(out))?])
}

#[cfg(test)]
mod tests {
    use super::super::record::tests::sample;
    use super::*;
    use std::fs;

    #[test]
    fn a_folder_is_complete_or_has_no_record() {
        let base = tempfile::tempdir().unwrap();
        let folder = base.path().join("new");
        let claim = || ResultFolder::claim(&folder).unwrap();
        let paths = write_refinement(&claim(), &sample(), Some("a")).unwrap();
        assert!(folder.join(REPORT).is_file());
        assert!(paths.iter().all(|path| fs::metadata(path).unwrap().len() > 100));
        fs::remove_file(&paths[1]).unwrap();
        fs::create_dir(&paths[1]).unwrap();
        let error = write_refinement(&claim(), &sample(), None).unwrap_err();
        assert!(error.to_string().contains("converge.svg") && !paths[2].exists(), "{error}");
    }
}
