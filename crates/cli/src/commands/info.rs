//! `fredholm info`.

use std::fs;
use std::path::{Path, PathBuf};

use fredholm_report::{
    EXTRAS, FILES, MatrixFormat, ReportError, ViewFactorFiles, read_run, read_view_factors_record,
};

use fredholm_study::{Error, ErrorKind, WAVE_FILES};
use serde_json::Value;

use super::{viewfactors, waves};
use crate::args::InfoArgs;
use crate::ending::Ending;
use crate::output;
use crate::summary::{Lines, provenance};

const RECORD: &str = "run.json";

/// Tells what made a result.
pub(crate) fn info(args: &InfoArgs) -> Result<Ending, Error> {
    let path = record(&args.path)?;
    if path.extension().is_some_and(|ending| ending == "npz") {
        return viewfactors::describe_matrix(&path);
    }
    if let Ok(record) = read_view_factors_record(&path) {
        return viewfactors::describe_record(&path, &record);
    }
    if let Some(record) = wave_record(&path) {
        return waves::describe(&path, &record);
    }
    let run = read_run(&path).map_err(|error| unreadable(&path, error))?;
    let mut lines = Lines::default();
    provenance(&run, &mut lines);
    output::print(&lines.under(&path.display().to_string()))?;
    Ok(Ending::Done)
}

/// The record of a result of waves, where a path is one.
fn wave_record(path: &Path) -> Option<Value> {
    let record: Value = serde_json::from_slice(&fs::read(path).ok()?).ok()?;
    record["format"].as_str()?.starts_with(waves::RECORD_FORMAT).then_some(record)
}

/// The record that belongs to a path: in the folder, or beside the file of a result. Files of view factors stand for themselves.
fn record(path: &Path) -> Result<PathBuf, Error> {
    let found = fs::metadata(path).map_err(|error| {
        Error::new(ErrorKind::Files, format!("cannot read {}: {error}", path.display()))
            .with_help("give a result folder, or a file in one")
    })?;
    if found.is_dir() {
        return Ok(path.join(RECORD));
    }
    let is_result = FILES
        .iter()
        .chain(&EXTRAS)
        .chain(&WAVE_FILES)
        .any(|name| path.file_name().is_some_and(|file| file == *name));
    if is_result {
        return Ok(path.with_file_name(RECORD));
    }
    if path.extension().is_some_and(|ending| ending == "json") {
        return Ok(path.to_owned());
    }
    match MatrixFormat::of(path) {
        Some(MatrixFormat::Npz) => Ok(path.to_owned()),
        // Tables of view factors tell less than the record beside them.
        Some(_) => Ok(ViewFactorFiles::beside(path).record),
        None => Err(foreign(path)),
    }
}

fn foreign(path: &Path) -> Error {
    let help = format!(
        "give a result folder, a matrix of view factors (.npz, .csv, .txt) or one of {}",
        [&FILES[..], &EXTRAS].concat().join(", ")
    );
    let text = format!("{} is none of the files of a result", path.display());
    Error::new(ErrorKind::Input, text).with_help(help)
}

fn unreadable(path: &Path, error: ReportError) -> Error {
    match error {
        ReportError::Read { source, .. } => {
            let text = format!("cannot read {}: {source}", path.display());
            Error::new(ErrorKind::Files, text).with_help(without_record(path))
        }
        other => Error::new(ErrorKind::Input, other),
    }
}

/// What a record that is not there means.
fn without_record(path: &Path) -> String {
    if path.file_name().is_none_or(|name| name != RECORD) {
        return "what is known of a table of view factors stands in the record beside it; compute them again if it is one".to_owned();
    }
    let entries = path.parent().and_then(|folder| fs::read_dir(folder).ok()).into_iter().flatten().flatten();
    let mut others: Vec<String> =
        entries.map(|entry| entry.file_name().to_string_lossy().into_owned()).collect();
    others.retain(|name| Path::new(name).extension().is_some_and(|ending| ending == "json"));
    others.sort();
    if others.is_empty() {
        format!("a folder without {RECORD} holds no complete result; solve the scene again")
    } else {
        format!(
            "there is no result of `fredholm solve`; other records in the folder are {}",
            others.join(", ")
        )
    }
}
