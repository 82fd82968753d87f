//! The couplings of a scene, as operators that SciPy takes.

use std::sync::Arc;

use fredholm_coupling::Radiosity;
use fredholm_linop::{LinearOperator, MultiVector, PackedSymmetric};
use numpy::{PyArray1, PyArray2, PyReadonlyArray2, PyUntypedArrayMethods};
use pyo3::prelude::*;

use crate::arrays::moved;
use crate::failure::{input, internal};
use crate::options::Problem;
use crate::run::{How, run};
use crate::scene::Scene;

/// Computes the couplings of the elements of a scene.
#[pyfunction]
pub(crate) fn couplings(py: Python<'_>, scene: &Scene, problem: Problem, how: How) -> PyResult<Py<PyAny>> {
    let (scene, options) = (Arc::clone(&scene.0), problem.options(py)?);
    let work = move |watch: &dyn fredholm_study::Watch| fredholm_study::couplings(scene, &options, watch);
    run(py, how, work, |found| Ok(Py::new(py, Couplings::new(found))?.into_any()))
}

/// What the elements of a scene exchange.
#[pyclass(frozen, module = "fredholm._core")]
pub(crate) struct Couplings {
    exchange: Arc<PackedSymmetric<f64>>,
    radiosity: Radiosity,
    row_error: Vec<f64>,
}

impl Couplings {
    fn new(found: fredholm_study::Couplings) -> Self {
        let fredholm_study::Couplings { exchange, radiosity, row_error, .. } = found;
        Self { exchange: Arc::new(exchange), radiosity, row_error }
    }

    /// Areas to a power.
    fn areas(&self, power: f64) -> Vec<f64> {
        self.radiosity.elements().iter().map(|element| element.area.powf(power)).collect()
    }

    fn operator(&self, left: Vec<f64>, right: Vec<f64>, second_kind: bool) -> Coupling {
        Coupling { exchange: Arc::clone(&self.exchange), left, right, second_kind }
    }

    fn ones(&self) -> Vec<f64> {
        vec![1.0; self.exchange.dim()]
    }
}

#[pymethods]
impl Couplings {
    /// G, m².
    fn exchange(&self) -> Coupling {
        self.operator(self.ones(), self.ones(), false)
    }

    /// F = A⁻¹ G.
    fn view_factors(&self) -> Coupling {
        self.operator(self.areas(-1.0), self.ones(), false)
    }

    /// A^(−1/2) G A^(−1/2), which is symmetric and has the eigenvalues of F.
    fn symmetric(&self) -> Coupling {
        self.operator(self.areas(-0.5), self.areas(-0.5), false)
    }

    /// I − R F of a band.
    fn system(&self, py: Python<'_>, band: usize) -> PyResult<Coupling> {
        let scaling = self.radiosity.scaling();
        if band >= scaling.rhs_count() {
            let text = format!("there is no band {band}; there are {}", scaling.rhs_count());
            return Err(input(py, text, Some("count the bands from 0")));
        }
        Ok(self.operator(scaling.vector(band), self.ones(), true))
    }

    #[getter]
    fn area<'py>(&self, py: Python<'py>) -> Bound<'py, PyArray1<f64>> {
        PyArray1::from_vec(py, self.areas(1.0))
    }

    #[getter]
    fn row_error<'py>(&self, py: Python<'py>) -> Bound<'py, PyArray1<f64>> {
        PyArray1::from_vec(py, self.row_error.clone())
    }

    /// Reflectance of the elements, elements × bands.
    #[getter]
    fn reflectance<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyArray2<f64>>> {
        let values = self.radiosity.reflectance();
        moved(py, values.as_slice().to_vec(), values.rhs_count())
    }

    /// Exitance of the elements, elements × bands, W/m².
    #[getter]
    fn exitance<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyArray2<f64>>> {
        let values = self.radiosity.exitance();
        moved(py, values.as_slice().to_vec(), values.rhs_count())
    }
}

/// L G R, or I − L G R, with diagonal L and R.
#[pyclass(frozen, module = "fredholm._core")]
pub(crate) struct Coupling {
    exchange: Arc<PackedSymmetric<f64>>,
    left: Vec<f64>,
    right: Vec<f64>,
    second_kind: bool,
}

impl Coupling {
    /// The product of the operator with the vectors in the columns of x, first scaled by `before`.
    fn apply(&self, x: &MultiVector<f64>, [before, after]: [&[f64]; 2]) -> MultiVector<f64> {
        let scale = |v: &mut MultiVector<f64>, factors: &[f64]| {
            for (i, factor) in factors.iter().enumerate() {
                v.row_mut(i).iter_mut().for_each(|value| *value *= factor);
            }
        };
        let (mut scaled, mut product) = (x.clone(), MultiVector::zeros(x.dim(), x.rhs_count()));
        scale(&mut scaled, before);
        self.exchange.apply(&scaled, &mut product);
        scale(&mut product, after);
        if self.second_kind {
            product.as_mut_slice().iter_mut().zip(x.as_slice()).for_each(|(y, x)| *y = x - *y);
        }
        product
    }

    fn product<'py>(
        &self,
        py: Python<'py>,
        x: &PyReadonlyArray2<'py, f64>,
        scales: [&[f64]; 2],
    ) -> PyResult<Bound<'py, PyArray2<f64>>> {
        let [rows, columns] = [x.shape()[0], x.shape()[1]];
        if rows != self.exchange.dim() {
            let text =
                format!("the vector has {rows} entries, but the operator {} columns", self.exchange.dim());
            return Err(input(py, text, None));
        }
        let values = x.as_array().iter().copied().collect();
        let x = MultiVector::from_vec(rows, columns, values).map_err(internal)?;
        let product = py.detach(|| self.apply(&x, scales));
        moved(py, product.as_slice().to_vec(), columns)
    }
}

#[pymethods]
impl Coupling {
    #[getter]
    fn shape(&self) -> (usize, usize) {
        (self.exchange.dim(), self.exchange.dim())
    }

    /// The product with each column.
    fn matmat<'py>(
        &self,
        py: Python<'py>,
        x: PyReadonlyArray2<'py, f64>,
    ) -> PyResult<Bound<'py, PyArray2<f64>>> {
        self.product(py, &x, [&self.right, &self.left])
    }

    /// The product of the transposed operator with each column.
    fn rmatmat<'py>(
        &self,
        py: Python<'py>,
        x: PyReadonlyArray2<'py, f64>,
    ) -> PyResult<Bound<'py, PyArray2<f64>>> {
        self.product(py, &x, [&self.left, &self.right])
    }
}
