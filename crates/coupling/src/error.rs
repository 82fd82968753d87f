//! What can stop an assembly.

use fredholm_linop::LinopError;
use thiserror::Error;

/// Why there is no matrix.
#[derive(Clone, Debug, Error, PartialEq)]
#[non_exhaustive]
pub enum CouplingError {
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
