//! Boxes along the axes that hold points. Metres.

use crate::Vec3;

/// A box with its sides along the axes, m.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Bounds {
    /// Least coordinates.
    pub min: Vec3,
    /// Largest coordinates.
    pub max: Vec3,
}

impl Bounds {
    /// The smallest box that holds all points; none for no points.
    pub fn around(points: impl IntoIterator<Item = Vec3>) -> Option<Self> {
        points
            .into_iter()
            .map(|point| Self { min: point, max: point })
            .reduce(|a, b| Self { min: a.min.min(b.min), max: a.max.max(b.max) })
    }

    /// Its middle.
    #[must_use]
    pub fn centre(&self) -> Vec3 {
        0.5 * (self.min + self.max)
    }

    /// Length of its diagonal, m.
    #[must_use]
    pub fn diagonal(&self) -> f64 {
        self.min.distance(self.max)
    }
}
