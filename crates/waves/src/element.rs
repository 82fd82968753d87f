//! The field of a current element, exact at any distance.
//!
//! With d = r − q, R = |d|, u = d/R and g = e^{−jkR}/(4πR) (C. A. Balanis, Antenna Theory, 4th ed.,
//! Wiley 2016, § 3.6):
//!
//! ```text
//! electric element J dA:  E = −jkη g [J (1 + 1/(jkR) − 1/(kR)²) − u (u·J) (1 + 3/(jkR) − 3/(kR)²)] dA
//!                         H = −(jk + 1/R) g (u × J) dA
//! magnetic element M dA:  E = +(jk + 1/R) g (u × M) dA,  H = E_J(J → M)/η² (duality)
//! ```
//!
//! J dA in A m, M dA in V m, lengths in metres.

use crate::medium::IMPEDANCE;
use crate::{ComplexVector, Field, Wave};
use fredholm_mesh::Vec3;
use num_complex::Complex64;
use std::f64::consts::TAU;

/// The field of an electric element `moment` (A m) at the separation `d` = r − q, m.
#[must_use]
pub fn electric_element(wave: &Wave, moment: ComplexVector, d: Vec3) -> Field {
    let scalars = Scalars::new(wave.wavenumber(), d.length());
    let along = Complex64::new(moment.re.dot(d), moment.im.dot(d));
    let e = moment * scalars.across + ComplexVector::along(d, scalars.along * along);
    Field { e: e * IMPEDANCE, h: moment.crossed_by(d) * scalars.curl }
}

/// The field of a magnetic element `moment` (V m) at the separation `d` = r − q, m.
#[must_use]
pub fn magnetic_element(wave: &Wave, moment: ComplexVector, d: Vec3) -> Field {
    dual(electric_element(wave, moment, d))
}

/// The field of magnetic currents M, from that of electric ones J = M: (E, H) → (−H, E/η²).
#[must_use]
pub(crate) fn dual(field: Field) -> Field {
    Field { e: -field.h, h: field.e * (1.0 / (IMPEDANCE * IMPEDANCE)) }
}

/// −(jk + 1/R) g/R: what d × J is multiplied by.
#[must_use]
pub(crate) fn curl(k: f64, distance: f64) -> Complex64 {
    Scalars::new(k, distance).curl
}

/// The three functions of the distance: E/η = across J + along d (d·J), H = curl d × J.
struct Scalars {
    across: Complex64,
    along: Complex64,
    curl: Complex64,
}

impl Scalars {
    fn new(k: f64, distance: f64) -> Self {
        let inverse = 1.0 / distance;
        let square = inverse * inverse;
        let g = Complex64::cis(-k * distance) / (2.0 * TAU);
        let third = inverse * square / k;
        Self {
            across: -g * Complex64::new(square, k * inverse - third),
            along: g * square * Complex64::new(3.0 * square, k * inverse - 3.0 * third),
            curl: -g * square * Complex64::new(inverse, k),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Central difference of a vector field along an axis.
    fn derivative(f: impl Fn(Vec3) -> ComplexVector, p: Vec3, axis: Vec3, step: f64) -> ComplexVector {
        (f(p + axis * step) - f(p - axis * step)) * (0.5 / step)
    }

    fn rotation(f: impl Fn(Vec3) -> ComplexVector, p: Vec3, step: f64) -> ComplexVector {
        let axes = [Vec3::X, Vec3::Y, Vec3::Z];
        axes.iter().map(|&axis| derivative(&f, p, axis, step).crossed_by(axis)).sum()
    }

    #[test]
    fn both_elements_obey_the_equations_of_maxwell_near_and_far() {
        let wave = Wave::new(1e9).unwrap();
        let moment = ComplexVector { re: Vec3::new(0.3, -1.0, 0.6), im: Vec3::new(-0.2, 0.4, 0.9) };
        for distance in [0.01, 0.05, 0.3, 2.0] {
            let p = Vec3::new(0.48, -0.6, 0.64) * distance;
            for element in [electric_element, magnetic_element] {
                let step = 1e-4 * distance.min(0.05);
                let field = element(&wave, moment, p);
                let jk = Complex64::new(0.0, wave.wavenumber());
                let faraday = rotation(|q| element(&wave, moment, q).e, p, step) + field.h * (jk * IMPEDANCE);
                let ampere = rotation(|q| element(&wave, moment, q).h, p, step) + field.e * (-jk / IMPEDANCE);
                let scale = field.e.norm() / distance + field.h.norm() * IMPEDANCE / distance;
                assert!(faraday.norm() < 1e-6 * scale, "{distance}: {} of {scale}", faraday.norm());
                assert!(ampere.norm() * IMPEDANCE < 1e-6 * scale, "{distance}: {}", ampere.norm());
            }
        }
    }

    #[test]
    fn the_power_of_a_hertzian_dipole_is_that_of_the_textbook() {
        // P = η k² |Il|²/(12π), from the far power density of one direction: S = (3/2) P
        // sin²θ/(4πr²).
        let wave = Wave::new(3e8).unwrap();
        let r = 1e4;
        let field = electric_element(&wave, ComplexVector::along(Vec3::Z, 1.0.into()), Vec3::X * r);
        let power = IMPEDANCE * wave.wavenumber().powi(2) / (6.0 * TAU);
        let density = 1.5 * power / (2.0 * TAU * r * r);
        assert!((field.power_density().x / density - 1.0).abs() < 1e-7);
    }
}
