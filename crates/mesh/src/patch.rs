//! A flat convex patch of three or four corners.
//!
//! Area vector of a polygon: a = ½ Σ pᵢ × pᵢ₊₁; normal n = a/|a|, area |a|.

use crate::cutting::Grid;
use crate::{MeshError, Vec3, quad, triangle};

/// Relative area (area over squared longest side) below which corners enclose no area.
const SLIVER_AREA: f64 = 1e-13;
/// Distance from the mean plane, relative to the longest side, up to which four corners count as
/// flat.
const FLAT_HEIGHT: f64 = 1e-10;

/// A flat convex polygon with three or four corners, counter-clockwise seen from the lit side.
/// Lengths in metres.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Patch {
    corners: [Vec3; 4],
    sides: usize,
    normal: Vec3,
    area: f64,
}

impl Patch {
    /// The triangle a, b, c.
    ///
    /// # Errors
    /// A coordinate that is not finite, or corners that enclose no area.
    pub fn triangle(corners: [Vec3; 3]) -> Result<Self, MeshError> {
        let [a, b, c] = corners;
        Self::new([a, b, c, c], 3)
    }

    /// The quadrilateral a, b, c, d, or `None` where it is not flat or not convex: such a one is
    /// two triangles.
    ///
    /// # Errors
    /// A coordinate that is not finite, or corners that enclose no area.
    pub fn quad(corners: [Vec3; 4]) -> Result<Option<Self>, MeshError> {
        let patch = Self::new(corners, 4)?;
        Ok((patch.is_flat() && patch.is_convex()).then_some(patch))
    }

    fn new(corners: [Vec3; 4], sides: usize) -> Result<Self, MeshError> {
        if let Some(corner) = corners.iter().position(|p| !p.is_finite()) {
            return Err(MeshError::NotFinite { corner });
        }
        let doubled = doubled_area(&corners[..sides]);
        Self { corners, sides, normal: doubled.normalize_or_zero(), area: 0.5 * doubled.length() }.checked()
    }

    /// A piece of a flat polygon with this normal. Whether it is flat and convex is not asked
    /// again: rounding could answer differently for a small piece far from the origin.
    pub(crate) fn piece(corners: [Vec3; 4], sides: usize, normal: Vec3) -> Result<Self, MeshError> {
        let area = 0.5 * doubled_area(&corners[..sides]).dot(normal);
        Self { corners, sides, normal, area }.checked()
    }

    fn checked(self) -> Result<Self, MeshError> {
        let longest = longest_side(self.corners());
        let enough = self.area > f64::MIN_POSITIVE && self.area > SLIVER_AREA * longest * longest;
        if !enough || !self.area.is_finite() {
            return Err(MeshError::NoArea { area: self.area, longest });
        }
        Ok(self)
    }

    fn is_flat(&self) -> bool {
        let longest = longest_side(self.corners());
        let centre = self.corners().iter().sum::<Vec3>() / self.sides as f64;
        self.corners().iter().all(|p| (*p - centre).dot(self.normal).abs() <= FLAT_HEIGHT * longest)
    }

    fn is_convex(&self) -> bool {
        (0..self.sides).all(|i| {
            let (a, b, c) = (self.corner(i), self.corner(i + 1), self.corner(i + 2));
            (b - a).cross(c - b).dot(self.normal) > 0.0
        })
    }

    /// The corners, counter-clockwise seen from the lit side.
    #[must_use]
    #[inline]
    pub fn corners(&self) -> &[Vec3] {
        &self.corners[..self.sides]
    }

    /// Corner `i`, counted round the polygon.
    #[must_use]
    #[inline]
    pub fn corner(&self, i: usize) -> Vec3 {
        self.corners[i % self.sides]
    }

    /// Number of sides: 3 or 4.
    #[must_use]
    #[inline]
    pub fn sides(&self) -> usize {
        self.sides
    }

    /// Unit normal, pointing to the lit side.
    #[must_use]
    #[inline]
    pub fn normal(&self) -> Vec3 {
        self.normal
    }

    /// Area, m².
    #[must_use]
    #[inline]
    pub fn area(&self) -> f64 {
        self.area
    }

    /// Centroid of the area, m.
    #[must_use]
    pub fn centroid(&self) -> Vec3 {
        let [a, b, c, d] = self.corners;
        let first = (b - a).cross(c - a).dot(self.normal);
        let second = (c - a).cross(d - a).dot(self.normal);
        a + ((b - a + (c - a)) * first + (c - a + (d - a)) * second) / (3.0 * (first + second))
    }

    /// Longest side or diagonal, m.
    #[must_use]
    pub fn diameter(&self) -> f64 {
        let corners = self.corners();
        let pairs = (0..self.sides).flat_map(|i| (0..i).map(move |j| (i, j)));
        pairs.map(|(i, j)| corners[i].distance(corners[j])).fold(0.0, f64::max)
    }

    /// The point at (u, v): bilinear in [0, 1]² on a quad, a + u (b − a) + v (c − a) with u + v ≤ 1
    /// on a triangle.
    #[must_use]
    pub fn point(&self, u: f64, v: f64) -> Vec3 {
        let [a, b, c, d] = self.corners;
        if self.sides == 3 {
            return a + (b - a) * u + (c - a) * v;
        }
        a * ((1.0 - u) * (1.0 - v)) + b * (u * (1.0 - v)) + c * (u * v) + d * ((1.0 - u) * v)
    }

    /// Piece `index` of n² similar ones: cell (i, j) of a quad, i along u and j along v, at i n +
    /// j; the triangles of a triangle row by row away from corner a, row r starting at r².
    pub(crate) fn piece_of(&self, n: usize, index: usize) -> Result<Self, MeshError> {
        if self.sides == 4 {
            let cell = quad::cell(&self.corners, Grid::even(n, n), index);
            return Self::piece(cell, 4, self.normal);
        }
        let [a, b, c] = triangle::piece([self.corners[0], self.corners[1], self.corners[2]], n, index);
        Self::piece([a, b, c, c], 3, self.normal)
    }

    /// Four similar pieces, cut at the middles of the sides. Of a quad, piece (i, j), i along u and
    /// j along v, is number 2 i + j; of a triangle they are those at its corners a and b, the
    /// middle one and that at c.
    ///
    /// # Errors
    /// [`MeshError::NoArea`] where the pieces would be too small for the precision of their
    /// coordinates.
    pub fn split(&self) -> Result<[Self; 4], MeshError> {
        let [a, b, c, d] = [0, 1, 2, 3].map(|index| self.piece_of(2, index));
        Ok([a?, b?, c?, d?])
    }

    /// The same polygon seen from behind.
    #[must_use]
    pub fn flipped(&self) -> Self {
        let [a, b, c, d] = self.corners;
        let corners = if self.sides == 3 { [a, c, b, b] } else { [a, d, c, b] };
        Self { corners, normal: -self.normal, ..*self }
    }
}

fn longest_side(corners: &[Vec3]) -> f64 {
    (0..corners.len()).map(|i| corners[i].distance(corners[(i + 1) % corners.len()])).fold(0.0, f64::max)
}

/// Twice the area vector: the cross product of two sides of a triangle, or of the diagonals of a
/// quad.
fn doubled_area(corners: &[Vec3]) -> Vec3 {
    match *corners {
        [a, b, c, d] => (c - a).cross(d - b),
        [a, b, c] => (b - a).cross(c - a),
        _ => Vec3::ZERO,
    }
}
