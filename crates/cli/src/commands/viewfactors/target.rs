//! Where the matrix goes, and in which form.

use std::path::Path;

use fredholm_report::{MatrixFormat, ViewFactorFiles};

use super::args::{Format, ViewFactorsArgs};
use crate::failure::{Ending, Failure};
use crate::folder;

/// Endings of the files that come beside the matrix.
const TAKEN: [&str; 3] = ["png", "svg", "json"];

/// The files of a run.
#[derive(Debug)]
pub(super) struct Target {
    pub(super) files: ViewFactorFiles,
    pub(super) format: MatrixFormat,
}

impl Target {
    /// Chooses the files and makes sure, before anything is computed, that they can be written.
    pub(super) fn new(args: &ViewFactorsArgs) -> Result<Self, Failure> {
        let stem = args.input.file_stem().unwrap_or_else(|| "F".as_ref());
        let default = || Path::new("out").join(stem).with_added_extension("npz");
        let path = args.output.clone().unwrap_or_else(default);
        let format = format(&path, args.format)?;
        let parent = path.parent().filter(|folder| !folder.as_os_str().is_empty());
        folder::probe(parent.unwrap_or(Path::new(".")), "-o FILE")?;
        let files = ViewFactorFiles::beside(&path);
        for file in [&files.matrix, &files.picture, &files.histogram, &files.record] {
            if file.is_dir() {
                let text = format!(
                    "cannot write {}: it is a folder\n  help: choose another file with -o FILE",
                    file.display()
                );
                return Err(Failure::new(Ending::Files, text));
            }
        }
        Ok(Self { files, format })
    }
}

fn format(path: &Path, given: Option<Format>) -> Result<MatrixFormat, Failure> {
    let ending = path.extension().and_then(|ending| ending.to_str()).unwrap_or_default().to_lowercase();
    if TAKEN.contains(&ending.as_str()) {
        let text = format!(
            "{} is the name of a picture, plot or record that comes beside the matrix\n  help: end the name of the matrix in .npz, .csv or .txt",
            path.display()
        );
        return Err(Failure::new(Ending::Input, text));
    }
    let by_name = MatrixFormat::of(path);
    let chosen = given.map(|format| match format {
        Format::Npz => MatrixFormat::Npz,
        Format::Csv => MatrixFormat::Csv,
        Format::View3d => MatrixFormat::View3d,
    });
    chosen.or(by_name).ok_or_else(|| {
        let text = format!(
            "the form of {} is not known from its name\n  help: end it in .npz, .csv, .txt, .out or .vf, or choose one with --format",
            path.display()
        );
        Failure::new(Ending::Input, text)
    })
}
