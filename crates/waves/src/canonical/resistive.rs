//! A resistive half-plane: E_tan = Z_s J on y = 0, x > 0, in a wave across its edge.
//!
//! In a wave whose tangential E on y = 0 is E_t e^{jkcx}, the transform J₊(α) = ∫ J e^{jαx} dx
//! obeys K J₊ = jE_t/(k (a + c)) + M₋, with α = ka and M₋ that of the field beyond the edge. With γ
//! = √(1 − a²) and q = η/2, for E along the edge (currents along z) and across it (along x),
//!
//! ```text
//! K = Z_s + q/γ   and   K = Z_s + q γ
//! ```
//!
//! so that J₊ = jE_t/(k (a + c) K₊(c) K₊(a)) where K = K₊(a) K₊(−a) (B. Noble, Methods Based on the
//! Wiener–Hopf Technique, Pergamon 1958; T. B. A. Senior, Scattering by resistive strips, Radio
//! Sci. 14 (1979) 911). Its inverse is the current of a sheet without an edge, and an integral
//! along the cut from a = 1, here straight down to the right in the plane of α, away from all poles
//! of 1/K:
//!
//! ```text
//! J/E_t = e^{jkcx}/K(c) + (j/2π) ∫ K₊(−a)/K₊(c) [1/K(−γ) − 1/K(γ)] e^{−jkax}/(a + c) da
//! ```
//!
//! K₊ is that of s + γ, times a constant, and 1/√(1 − a) for E along the edge. Its logarithmic
//! slope is known, since (π − w)/(π sin w) is the part of 1/γ that is regular in the upper
//! half-plane; with a = cos w and s = sin w₀
//!
//! ```text
//! d ln(s + γ)₊/da = [−a (½ − s (π − w)/(π sin w)) + cos w₀ (w₀/π − ½)]/(cos² w₀ − a²)
//! ```
//!
//! which is regular at a = ±cos w₀, too. So Cauchy's integral becomes one of finite length.

use super::{Medium, Oblique};
use crate::source::PlaneWave;
use crate::{ComplexVector, WaveError};
use fredholm_mesh::Vec3;
use fredholm_quadrature::{IntervalRule, gauss_legendre};
use num_complex::Complex64;
use std::f64::consts::{FRAC_PI_2, FRAC_PI_4, PI, TAU};

/// What a component of a direction is below if the direction is across the axis.
const ACROSS: f64 = 1e-12;
/// Step of ln τ along the cut: nothing singular is closer than a turn of π/4, so that the error is
/// e^{−2π (π/4)/step}.
const STEP: f64 = 0.125;
/// ln τ from where on: what is before is below rounding even as √τ.
const FIRST: f64 = -80.0;
/// e^{−LAST} is below rounding.
const LAST: f64 = 45.0;

/// A thin resistive sheet on the half-plane y = 0, x > 0.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ResistiveHalfPlane {
    resistance: f64,
}

impl ResistiveHalfPlane {
    /// The sheet of this resistance Z_s ≥ 0 (Ω per square); 0 is a perfect conductor.
    ///
    /// # Errors
    /// [`WaveError::Material`] unless Z_s is finite and at least 0.
    pub fn new(resistance: f64) -> Result<Self, WaveError> {
        if resistance >= 0.0 && resistance.is_finite() {
            return Ok(Self { resistance });
        }
        let reason = "the resistance must be finite and at least 0";
        Err(WaveError::Material { what: "of the half-plane".into(), reason })
    }

    /// The currents of both sides together, J = E_tan/Z_s in A/m, at these distances from the edge
    /// (m, above 0), of a wave that travels across the edge. A wave along the sheet with no E in it
    /// drives none.
    ///
    /// # Errors
    /// [`WaveError::Travel`] unless the wave travels across the edge, [`WaveError::Length`] for
    /// another distance, [`WaveError::NotFinite`] where numbers do not reach.
    pub fn currents(
        &self,
        medium: &Medium,
        source: &PlaneWave,
        distances: &[f64],
    ) -> Result<Vec<ComplexVector>, WaveError> {
        Oblique::new(medium, source)?;
        if source.travel().z.abs() > ACROSS {
            return Err(WaveError::Travel { what: "must be across the edge of a resistive half-plane" });
        }
        if let Some(&value) = distances.iter().find(|x| !(**x > 0.0 && x.is_finite())) {
            return Err(WaveError::Length { what: "the distance to the edge", value });
        }
        let incident = medium.incident(source, Vec3::ZERO).e;
        let mut currents = vec![ComplexVector::ZERO; distances.len()];
        for (axis, along) in [(Vec3::X, false), (Vec3::Z, true)] {
            if source.polarisation().dot(axis).abs() < ACROSS {
                continue;
            }
            let edge = Edge::new(self.resistance, medium, along);
            for (current, value) in
                currents.iter_mut().zip(edge.currents(-source.travel().x.clamp(-1.0, 1.0), distances))
            {
                *current += ComplexVector::along(axis, incident.dot(axis) * value);
            }
        }
        if currents.iter().all(|current| current.is_finite()) {
            Ok(currents)
        } else {
            Err(WaveError::NotFinite { what: "the current at this place" })
        }
    }
}

