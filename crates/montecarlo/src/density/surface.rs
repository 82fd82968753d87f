//! 1/A: every point of a patch alike.

use fredholm_mesh::{Patch, Vec3};

/// The uniform density of a patch.
#[derive(Clone, Copy, Debug)]
pub struct SurfaceDensity {
    patch: Patch,
    /// Share of the triangle a, b, c in the area.
    first: f64,
}

impl SurfaceDensity {
    /// The density of this patch.
    #[must_use]
    pub fn new(patch: &Patch) -> Self {
        let [a, b, c] = [0, 1, 2].map(|i| patch.corner(i));
        let first = if patch.sides() == 3 { 1.0 } else { 0.5 * (b - a).cross(c - a).length() / patch.area() };
        Self { patch: *patch, first }
    }

    /// The point of two numbers in [0, 1), m.
    #[must_use]
    pub fn sample(&self, [u, v]: [f64; 2]) -> Vec3 {
        let corner = |i| self.patch.corner(i);
        if u < self.first {
            in_triangle([corner(0), corner(1), corner(2)], [u / self.first, v])
        } else {
            let u = (u - self.first) / (1.0 - self.first);
            in_triangle([corner(0), corner(2), corner(3)], [u, v])
        }
    }

    /// 1/A, 1/m².
    #[must_use]
    pub fn pdf(&self) -> f64 {
        1.0 / self.patch.area()
    }
}

/// a + √u ((1 − v) (b − a) + v (c − a)) (G. Turk, Graphics Gems, 1990).
fn in_triangle([a, b, c]: [Vec3; 3], [u, v]: [f64; 2]) -> Vec3 {
    let root = u.sqrt();
    a + ((b - a) * (1.0 - v) + (c - a) * v) * root
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::points::{Key, PointSet, Samples};

    /// Moments of a trapezoid and a triangle: mean is the centroid, and as many points fall on each
    /// side of a line as area.
    #[test]
    fn points_are_spread_by_area() {
        let corner = |x, y| Vec3::new(x, y, 0.5);
        let trapezoid = [corner(0.0, 0.0), corner(3.0, 0.0), corner(1.0, 1.0), corner(0.0, 1.0)];
        let triangle = [corner(0.0, 0.0), corner(2.0, 0.0), corner(0.0, 1.0)];
        for patch in [Patch::quad(trapezoid).unwrap().unwrap(), Patch::triangle(triangle).unwrap()] {
            let (n, density) = (20_000, SurfaceDensity::new(&patch));
            let key = Key { seed: 2, batch: 0, stream: 0 };
            let mut samples = Samples::new(PointSet::Independent, key, n);
            let points: Vec<Vec3> = (0..n).map(|s| density.sample(samples.draw(s).pair())).collect();
            let mean = points.iter().sum::<Vec3>() / f64::from(n);
            assert!((mean - patch.centroid()).length() < 0.02, "{mean}");
            // Left of x = 1: 1 of 2, and 3/4 of 1.
            let left = points.iter().filter(|p| p.x < 1.0).count() as f64 / f64::from(n);
            let expected = if patch.sides() == 4 { 0.5 } else { 0.75 };
            assert!((left - expected).abs() < 0.015, "{left}");
            assert!((density.pdf() * patch.area() - 1.0).abs() < 1e-14);
        }
    }
}
