//! The files of a matrix: the matrix itself, a heat map (`.png`), a histogram of the closure errors
//! (`.svg`), the page for the browser (`.html`) and the record (`.json`).
//!
//! The record is written last: where it stands, the files beside it belong together.

use std::ffi::OsStr;
use std::path::{Path, PathBuf};

use super::heat_map::heat_map;
use super::histogram::write_closure_histogram;
use super::matrix::ViewFactors;
use super::record::ViewFactorsRecord;
use crate::{ReportError, ReportPage, ResultFolder};

/// Forms of the matrix.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum MatrixFormat {
    /// Arrays for `NumPy` and `SciPy`.
    Npz,
    /// A table.
    Csv,
    /// Text as View3D writes it.
    View3d,
}

impl MatrixFormat {
    /// The format that the ending of a name stands for: `.npz`, `.csv`, or `.txt`, `.out` and
    /// `.vf`.
    #[must_use]
    pub fn of(path: &Path) -> Option<Self> {
        match path.extension()?.to_str()?.to_lowercase().as_str() {
            "npz" => Some(Self::Npz),
            "csv" => Some(Self::Csv),
            "txt" | "out" | "vf" => Some(Self::View3d),
            _ => None,
        }
    }
}

/// Where the files of a matrix lie.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct ViewFactorFiles {
    /// The matrix.
    pub matrix: PathBuf,
    /// The heat map.
    pub picture: PathBuf,
    /// The histogram.
    pub histogram: PathBuf,
    /// The page for the browser.
    pub page: PathBuf,
    /// The record.
    pub record: PathBuf,
}

impl ViewFactorFiles {
    /// The files beside a matrix.
    #[must_use]
    pub fn beside(matrix: &Path) -> Self {
        let with = |ending| matrix.with_extension(ending);
        Self {
            matrix: matrix.to_owned(),
            picture: with("png"),
            histogram: with("svg"),
            page: with("html"),
            record: with("json"),
        }
    }
}

/// Writes all files to a place that was claimed for them, the page where it is wanted.
///
/// # Errors
/// [`ReportError::Write`] with the file or folder that could not be written. There is then no
/// record.
pub fn write_view_factors(
    (place, files): (&ResultFolder, &ViewFactorFiles),
    format: MatrixFormat,
    factors: &ViewFactors,
    record: &ViewFactorsRecord,
    report: bool,
) -> Result<(), ReportError> {
    place.write(&name(&files.matrix), |out| match format {
        MatrixFormat::Npz => factors.write_npz(out),
        MatrixFormat::Csv => factors.write_csv(out),
        MatrixFormat::View3d => factors.write_view3d(record.enforced.is_some(), out),
    })?;
    let map = heat_map(factors).map_err(|error| ReportError::Drawing { why: error.to_string() })?;
    place.write(&name(&files.picture), |out| map.write_png(out))?;
    place.write(&name(&files.histogram), |out| write_closure_histogram(factors, out))?;
    if report {
        let page = ReportPage::of_view_factors(factors, record, Some(&map));
        place.write(&name(&files.page), |out| page.write(out))?;
    }
    place.write(&name(&files.record), |out| record.write(out)).map(drop)
}

fn name(path: &Path) -> String {
    path.file_name().map(OsStr::to_string_lossy).unwrap_or_default().into_owned()
}

#[cfg(test)]
mod tests {
    use super::super::matrix::tests::sample;
    use std::fs;

    use super::*;
    use crate::read_view_factors_record;

    #[test]
    fn all_files_are_written_or_there_is_no_record() {
        let base = tempfile::tempdir().unwrap();
        let files = ViewFactorFiles::beside(&base.path().join("new/F.npz"));
        let record = ViewFactorsRecord::default();
        let claim = || ResultFolder::of_matrix(&files).unwrap();
        write_view_factors((&claim(), &files), MatrixFormat::Npz, &sample(None), &record, true).unwrap();
        assert_eq!(ViewFactors::read_npz(&files.matrix).unwrap(), sample(None));
        assert_eq!(read_view_factors_record(&files.record).unwrap(), record);
        let picture = image::open(&files.picture).unwrap();
        assert!(picture.width() > 100 && fs::read_to_string(&files.histogram).unwrap().contains("</svg>"));
        assert!(fs::read_to_string(&files.page).unwrap().contains("View factors"));
        fs::remove_file(&files.picture).unwrap();
        fs::create_dir(&files.picture).unwrap();
        let error = write_view_factors((&claim(), &files), MatrixFormat::Npz, &sample(None), &record, true)
            .unwrap_err();
        assert!(error.to_string().contains("F.png") && !files.record.exists(), "{error}");
    }

    #[test]
    fn endings_name_formats() {
        let of = |name: &str| MatrixFormat::of(Path::new(name));
        assert_eq!(
            [of("a.NPZ"), of("a.csv"), of("a.vf")],
            [Some(MatrixFormat::Npz), Some(MatrixFormat::Csv), Some(MatrixFormat::View3d)]
        );
        assert_eq!([of("a.png"), of("npz"), of("a")], [None; 3]);
    }
}
