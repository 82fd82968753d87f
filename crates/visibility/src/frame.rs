//! The bounding box of the occluders and the lengths that follow from it.
//!
//! Units: metres.

use fredholm_mesh::{Patch, Vec3};

use crate::VisibilityError;

/// Tolerance of length relative to the extent of the scene.
const TOLERANCE: f64 = 1e-9;
/// Tolerance of length relative to the largest coordinate: where that rules, coordinates resolve no better.
const RESOLUTION: f64 = 16.0 * f64::EPSILON;
/// Least and largest extent, m: products of five lengths stay finite and normal.
const LEAST: f64 = 1e-50;
const MOST: f64 = 1e50;

/// Where the scene lies, how large it is, and up to what length two places count as one.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Frame {
    /// Centre of the bounding box, m. Computations in f64 are relative to it.
    pub centre: Vec3,
    /// Half the sides of the bounding box, m.
    pub half: Vec3,
    /// Longest side of the bounding box, m; 1 for an empty scene.
    pub extent: f64,
    /// Tolerance of length, m.
    pub tolerance: f64,
}

impl Frame {
    pub(crate) fn around(patches: &[Patch]) -> Result<Self, VisibilityError> {
        let corners = || patches.iter().flat_map(Patch::corners);
        if patches.is_empty() {
            return Ok(Self { centre: Vec3::ZERO, half: Vec3::ZERO, extent: 1.0, tolerance: TOLERANCE });
        }
        let low = corners().fold(Vec3::INFINITY, |low, &p| low.min(p));
        let high = corners().fold(Vec3::NEG_INFINITY, |high, &p| high.max(p));
        let largest = low.abs().max(high.abs()).max_element();
        let extent = (high - low).max_element();
        if !(LEAST..=MOST).contains(&extent) || largest > MOST {
            return Err(VisibilityError::Span { extent: extent.max(largest), least: LEAST, most: MOST });
        }
        let centre = low + 0.5 * (high - low);
        let half = (centre - low).max(high - centre);
        let tolerance = TOLERANCE * extent + RESOLUTION * largest;
        Ok(Self { centre, half, extent, tolerance })
    }

    /// A length that takes a ray from the point past every occluder, m.
    pub(crate) fn beyond(&self, point: Vec3) -> f64 {
        2.0 * (point.distance(self.centre) + self.half.length() + self.extent)
    }
}
