//! Weights of the corners of a patch at a point on it: bilinear on quads, barycentric on triangles.
//!
//! A quad a, b, c, d maps (u, v) to p = a + e u + f v + g u v with e = b − a, f = d − a, g = a − b + c − d. With
//! h = p − a and the plane product x × y, eliminating u leaves
//!
//! (g × f) v² + (e × f + h × g) v + h × e = 0.
//!
//! The derivative of the left side at the wanted root is the Jacobian of the map, which is positive
//! on a convex quad. This selects the root v = −2 k₀ / (k₁ + √(k₁² − 4 k₂ k₀)), whose denominator
//! is positive too, so that parallelograms (k₂ = 0) need no case of their own.

use fredholm_mesh::{Patch, Vec3};

/// Weights of the corners at a point of the plane of the patch, clamped to the patch. They add up
/// to 1.
pub(crate) fn corner_weights(patch: &Patch, point: Vec3) -> [f64; 4] {
    if patch.sides() == 3 {
        return barycentric(patch, point);
    }
    let (u, v) = bilinear(patch, point);
    [(1.0 - u) * (1.0 - v), u * (1.0 - v), u * v, (1.0 - u) * v]
}

fn barycentric(patch: &Patch, point: Vec3) -> [f64; 4] {
    let opposite = |i: usize| {
        let (b, c) = (patch.corner(i + 1), patch.corner(i + 2));
        (c - b).cross(point - b).dot(patch.normal()).max(0.0)
    };
    let areas = [opposite(0), opposite(1), opposite(2)];
    let total = areas[0] + areas[1] + areas[2];
    [areas[0] / total, areas[1] / total, areas[2] / total, 0.0]
}

fn bilinear(patch: &Patch, point: Vec3) -> (f64, f64) {
    let [a, b, c, d] = [0, 1, 2, 3].map(|i| patch.corner(i));
    let product = |x: Vec3, y: Vec3| x.cross(y).dot(patch.normal());
    let (e, f, g, h) = (b - a, d - a, a - b + c - d, point - a);
    let (k2, k1, k0) = (product(g, f), product(e, f) + product(h, g), product(h, e));
    let jacobian = (k1 * k1 - 4.0 * k2 * k0).max(0.0).sqrt();
    let v = inside(-2.0 * k0 / (k1 + jacobian));
    let along = e + g * v;
    (inside((h - f * v).dot(along) / along.length_squared()), v)
}

/// A parameter clamped to [0, 1]; the quotients above are not numbers only far outside the patch.
fn inside(parameter: f64) -> f64 {
    if parameter.is_nan() { 0.5 } else { parameter.clamp(0.0, 1.0) }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn shapes() -> Vec<Patch> {
        let tilt = |x: f64, y: f64| Vec3::new(x + 0.3 * y, 2.0 * y - x, 5.0 + 0.7 * x - 0.2 * y);
        let quads: [[(f64, f64); 4]; 4] = [
            [(0.0, 0.0), (2.0, 0.0), (2.0, 1.0), (0.0, 1.0)],
            [(0.0, 0.0), (1.0, 0.0), (1.4, 0.9), (0.4, 0.9)],
            [(0.0, 0.0), (3.0, 0.0), (2.0, 1.0), (1.0, 1.0)],
            [(0.0, 0.0), (1.0, 0.1), (1.6, 1.7), (-0.4, 0.8)],
        ];
        let mut shapes: Vec<Patch> =
            quads.iter().map(|quad| Patch::quad(quad.map(|(x, y)| tilt(x, y))).unwrap().unwrap()).collect();
        shapes.push(Patch::triangle([tilt(0.0, 0.0), tilt(2.0, 0.3), tilt(0.4, 1.0)]).unwrap());
        shapes
    }

    #[test]
    fn weights_invert_the_map() {
        for patch in shapes() {
            let reach = if patch.sides() == 3 { 10 } else { 20 };
            for (i, j) in (0..=reach).flat_map(|i| (0..=reach).map(move |j| (i, j))) {
                let (u, v) = (f64::from(i) / 20.0, f64::from(j) / 20.0);
                let expected = if patch.sides() == 3 {
                    [1.0 - u - v, u, v, 0.0]
                } else {
                    [(1.0 - u) * (1.0 - v), u * (1.0 - v), u * v, (1.0 - u) * v]
                };
                let found = corner_weights(&patch, patch.point(u, v));
                for (a, b) in found.iter().zip(expected) {
                    assert!((a - b).abs() < 1e-13, "({u}, {v}): {found:?} {expected:?}");
                }
            }
        }
    }

    #[test]
    fn points_outside_are_clamped() {
        for patch in shapes() {
            for k in 0..32 {
                let angle = f64::from(k) * 0.2;
                let far = patch.centroid()
                    + (patch.corner(1) - patch.corner(0)) * (50.0 * angle.cos())
                    + (patch.corner(2) - patch.corner(0)) * (50.0 * angle.sin());
                let weights = corner_weights(&patch, far);
                assert!(weights.iter().all(|w| (0.0..=1.0).contains(w)), "{weights:?}");
                assert!((weights.iter().sum::<f64>() - 1.0).abs() < 1e-12);
            }
        }
    }
}
