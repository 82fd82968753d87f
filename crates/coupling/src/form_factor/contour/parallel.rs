//! ∫∫ ln r ds dt over parallel edges, both integrals closed.
//!
//! With w the distance along them and h across, Φ(w) = ¼ (w² − h²) ln(w² + h²) − ¾ w² + h w
//! atan(w/h) has Φ″ = ½ ln(w² + h²) up to a constant of Φ. E. M. Sparrow 1963,
//! doi:10.1115/1.3686055, does the same for opposite squares.

use super::edge::{Edge, ROUNDING};
use fredholm_quadrature::Estimate;
use std::f64::consts::PI;

/// The integral over edges of the same (`sign` 1) or opposite (−1) direction. The error is that of
/// rounding and, where the edges enclose an angle of sine `sine`, of turning `e` about its middle:
/// a point moved by δ across `f` changes ∫ ln r dt by at most π δ.
pub(super) fn parallel(e: Edge, f: Edge, sign: f64, sine: f64) -> Estimate {
    let d = e.start + e.direction * (0.5 * e.length) - f.start;
    let along = d.dot(f.direction) * sign - 0.5 * e.length;
    let h2 = (d - f.direction * d.dot(f.direction)).length_squared();
    let (a, b) = (along + e.length, sign * f.length);
    let terms = [primitive(a, h2), primitive(along - b, h2), -primitive(a - b, h2), -primitive(along, h2)];
    let largest = terms.iter().fold(0.0, |m: f64, t| m.max(t.abs()));
    // ∂ₛ∂ₜ Φ(w₀ + s − σt) = −σ Φ″.
    Estimate {
        value: sign * terms.iter().sum::<f64>(),
        error: ROUNDING * largest + 0.5 * PI * sine * e.length * e.length,
    }
}

fn primitive(w: f64, h2: f64) -> f64 {
    let (r2, h) = (w * w + h2, h2.sqrt());
    let log = if r2 == 0.0 { 0.0 } else { 0.25 * (w * w - h2) * r2.ln() };
    let angle = if h == 0.0 { 0.0 } else { h * w * (w / h).atan() };
    log - 0.75 * w * w + angle
}
