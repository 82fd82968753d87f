//! What can be asked of a rule that it cannot give.

/// A rule that does not exist.
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
#[non_exhaustive]
pub enum RuleError {
    /// The table of symmetric rules ends below the degree.
    #[error("the symmetric triangle rules end at degree {highest}, not {degree}: take a collapsed rule")]
    DegreeBeyondTable {
        /// Degree asked for.
        degree: usize,
        /// Highest degree in the table.
        highest: usize,
    },
    /// Equally spaced points: too few to span an interval, or so many that rounding eats the
    /// result.
    #[error(
        "this kind of Newton–Cotes rule has {lowest} to {highest} points, not {points}: compose one of fewer"
    )]
    PointCount {
        /// Number of points asked for.
        points: usize,
        /// Smallest number of points.
        lowest: usize,
        /// Largest number of points.
        highest: usize,
    },
}
