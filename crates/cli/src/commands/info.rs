//! `fredholm info`.

use std::fs;
use std::path::{Path, PathBuf};

use fredholm_report::{EXTRAS, FILES, ReportError, read_run, read_view_factors_record};

use super::viewfactors;
use crate::args::InfoArgs;
use crate::failure::{Ending, Failure};
use crate::output;
use crate::summary::{Lines, provenance};

const RECORD: &str = "run.json";

/// Tells what made a result.
pub(crate) fn info(args: &InfoArgs) -> Result<Ending, Failure> {
    let path = record(&args.path)?;
    if path.extension().is_some_and(|ending| ending == "npz") {
        return viewfactors::describe_matrix(&path);
    }
    if let Ok(record) = read_view_factors_record(&path) {
        return viewfactors::describe_record(&path, &record);
    }
    let run = read_run(&path).map_err(|error| unreadable(&path, error))?;
    let mut lines = Lines::default();
    provenance(&run, &mut lines);
    output::print(&lines.under(&path.display().to_string()))?;
    Ok(Ending::Done)
}

/// The record that belongs to a path: in the folder, or beside the file of a result. Files of view factors stand for themselves.
fn record(path: &Path) -> Result<PathBuf, Failure> {
    let found = fs::metadata(path)
        .map_err(|error| Failure::new(Ending::Files, format!("cannot read {}: {error}", path.display())))?;
    if found.is_dir() {
        return Ok(path.join(RECORD));
    }
    let alone = path.extension().is_some_and(|ending| ending == "json" || ending == "npz");
    let is_result =
        FILES.iter().chain(&EXTRAS).any(|name| path.file_name().is_some_and(|file| file == *name));
    match (is_result, alone) {
        (true, _) => Ok(path.with_file_name(RECORD)),
        (false, true) => Ok(path.to_owned()),
        (false, false) => Err(foreign(path)),
    }
}

fn foreign(path: &Path) -> Failure {
    let text = format!(
        "{} is none of the files of a result\n  help: give a result folder or one of {}",
        path.display(),
        [&FILES[..], &EXTRAS].concat().join(", ")
    );
    Failure::new(Ending::Input, text)
}

fn unreadable(path: &Path, error: ReportError) -> Failure {
    match error {
        ReportError::Read { source, .. } => {
            let text = format!(
                "cannot read {}: {source}\n  help: a folder without {RECORD} holds no complete result; solve the scene again",
                path.display()
            );
            Failure::new(Ending::Files, text)
        }
        other => Failure::new(Ending::Input, other),
    }
}
