//! The plane of a polygon, and its borders in it.
//!
//! Normal along the area vector ½ Σ (pᵢ − p₀) × (pᵢ₊₁ − p₀) of the outline. Lengths in metres, in
//! the plane relative to the extent of the outline.

use glam::DVec2;

use crate::border::Corner;
use crate::disc::frame;
use crate::error::Ring;
use crate::{MeshError, Vec3};

/// Distance from the plane, relative to the extent, up to which a polygon counts as flat.
const PLANAR_TOLERANCE: f64 = 1e-6;
/// Distance, relative to the extent, up to which corners coincide and borders touch.
pub(crate) const TOUCH_DISTANCE: f64 = 1e-9;
/// Area, relative to the squared extent, up to which corners lie on one line.
const COLLINEAR_AREA: f64 = 1e-13;

/// The plane of an outline.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Plane {
    origin: Vec3,
    extent: f64,
    normal: Vec3,
    across: [Vec3; 2],
}

impl Plane {
    /// The plane of an outline, which runs counter-clockwise in it.
    pub fn of(outline: &[Vec3]) -> Result<Self, MeshError> {
        let Some(&origin) = outline.first() else {
            return Err(MeshError::TooFewCorners { ring: Ring::Outline });
        };
        let extent = outline.iter().map(|p| p.distance(origin)).fold(0.0, f64::max);
        let crosses =
            outline.windows(2).map(|side| (side[0] - origin).cross(side[1] - origin) / (extent * extent));
        let area: Vec3 = crosses.clone().sum();
        // The lobes of a border that crosses itself may cancel: then any of its triangles tells the
        // plane.
        let longer = |a: Vec3, b: Vec3| if b.length_squared() > a.length_squared() { b } else { a };
        let vector = if area.length() > COLLINEAR_AREA { area } else { crosses.fold(area, longer) };
        if extent <= 0.0 || vector.length() <= COLLINEAR_AREA {
            return Err(MeshError::NoArea { area: 0.5 * area.length() * extent * extent, longest: extent });
        }
        let normal = vector.normalize();
        Ok(Self { origin, extent, normal, across: frame(normal) })
    }

    /// A border in this plane, without repeated corners.
    pub fn border(&self, ring: Ring, corners: &[Vec3]) -> Result<Vec<Corner>, MeshError> {
        let flat = corners.iter().enumerate().map(|(index, p)| self.corner(ring, index, *p));
        let mut border: Vec<Corner> = flat.collect::<Result<_, _>>()?;
        let same = |a: &Corner, b: &Corner| a.at.distance(b.at) <= TOUCH_DISTANCE;
        border.dedup_by(|b, a| same(a, b));
        while border.len() > 1 && same(&border[0], &border[border.len() - 1]) {
            border.pop();
        }
        if border.len() < 3 { Err(MeshError::TooFewCorners { ring }) } else { Ok(border) }
    }

    fn corner(&self, ring: Ring, index: usize, point: Vec3) -> Result<Corner, MeshError> {
        let offset = (point - self.origin) / self.extent;
        let height = offset.dot(self.normal).abs();
        if height > PLANAR_TOLERANCE {
            return Err(MeshError::NotPlanar { ring, corner: index, distance: height * self.extent });
        }
        Ok(Corner { index, at: DVec2::new(offset.dot(self.across[0]), offset.dot(self.across[1])) })
    }
}
