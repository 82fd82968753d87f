//! Studies whose answer is a record and files.
//!
//! The files are written into a folder of the system's for temporary files, which lives as long as
//! the answer, and copied from there where they are asked for: a run that was left because of
//! Ctrl-C can write nothing that the user sees.

use std::fs;
use std::path::{Path, PathBuf};
use std::sync::Arc;

use fredholm_study::{
    CompareOptions, ConvergeOptions, CrosscheckOptions, Error, ErrorKind, JudgeOptions, MultipleTests,
    ProblemOptions, ReferenceOptions, ResultFolder, SceneSource, SpectrumOptions, TraceOptions, Watch,
    claim_folder,
};
use pyo3::prelude::*;
use serde_json::json;
use tempfile::TempDir;

use crate::failure::{failure, input};
use crate::options::{Paths, Problem, Stop, Tracing};
use crate::run::{How, run};
use crate::scene::Scene;
use crate::solved::ending;

/// The answer of a study.
#[pyclass(frozen, module = "fredholm._core")]
pub(crate) struct Study {
    folder: TempDir,
    /// The record of the run as JSON.
    #[pyo3(get)]
    record: String,
    /// How the study ended.
    #[pyo3(get)]
    ended: &'static str,
}

#[pymethods]
impl Study {
    /// Paths of the files in the folder, the record last.
    #[getter]
    fn files(&self, py: Python<'_>) -> PyResult<Vec<String>> {
        names(self.folder.path()).map_err(|error| failure(py, &error))
    }

    /// The bytes of a file.
    fn read(&self, name: &str) -> PyResult<Vec<u8>> {
        Ok(fs::read(self.folder.path().join(name))?)
    }

    /// Writes all files into a folder.
    fn write(&self, py: Python<'_>, folder: PathBuf) -> PyResult<()> {
        py.detach(|| copy(self.folder.path(), &folder)).map_err(|error| failure(py, &error))
    }
}

fn files(error: impl Into<Box<dyn std::error::Error + Send + Sync>>) -> Error {
    Error::new(ErrorKind::Files, error)
}

/// Paths of the files of a folder and of the folders in it: the records come last, since where they
/// stand the folder is complete.
fn names(folder: &Path) -> Result<Vec<String>, Error> {
    let (mut names, mut folders) = (vec![], vec![String::new()]);
    while let Some(inside) = folders.pop() {
        for entry in fs::read_dir(folder.join(&inside)).map_err(files)? {
            let entry = entry.map_err(files)?;
            let name = entry.file_name().to_string_lossy().into_owned();
            // The list of the files is the folder's own.
            if name.starts_with('.') {
                continue;
            }
            let path = if inside.is_empty() { name } else { format!("{inside}/{name}") };
            let list = if entry.path().is_dir() { &mut folders } else { &mut names };
            list.push(path);
        }
    }
    names.sort_by_key(|name| (is_record(name), name.clone()));
    Ok(names)
}

fn is_record(name: &str) -> bool {
    Path::new(name).extension().is_some_and(|ending| ending == "json")
}

/// Copies all files; what an older result has left is removed first.
fn copy(from: &Path, to: &Path) -> Result<(), Error> {
    let names = names(from)?;
    let to = claim_folder(to, "another path")?;
    for name in &names {
        let bytes = fs::read(from.join(name)).map_err(files)?;
        to.write(name, |out| out.write_all(&bytes)).map_err(files)?;
    }
    Ok(())
}

