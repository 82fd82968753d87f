//! Charts: the geometry of an element, X(u, v) with dA = |∂X/∂u × ∂X/∂v| du dv.
//!
//! The domain is [0, 1]² with four sides and u, v ≥ 0, u + v ≤ 1 with three. Lengths in metres. M.
//! do Carmo, *Differential Geometry of Curves and Surfaces*, Prentice-Hall 1976, section 2-5, for
//! the area element.

mod cylinder;
mod flat;
mod sphere;

pub use cylinder::CylinderStrip;
pub use flat::FlatChart;
pub use sphere::SpherePatch;

use fredholm_mesh::{Patch, Vec3};
use std::fmt::Debug;

/// The geometry of one element.
pub trait Chart: Debug + Send + Sync {
    /// Number of sides, 3 or 4: it tells the domain.
    fn sides(&self) -> usize;

    /// X(u, v), m.
    fn position(&self, u: f64, v: f64) -> Vec3;

    /// Unit normal at (u, v), to the lit side.
    fn normal(&self, u: f64, v: f64) -> Vec3;

    /// |∂X/∂u × ∂X/∂v| at (u, v), m².
    fn jacobian(&self, u: f64, v: f64) -> f64;

    /// The flat patch this is, where it is one.
    fn flat(&self) -> Option<&Patch> {
        None
    }
}

/// A point on an element, m.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Site {
    /// Index of the element.
    pub element: usize,
    /// First parameter.
    pub u: f64,
    /// Second parameter.
    pub v: f64,
    /// Position, m.
    pub position: Vec3,
    /// Unit normal, to the lit side.
    pub normal: Vec3,
}

#[cfg(test)]
mod tests {
    use super::*;
    use fredholm_quadrature::tensor_quad;
    use std::f64::consts::PI;

    /// Area by the chart's own Jacobian, and by finite differences of its positions.
    fn areas(chart: &dyn Chart) -> (f64, f64) {
        let h = 1e-5;
        let (mut own, mut other) = (0.0, 0.0);
        for p in tensor_quad(8) {
            let along_u = (chart.position(p.u + h, p.v) - chart.position(p.u - h, p.v)) / (2.0 * h);
            let along_v = (chart.position(p.u, p.v + h) - chart.position(p.u, p.v - h)) / (2.0 * h);
            own += p.weight * chart.jacobian(p.u, p.v);
            other += p.weight * along_u.cross(along_v).dot(chart.normal(p.u, p.v));
        }
        (own, other)
    }

    #[test]
    fn curved_charts_have_the_area_of_the_shape() {
        let strip = CylinderStrip { radius: 2.0, angles: [0.1, 0.7], heights: [0.0, 3.0], inward: false };
        let (own, other) = areas(&strip);
        assert!((own - 2.0 * 0.6 * 3.0).abs() < 1e-13 && (own - other).abs() < 1e-7, "{own} {other}");
        let face = |inward| SpherePatch { radius: 2.0, face: 3, u: [0.0, 1.0], v: [0.0, 1.0], inward };
        let (own, other) = areas(&face(false));
        assert!((6.0 * own - 4.0 * PI * 4.0).abs() < 1e-5 && (own - other).abs() < 1e-7, "{own} {other}");
        assert!((areas(&face(true)).1 - own).abs() < 1e-7, "the inner side is a chart as well");
    }

    #[test]
    fn normals_point_outwards_or_inwards() {
        for face in 0..6 {
            let out = SpherePatch { radius: 2.0, face, u: [0.2, 0.9], v: [0.1, 0.5], inward: false };
            assert!((out.normal(0.3, 0.8) - out.position(0.3, 0.8) / 2.0).length() < 1e-15);
        }
    }
}
