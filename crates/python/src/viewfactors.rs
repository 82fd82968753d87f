//! View factors.

use std::path::PathBuf;
use std::sync::Arc;

use fredholm_report::Factors;
use fredholm_study::{MatrixFiles, MatrixRows, SolvedViewFactors, ViewFactorOptions, solve_view_factors};
use numpy::{PyArray1, PyArray2};
use pyo3::prelude::*;

use crate::arrays::{moved, shared};
use crate::failure::{failure, input, internal};
use crate::options::{Problem, points};
use crate::run::{How, run};
use crate::scene::Scene;

/// What is asked of a matrix.
#[derive(FromPyObject)]
#[pyo3(from_item_all)]
pub(crate) struct Asked {
    tolerance: Option<f64>,
    method: String,
    setting: Option<String>,
    rows: String,
    threshold: Option<f64>,
    close: bool,
    sky: bool,
    points: Vec<[f64; 6]>,
    problem: Problem,
}

/// A scene, or the file of one or of a mesh.
#[derive(FromPyObject)]
pub(crate) enum Source<'py> {
    Scene(PyRef<'py, Scene>),
    File(PathBuf),
}

/// The names of the methods.
#[pyfunction]
pub(crate) fn methods() -> Vec<&'static str> {
    fredholm_study::view_factor_methods()
}

/// Computes view factors.
#[pyfunction]
pub(crate) fn view_factors(
    py: Python<'_>,
    source: Source<'_>,
    asked: Asked,
    how: How,
) -> PyResult<Py<PyAny>> {
    let problem = asked.problem.options(py)?;
    let input = match source {
        Source::Scene(scene) => ViewFactorOptions::new(Arc::clone(&scene.0)),
        Source::File(path) => ViewFactorOptions::new(path.as_path()),
    };
    let options = ViewFactorOptions {
        tolerance: asked.tolerance,
        method: asked.method,
        setting: asked.setting,
        rows: rows(py, &asked.rows)?,
        threshold: asked.threshold,
        close: asked.close,
        sky: asked.sky,
        points: points(py, &asked.points)?,
        threads: problem.threads,
        memory: problem.memory,
        ..input
    };
    let work = move |watch: &dyn fredholm_study::Watch| solve_view_factors(&options, watch);
    run(py, how, work, |found| Ok(Py::new(py, ViewFactors(found))?.into_any()))
}

fn rows(py: Python<'_>, name: &str) -> PyResult<MatrixRows> {
    match name {
        "element" => Ok(MatrixRows::Element),
        "face" => Ok(MatrixRows::Face),
        "surface" => Ok(MatrixRows::Surface),
        _ => Err(input(py, format!("rows are no {name:?}"), Some("use element, face or surface"))),
    }
}

/// A matrix of view factors.
#[pyclass(frozen, module = "fredholm._core")]
pub(crate) struct ViewFactors(SolvedViewFactors);

/// Starts of rows, columns and values.
type Csr<'py> = (Bound<'py, PyArray1<i64>>, Bound<'py, PyArray1<i32>>, Bound<'py, PyArray2<f64>>);

#[pymethods]
impl ViewFactors {
    /// All factors, rows × rows; none where only those above a threshold are kept.
    #[getter]
    fn dense<'py>(slf: &Bound<'py, Self>) -> PyResult<Option<Bound<'py, PyArray2<f64>>>> {
        let found = &slf.get().0;
        match &found.factors.factors {
            Factors::Dense(values) => Ok(Some(shared(slf.clone().into_any(), values, found.factors.len())?)),
            Factors::Sparse(_) => Ok(None),
        }
    }

    /// The factors that are kept, as compressed rows; none where all are.
    #[getter]
    fn sparse<'py>(slf: &Bound<'py, Self>) -> PyResult<Option<Csr<'py>>> {
        let py = slf.py();
        let Factors::Sparse(sparse) = &slf.get().0.factors.factors else { return Ok(None) };
        let starts = PyArray1::from_iter(py, sparse.starts.iter().map(|&start| start as i64));
        let columns = PyArray1::from_iter(py, sparse.columns.iter().map(|&column| column as i32));
        Ok(Some((starts, columns, shared(slf.clone().into_any(), &sparse.values, 1)?)))
    }

    /// Where the stored factors lie in memory.
    fn address(&self) -> usize {
        match &self.0.factors.factors {
            Factors::Dense(values) => values.as_ptr() as usize,
            Factors::Sparse(sparse) => sparse.values.as_ptr() as usize,
        }
    }

    /// Stated error of every stored factor, in their order.
    #[getter]
    fn errors<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyArray2<f32>>> {
        moved(py, self.0.factors.errors.clone(), 1)
    }

    #[getter]
    fn names(&self) -> Vec<String> {
        self.0.factors.surfaces.names.clone()
    }

    /// Area, stated error of the sum, sum and dropped sum of every row.
    #[getter]
    fn rows<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyArray2<f64>>> {
        let factors = &self.0.factors;
        let row = |i: usize| {
            [
                factors.surfaces.area[i],
                factors.surfaces.row_error[i],
                factors.row_sums[i],
                factors.row_dropped[i],
            ]
        };
        moved(py, (0..factors.len()).flat_map(row).collect(), 4)
    }

    /// What points see, points × rows.
    #[getter]
    fn points<'py>(&self, py: Python<'py>) -> PyResult<Option<Bound<'py, PyArray2<f64>>>> {
        let factors = &self.0.factors;
        factors.points.as_ref().map(|points| moved(py, points.factors.clone(), factors.len())).transpose()
    }

    /// The record of the run as JSON.
    #[getter]
    fn record(&self) -> PyResult<String> {
        serde_json::to_string(&self.0.record).map_err(internal)
    }

    /// Writes the matrix, in the form of the ending of the name, and what comes beside it.
    fn write(&self, py: Python<'_>, file: PathBuf) -> PyResult<()> {
        let written =
            py.detach(|| MatrixFiles::new(&file, Some(&file), None).and_then(|files| self.0.write(&files)));
        written.map_err(|error| failure(py, &error))
    }
}
