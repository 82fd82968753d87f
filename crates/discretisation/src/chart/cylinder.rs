//! A strip of a circular cylinder about the z axis: X = (r cos φ, r sin φ, z), dA = r dφ dz. Metres
//! and radians.
//!
//! M. do Carmo, *Differential Geometry of Curves and Surfaces*, Prentice-Hall 1976, section 2-5.

use super::Chart;
use fredholm_mesh::Vec3;

/// Angles and heights between two values each: φ runs with u, z with v; the other way round in φ
/// where the inner side is lit.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct CylinderStrip {
    /// Radius r, m.
    pub radius: f64,
    /// Angles φ, rising, radians.
    pub angles: [f64; 2],
    /// Heights z, rising, m.
    pub heights: [f64; 2],
    /// Lit inside instead of outside.
    pub inward: bool,
}

impl CylinderStrip {
    fn outward(&self, u: f64) -> Vec3 {
        let u = if self.inward { 1.0 - u } else { u };
        let (sine, cosine) = (self.angles[0] + (self.angles[1] - self.angles[0]) * u).sin_cos();
        Vec3::new(cosine, sine, 0.0)
    }
}

impl Chart for CylinderStrip {
    fn sides(&self) -> usize {
        4
    }

    fn position(&self, u: f64, v: f64) -> Vec3 {
        let z = self.heights[0] + (self.heights[1] - self.heights[0]) * v;
        self.outward(u) * self.radius + Vec3::Z * z
    }

    fn normal(&self, u: f64, _: f64) -> Vec3 {
        if self.inward { -self.outward(u) } else { self.outward(u) }
    }

    fn jacobian(&self, _: f64, _: f64) -> f64 {
        self.radius * (self.angles[1] - self.angles[0]) * (self.heights[1] - self.heights[0])
    }
}
