//! Errors of a study as exceptions, of the same kinds, with file, line and help.

use std::fmt::Display;
use std::path::Path;

use fredholm_scene::{Place, SceneError};
use fredholm_study::{Error, ErrorKind};
use pyo3::exceptions::PyRuntimeError;
use pyo3::prelude::*;

/// The module that defines the exceptions.
const MODULE: &str = "fredholm._errors";

/// What is known of an error besides its message.
#[derive(Default)]
struct Known<'a> {
    file: Option<&'a Path>,
    line: Option<usize>,
    column: Option<usize>,
    byte: Option<usize>,
    help: Option<String>,
}

/// The exception of an error of a study.
pub(crate) fn failure(py: Python<'_>, error: &Error) -> PyErr {
    let kind = match error.kind() {
        ErrorKind::Input => "InputError",
        ErrorKind::NotConverged => "NotConvergedError",
        ErrorKind::Resources => "ResourceError",
        ErrorKind::Files => "FileError",
        ErrorKind::Interrupted => "Interrupted",
    };
    let mut known = error.cause().downcast_ref::<SceneError>().map(of_scene).unwrap_or_default();
    known.help = error.help().map(str::to_owned).or(known.help);
    raise(py, kind, error.to_string(), &known)
}

/// The exception of an argument that is wrong.
pub(crate) fn input(py: Python<'_>, message: impl Display, help: Option<&str>) -> PyErr {
    let known = Known { help: help.map(str::to_owned), ..Known::default() };
    raise(py, "InputError", message.to_string(), &known)
}

/// The exception of a scene that is wrong.
pub(crate) fn scene(py: Python<'_>, error: &SceneError) -> PyErr {
    let kind = match error.kind() {
        fredholm_scene::ErrorKind::Io => "FileError",
        fredholm_scene::ErrorKind::TooLarge => "ResourceError",
        _ => "InputError",
    };
    raise(py, kind, error.to_string(), &of_scene(error))
}

/// What should never happen.
pub(crate) fn internal(error: impl Display) -> PyErr {
    PyRuntimeError::new_err(error.to_string())
}

/// The end of a run by Ctrl-C, with what it has found by then.
pub(crate) fn interrupted(py: Python<'_>, partial: Option<Py<PyAny>>) -> PyErr {
    let made = || -> PyResult<PyErr> {
        let class = py.import(MODULE)?.getattr("Interrupted")?;
        Ok(PyErr::from_value(class.call1((partial,))?))
    };
    made().unwrap_or_else(|error| error)
}

fn of_scene(error: &SceneError) -> Known<'_> {
    let (mut line, mut column, mut byte) = (None, None, None);
    match error.place() {
        Some(Place::Line { line: l, column: c }) => (line, column) = (Some(l), Some(c)),
        Some(Place::Byte(offset)) => byte = Some(offset),
        _ => {}
    }
    Known { file: Some(error.file()), line, column, byte, help: Some(error.help().to_owned()) }
}

fn raise(py: Python<'_>, kind: &str, message: String, known: &Known<'_>) -> PyErr {
    let made = || -> PyResult<PyErr> {
        let make = py.import(MODULE)?.getattr("made")?;
        let Known { file, line, column, byte, help } = known;
        let file = file.map(|file| file.display().to_string());
        Ok(PyErr::from_value(make.call1((kind, message, file, line, column, byte, help))?))
    };
    made().unwrap_or_else(|error| error)
}
