//! The parameters (u, v) of a point on a flat patch: X(u, v) = x.
//!
//! Affine on a triangle. On a quad X is bilinear, and Newton's method from the middle is run until it stands: one step where the quad is a
//! parallelogram. Convex quads have one solution in the unit square. C. T. Kelley, *Solving Nonlinear Equations with Newton's Method*, SIAM 2003,
//! doi:10.1137/1.9780898718898. Dimensionless.

use fredholm_mesh::{Patch, Vec3};

/// Newton steps at most: they double the digits each.
const STEPS: usize = 20;
/// Step below which (u, v) stands.
const SMALL: f64 = 1e-14;

/// Parameters of the point of `patch` at `x`.
pub(crate) fn inverse(patch: &Patch, x: Vec3) -> (f64, f64) {
    let [a, b, c] = [0, 1, 2].map(|i| patch.corner(i));
    let n = patch.normal();
    if patch.sides() == 3 {
        return coordinates(x - a, b - a, c - a, n);
    }
    let d = patch.corner(3);
    let (mut u, mut v) = (0.5, 0.5);
    for _ in 0..STEPS {
        let along_u = (b - a) * (1.0 - v) + (c - d) * v;
        let along_v = (d - a) * (1.0 - u) + (c - b) * u;
        let (du, dv) = coordinates(x - patch.point(u, v), along_u, along_v, n);
        (u, v) = (u + du, v + dv);
        if du.abs().max(dv.abs()) < SMALL {
            break;
        }
    }
    (u, v)
}

/// (s, t) with r = s e + t f in the plane with normal n.
fn coordinates(r: Vec3, e: Vec3, f: Vec3, n: Vec3) -> (f64, f64) {
    let area = e.cross(f).dot(n);
    (r.cross(f).dot(n) / area, e.cross(r).dot(n) / area)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn finds_the_parameters_of_every_point() {
        let v = |x: f64, y: f64| Vec3::new(x, y, 0.3 * x - 0.2 * y);
        let trapezoid = Patch::quad([v(0., 0.), v(3., 0.2), v(2., 1.), v(0.1, 0.8)]).unwrap().unwrap();
        let triangle = Patch::triangle([v(0., 0.), v(3., 0.2), v(2., 1.)]).unwrap();
        for patch in [trapezoid, triangle] {
            for (s, t) in [(0.0, 0.0), (0.3, 0.6), (1.0, 0.0), (0.99, 0.01), (0.0, 1.0)] {
                let (u, v) = inverse(&patch, patch.point(s, t));
                assert!((u - s).abs() < 1e-12 && (v - t).abs() < 1e-12, "({s}, {t}): ({u}, {v})");
            }
        }
    }
}
