//! What a result tells, in words: at the end of a run, and to whoever asks the folder for it later.

mod lines;
mod run;
mod studies;
mod view_factors;
mod waves;

use std::fs;
use std::path::{Path, PathBuf};

use fredholm_report::{
    COMPARISON_FORMAT, CROSSCHECK_FORMAT, ComparisonRecord, CrosscheckRecord, FORMAT, JUDGE_FORMAT,
    JudgeRecord, METHODS_FORMAT, MatrixFormat, MethodsRecord, REFERENCE_FORMAT, REFINEMENT_FORMAT, RUN,
    ReferenceRecord, RefinementRecord, RunRecord, SHOOTING_FORMAT, SPECTRUM_FORMAT, ShootingRecord,
    SpectrumRecord, VIEW_FACTORS_FORMAT, ViewFactorFiles, ViewFactorsRecord, WAVE_COMPARISON_FORMAT,
    WaveComparison, is_result, records,
};
use serde::de::DeserializeOwned;
use serde_json::Value;

use crate::error::{Error, ErrorKind};
pub use lines::{Lines, extent};
pub(crate) use waves::RECORD_FORMAT as WAVES_FORMAT;
pub use waves::{WaveRecord, frequencies};

/// What made a result.
pub struct Made<'a> {
    /// Version of the program.
    pub version: &'a str,
    /// The scene, geometry or bundle.
    pub of: &'a str,
    /// Its SHA-256; empty where the record has none.
    pub sha256: &'a str,
}

/// A record that can be put into words.
pub trait Summarise {
    /// What made it.
    fn made(&self) -> Made<'_>;

    /// What there is to look at first: a label and the name of a file.
    fn shown(&self) -> Option<(&'static str, &'static str)> {
        None
    }

    /// The result, and the figures that say whether to trust it.
    fn lines(&self, lines: &mut Lines);

    /// What else the record holds.
    fn details(&self, lines: &mut Lines);
}

/// What a run came to, whose record lies in a folder, or, of a matrix, beside `place`.
#[must_use]
pub fn summary(record: &impl Summarise, place: &Path) -> String {
    let mut lines = Lines::default();
    record.lines(&mut lines);
    if let Some((label, file)) = record.shown() {
        lines.add(label, place.join(file).display().to_string());
    }
    lines.under(&format!("{} → {}", record.made().of, place.display()))
}

/// What a result tells: a folder, one of the files in one, a matrix of view factors or its record.
///
/// # Errors
/// [`ErrorKind::Files`] for what cannot be read, [`ErrorKind::Input`] for what is no result.
pub fn info(path: &Path) -> Result<String, Error> {
    let path = record_of(path)?;
    if path.extension().is_some_and(|ending| ending == "npz") {
        return view_factors::matrix(&path);
    }
    let bytes = fs::read(&path).map_err(|error| {
        let text = format!("cannot read {}: {error}", path.display());
        Error::new(ErrorKind::Files, text).with_help(without_record(&path))
    })?;
    let broken = |error: serde_json::Error| {
        let text = format!("{} is damaged: {error}", path.display());
        Error::new(ErrorKind::Input, text).with_help("make the result again")
    };
    let record: Value = serde_json::from_slice(&bytes).map_err(broken)?;
    let format = record["format"].as_str().unwrap_or_default().to_owned();
    let told = match format.as_str() {
        FORMAT => told::<RunRecord>(record, &path),
        VIEW_FACTORS_FORMAT => told::<ViewFactorsRecord>(record, &path),
        COMPARISON_FORMAT => told::<ComparisonRecord>(record, &path),
        WAVE_COMPARISON_FORMAT => told::<WaveComparison>(record, &path),
        METHODS_FORMAT => told::<MethodsRecord>(record, &path),
        REFINEMENT_FORMAT => told::<RefinementRecord>(record, &path),
        SPECTRUM_FORMAT => told::<SpectrumRecord>(record, &path),
        SHOOTING_FORMAT => told::<ShootingRecord>(record, &path),
        CROSSCHECK_FORMAT => told::<CrosscheckRecord>(record, &path),
        REFERENCE_FORMAT => told::<ReferenceRecord>(record, &path),
        JUDGE_FORMAT => told::<JudgeRecord>(record, &path),
        WAVES_FORMAT => Ok(whole(&WaveRecord(&record), &path)),
        _ => return Err(foreign(&path, &record["format"])),
    };
    told.map_err(broken)
}

fn told<R: Summarise + DeserializeOwned>(record: Value, path: &Path) -> Result<String, serde_json::Error> {
    Ok(whole(&serde_json::from_value::<R>(record)?, path))
}

/// Everything that a record tells.
fn whole(record: &impl Summarise, path: &Path) -> String {
    let mut lines = Lines::default();
    let Made { version, of, sha256 } = record.made();
    lines.add("made by", format!("fredholm {version}"));
    lines.add("made of", of);
    lines.add_some("sha256 of it", (!sha256.is_empty()).then(|| sha256.to_owned()));
    record.lines(&mut lines);
    record.details(&mut lines);
    lines.under(&path.display().to_string())
}

/// The record that belongs to a path: in the folder, or beside the file of a result. Files of view
/// factors stand for themselves.
fn record_of(path: &Path) -> Result<PathBuf, Error> {
    let found = fs::metadata(path).map_err(|error| {
        Error::new(ErrorKind::Files, format!("cannot read {}: {error}", path.display()))
            .with_help("give a result folder, or a file in one")
    })?;
    if found.is_dir() {
        return Ok(in_folder(path));
    }
    let name = path.file_name().and_then(|name| name.to_str()).unwrap_or_default();
    if path.extension().is_some_and(|ending| ending == "json") && name != fredholm_report::TRACE_STATE {
        return Ok(path.to_owned());
    }
    if is_result(name) {
        return Ok(in_folder(path.parent().unwrap_or(Path::new(""))));
    }
    match MatrixFormat::of(path) {
        Some(MatrixFormat::Npz) => Ok(path.to_owned()),
        // Tables of view factors tell less than the record beside them.
        Some(_) => Ok(ViewFactorFiles::beside(path).record),
        None => {
            let text = format!("{} is none of the files of a result", path.display());
            Err(Error::new(ErrorKind::Input, text).with_help(
                "give a result folder, one of its files, or a matrix of view factors (.npz, .csv, .txt)",
            ))
        }
    }
}

/// The record that a folder has, or the one that is missed most.
fn in_folder(folder: &Path) -> PathBuf {
    let found = records().map(|name| folder.join(name)).find(|path| path.is_file());
    found.unwrap_or_else(|| folder.join(RUN))
}

fn foreign(path: &Path, format: &Value) -> Error {
    let found = if format.is_null() { "missing".to_owned() } else { format.to_string() };
    let text = format!("{} is no record of a result: \"format\" is {found}", path.display());
    Error::new(ErrorKind::Input, text).with_help("give a folder that this version of Fredholm has written")
}

/// What a record that is not there means.
fn without_record(path: &Path) -> &'static str {
    if path.file_name().is_some_and(|name| name == RUN) {
        "a folder without a record holds no complete result; run the command again"
    } else {
        "what is known of a table of view factors stands in the record beside it; compute them again if it is one"
    }
}
