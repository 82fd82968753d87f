//! Fresnel's coefficients between two half-spaces, the first one free space.
//!
//! With w = √(ε − sin²θ), Im w ≤ 0, which is n₂ cos θ_t, and the admittances p₁ = cos θ, p₂ = w
//! (TE, of E) or w/ε (TM, of H):
//!
//! ```text
//! r = (p₁ − p₂)/(p₁ + p₂),   t = 2 p₁/(p₁ + p₂)
//! ```
//!
//! M. Born, E. Wolf, Principles of Optics, 7th ed., Cambridge 1999, § 1.5. r∥ is that of H, so that
//! r⊥ and r∥ of a conductor are −1 and +1; t∥ of E is t∥ of H over n₂.

use super::Coefficients;
use num_complex::Complex64;

/// n cos θ inside a medium, for this sin² θ in free space: the branch that decays.
pub(super) fn slowness(permittivity: Complex64, sin_squared: f64) -> Complex64 {
    let root = (permittivity - sin_squared).sqrt();
    if root.im > 0.0 { -root } else { root }
}

/// Admittances of a medium: TE and TM.
pub(super) fn admittances(permittivity: Complex64, sin_squared: f64) -> [Complex64; 2] {
    let slowness = slowness(permittivity, sin_squared);
    [slowness, slowness / permittivity]
}

/// Reflection and transmission from free space into the relative permittivity ε′ − jε″, at cos θ (0
/// … 1).
#[must_use]
pub fn half_space(permittivity: Complex64, cos: f64) -> Coefficients {
    let second = admittances(permittivity, 1.0 - cos * cos);
    let first = Complex64::from(cos);
    Coefficients {
        reflected: second.map(|second| (first - second) / (first + second)),
        transmitted: second.map(|second| first * 2.0 / (first + second)),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The forms with angles: r⊥ = (cos θ_i − n cos θ_t)/…, r∥ = (n cos θ_i − cos θ_t)/…
    #[test]
    fn agrees_with_the_forms_of_the_textbook() {
        let n: f64 = 1.5;
        for degrees in [0.0_f64, 20.0, 56.0, 85.0] {
            let (sin, cos) = degrees.to_radians().sin_cos();
            let inner = (1.0 - (sin / n).powi(2)).sqrt();
            let got = half_space((n * n).into(), cos);
            let te = (cos - n * inner) / (cos + n * inner);
            let tm = (n * cos - inner) / (n * cos + inner);
            assert!((got.reflected[0] - te).norm() < 1e-14 && (got.reflected[1] - tm).norm() < 1e-14);
            // Power through: Re(p₂)/p₁ |t|².
            for (p, (r, t)) in [n * inner, inner / n].iter().zip(got.reflected.iter().zip(&got.transmitted)) {
                assert!((r.norm_sqr() + p / cos * t.norm_sqr() - 1.0).abs() < 1e-13);
            }
        }
        let brewster = n.atan().cos();
        assert!(half_space((n * n).into(), brewster).reflected[1].norm() < 1e-15);
    }
}
