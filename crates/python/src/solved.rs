//! Solved scenes.

use std::path::PathBuf;
use std::sync::{Arc, Mutex};

use fredholm_mesh::{Mesh, Patch};
use fredholm_study::{Ended, FalseColour, SolveOptions, claim_folder};
use numpy::PyArray2;
use pyo3::prelude::*;
use pyo3::types::PyBytes;

use crate::arrays::{moved, shared};
use crate::failure::{failure, internal};
use crate::locks::{Guard, attached, locked};
use crate::options::{Problem, Stop, way};
use crate::run::{How, run};
use crate::scene::Scene;

/// A two-dimensional array of numbers.
type Array<'py, T> = Bound<'py, PyArray2<T>>;

/// What is asked of a solution.
#[derive(FromPyObject)]
#[pyo3(from_item_all)]
#[allow(clippy::struct_excessive_bools, reason = "each is a switch of its own")]
pub(crate) struct Asked {
    accuracy: Option<f64>,
    way: Option<String>,
    goal: Vec<String>,
    final_gather: bool,
    /// A band in false colour; all of them where it has no name.
    false_colour: Option<String>,
    discontinuity: bool,
    pictures: bool,
    report: bool,
    problem: Problem,
    stop: Stop,
}

/// Solves a scene.
#[pyfunction]
pub(crate) fn solve(py: Python<'_>, scene: &Scene, asked: Asked, how: How) -> PyResult<Py<PyAny>> {
    let options = SolveOptions {
        accuracy: asked.accuracy,
        way: asked.way.map(|name| way(py, &name)).transpose()?,
        goal: asked.goal,
        final_gather: asked.final_gather,
        false_colour: asked
            .false_colour
            .map(|band| FalseColour { band: Some(band).filter(|b| !b.is_empty()) }),
        discontinuity: asked.discontinuity,
        no_pictures: !asked.pictures,
        no_report: !asked.report,
        problem: asked.problem.options(py)?,
        stop: asked.stop.into(),
        ..SolveOptions::default()
    };
    let scene = Arc::clone(&scene.0);
    let work = move |watch: &dyn fredholm_study::Watch| {
        fredholm_study::solve(scene, &options, watch).map(fredholm_study::Solved::unwatched)
    };
    run(py, how, work, |solved| Ok(Py::new(py, Solved(Mutex::new(solved)))?.into_any()))
}

/// How a study ended, in the words of Python.
pub(crate) fn ending(ended: Ended) -> &'static str {
    match ended {
        Ended::Done => "done",
        Ended::NotConverged => "not converged",
        Ended::Interrupted => "interrupted",
    }
}

/// A solved scene. It is never changed: what writes it notes only where.
#[pyclass(frozen, module = "fredholm._core")]
pub(crate) struct Solved(Mutex<fredholm_study::Solved<'static>>);

impl Solved {
    fn get(&self) -> Guard<'_, fredholm_study::Solved<'static>> {
        attached(&self.0)
    }
}

/// Three numbers of every element.
fn triples<'py>(py: Python<'py>, mesh: &Mesh, of: impl Fn(&Patch) -> [f64; 3]) -> PyResult<Array<'py, f64>> {
    moved(py, mesh.patches().flat_map(of).collect(), 3)
}

