//! The folder for the results.

use std::fs;
use std::io;
use std::path::Path;

use crate::error::{Error, ErrorKind};

/// Makes sure that files can be written to `folder`, before anything is computed. Leaves nothing
/// behind. `option` is what chooses another one.
///
/// # Errors
/// [`ErrorKind::Files`] where they cannot.
pub fn probe(folder: &Path, option: &str) -> Result<(), Error> {
    let missing: Vec<&Path> =
        folder.ancestors().take_while(|a| !a.as_os_str().is_empty() && !a.exists()).collect();
    let written = fs::create_dir_all(folder).and_then(|()| tempfile::tempfile_in(folder));
    // What was already there, or what something else has filled meanwhile, stays.
    for made in missing {
        let _ = fs::remove_dir(made);
    }
    written.map(drop).map_err(|error| unusable(folder, option, &error))
}

fn unusable(folder: &Path, option: &str, error: &io::Error) -> Error {
    let what =
        if folder.exists() && !folder.is_dir() { "it is a file".to_owned() } else { error.to_string() };
    let text = format!("cannot write results to {}: {what}", folder.display());
    Error::new(ErrorKind::Files, text).with_help(format!("write elsewhere with {option}"))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_probe_leaves_nothing_behind() {
        let root = tempfile::tempdir().unwrap();
        let deep = root.path().join("a/b/c");
        probe(&deep, "-o DIR").unwrap();
        assert!(!root.path().join("a").exists());
        fs::create_dir_all(&deep).unwrap();
        probe(&deep, "-o DIR").unwrap();
        assert!(deep.is_dir());
    }

    #[test]
    fn a_file_is_no_folder() {
        let root = tempfile::tempdir().unwrap();
        let file = root.path().join("taken");
        fs::write(&file, "x").unwrap();
        for path in [file.clone(), file.join("below")] {
            assert_eq!(probe(&path, "-o DIR").unwrap_err().kind(), ErrorKind::Files);
        }
        assert_eq!(fs::read(&file).unwrap(), b"x");
    }
}
