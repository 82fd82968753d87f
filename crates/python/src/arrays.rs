//! Arrays of NumPy that share the memory of a result, or take a vector over.

use numpy::ndarray::ArrayView2;
use numpy::{Element, PyArray2, PyArrayMethods};
use pyo3::prelude::*;

/// A vector moved into an array of `columns` columns.
pub(crate) fn moved<T: Element>(
    py: Python<'_>,
    values: Vec<T>,
    columns: usize,
) -> PyResult<Bound<'_, PyArray2<T>>> {
    let rows = values.len().checked_div(columns).unwrap_or(0);
    numpy::PyArray1::from_vec(py, values).reshape([rows, columns])
}

/// An array, which cannot be written to, over numbers that `owner` holds: rows of `columns`
/// numbers.
///
/// `owner` must be immutable from Python, and must neither change nor move the numbers while it
/// lives; the array keeps it alive.
pub(crate) fn shared<'py>(
    owner: Bound<'py, PyAny>,
    values: &[f64],
    columns: usize,
) -> PyResult<Bound<'py, PyArray2<f64>>> {
    let rows = values.len().checked_div(columns).unwrap_or(0);
    let view = ArrayView2::from_shape((rows, columns), values).map_err(crate::failure::internal)?;
    // SAFETY: every caller in this crate passes the object that owns the buffer of `values`, a
    // frozen class that has no method that changes or moves it, and the array becomes read-only
    // before anyone sees it.
    #[allow(unsafe_code, reason = "NumPy is told of memory that a result owns")]
    let array = unsafe { PyArray2::borrow_from_array(&view, owner) };
    array.readwrite().make_nonwriteable();
    Ok(array)
}
