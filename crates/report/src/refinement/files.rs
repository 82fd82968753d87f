//! The files of a study. The record is removed first and written last: where it stands, the files beside it belong together.

use std::path::{Path, PathBuf};

use super::csv::write_refinement_csv;
use super::plot::write_refinement_plot;
use super::record::RefinementRecord;
use crate::outputs::{prepare, write_page};
use crate::{ReportError, ReportPage, write_atomically};

/// Names of the files of a study, in the order in which they are written.
pub const REFINEMENT_FILES: [&str; 3] = ["converge.csv", "converge.svg", "converge.json"];

/// Writes all files of a study into a folder, which is made where it does not exist, and returns their paths; with a title,
/// `report.html` too.
///
/// # Errors
/// [`ReportError::Write`] with the file or folder that could not be written. The folder then has no `converge.json`.
pub fn write_refinement(
    folder: &Path,
    record: &RefinementRecord,
    title: Option<&str>,
) -> Result<Vec<PathBuf>, ReportError> {
    let paths = REFINEMENT_FILES.map(|name| folder.join(name));
    prepare(folder, &paths[2])?;
    write_atomically(&paths[0], |out| write_refinement_csv(record, out))?;
    write_atomically(&paths[1], |out| write_refinement_plot(record, out))?;
    let page = title.map(|title| ReportPage::of_refinement(title, record));
    write_page(folder, page.as_ref())?;
    write_atomically(&paths[2], |out| record.write(out))?;
    Ok(paths.to_vec())
}

#[cfg(test)]
mod tests {
    use super::super::record::tests::sample;
    use super::*;
    use crate::REPORT;
    use std::fs;

    #[test]
    fn a_folder_is_complete_or_has_no_record() {
        let base = tempfile::tempdir().unwrap();
        let folder = base.path().join("new");
        let paths = write_refinement(&folder, &sample(), Some("a")).unwrap();
        assert!(folder.join(REPORT).is_file());
        assert!(paths.iter().all(|path| fs::metadata(path).unwrap().len() > 100));
        fs::remove_file(&paths[1]).unwrap();
        fs::create_dir(&paths[1]).unwrap();
        let error = write_refinement(&folder, &sample(), None).unwrap_err();
        assert!(error.to_string().contains("converge.svg") && !paths[2].exists(), "{error}");
    }
}
