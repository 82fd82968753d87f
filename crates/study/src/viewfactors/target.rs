//! Where the matrix goes, and in which form.

use std::path::Path;

use fredholm_report::{MatrixFormat, ResultFolder, ViewFactorFiles};

use crate::error::{Error, ErrorKind};
use crate::folder;

/// Endings of the files that come beside the matrix.
const TAKEN_ENDINGS: [&str; 3] = ["png", "svg", "json"];

/// Where a matrix goes, what comes beside it, and in which form it is written.
#[derive(Debug)]
pub struct MatrixFiles {
    /// The matrix, and what comes beside it.
    pub files: ViewFactorFiles,
    /// Form of the matrix.
    pub format: MatrixFormat,
    /// The place of the files, claimed.
    pub(crate) place: ResultFolder,
}

impl MatrixFiles {
    /// Chooses the files and makes sure, before anything is computed, that they can be written:
    /// `output`, or else `out/` and the name of the input, in the form asked for, or else that of
    /// the ending of the name.
    ///
    /// # Errors
    /// [`ErrorKind::Input`] for a name whose form is not known, or which is that of a file beside
    /// the matrix; [`ErrorKind::Files`] while another run writes them, for files of these names
    /// that are not those of a run, and where they cannot be written.
    pub fn new(input: &Path, output: Option<&Path>, form: Option<MatrixFormat>) -> Result<Self, Error> {
        let stem = input.file_stem().unwrap_or_else(|| "F".as_ref());
        let default = || Path::new("out").join(stem).with_added_extension("npz");
        let path = output.map_or_else(default, Path::to_owned);
        let format = format(&path, form)?;
        let files = ViewFactorFiles::beside(&path);
        for file in [&files.matrix, &files.picture, &files.histogram, &files.record] {
            if file.is_dir() {
                let text = format!("cannot write {}: it is a folder", file.display());
                let error = Error::new(ErrorKind::Files, text);
                return Err(error.with_help("choose another file with -o FILE"));
            }
        }
        let place = folder::claim_matrix(&files, "-o FILE")?;
        Ok(Self { files, format, place })
    }
}

fn format(path: &Path, given: Option<MatrixFormat>) -> Result<MatrixFormat, Error> {
    let ending = path.extension().and_then(|ending| ending.to_str()).unwrap_or_default().to_lowercase();
    if TAKEN_ENDINGS.contains(&ending.as_str()) {
        let text = format!(
            "{} is the name of a picture, plot or record that comes beside the matrix",
            path.display()
        );
        let help = "end the name of the matrix in .npz, .csv or .txt";
        return Err(Error::new(ErrorKind::Input, text).with_help(help));
    }
    given.or(MatrixFormat::of(path)).ok_or_else(|| {
        let text = format!("the form of {} is not known from its name", path.display());
        let help = "end it in .npz, .csv, .txt, .out or .vf, or choose one with --format";
        Error::new(ErrorKind::Input, text).with_help(help)
    })
}
