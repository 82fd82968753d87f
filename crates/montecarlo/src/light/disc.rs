//! Area that a disc and a polygon of one plane share, m².
//!
//! The sum over the sides (a, b) of the signed area that the disc shares with the triangle from its
//! centre: of what lies inside the half cross product, of what lies outside the sector.

use fredholm_mesh::{Patch, Vec3};

/// Area of the part of a patch within `radius` of `centre`, a point of its plane.
pub(super) fn shared(patch: &Patch, centre: Vec3, radius: f64) -> f64 {
    let side = |i: usize| {
        let [a, b] = [patch.corner(i) - centre, patch.corner(i + 1) - centre];
        from_centre(a, b, patch.normal(), radius)
    };
    (0..patch.sides()).map(side).sum::<f64>().max(0.0)
}

/// Signed area that the disc shares with the triangle (0, a, b).
fn from_centre(a: Vec3, b: Vec3, normal: Vec3, radius: f64) -> f64 {
    let along = b - a;
    let (square, half) = (along.length_squared(), a.dot(along));
    let discriminant = half * half - square * (a.length_squared() - radius * radius);
    if discriminant <= 0.0 {
        return sector(a, b, normal, radius);
    }
    let root = discriminant.sqrt();
    let place = |sign: f64| ((sign * root - half) / square).clamp(0.0, 1.0);
    let [p, q] = [place(-1.0), place(1.0)].map(|t| a + along * t);
    sector(a, p, normal, radius) + 0.5 * p.cross(q).dot(normal) + sector(q, b, normal, radius)
}

fn sector(a: Vec3, b: Vec3, normal: Vec3, radius: f64) -> f64 {
    0.5 * radius * radius * a.cross(b).dot(normal).atan2(a.dot(b))
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::f64::consts::PI;

    #[test]
    fn discs_inside_across_and_around_a_square() {
        let corner = |x, y| Vec3::new(x, y, 2.0);
        let square = Patch::quad([corner(0.0, 0.0), corner(1.0, 0.0), corner(1.0, 1.0), corner(0.0, 1.0)])
            .unwrap()
            .unwrap();
        let area = |x, y, radius| shared(&square, corner(x, y), radius);
        assert!((area(0.5, 0.5, 0.25) - PI / 16.0).abs() < 1e-14);
        assert!((area(0.0, 0.0, 0.25) - PI / 64.0).abs() < 1e-14);
        assert!((area(0.5, 0.0, 0.25) - PI / 32.0).abs() < 1e-14);
        assert!((area(0.5, 0.5, 1.0) - 1.0).abs() < 1e-14);
        // The square of side √2 r in a circle: four segments of r²(π/4 − ½) are cut off at r = 0.6.
        let cut =
            0.6_f64.powi(2) * ((0.5 / 0.6_f64).acos() - 0.5 / 0.6 * (1.0 - (0.5 / 0.6_f64).powi(2)).sqrt());
        assert!((area(0.5, 0.5, 0.6) - (0.36 * PI - 4.0 * cut)).abs() < 1e-14);
        assert!(area(3.0, 0.0, 0.5).abs() < 1e-14);
    }
}