/// A record as JSON, and how the study ended.
type Answer = (serde_json::Result<String>, &'static str);

/// Runs a study that writes into a folder.
pub(crate) fn study(
    py: Python<'_>,
    how: How,
    work: impl FnOnce(&ResultFolder, &dyn Watch) -> Result<Answer, Error> + Send + 'static,
) -> PyResult<Py<PyAny>> {
    let inside = move |watch: &dyn Watch| {
        let folder = tempfile::tempdir().map_err(files)?;
        let place = claim_folder(folder.path(), "another path")?;
        let (record, ended) = work(&place, watch)?;
        Ok(Study { folder, record: record.map_err(files)?, ended })
    };
    run(py, how, inside, |found| Ok(Py::new(py, found)?.into_any()))
}

/// What is asked of a comparison.
#[derive(FromPyObject)]
#[pyo3(from_item_all)]
pub(crate) struct Comparing {
    solvers: Vec<String>,
    tolerance: f64,
    max_iterations: u32,
    sweep: Option<Vec<f64>>,
    report: bool,
    problem: Problem,
}

/// Runs solvers on the system of a scene.
#[pyfunction]
pub(crate) fn compare(py: Python<'_>, scene: &Scene, asked: Comparing, how: How) -> PyResult<Py<PyAny>> {
    let (scene, problem) = (Arc::clone(&scene.0), asked.problem.options(py)?);
    let ProblemOptions { threads, form_factor_tolerance, storage, memory, .. } = problem;
    let Comparing { solvers, tolerance, max_iterations, sweep, report, .. } = asked;
    let options = CompareOptions {
        solvers,
        tolerance,
        max_iterations,
        sweep,
        no_report: !report,
        threads,
        form_factor_tolerance,
        storage,
        memory,
    };
    study(py, how, move |folder, watch| {
        let (record, ended) = fredholm_study::compare(scene, &options, folder, watch)?;
        Ok((serde_json::to_string(&record), ending(ended)))
    })
}

/// Solves a scene on finer and finer meshes.
#[pyfunction]
pub(crate) fn converge(
    py: Python<'_>,
    scene: &Scene,
    asked: (u8, bool),
    problem: Problem,
    stop: Stop,
    how: How,
) -> PyResult<Py<PyAny>> {
    let (scene, problem) = (Arc::clone(&scene.0), problem.options(py)?);
    let ((levels, report), stop) = (asked, stop.into());
    let options = ConvergeOptions { levels, no_report: !report, problem, stop, ..ConvergeOptions::default() };
    study(py, how, move |folder, watch| {
        let (record, ended) = fredholm_study::converge(scene, &options, folder, watch)?;
        Ok((serde_json::to_string(&record), ending(ended)))
    })
}

/// Analyses the matrix of a scene.
#[pyfunction]
pub(crate) fn spectrum(
    py: Python<'_>,
    scene: &Scene,
    asked: (usize, u32),
    problem: Problem,
    how: How,
) -> PyResult<Py<PyAny>> {
    let scene = Arc::clone(&scene.0);
    let ProblemOptions { threads, form_factor_tolerance, memory, .. } = problem.options(py)?;
    let (dense, steps) = asked;
    let options = SpectrumOptions { dense, steps, no_report: false, threads, form_factor_tolerance, memory };
    study(py, how, move |folder, watch| {
        let (record, ended) = fredholm_study::spectrum(scene, &options, folder, watch)?;
        Ok((serde_json::to_string(&record), ending(ended)))
    })
}

/// A scene that was read, or the file of a scene of waves.
#[derive(FromPyObject)]
pub(crate) enum Source<'py> {
    Scene(PyRef<'py, Scene>),
    File(PathBuf),
}

impl From<Source<'_>> for SceneSource {
    fn from(source: Source<'_>) -> Self {
        match source {
            Source::Scene(scene) => Arc::clone(&scene.0).into(),
            Source::File(path) => path.as_path().into(),
        }
    }
}

/// What is asked of random paths.
#[derive(FromPyObject)]
#[pyo3(from_item_all)]
pub(crate) struct Sampling {
    method: Option<String>,
    control: bool,
    spp: Option<u32>,
    pictures: bool,
    report: bool,
    accuracy: Option<f64>,
    significance: f64,
    correction: String,
    paths: Paths,
    tracing: Tracing,
    problem: Problem,
}

/// Traces a scene by random paths.
#[pyfunction]
pub(crate) fn trace(py: Python<'_>, source: Source<'_>, asked: Sampling, how: How) -> PyResult<Py<PyAny>> {
    let (source, usual) = (SceneSource::from(source), TraceOptions::default());
    let options = TraceOptions {
        method: asked.method.unwrap_or(usual.method),
        control: asked.control,
        spp: asked.spp,
        no_pictures: !asked.pictures,
        no_report: false,
        go_on: false,
        paths: asked.paths.options(py)?,
        stop: asked.tracing.into(),
        problem: asked.problem.options(py)?,
    };
    study(py, how, move |folder, watch| {
        let (traced, ended) = fredholm_study::trace(source, &options, folder, watch)?;
        Ok((serde_json::to_string(&traced.record), ending(ended)))
    })
}

