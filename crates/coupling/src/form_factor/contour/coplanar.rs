//! ∫∫ ln r ds dt over edges in one plane, such as those that touch: four inner integrals.
//!
//! Measured from the point where the lines of the edges meet, r² = s² + t² − 2 s t cos φ is
//! homogeneous in (s, t), so that div((s, t) ln r) = 2 ln r + 1, and Gauss' theorem over [s₀, s₁] ×
//! [t₀, t₁] leaves
//!
//! ∫∫ ln r = ½ [s₁ I(s₁) − s₀ I(s₀) + t₁ J(t₁) − t₀ J(t₀) − (s₁ − s₀)(t₁ − t₀)],
//!
//! I(s) = ∫ ln r dt from the point s of the first edge along the second, J(t) the other way round.
//! At a common corner two of the four vanish.

use super::edge::{Edge, ROUNDING, log_integral};
use fredholm_mesh::Vec3;
use fredholm_quadrature::Estimate;
use std::f64::consts::PI;

/// The integral, with the error of rounding and of taking lines that pass at a small distance as
/// meeting; `None` for parallel lines.
pub(super) fn coplanar(e: Edge, f: Edge) -> Option<Estimate> {
    let normal = e.direction.cross(f.direction);
    let sine2 = normal.length_squared();
    let gap2 = (f.start - e.start).dot(normal).powi(2) / sine2;
    let [s0, t0] = meeting(e, f, sine2);
    let (s1, t1) = (s0 + e.length, t0 + f.length);
    let term = |place: f64, from: Vec3, along: Edge| {
        if place == 0.0 { 0.0 } else { place * log_integral(from, along) }
    };
    let terms = [term(s1, e.end(), f), -term(s0, e.start, f), term(t1, f.end(), e), -term(t0, f.start, e)];
    let value = 0.5 * (terms.iter().sum::<f64>() - e.length * f.length);
    let largest = terms.iter().fold(e.length * f.length, |m, t| m.max(t.abs()));
    let error = ROUNDING * largest / sine2 + passing(gap2, sine2.sqrt());
    error.is_finite().then_some(Estimate { value, error })
}

/// Places of the starts, counted along each edge from the point where the lines meet.
fn meeting(e: Edge, f: Edge, sine2: f64) -> [f64; 2] {
    let (w, cosine) = (e.start - f.start, e.direction.dot(f.direction));
    let (along_e, along_f) = (w.dot(e.direction), w.dot(f.direction));
    [(along_e - cosine * along_f) / sine2, (cosine * along_e - along_f) / sine2]
}

/// Bound of the change of the integral where the lines pass at distance h: ∂/∂h = ∫∫ h/r² ≤ (π
/// h/sin φ) ln(1 + R²/h²) over edges within R = 4 typical distances.
fn passing(gap2: f64, sine: f64) -> f64 {
    if gap2 == 0.0 { 0.0 } else { 0.5 * PI / sine * gap2 * (1.0 + (1.0 + 16.0 / gap2).ln()) }
}