#[pymethods]
impl Solved {
    #[getter]
    fn irradiance<'py>(slf: &Bound<'py, Self>) -> PyResult<Array<'py, f64>> {
        let solved = slf.get().get();
        let values = solved.irradiance();
        shared(slf.clone().into_any(), values.as_slice(), values.rhs_count())
    }

    #[getter]
    fn radiosity<'py>(slf: &Bound<'py, Self>) -> PyResult<Array<'py, f64>> {
        let solved = slf.get().get();
        let values = solved.radiosity();
        shared(slf.clone().into_any(), values.as_slice(), values.rhs_count())
    }

    /// Where the irradiance and the radiosity lie in memory.
    fn addresses(&self) -> [usize; 2] {
        let solved = self.get();
        [solved.irradiance(), solved.radiosity()].map(|values| values.as_slice().as_ptr() as usize)
    }

    #[getter]
    fn area<'py>(&self, py: Python<'py>) -> PyResult<Array<'py, f64>> {
        moved(py, self.get().mesh().patches().map(Patch::area).collect(), 1)
    }

    #[getter]
    fn centroid<'py>(&self, py: Python<'py>) -> PyResult<Array<'py, f64>> {
        triples(py, self.get().mesh(), |patch| patch.centroid().to_array())
    }

    #[getter]
    fn normal<'py>(&self, py: Python<'py>) -> PyResult<Array<'py, f64>> {
        triples(py, self.get().mesh(), |patch| patch.normal().to_array())
    }

    /// Corners of the elements one after the other.
    #[getter]
    fn corners<'py>(&self, py: Python<'py>) -> PyResult<Array<'py, f64>> {
        let solved = self.get();
        let corners = solved.mesh().patches().flat_map(|patch| patch.corners().to_vec());
        moved(py, corners.flat_map(|corner| corner.to_array()).collect(), 3)
    }

    /// Number of corners, face and surface of every element.
    #[getter]
    fn indices<'py>(&self, py: Python<'py>) -> PyResult<Array<'py, i64>> {
        let solved = self.get();
        let mesh = solved.mesh();
        let of = |leaf: usize| [mesh.patch(leaf).sides(), mesh.face_of(leaf), mesh.surface_of(leaf)];
        moved(py, (0..mesh.len()).flat_map(of).map(|index| index as i64).collect(), 3)
    }

    /// Areas and centroids of the faces: four numbers each.
    #[getter]
    fn faces<'py>(&self, py: Python<'py>) -> PyResult<Array<'py, f64>> {
        let solved = self.get();
        let of = |face: &fredholm_mesh::Face| {
            let [x, y, z] = face.centroid.to_array();
            [face.area, x, y, z]
        };
        moved(py, solved.mesh().faces().iter().flat_map(of).collect(), 4)
    }

    /// Surface of every face.
    #[getter]
    fn face_surface<'py>(&self, py: Python<'py>) -> PyResult<Array<'py, i64>> {
        moved(py, self.get().mesh().faces().iter().map(|face| face.surface as i64).collect(), 1)
    }

    /// Mean irradiance and radiosity of the faces, each faces × bands.
    #[getter]
    fn face_means<'py>(&self, py: Python<'py>) -> PyResult<[Array<'py, f64>; 2]> {
        let [irradiance, radiosity] = self.get().face_means().map_err(|error| failure(py, &error))?;
        let array = |values: &fredholm_linop::MultiVector<f64>| {
            moved(py, values.as_slice().to_vec(), values.rhs_count())
        };
        Ok([array(&irradiance)?, array(&radiosity)?])
    }

    /// Stated error of the irradiance of the faces, faces × bands.
    #[getter]
    fn face_errors<'py>(&self, py: Python<'py>) -> PyResult<Option<Array<'py, f64>>> {
        let solved = self.get();
        let bands = solved.scene().bands().len();
        solved.face_errors().map(|errors| moved(py, errors, bands)).transpose()
    }

    /// Names of the surfaces, and the numbers of their materials.
    #[getter]
    fn surfaces(&self) -> Vec<(String, usize)> {
        self.get().mesh().surfaces().iter().map(|surface| (surface.name.clone(), surface.material)).collect()
    }

    /// Mean irradiance of a surface and its stated error, per band.
    fn surface(&self, name: &str) -> Option<(Vec<f64>, Vec<f64>)> {
        self.get().surface(name).map(|light| (light.irradiance, light.error))
    }

    #[getter]
    fn relative_error(&self) -> Option<f64> {
        self.get().relative_error()
    }

    #[getter]
    fn ended(&self) -> &'static str {
        ending(self.get().ended())
    }

    #[getter]
    fn remarks(&self) -> Vec<String> {
        self.get().remarks().collect()
    }

    /// The record of the run as JSON.
    #[getter]
    fn record(&self) -> PyResult<String> {
        serde_json::to_string(&self.get().record()).map_err(internal)
    }

    /// A picture of so many pixels in width: a PNG file.
    fn picture<'py>(&self, py: Python<'py>, width: u32) -> PyResult<Bound<'py, PyBytes>> {
        let png = py.detach(|| locked(&self.0).picture(width)).map_err(|error| failure(py, &error))?;
        Ok(PyBytes::new(py, &png))
    }

    /// Writes all results into a folder.
    fn write(&self, py: Python<'_>, folder: PathBuf) -> PyResult<()> {
        let written = py.detach(|| {
            let folder = claim_folder(&folder, "another path")?;
            locked(&self.0).write(&folder).map(drop)
        });
        written.map_err(|error| failure(py, &error))
    }
}