/// A correction for many tests, by its name.
fn correction(py: Python<'_>, name: &str) -> PyResult<MultipleTests> {
    match name {
        "holm" => Ok(MultipleTests::Holm),
        "benjamini-hochberg" => Ok(MultipleTests::BenjaminiHochberg),
        other => {
            let help = "use holm or benjamini-hochberg";
            Err(input(py, format!("there is no correction {other:?}"), Some(help)))
        }
    }
}

/// Solves and traces a scene, and decides whether the two agree.
#[pyfunction]
pub(crate) fn crosscheck(
    py: Python<'_>,
    source: Source<'_>,
    asked: Sampling,
    how: How,
) -> PyResult<Py<PyAny>> {
    let source = SceneSource::from(source);
    let correction = correction(py, &asked.correction)?;
    let options = CrosscheckOptions {
        method: asked.method,
        accuracy: asked.accuracy,
        significance: asked.significance,
        correction,
        no_report: !asked.report,
        paths: asked.paths.options(py)?,
        stop: asked.tracing.into(),
        problem: asked.problem.options(py)?,
    };
    study(py, how, move |folder, watch| {
        let (record, verdict) = fredholm_study::crosscheck(source, &options, folder, watch)?;
        Ok((serde_json::to_string(&record), verdict.name()))
    })
}

/// Computes reference values with stated errors.
#[pyfunction]
pub(crate) fn reference(
    py: Python<'_>,
    scene: &Scene,
    size: Option<[u32; 2]>,
    asked: Sampling,
    how: How,
) -> PyResult<Py<PyAny>> {
    let scene = Arc::clone(&scene.0);
    let (paths, problem) = (asked.paths.options(py)?, asked.problem.options(py)?);
    let options = ReferenceOptions {
        size,
        spp: asked.spp,
        no_report: false,
        paths,
        stop: asked.tracing.into(),
        problem,
    };
    study(py, how, move |folder, watch| {
        let record = fredholm_study::reference(scene, &options, folder, watch)?;
        Ok((serde_json::to_string(&record), "done"))
    })
}

/// What is asked of a judgement.
#[derive(FromPyObject)]
#[pyo3(from_item_all)]
pub(crate) struct Judging {
    bundle: PathBuf,
    files: Vec<PathBuf>,
    significance: f64,
    correction: String,
    exact: bool,
    rounding: Option<f64>,
}

/// Judges what another tracer has found by reference values.
#[pyfunction]
pub(crate) fn judge(py: Python<'_>, asked: Judging, how: How) -> PyResult<Py<PyAny>> {
    let Judging { bundle, files, significance, exact, rounding, .. } = asked;
    let correction = correction(py, &asked.correction)?;
    let options = JudgeOptions { significance, correction, exact, rounding };
    study(py, how, move |folder, watch| {
        let (record, verdict) = fredholm_study::judge(bundle, &files, &options, folder, watch)?;
        Ok((serde_json::to_string(&record), verdict.name()))
    })
}

/// What a scene is, and what its solution will take, as JSON; with check.png among the files.
#[pyfunction]
pub(crate) fn check(py: Python<'_>, scene: &Scene, problem: Problem, how: How) -> PyResult<Py<PyAny>> {
    let (scene, options) = (Arc::clone(&scene.0), problem.options(py)?);
    study(py, how, move |folder, watch| {
        let found = fredholm_study::check(scene, (&options, None), Some((folder, "check.png")), watch)?;
        let report = &found.report;
        let mut record = json!({
            "pieces": report.pieces,
            "components": report.components,
            "closed": report.closed,
            "diagonal": report.diagonal,
            "findings": report.findings.iter().map(ToString::to_string).collect::<Vec<_>>(),
        });
        let more = match &found.forecast {
            Ok(forecast) => json!({
                "elements": forecast.elements,
                "faces": forecast.faces,
                "surfaces": forecast.surfaces,
                "occluders": forecast.occluders,
                "unknowns": forecast.unknowns,
                "discretisation": forecast.discretisation,
                "solver": forecast.solver,
                "threads": forecast.threads,
                "memory_bytes": u64::try_from(forecast.plan.peak().0).ok(),
                "seconds": found.seconds(),
                "warnings": forecast.warnings,
                "refused": null,
            }),
            Err(error) => json!({ "refused": error.to_string() }),
        };
        if let (Some(record), Some(more)) = (record.as_object_mut(), more.as_object()) {
            record.extend(more.clone());
        }
        Ok((serde_json::to_string(&record), "done"))
    })
}
