//! The kernel of diffuse light, cosθp cosθq / (π r²) (1/m²), without visibility.
//!
//! M. F. Cohen, J. R. Wallace, *Radiosity and Realistic Image Synthesis*, Academic Press 1993, eq.
//! 4.4. Symmetric in p and q; 0 when either point is behind the other; singular as 1/r² where both
//! cosines stay away from 0, bounded on a flat patch.

use fredholm_mesh::Vec3;
use std::f64::consts::FRAC_1_PI;

/// cosθp cosθq / (π r²) between a point p with normal np and a point q with normal nq, 1/m².
///
/// ```
/// use fredholm_coupling::kernel::lambert;
/// use fredholm_mesh::Vec3;
/// let facing = lambert(Vec3::ZERO, Vec3::Z, Vec3::Z * 2.0, Vec3::NEG_Z);
/// assert!((facing - 0.25 / std::f64::consts::PI).abs() < 1e-16);
/// ```
#[must_use]
pub fn lambert(p: Vec3, np: Vec3, q: Vec3, nq: Vec3) -> f64 {
    let d = q - p;
    let r2 = d.length_squared();
    let (cp, cq) = (d.dot(np), -d.dot(nq));
    if cp <= 0.0 || cq <= 0.0 { 0.0 } else { FRAC_1_PI * cp * cq / (r2 * r2) }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn is_symmetric_and_one_sided() {
        let (p, np) = (Vec3::new(0.1, 0.2, 0.0), Vec3::Z);
        let (q, nq) = (Vec3::new(1.0, -0.3, 0.7), Vec3::new(-1.0, 0.0, -0.2).normalize());
        assert!((lambert(p, np, q, nq) - lambert(q, nq, p, np)).abs() < 1e-16);
        assert!(lambert(p, -np, q, nq) == 0.0 && lambert(p, np, q, -nq) == 0.0);
    }

    #[test]
    fn falls_with_the_square_of_the_distance() {
        let at = |r: f64| lambert(Vec3::ZERO, Vec3::Z, Vec3::Z * r, Vec3::NEG_Z);
        assert!((at(1.0) / at(10.0) - 100.0).abs() < 1e-12);
    }
}
