//! What can be wrong with a set of occluders.

use thiserror::Error;

/// Occluders that no query can be answered for, with what to do about it.
#[derive(Clone, Debug, Error, PartialEq)]
#[non_exhaustive]
pub enum VisibilityError {
    /// More patches were given than an index of 32 bits can name.
    #[error(
        "{count} occluders are more than the limit of {limit}; merge flat neighbours into larger patches"
    )]
    TooMany {
        /// Number of patches given.
        count: usize,
        /// Largest number of patches.
        limit: usize,
    },
    /// The scene is so large or so small that products of three lengths leave the range of f64.
    #[error("the occluders span {extent:e} m; scale the scene to between {least:e} m and {most:e} m")]
    Span {
        /// Longest side of the bounding box, m.
        extent: f64,
        /// Least extent, m.
        least: f64,
        /// Largest extent, m.
        most: f64,
    },
}
