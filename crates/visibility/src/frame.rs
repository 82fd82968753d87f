//! The bounding box of the occluders and the lengths that follow from it.
//!
//! Inside this crate coordinates are *local*: the centre of the bounding box is 0 and its longest
//! side is 1, so that f32 serves every scene alike. Units outside: metres.

use fredholm_mesh::{Patch, Vec3};

use crate::VisibilityError;

/// Tolerance of length relative to the extent of the scene.
const TOLERANCE: f64 = 1e-9;
/// Tolerance of length relative to the largest coordinate: where that rules, coordinates resolve no
/// better.
const RESOLUTION: f64 = 16.0 * f64::EPSILON;
/// Least and largest coordinates, m: products of three lengths, as the exact predicates form them,
/// stay in range.
const LEAST_COORDINATE: f64 = 1e-50;
const LARGEST_COORDINATE: f64 = 1e50;

/// Where the scene lies, how large it is, and up to what length two places count as one.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Frame {
    centre: Vec3,
    scale: f64,
    /// Half the sides of the bounding box, local.
    pub half: Vec3,
    /// Tolerance of length, local.
    pub tolerance: f64,
}

impl Frame {
    pub(crate) fn around(patches: &[Patch]) -> Result<Self, VisibilityError> {
        let corners = || patches.iter().flat_map(Patch::corners);
        if patches.is_empty() {
            return Ok(Self { centre: Vec3::ZERO, scale: 1.0, half: Vec3::ZERO, tolerance: TOLERANCE });
        }
        let low = corners().fold(Vec3::INFINITY, |low, &p| low.min(p));
        let high = corners().fold(Vec3::NEG_INFINITY, |high, &p| high.max(p));
        let largest = low.abs().max(high.abs()).max_element();
        let extent = (high - low).max_element();
        if !(LEAST_COORDINATE..=LARGEST_COORDINATE).contains(&extent) || largest > LARGEST_COORDINATE {
            return Err(VisibilityError::Span {
                extent: extent.max(largest),
                least: LEAST_COORDINATE,
                most: LARGEST_COORDINATE,
            });
        }
        let tolerance = TOLERANCE + RESOLUTION * largest / extent;
        Ok(Self {
            centre: low + 0.5 * (high - low),
            scale: 1.0 / extent,
            half: 0.5 * (high - low) / extent,
            tolerance,
        })
    }

    /// Local coordinates of a point.
    #[inline]
    pub(crate) fn local(&self, point: Vec3) -> Vec3 {
        (point - self.centre) * self.scale
    }

    /// The local vector of a difference of two points.
    pub(crate) fn edge(&self, difference: Vec3) -> Vec3 {
        difference * self.scale
    }

    /// The centre of the bounding box, m: the local origin.
    pub(crate) fn centre(&self) -> Vec3 {
        self.centre
    }

    /// A length in local units.
    pub(crate) fn local_length(&self, metres: f64) -> f64 {
        metres * self.scale
    }

    /// A local length in metres.
    pub(crate) fn metres(&self, length: f64) -> f64 {
        length / self.scale
    }

    /// A length that takes a ray from the point past every occluder, m.
    pub(crate) fn beyond(&self, point: Vec3) -> f64 {
        self.metres(self.local(point).length() + self.half.length() + 1.0)
    }
}