/// The sheet for E along the edge, or across it.
struct Edge {
    along: bool,
    z: f64,
    q: Complex64,
    k: Complex64,
    factor: Factor,
}

impl Edge {
    fn new(z: f64, medium: &Medium, along: bool) -> Self {
        let q = medium.impedance() * 0.5;
        let s = if along { q / z } else { z / q };
        Self { along, z, q, k: medium.wavenumber(), factor: Factor::new(s) }
    }

    /// 1/K.
    fn inverse(&self, gamma: Complex64) -> Complex64 {
        if self.along { gamma / (self.q + gamma * self.z) } else { (self.z + gamma * self.q).inv() }
    }

    /// J over the tangential E of the wave at the edge.
    fn currents(&self, c: f64, distances: &[f64]) -> Vec<Complex64> {
        let nearest = distances.iter().copied().fold(f64::INFINITY, f64::min);
        let last = (LAST / (FRAC_PI_4.cos() * self.k.norm() * nearest)).ln().min(LAST);
        // Straight down to the right in the plane of α, with which k turns.
        let way = Complex64::cis(-FRAC_PI_4 - self.k.arg());
        let left = Complex64::cis(0.5 * (PI - FRAC_PI_4 - self.k.arg()));
        let at_c = self.factor.at(Complex64::from(c.acos()));
        let nodes = ((last - FIRST) / STEP).max(0.0) as usize;
        let cut: Vec<[Complex64; 2]> = (0..nodes)
            .map(|i| {
                let size = (FIRST + i as f64 * STEP).exp();
                let step = way * size;
                // cos and sin of w/2 with cos w = −a; the root of 1 − a is that left of the cut.
                let (cos, sin) = (left * (0.5 * size).sqrt(), (1.0 + 0.5 * step).sqrt());
                let w = angle(if cos.re < 0.0 { -cos } else { cos }, sin) * 2.0;
                let gamma = cos * sin * 2.0;
                let mut ratio = self.factor.at(w) / at_c;
                if self.along {
                    ratio *= (1.0 - c).sqrt() / (2.0 + step).sqrt();
                }
                let jump = self.inverse(-gamma) - self.inverse(gamma);
                let weight = Complex64::new(0.0, STEP / TAU) * step;
                [step, weight * ratio * jump / (step + (1.0 + c))]
            })
            .collect();
        let turn = self.k * -Complex64::I;
        let whole = self.inverse(((1.0 - c) * (1.0 + c)).sqrt().into());
        let at = |x: f64| {
            let diffracted: Complex64 = cut.iter().map(|[step, value]| value * (turn * x * step).exp()).sum();
            (turn * (-c * x)).exp() * whole + (turn * x).exp() * diffracted
        };
        distances.iter().map(|&x| at(x)).collect()
    }
}

/// The factor of s + γ that is regular above, over its value at a = 0.
struct Factor {
    s: Complex64,
    /// w₀ and its cosine.
    zero: [Complex64; 2],
    rule: IntervalRule,
}

impl Factor {
    fn new(s: Complex64) -> Self {
        let cos = (1.0 - s * s).sqrt();
        Self { s, zero: [angle(cos, s), cos], rule: gauss_legendre(16) }
    }

    /// At a = cos w.
    fn at(&self, w: Complex64) -> Complex64 {
        if !self.s.is_finite() {
            return Complex64::ONE;
        }
        // Beside the straight way, on which the removable poles may lie.
        let via = (w + FRAC_PI_2) * 0.5 - Complex64::new(0.0, 0.3);
        (self.integral(FRAC_PI_2.into(), via) + self.integral(via, w)).exp()
    }

    /// ∫ d ln(s + γ)₊ in panels that become shorter towards w = 0, near which a pole may lie.
    fn integral(&self, from: Complex64, to: Complex64) -> Complex64 {
        let (mut at, mut sum) = (from, Complex64::ZERO);
        loop {
            let (left, step) = ((to - at).norm(), (0.5 * at.norm()).clamp(1e-12, 1.0));
            let length = (to - at) * (step / left).min(1.0);
            for (x, weight) in self.rule.points.iter().zip(&self.rule.weights) {
                sum += self.slope(at + length * x) * length * weight;
            }
            if left <= step {
                return sum;
            }
            at += length;
        }
    }

    /// d ln(s + γ)₊/dw.
    fn slope(&self, w: Complex64) -> Complex64 {
        let ([zero, cos_zero], sin, cos) = (self.zero, w.sin(), w.cos());
        let regular = cos * (0.5 * sin - self.s * (PI - w) / PI) - sin * cos_zero * (zero / PI - 0.5);
        regular / ((cos_zero - cos) * (cos_zero + cos))
    }
}

/// The angle with these cosine and sine, from the larger of e^{jw} and e^{−jw}.
fn angle(cos: Complex64, sin: Complex64) -> Complex64 {
    let [plus, minus] = [1.0, -1.0].map(|sign| cos + sin * Complex64::new(0.0, sign));
    if plus.norm() > minus.norm() { plus.ln() * -Complex64::I } else { minus.ln() * Complex64::I }
}

#[cfg(test)]
mod tests;
