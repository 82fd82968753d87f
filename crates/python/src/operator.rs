//! A matrix or an operator of Python as the coupling of a system: K = I − A/s, so that A/s = I − K.
//!
//! s is a power of two near the size of A. Division by it is exact, and keeps what is lost when an
//! entry is taken from 1 as small beside the largest entries as rounding is.

use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::{Mutex, OnceLock, PoisonError};

use fredholm_linop::{Dense, LinearOperator, LinopError, MultiVector, Scalar, Symmetry};
use numpy::ndarray::ArrayView2;
use numpy::{Element, PyArray1, PyReadonlyArray1};
use pyo3::exceptions::{PyRuntimeError, PyValueError};
use pyo3::prelude::*;

/// I − A/s of the entries of A. Where nothing is said of the symmetry of A, it is looked at.
pub(crate) fn dense<T: Scalar>(
    entries: ArrayView2<'_, T>,
    scale: f64,
    symmetric: Option<bool>,
) -> Result<Dense<T>, LinopError> {
    let coupling = Dense::from_rows(entries.nrows(), |i, row| {
        row.iter_mut().zip(entries.row(i)).for_each(|(k, a)| *k = -a.scale(scale.recip()));
        row[i] += T::one();
    })?;
    match symmetric {
        Some(symmetric) => coupling.with_symmetry(symmetry::<T>(symmetric)),
        None => Ok(coupling.with_found_symmetry()),
    }
}

/// The symmetry that solvers ask for, or none.
pub(crate) fn symmetry<T: Scalar>(symmetric: bool) -> Symmetry {
    match (symmetric, T::IS_REAL) {
        (false, _) => Symmetry::General,
        (true, true) => Symmetry::Symmetric,
        (true, false) => Symmetry::Hermitian,
    }
}

/// A function of Python that multiplies a vector and returns an array of the same numbers.
pub(crate) struct Operator<T> {
    matvec: Py<PyAny>,
    dim: usize,
    scale: f64,
    symmetry: Symmetry,
    /// Whether a product has failed, and how.
    pub(crate) failed: AtomicBool,
    error: Mutex<Option<PyErr>>,
    /// All entries, once a solver has asked for some: n products, each computed once.
    entries: OnceLock<Result<Dense<T>, LinopError>>,
}

impl<T: Scalar + Element> Operator<T> {
    pub(crate) fn new(matvec: Py<PyAny>, dim: usize, scale: f64, symmetry: Symmetry) -> Self {
        let (failed, error, entries) = (AtomicBool::new(false), Mutex::new(None), OnceLock::new());
        Self { matvec, dim, scale, symmetry, failed, error, entries }
    }

    /// What a product has raised.
    pub(crate) fn raised(&self) -> Option<PyErr> {
        self.error.lock().unwrap_or_else(PoisonError::into_inner).take()
    }

    /// A v, or nothing where Python raised an exception or has ended.
    fn product(&self, v: Vec<T>) -> Option<Vec<T>> {
        if self.failed.load(Ordering::Relaxed) {
            return None;
        }
        let ended = || Err(PyRuntimeError::new_err("the interpreter has ended"));
        let product = Python::try_attach(|py| self.call(py, v)).unwrap_or_else(ended);
        product.map_err(|error| self.fail(error)).ok()
    }

    fn call(&self, py: Python<'_>, v: Vec<T>) -> PyResult<Vec<T>> {
        let product = self.matvec.bind(py).call1((PyArray1::from_vec(py, v),))?;
        let values: PyReadonlyArray1<'_, T> = product.extract()?;
        let found = values.as_array().len();
        if found != self.dim {
            let text = format!("matvec returned {found} numbers, but the operator has {} rows", self.dim);
            return Err(PyValueError::new_err(text));
        }
        Ok(values.as_array().iter().copied().collect())
    }

    fn fail(&self, error: PyErr) {
        self.failed.store(true, Ordering::Relaxed);
        self.error.lock().unwrap_or_else(PoisonError::into_inner).get_or_insert(error);
    }

    /// All entries of K.
    fn all(&self) -> Result<&Dense<T>, LinopError> {
        let columns = || -> Result<Dense<T>, LinopError> {
            let mut all = Dense::zeros(self.dim)?;
            for j in 0..self.dim {
                let mut unit = MultiVector::zeros(self.dim, 1);
                unit.row_mut(j)[0] = T::one();
                let mut image = MultiVector::zeros(self.dim, 1);
                self.apply(&unit, &mut image);
                (0..self.dim).for_each(|i| all.row_slice_mut(i)[j] = image.row(i)[0]);
            }
            Ok(all)
        };
        self.entries.get_or_init(columns).as_ref().map_err(Clone::clone)
    }

    /// Something of all entries; where these do not fit, the run fails.
    fn of_all<R>(&self, of: impl FnOnce(&Dense<T>) -> R) -> Option<R> {
        match self.all() {
            Ok(all) => Some(of(all)),
            Err(error) => {
                self.fail(pyo3::exceptions::PyMemoryError::new_err(error.to_string()));
                None
            }
        }
    }
}

impl<T: Scalar + Element> LinearOperator<T> for Operator<T> {
    fn dim(&self) -> usize {
        self.dim
    }

    fn apply(&self, x: &MultiVector<T>, y: &mut MultiVector<T>) {
        for rhs in 0..x.rhs_count() {
            // After a failure the numbers do not matter: the run ends.
            let product = self.product(x.vector(rhs)).unwrap_or_else(|| vec![T::zero(); self.dim]);
            let rest = |i: usize| x.row(i)[rhs] - product[i].scale(self.scale.recip());
            (0..self.dim).for_each(|i| y.row_mut(i)[rhs] = rest(i));
        }
    }

    fn symmetry(&self) -> Symmetry {
        self.symmetry
    }

    fn row(&self, i: usize, _rhs: usize, out: &mut [T]) {
        self.of_all(|all| out.copy_from_slice(all.row_slice(i)));
    }

    fn column(&self, j: usize, rhs: usize, out: &mut [T]) {
        self.of_all(|all| all.column(j, rhs, out));
    }

    fn diagonal(&self, rhs: usize, out: &mut [T]) {
        self.of_all(|all| all.diagonal(rhs, out));
    }

    fn dense(&self, rhs: usize) -> Result<Dense<T>, LinopError> {
        self.all()?.dense(rhs)
    }
}
