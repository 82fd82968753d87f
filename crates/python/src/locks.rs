//! Locks beside the lock of the interpreter.

use std::sync::{Mutex, MutexGuard, PoisonError};

use pyo3::prelude::*;
use pyo3::sync::MutexExt;

/// What is held while a value is looked at.
pub(crate) type Guard<'a, T> = MutexGuard<'a, T>;

/// The value, for a thread that does not hold the lock of the interpreter.
pub(crate) fn locked<T>(mutex: &Mutex<T>) -> Guard<'_, T> {
    mutex.lock().unwrap_or_else(PoisonError::into_inner)
}

/// The value, for a thread that holds the lock of the interpreter, which it gives away while it
/// waits: the other thread may need it before it is done.
pub(crate) fn attached<T>(mutex: &Mutex<T>) -> Guard<'_, T> {
    Python::attach(|py| mutex.lock_py_attached(py).unwrap_or_else(PoisonError::into_inner))
}
