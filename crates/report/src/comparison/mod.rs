//! What a comparison of solvers leaves: `compare.csv`, `compare_history.csv`, `compare.svg`, for a sweep `compare_sweep.svg`, and `compare.json` last.

mod csv;
mod plot;
mod record;

use std::fs;
use std::path::Path;

use crate::outputs::write_page;
use crate::{ReportError, ReportPage, write_atomically};

pub use csv::{write_comparison_csv, write_comparison_history};
pub use plot::{write_comparison_plot, write_sweep_plot};
pub use record::{COMPARISON_FORMAT, ComparisonCase, ComparisonHistory, ComparisonRecord, ComparisonRun};

/// The files of a comparison without a sweep, in the order in which they are written.
pub const COMPARISON_FILES: [&str; 4] = ["compare.csv", "compare_history.csv", "compare.svg", "compare.json"];
/// The plot of a sweep.
const SWEEP: &str = "compare_sweep.svg";

/// Writes a comparison into a folder, which is made where there is none; with a title, `report.html` too.
///
/// # Errors
/// [`ReportError::Write`] with the path.
pub fn write_comparison(
    folder: &Path,
    record: &ComparisonRecord,
    title: Option<&str>,
) -> Result<(), ReportError> {
    fs::create_dir_all(folder).map_err(|source| ReportError::Write { path: folder.to_owned(), source })?;
    let [table, history, plot, json] = COMPARISON_FILES.map(|name| folder.join(name));
    write_atomically(&table, |out| write_comparison_csv(record, out))?;
    write_atomically(&history, |out| write_comparison_history(record, out))?;
    write_atomically(&plot, |out| write_comparison_plot(record, out))?;
    if record.cases.len() > 1 {
        write_atomically(&folder.join(SWEEP), |out| write_sweep_plot(record, out))?;
    }
    let page = title.map(|title| ReportPage::of_comparison(title, record));
    write_page(folder, page.as_ref())?;
    write_atomically(&json, |out| {
        serde_json::to_writer_pretty(&mut *out, record)?;
        writeln!(out)
    })
}

#[cfg(test)]
mod tests {
    use super::record::tests::sample;
    use super::*;
    use crate::REPORT;

    #[test]
    fn the_record_names_every_case_and_solver() {
        let folder = tempfile::tempdir().unwrap();
        write_comparison(folder.path(), &sample(), Some("a")).unwrap();
        for name in COMPARISON_FILES.into_iter().chain([SWEEP, REPORT]) {
            assert!(folder.path().join(name).is_file(), "{name}");
        }
        let text = fs::read(folder.path().join("compare.json")).unwrap();
        let json: serde_json::Value = serde_json::from_slice(&text).unwrap();
        assert_eq!(json["format"], COMPARISON_FORMAT);
        assert_eq!(json["cases"][1]["runs"][0]["history"]["entries"][2], 20);
        assert!(json["cases"][0]["runs"][1]["error"].is_null());
    }
}
