//! What can be wrong with geometry.

use thiserror::Error;

/// Geometry that cannot be meshed, with what to do about it.
#[derive(Clone, Debug, Error, PartialEq)]
#[non_exhaustive]
pub enum MeshError {
    /// A coordinate is NaN or infinite.
    #[error("corner {corner} has a coordinate that is not a finite number")]
    NotFinite {
        /// Index of the corner, from 0.
        corner: usize,
    },
    /// The corners enclose no area.
    #[error("the corners enclose no area (area {area:e} m², longest side {longest:e} m); remove the face or separate its corners")]
    NoArea {
        /// Area found, m².
        area: f64,
        /// Longest side, m.
        longest: f64,
    },
    /// More elements were asked for than an index can hold.
    #[error("the mesh would have more than {limit} elements; subdivide less")]
    TooLarge {
        /// Largest number of elements.
        limit: usize,
    },
}
