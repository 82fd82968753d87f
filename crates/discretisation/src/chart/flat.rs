//! A flat patch as a chart: affine on a triangle, bilinear on a quad. Metres.

use super::Chart;
use fredholm_mesh::{Patch, Vec3};

/// A flat element.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct FlatChart(pub Patch);

impl Chart for FlatChart {
    fn sides(&self) -> usize {
        self.0.sides()
    }

    fn position(&self, u: f64, v: f64) -> Vec3 {
        self.0.point(u, v)
    }

    fn normal(&self, _: f64, _: f64) -> Vec3 {
        self.0.normal()
    }

    fn jacobian(&self, u: f64, v: f64) -> f64 {
        if self.0.sides() == 3 {
            return 2.0 * self.0.area();
        }
        let [a, b, c, d] = [0, 1, 2, 3].map(|i| self.0.corner(i));
        let along_u = (b - a) * (1.0 - v) + (c - d) * v;
        let along_v = (d - a) * (1.0 - u) + (c - b) * u;
        along_u.cross(along_v).dot(self.0.normal())
    }

    fn flat(&self) -> Option<&Patch> {
        Some(&self.0)
    }
}
