//! What can be wrong with a problem.

use fredholm_visibility::VisibilityError;
use thiserror::Error;

/// Why something cannot be traced or compared.
#[derive(Debug, Error, PartialEq)]
#[non_exhaustive]
pub enum MonteCarloError {
    /// Vectors that do not belong together.
    #[error("{what} has {found} values, but {expected} are needed")]
    Length {
        /// Which vector.
        what: &'static str,
        /// How many there should be.
        expected: usize,
        /// How many there are.
        found: usize,
    },
    /// A number outside its range.
    #[error("{what} of patch {patch} is {value}; it must lie in {range}")]
    Range {
        /// Which number.
        what: &'static str,
        /// Of which patch.
        patch: usize,
        /// Its value.
        value: f64,
        /// Where it may lie.
        range: &'static str,
    },
    /// Nothing emits.
    #[error("nothing emits light; give a material an exitance")]
    NoLight,
    /// The patches cannot be prepared for ray casting.
    #[error("the patches cannot be prepared for ray casting: {0}")]
    Visibility(#[from] VisibilityError),
    /// A state of another run.
    #[error(
        "the run to be continued is another one: {what} differs; start anew, or continue it with its own settings"
    )]
    Foreign {
        /// What differs.
        what: &'static str,
    },
    /// More samples than numbers can be told apart.
    #[error("a batch of {samples} samples of {streams} streams is too large; ask for fewer")]
    TooMany {
        /// Samples of a batch.
        samples: u64,
        /// Streams of a batch.
        streams: u64,
    },
}
