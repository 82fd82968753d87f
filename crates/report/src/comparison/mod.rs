//! What a comparison of solvers leaves: `compare.csv`, `compare_history.csv`, `compare.svg`, for a
//! sweep `compare_sweep.svg`, and `compare.json` last.

mod csv;
mod plot;
mod record;

use std::io::Write;

use crate::{REPORT, ReportError, ReportPage, ResultFolder};

pub use csv::{write_comparison_csv, write_comparison_history};
pub use plot::{write_comparison_plot, write_sweep_plot};
pub use record::{COMPARISON_FORMAT, ComparisonCase, ComparisonHistory, ComparisonRecord, ComparisonRun};

/// The files of a comparison without a sweep, in the order in which they are written.
pub const COMPARISON_FILES: [&str; 4] = ["compare.csv", "compare_history.csv", "compare.svg", "compare.json"];
/// The plot of a sweep.
pub(crate) const SWEEP_PLOT: &str = "compare_sweep.svg";

/// Writes a comparison into a folder; with a title, `report.html` too.
///
/// # Errors
/// [`ReportError::Write`] with the path.
pub fn write_comparison(
    folder: &ResultFolder,
    record: &ComparisonRecord,
    title: Option<&str>,
) -> Result<(), ReportError> {
    let [table, history, plot, json] = COMPARISON_FILES;
    folder.write(table, |out| write_comparison_csv(record, out))?;
    folder.write(history, |out| write_comparison_history(record, out))?;
    folder.write(plot, |out| write_comparison_plot(record, out))?;
    if record.cases.len() > 1 {
        folder.write(SWEEP_PLOT, |out| write_sweep_plot(record, out))?;
    }
    if let Some(title) = title {
        folder.write(REPORT, |out| ReportPage::of_comparison(title, record).write(out))?;
    }
    let record = |out: &mut dyn Write| {
        serde_json::to_writer_pretty(&mut *out, record)?;
        writeln!(out)
    };
    folder.write(json, record).map(drop)
}

#[cfg(test)]
mod tests {
    use super::record::tests::sample;
    use super::*;
    use std::fs;

    #[test]
    fn the_record_names_every_case_and_solver() {
        let folder = tempfile::tempdir().unwrap();
        write_comparison(&ResultFolder::claim(folder.path()).unwrap(), &sample(), Some("a")).unwrap();
        for name in COMPARISON_FILES.into_iter().chain([SWEEP_PLOT, REPORT]) {
            assert!(folder.path().join(name).is_file(), "{name}");
        }
        let text = fs::read(folder.path().join("compare.json")).unwrap();
        let json: serde_json::Value = serde_json::from_slice(&text).unwrap();
        assert_eq!(json["format"], COMPARISON_FORMAT);
        assert_eq!(json["cases"][1]["runs"][0]["history"]["entries"][2], 20);
        assert!(json["cases"][0]["runs"][1]["error"].is_null());
    }
}
