//! The parameters (u, v) of a point on a flat patch: X(u, v) = x.
//!
//! Affine on triangles and parallelograms. On another quad X is bilinear, and Newton's method runs
//! from the middle until it stands; convex quads have one solution in the unit square. C. T.
//! Kelley, *Solving Nonlinear Equations with Newton's Method*, SIAM 2003,
//! doi:10.1137/1.9780898718898. Dimensionless.

use fredholm_mesh::{Patch, Vec3};

/// Newton steps at most: they double the digits each.
const STEPS: usize = 20;
/// Step below which (u, v) stands.
const SMALLEST_STEP: f64 = 1e-14;
/// Distance of a corner from that of the parallelogram, relative to its diameter, that is taken for
/// rounding.
const SKEW_TOLERANCE: f64 = 1e-14;

/// The inverse of one patch's parametrisation.
#[derive(Clone, Copy, Debug)]
pub(crate) enum Inverse {
    /// Origin, and the vectors whose products with x − origin are u and v.
    Affine([Vec3; 3]),
    Bilinear(Patch),
}

impl Inverse {
    pub(crate) fn of(patch: &Patch) -> Self {
        let [a, b, c] = [0, 1, 2].map(|i| patch.corner(i));
        let d = if patch.sides() == 3 { c } else { patch.corner(3) };
        let skew = (a - b + c - d).length();
        if patch.sides() == 4 && skew > SKEW_TOLERANCE * patch.diameter() {
            return Self::Bilinear(*patch);
        }
        let (e, f, n) = (b - a, d - a, patch.normal());
        let area = e.cross(f).dot(n);
        Self::Affine([a, f.cross(n) / area, n.cross(e) / area])
    }

    /// Parameters of the point of the patch at `x`.
    pub(crate) fn at(&self, x: Vec3) -> (f64, f64) {
        match self {
            Self::Affine([origin, to_u, to_v]) => ((x - origin).dot(*to_u), (x - origin).dot(*to_v)),
            Self::Bilinear(patch) => newton(patch, x),
        }
    }
}

fn newton(patch: &Patch, x: Vec3) -> (f64, f64) {
    let [a, b, c, d] = [0, 1, 2, 3].map(|i| patch.corner(i));
    let n = patch.normal();
    let (mut u, mut v) = (0.5, 0.5);
    for _ in 0..STEPS {
        let along_u = (b - a) * (1.0 - v) + (c - d) * v;
        let along_v = (d - a) * (1.0 - u) + (c - b) * u;
        let (r, area) = (x - patch.point(u, v), along_u.cross(along_v).dot(n));
        let (du, dv) = (r.cross(along_v).dot(n) / area, along_u.cross(r).dot(n) / area);
        (u, v) = (u + du, v + dv);
        if du.abs().max(dv.abs()) < SMALLEST_STEP {
            break;
        }
    }
    (u, v)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn finds_the_parameters_of_every_point() {
        let v = |x: f64, y: f64| Vec3::new(x, y, 0.3 * x - 0.2 * y);
        let trapezoid = Patch::quad([v(0., 0.), v(3., 0.2), v(2., 1.), v(0.1, 0.8)]).unwrap().unwrap();
        let square = Patch::quad([v(0., 0.), v(3., 0.2), v(3.5, 1.2), v(0.5, 1.0)]).unwrap().unwrap();
        let triangle = Patch::triangle([v(0., 0.), v(3., 0.2), v(2., 1.)]).unwrap();
        for patch in [trapezoid, square, triangle] {
            let inverse = Inverse::of(&patch);
            for (s, t) in [(0.0, 0.0), (0.3, 0.6), (1.0, 0.0), (0.99, 0.01), (0.0, 1.0)] {
                let (u, v) = inverse.at(patch.point(s, t));
                assert!((u - s).abs() < 1e-12 && (v - t).abs() < 1e-12, "({s}, {t}): ({u}, {v})");
            }
        }
    }
}
