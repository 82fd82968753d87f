//! The folder for the results.

use std::path::Path;

use fredholm_report::{ReportError, ResultFolder, ViewFactorFiles};

use crate::error::{Error, ErrorKind};

/// Claims a folder for the results of a run, before anything is computed; see
/// [`ResultFolder::claim`]. `option` is what chooses another one.
///
/// # Errors
/// [`ErrorKind::Files`] while another run writes there, for a folder with files that are not those
/// of a run, and where nothing can be written.
pub fn claim(folder: &Path, option: &str) -> Result<ResultFolder, Error> {
    ResultFolder::claim(folder).map_err(|error| unusable(folder, option, error))
}

/// The same for files that are added beside a result; see [`ResultFolder::to_add`].
///
/// # Errors
/// As for [`claim`], but for files that are not those of a run.
pub fn claim_to_add(folder: &Path, option: &str) -> Result<ResultFolder, Error> {
    ResultFolder::to_add(folder).map_err(|error| unusable(folder, option, error))
}

/// The same for the files of a matrix; see [`ResultFolder::of_matrix`].
pub(crate) fn claim_matrix(files: &ViewFactorFiles, option: &str) -> Result<ResultFolder, Error> {
    ResultFolder::of_matrix(files).map_err(|error| unusable(&files.matrix, option, error))
}

fn unusable(place: &Path, option: &str, error: ReportError) -> Error {
    let failed = |text: String| Error::new(ErrorKind::Files, text);
    let elsewhere = format!("write elsewhere with {option}");
    match error {
        ReportError::Busy { path } => {
            let text = format!("another run of Fredholm writes into {}", path.display());
            failed(text).with_help(format!("wait until it has ended, or {elsewhere}"))
        }
        ReportError::Occupied { path } => {
            let text = format!(
                "{} would be replaced, but is not listed as the file of an earlier run",
                path.display()
            );
            failed(text).with_help(format!("move it away, or {elsewhere}"))
        }
        ReportError::Write { source, .. } => {
            let what = if place.exists() && !place.is_dir() {
                "it is a file".to_owned()
            } else {
                source.to_string()
            };
            failed(format!("cannot write results to {}: {what}", place.display())).with_help(elsewhere)
        }
        other => Error::new(ErrorKind::Files, other).with_help(elsewhere),
    }
}

#[cfg(test)]
mod tests {
    use std::fs;

    use super::*;

    #[test]
    fn a_claim_leaves_nothing_behind() {
        let root = tempfile::tempdir().unwrap();
        let deep = root.path().join("a/b/c");
        drop(claim(&deep, "-o DIR").unwrap());
        assert!(!root.path().join("a").exists());
        fs::create_dir_all(&deep).unwrap();
        drop(claim(&deep, "-o DIR").unwrap());
        assert!(deep.is_dir());
    }

    #[test]
    fn a_file_is_no_folder() {
        let root = tempfile::tempdir().unwrap();
        let file = root.path().join("taken");
        fs::write(&file, "x").unwrap();
        for path in [file.clone(), file.join("below")] {
            assert_eq!(claim(&path, "-o DIR").unwrap_err().kind(), ErrorKind::Files);
        }
        assert_eq!(fs::read(&file).unwrap(), b"x");
    }

    #[test]
    fn what_keeps_a_folder_from_being_used_comes_with_a_way_out() {
        let root = tempfile::tempdir().unwrap();
        let first = claim(root.path(), "-o DIR").unwrap();
        let busy = claim(root.path(), "-o DIR").unwrap_err();
        assert_eq!(busy.help(), Some("wait until it has ended, or write elsewhere with -o DIR"));
        drop(first);
        fs::write(root.path().join("run.json"), "x").unwrap();
        let occupied = claim(root.path(), "-o DIR").unwrap_err();
        assert!(occupied.to_string().contains("run.json"), "{occupied}");
        assert_eq!(occupied.help(), Some("move it away, or write elsewhere with -o DIR"));
    }
}
