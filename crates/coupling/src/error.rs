//! What can stop an assembly.

use fredholm_linop::LinopError;
use thiserror::Error;

/// Why there is no matrix.
#[derive(Clone, Debug, Error, PartialEq)]
#[non_exhaustive]
pub enum CouplingError {
    /// The matrix does not fit the memory allowed.
    #[error(
        "the form-factor matrix of {elements} elements needs {needed} bytes and {limit} are allowed; use fewer elements \
         (elements_per_face, divide, largest_edge), storage = \"f32\", or a larger limit"
    )]
    Memory {
        /// Number of elements.
        elements: usize,
        /// Bytes needed.
        needed: u64,
        /// Bytes allowed.
        limit: u64,
    },
    /// The operating system refused the memory.
    #[error(
        "the system has no {needed} bytes for the form-factor matrix; use fewer elements or storage = \"f32\""
    )]
    Allocation {
        /// Bytes asked for.
        needed: u64,
    },
    /// The caller asked to stop.
    #[error(
        "stopped during the assembly of the form factors, after {done} of {total} pairs; there is no partial result"
    )]
    Interrupted {
        /// Pairs computed.
        done: u64,
        /// Pairs in all.
        total: u64,
    },
    /// The tolerance is not a number between 0 and 1.
    #[error("the form-factor tolerance {0} is not between 1e-15 and 1")]
    Tolerance(f64),
    /// Arrays that do not fit each other.
    #[error("{elements} elements have data for {found}")]
    Dimension {
        /// Number of elements.
        elements: usize,
        /// Length found.
        found: usize,
    },
    /// A matrix that does not fit its vectors.
    #[error(transparent)]
    Linop(#[from] LinopError),
}
