//! What can be wrong with a matrix that is to be compressed.

use thiserror::Error;

/// A matrix that cannot be compressed as asked.
#[derive(Clone, Debug, Error, PartialEq)]
#[non_exhaustive]
pub enum CompressionError {
    /// The number of places is not that of the groups of unknowns.
    #[error("there are {found} places for {expected} groups of unknowns")]
    Places {
        /// Groups of the matrix.
        expected: usize,
        /// Places given.
        found: usize,
    },
    /// A place is NaN or infinite.
    #[error("the place of group {group} is not finite")]
    NotFinite {
        /// The group.
        group: usize,
    },
    /// A setting is out of its range.
    #[error("{what} is {value}, but must be {expected}")]
    Setting {
        /// What is set.
        what: &'static str,
        /// What was given.
        value: f64,
        /// What it may be.
        expected: &'static str,
    },
    /// The matrix does not fit.
    #[error(
        "the compressed matrix needs about {needed} bytes, but {limit} are allowed; raise the tolerance or the limit"
    )]
    Memory {
        /// Bytes predicted.
        needed: u64,
        /// Bytes allowed.
        limit: u64,
    },
    /// The factors do not fit.
    #[error(
        "the factors of the compressed matrix need more than {needed} bytes, but {limit} are allowed; raise their tolerance or the limit"
    )]
    Factors {
        /// Bytes that they have grown to.
        needed: u64,
        /// Bytes allowed.
        limit: u64,
    },
    /// A block on the diagonal cannot be inverted.
    #[error("block {block} of the diagonal is singular to single precision")]
    Singular {
        /// The block.
        block: usize,
    },
    /// Nothing is far enough away for multipoles.
    #[error(
        "all of the {boxes} smallest boxes are near each other: the bodies are too small beside the wavelength for multipoles"
    )]
    Small {
        /// Boxes of the finest level.
        boxes: usize,
    },
    /// The bodies are too large, or too far from each other.
    #[error(
        "the bodies are {across:.0} of the smallest boxes across: too large, or too far from each other, for multipoles"
    )]
    Large {
        /// Boxes of the finest level along the longest side.
        across: f64,
    },
    /// The matrix is no longer wanted.
    #[error("the compression was interrupted")]
    Interrupted,
}
