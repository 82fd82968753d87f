//! A patch of a sphere about the origin: a rectangle on a face of the cube, thrown onto the sphere
//! from the centre.
//!
//! With a, b = tan of angles from −π/4 to π/4, X = r (1, a, b)/√(1 + a² + b²) and its rotations.
//! Six whole faces make the sphere, and no point is singular. C. Ronchi, R. Iacono, P. S. Paolucci,
//! J. Comput. Phys. 124 (1996) 93, doi:10.1006/jcph.1996.0047. Metres.

use super::Chart;
use fredholm_mesh::Vec3;
use std::f64::consts::{FRAC_PI_2, FRAC_PI_4};

/// The part of one of the six faces between two values of u and of v, in [0, 1]. It is mirrored in
/// u where the inner side is lit.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SpherePatch {
    /// Radius r, m.
    pub radius: f64,
    /// Face of the cube: +x, −x, +y, −y, +z, −z for 0 to 5.
    pub face: usize,
    /// Part along u.
    pub u: [f64; 2],
    /// Part along v.
    pub v: [f64; 2],
    /// Lit inside instead of outside.
    pub inward: bool,
}

impl SpherePatch {
    /// tan of the two angles.
    fn tangents(&self, u: f64, v: f64) -> [f64; 2] {
        let u = if self.inward { 1.0 - u } else { u };
        let on = |range: [f64; 2], t: f64| range[0] + (range[1] - range[0]) * t;
        [on(self.u, u), on(self.v, v)].map(|t| (FRAC_PI_2 * t - FRAC_PI_4).tan())
    }

    fn outward(&self, u: f64, v: f64) -> Vec3 {
        let [a, b] = self.tangents(u, v);
        let p = match self.face {
            0 => Vec3::new(1.0, a, b),
            1 => Vec3::new(-1.0, -a, b),
            2 => Vec3::new(b, 1.0, a),
            3 => Vec3::new(b, -1.0, -a),
            4 => Vec3::new(a, b, 1.0),
            _ => Vec3::new(-a, b, -1.0),
        };
        p.normalize()
    }
}

impl Chart for SpherePatch {
    fn sides(&self) -> usize {
        4
    }

    fn position(&self, u: f64, v: f64) -> Vec3 {
        self.outward(u, v) * self.radius
    }

    fn normal(&self, u: f64, v: f64) -> Vec3 {
        if self.inward { -self.outward(u, v) } else { self.outward(u, v) }
    }

    // |∂X/∂a × ∂X/∂b| = r²/(1 + a² + b²)^{3/2}, and da = (π/2) (1 + a²) du.
    fn jacobian(&self, u: f64, v: f64) -> f64 {
        let [a, b] = self.tangents(u, v);
        let angles = FRAC_PI_2 * FRAC_PI_2 * (self.u[1] - self.u[0]) * (self.v[1] - self.v[0]);
        angles * self.radius * self.radius * (1.0 + a * a) * (1.0 + b * b) / (1.0 + a * a + b * b).powf(1.5)
    }
}
