//! Scenes.

use std::collections::BTreeMap;
use std::path::PathBuf;
use std::sync::Arc;

use pyo3::prelude::*;

use crate::failure;

/// A scene that was read and checked.
#[pyclass(frozen, module = "fredholm._core")]
pub(crate) struct Scene(pub(crate) Arc<fredholm_scene::Scene>);

/// A material: name, reflectance and exitance, per band.
type Material = (String, Vec<f64>, Vec<f64>);

#[pymethods]
impl Scene {
    /// Reads a scene file or a mesh file.
    #[staticmethod]
    fn load(py: Python<'_>, path: PathBuf) -> PyResult<Self> {
        let loaded = py.detach(|| fredholm_scene::Scene::load(path));
        loaded.map(|scene| Self(Arc::new(scene))).map_err(|error| failure::scene(py, &error))
    }

    /// Reads a scene from text, and the files that it names from memory.
    #[staticmethod]
    fn from_memory(
        py: Python<'_>,
        text: String,
        path: PathBuf,
        files: BTreeMap<PathBuf, Vec<u8>>,
    ) -> PyResult<Self> {
        let read = py.detach(|| fredholm_scene::Scene::from_memory(&text, path, files));
        read.map(|scene| Self(Arc::new(scene))).map_err(|error| failure::scene(py, &error))
    }

    #[getter]
    fn path(&self) -> PathBuf {
        self.0.path().to_owned()
    }

    #[getter]
    fn title(&self) -> Option<&str> {
        self.0.title()
    }

    #[getter]
    fn bands(&self) -> Vec<String> {
        self.0.bands().to_vec()
    }

    #[getter]
    fn materials(&self) -> Vec<Material> {
        let material =
            |m: &fredholm_scene::Material| (m.name.clone(), m.reflectance.clone(), m.exitance.clone());
        self.0.materials().iter().map(material).collect()
    }

    #[getter]
    fn sha256(&self) -> &str {
        self.0.sha256()
    }

    #[getter]
    fn notes(&self) -> Vec<String> {
        self.0.notes().iter().map(ToString::to_string).collect()
    }

    /// Elements and faces that the mesh will have.
    #[getter]
    fn predicted(&self) -> (u128, u128) {
        (self.0.predicted_elements(), self.0.predicted_faces())
    }
}
