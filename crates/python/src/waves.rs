//! Scenes of waves.

use std::path::PathBuf;
use std::sync::Mutex;

use fredholm_report::{FarRow, MonostaticRow, WaveRow};
use fredholm_study::{
    Error, ErrorKind, SolvedWaves, Watch, WaveCompareOptions, WaveMethod, WaveOptions, claim_folder,
};
use numpy::{Complex64, PyArray2};
use pyo3::prelude::*;

use crate::arrays::moved;
use crate::failure::{failure, internal};
use crate::locks::{Guard, attached, locked};
use crate::options::Problem;
use crate::run::{How, run};
use crate::solved::ending;

/// Computes the fields of a scene of waves, whose file is given.
#[pyfunction]
pub(crate) fn waves(
    py: Python<'_>,
    path: PathBuf,
    report: bool,
    problem: Problem,
    how: How,
) -> PyResult<Py<PyAny>> {
    let options =
        WaveOptions { memory: problem.options(py)?.memory, no_report: !report, ..WaveOptions::default() };
    let work =
        move |watch: &dyn Watch| fredholm_study::waves(path, &options, watch).map(SolvedWaves::unwatched);
    run(py, how, work, |solved| Ok(Py::new(py, Waves(Mutex::new(solved)))?.into_any()))
}

/// Runs solvers on the coupling of a scene of waves.
#[pyfunction]
pub(crate) fn compare_waves(
    py: Python<'_>,
    path: PathBuf,
    asked: (Vec<String>, f64, u32),
    problem: Problem,
    how: How,
) -> PyResult<Py<PyAny>> {
    let options =
        WaveOptions { memory: problem.options(py)?.memory, no_report: true, ..WaveOptions::default() };
    let (solvers, tolerance, max_iterations) = asked;
    let solvers = WaveCompareOptions { solvers, tolerance, max_iterations };
    crate::studies::study(py, how, move |folder, watch| {
        let (record, ended) = fredholm_study::compare_waves(path, &options, &solvers, folder, watch)?;
        Ok((serde_json::to_string(&record), ending(ended)))
    })
}

/// Finds the currents of a scene of waves by several methods.
#[pyfunction]
pub(crate) fn compare_wave_methods(
    py: Python<'_>,
    path: PathBuf,
    methods: Vec<String>,
    problem: Problem,
    how: How,
) -> PyResult<Py<PyAny>> {
    let options =
        WaveOptions { memory: problem.options(py)?.memory, no_report: true, ..WaveOptions::default() };
    let methods =
        WaveMethod::list(&methods).map_err(|text| failure(py, &Error::new(ErrorKind::Input, text)))?;
    crate::studies::study(py, how, move |folder, watch| {
        let (record, ended) = fredholm_study::compare_wave_methods(path, &options, &methods, folder, watch)?;
        Ok((serde_json::to_string(&record), ending(ended)))
    })
}

/// The fields of a scene of waves.
#[pyclass(frozen, module = "fredholm._core")]
pub(crate) struct Waves(Mutex<SolvedWaves<'static>>);

/// Where and when a row is: receiver, index, then numbers of the place, and the frequency.
type Places<'py> = Bound<'py, PyArray2<f64>>;
/// Phasors.
type Phasors<'py> = Bound<'py, PyArray2<Complex64>>;

impl Waves {
    fn get(&self) -> Guard<'_, SolvedWaves<'static>> {
        attached(&self.0)
    }
}

/// Numbers, real part first, as phasors.
fn phasors(values: &[f64]) -> impl Iterator<Item = Complex64> {
    values.chunks_exact(2).map(|pair| Complex64::new(pair[0], pair[1]))
}

#[pymethods]
impl Waves {
    /// Receiver, index, x, y, z (m) and frequency (Hz) of the points; incident and scattered E and
    /// H.
    #[getter]
    fn near<'py>(&self, py: Python<'py>) -> PyResult<(Places<'py>, Phasors<'py>, Phasors<'py>)> {
        let solved = self.get();
        let place = |row: &WaveRow| {
            let [x, y, z] = row.position;
            [row.receiver as f64, row.index as f64, x, y, z, row.frequency]
        };
        let all = |of: fn(&WaveRow) -> &[f64; 12]| {
            moved(py, solved.near().iter().flat_map(|row| phasors(of(row))).collect(), 6)
        };
        let places = moved(py, solved.near().iter().flat_map(place).collect(), 6)?;
        Ok((places, all(|row| &row.incident)?, all(|row| &row.scattered)?))
    }

    /// Receiver, index, θ, φ (degrees), frequency (Hz) and two radar cross-sections (m², NaN where
    /// there is none) of the directions; amplitudes along θ and φ, V.
    #[getter]
    fn far<'py>(&self, py: Python<'py>) -> PyResult<(Places<'py>, Phasors<'py>)> {
        let solved = self.get();
        let place = |row: &FarRow| {
            let [theta, phi] = row.cross_section.unwrap_or([f64::NAN; 2]);
            [
                row.receiver as f64,
                row.index as f64,
                row.theta_degrees,
                row.phi_degrees,
                row.frequency,
                theta,
                phi,
            ]
        };
        let amplitudes = solved.far().iter().flat_map(|row| phasors(&row.amplitude)).collect();
        Ok((moved(py, solved.far().iter().flat_map(place).collect(), 7)?, moved(py, amplitudes, 2)?))
    }

    /// Receiver, index, θ, φ (degrees) and frequency (Hz) of the directions; S_θθ, S_φθ, S_θφ and
    /// S_φφ, m, received then incident.
    #[getter]
    fn monostatic<'py>(&self, py: Python<'py>) -> PyResult<(Places<'py>, Phasors<'py>)> {
        let solved = self.get();
        let place = |row: &MonostaticRow| {
            [row.receiver as f64, row.index as f64, row.theta_degrees, row.phi_degrees, row.frequency]
        };
        let scattering = |row: &MonostaticRow| row.scattering.map(|[re, im]| Complex64::new(re, im));
        let all = solved.monostatic().iter().flat_map(scattering).collect();
        Ok((moved(py, solved.monostatic().iter().flat_map(place).collect(), 5)?, moved(py, all, 4)?))
    }

    #[getter]
    fn receivers(&self) -> Vec<String> {
        let solved = self.get();
        (0..).map_while(|number| solved.receiver(number).map(str::to_owned)).collect()
    }

    #[getter]
    fn ended(&self) -> &'static str {
        ending(self.get().ended())
    }

    /// The record of the run as JSON.
    #[getter]
    fn record(&self) -> PyResult<String> {
        serde_json::to_string(&self.get().record()).map_err(internal)
    }

    /// Writes all results into a folder.
    fn write(&self, py: Python<'_>, folder: PathBuf) -> PyResult<()> {
        let written = py.detach(|| {
            let folder = claim_folder(&folder, "another path")?;
            locked(&self.0).write(&folder)
        });
        written.map_err(|error| failure(py, &error))
    }
}
