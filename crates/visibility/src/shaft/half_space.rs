//! A half-space N·x ≥ c, whose normal need not be of unit length.

use fredholm_mesh::Vec3;

/// The points x with N·x ≥ c.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(crate) struct HalfSpace {
    pub normal: Vec3,
    pub offset: f64,
}

impl HalfSpace {
    /// N·x − c: positive inside.
    pub(crate) fn depth(&self, point: Vec3) -> f64 {
        self.normal.dot(point) - self.offset
    }

    /// The half-space less a layer of at least the given thickness.
    pub(crate) fn shrunk(&self, thickness: f64) -> Self {
        Self { offset: self.offset + thickness * self.size(), ..*self }
    }

    /// The sum of the sizes of the coordinates of N.
    pub(crate) fn size(&self) -> f64 {
        norm1(self.normal)
    }

    /// Whether all the points lie outside.
    pub(crate) fn excludes(&self, points: &[Vec3]) -> bool {
        points.iter().all(|&p| self.depth(p) <= 0.0)
    }
}

/// The sum of the coordinates' sizes: between the length and √3 times the length, and free of a
/// square root.
pub(crate) fn norm1(v: Vec3) -> f64 {
    v.x.abs() + v.y.abs() + v.z.abs()
}
