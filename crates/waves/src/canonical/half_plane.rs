//! A perfectly conducting half-plane.
//!
//! A. Sommerfeld, Math. Ann. 47 (1896) 317, doi:10.1007/BF01447273; with κ and k_z as in
//! `canonical`, φ and φ′ the azimuths of the place and of where the wave comes from, 0 … 2π,
//!
//! ```text
//! E_z = E_z0 (V(φ − φ′) − V(φ + φ′)) e^{−jk_z z},   H_z = H_z0 (V(φ − φ′) + V(φ + φ′)) e^{−jk_z z}
//! V(ψ) = e^{jκρ cos ψ} (e^{jπ/4}/√π) ∫_{−a}^∞ e^{−jt²} dt,   a = √(2κρ) cos(ψ/2)
//! ∇V = jκ V (ρ̂ cos ψ − φ̂ sin ψ) + √(jκ/(2πρ)) e^{−jκρ} (ρ̂ cos(ψ/2) − φ̂ sin(ψ/2))
//! ```
//!
//! (C. A. Balanis, Advanced Engineering Electromagnetics, 2nd ed., Wiley 2012, ch. 13). κ may be
//! complex: V is e^{−jκρ} E(−a), or e^{jκρ cos ψ} − e^{−jκρ} E(a) where Re a > 0, with the function
//! E(a) = ½ erfcx(e^{jπ/4} a) of the edge currents, |arg e^{jπ/4} a| ≤ π/4.

use super::wedge::azimuth;
use super::{Medium, Oblique, finite};
use crate::edges::fresnel;
use crate::source::PlaneWave;
use crate::{ComplexVector, Field, WaveError};
use fredholm_mesh::Vec3;
use num_complex::Complex64;
use std::f64::consts::PI;

/// The perfectly conducting half-plane y = 0, x > 0, without thickness.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct HalfPlane;

impl HalfPlane {
    /// The total field at `p` (m). On the half-plane y = 0 is the side towards +y, and y = −0 the
    /// one towards −y.
    ///
    /// # Errors
    /// [`WaveError::Travel`] for a wave along the edge, [`WaveError::NotFinite`] on the edge and
    /// where numbers do not reach.
    pub fn total(&self, medium: &Medium, source: &PlaneWave, p: Vec3) -> Result<Field, WaveError> {
        let seen = Oblique::new(medium, source)?;
        let (rho, phi) = (p.x.hypot(p.y), azimuth(p.x, p.y));
        let from = azimuth(-source.travel().x, -source.travel().y);
        let [direct, mirrored] = [phi - from, phi + from].map(|psi| part(seen.kappa, rho, psi));
        let (sin, cos) = (p.y / rho, p.x / rho);
        let of = |i: usize, sign: f64| {
            let scale = seen.axial[i] * seen.along(p.z);
            let [value, along, across] = [0, 1, 2].map(|c| (direct[c] + mirrored[c] * sign) * scale);
            [value, along * cos - across * sin, along * sin + across * cos]
        };
        finite(medium.field([seen.kz, seen.kappa], of(0, -1.0), of(1, 1.0)))
    }

    /// The currents of both sides together, ŷ × (H(+0) − H(−0)) in A/m, at `x` > 0 and `z` (m).
    ///
    /// # Errors
    /// Those of [`Self::total`]; [`WaveError::Length`] unless x is above 0.
    pub fn current(
        &self,
        medium: &Medium,
        source: &PlaneWave,
        x: f64,
        z: f64,
    ) -> Result<ComplexVector, WaveError> {
        if !(x > 0.0 && x.is_finite()) {
            return Err(WaveError::Length { what: "the distance to the edge", value: x });
        }
        let side = |y: f64| self.total(medium, source, Vec3::new(x, y, z)).map(|field| field.h);
        Ok((side(0.0)? - side(-0.0)?).crossed_by(Vec3::Y))
    }
}

/// V, ∂V/∂ρ and ∂V/(ρ∂ψ).
fn part(kappa: Complex64, rho: f64, psi: f64) -> [Complex64; 3] {
    let (sin, cos) = (0.5 * psi).sin_cos();
    let edge = (kappa * rho * -Complex64::I).exp();
    let a = Complex64::I.sqrt() * (kappa * (2.0 * rho)).sqrt() * cos.abs();
    let diffracted = edge * fresnel::of(a);
    let plane = kappa * Complex64::I;
    let value = if cos > 0.0 { (plane * rho * psi.cos()).exp() - diffracted } else { diffracted };
    let bent = edge * (plane / (2.0 * PI * rho)).sqrt();
    [value, plane * value * psi.cos() + bent * cos, -plane * value * psi.sin() - bent * sin]
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::canonical::ConductingWedge;
    use crate::canonical::tests::{from, maxwell_gap, oblique, wave_of};
    use num_complex::Complex64;

    fn lossy() -> Medium {
        Medium::of(&wave_of(3.0), Complex64::new(2.5, -1.5)).unwrap()
    }

    fn free() -> Medium {
        Medium::free_space(&wave_of(3.0))
    }

    fn place(rho: f64, degrees: f64) -> Vec3 {
        let (sin, cos) = degrees.to_radians().sin_cos();
        Vec3::new(rho * cos, rho * sin, 0.3)
    }

    fn gap(medium: &Medium, a: Field, b: Field) -> f64 {
        let eta = medium.impedance().norm();
        ((a.e - b.e).norm() + (a.h - b.h).norm() * eta) / (1.0 + b.e.norm() + b.h.norm() * eta)
    }

    #[test]
    fn it_obeys_maxwell_and_has_no_tangential_field_on_the_faces() {
        for medium in [free(), lossy()] {
            for (rho, degrees) in [(0.5, 20.0), (0.5, 130.0), (1.0, 220.0), (2.0, 300.0), (0.3, 90.0)] {
                let p = place(rho, degrees);
                let found = maxwell_gap(&medium, p, |p| HalfPlane.total(&medium, &oblique(), p).unwrap());
                assert!(found < 1e-8, "{p}: {found:e}");
            }
            for y in [0.0, -0.0] {
                for x in [1e-6, 0.3, 4.0] {
                    let field = HalfPlane.total(&medium, &oblique(), Vec3::new(x, y, 0.2)).unwrap();
                    let tangential = field.e.crossed_by(Vec3::Y).norm();
                    assert!(tangential < 1e-12 * (1.0 + field.e.norm()), "{x} {y}: {tangential:e}");
                    assert!(field.h.dot(Vec3::Y).norm() < 1e-14 * (1.0 + field.e.norm()));
                }
            }
        }
    }

    #[test]
    fn it_is_the_wedge_without_thickness() {
        let wedge = ConductingWedge::new(2.0).unwrap();
        for medium in [free(), lossy()] {
            for source in
                [oblique(), from([1.0, 0.2, 0.0], [0.1, 0.3, 1.0]), from([0.3, 0.8, -0.4], [0.0, 0.0, 1.0])]
            {
                for (rho, degrees) in
                    [(1e-3, 10.0), (0.4, 100.0), (2.0, 200.0), (6.0, 275.0), (1.0, 0.0), (3.0, 355.0)]
                {
                    let p = place(rho, degrees);
                    let expected = wedge.total(&medium, &source, p).unwrap();
                    let found = HalfPlane.total(&medium, &source, p).unwrap();
                    assert!(
                        gap(&medium, found, expected) < 1e-11,
                        "{p}: {:e}",
                        gap(&medium, found, expected)
                    );
                }
            }
        }
    }

    /// E_z and J_x rise as √ρ, and J_z falls as 1/√ρ.
    #[test]
    fn near_the_edge_it_goes_as_the_root_of_the_distance() {
        let electric = from([-0.6, -0.8, 0.0], [0.0, 0.0, 1.0]);
        let magnetic = from([-0.6, -0.8, 0.0], [0.8, -0.6, 0.0]);
        for medium in [free(), lossy()] {
            let ratio = |of: &dyn Fn(f64) -> Complex64| of(4e-8) / of(1e-8);
            let e = |rho: f64| HalfPlane.total(&medium, &electric, place(rho, 120.0)).unwrap().e.dot(Vec3::Z);
            let z = |x: f64| HalfPlane.current(&medium, &electric, x, 0.0).unwrap().dot(Vec3::Z);
            let x = |x: f64| HalfPlane.current(&medium, &magnetic, x, 0.0).unwrap().dot(Vec3::X);
            let ratios = [ratio(&e), ratio(&z), ratio(&x)];
            for (found, expected) in ratios.into_iter().zip([2.0, 0.5, 2.0]) {
                assert!((found / expected - 1.0).norm() < 1e-3, "{found} {expected}");
            }
        }
    }

    /// Values of mpmath 1.4.1, 40 digits, for a wave of 1 V/m from 70°: J_z η and J_x η at x = 0.4
    /// by V with erfc, and its slope by differences.
    #[test]
    fn the_current_of_both_sides() {
        let (sin, cos) = 70_f64.to_radians().sin_cos();
        let amplitude = Complex64::new(0.8, -0.6);
        let electric = from([-cos, -sin, 0.0], [0.0, 0.0, 1.0]);
        let magnetic = from([-cos, -sin, 0.0], [sin, -cos, 0.0]);
        for (medium, z, x) in [
            (
                free(),
                Complex64::new(1.537_240_386_374_633_7, 0.724_629_483_076_152_2),
                Complex64::new(1.994_077_525_927_352, 1.584_971_466_999_771_9),
            ),
            (
                lossy(),
                Complex64::new(1.720_664_298_914_999_5, 1.439_484_576_040_616_8),
                Complex64::new(2.173_487_955_888_377_7, 1.726_400_977_962_785_5),
            ),
        ] {
            let scale = amplitude / medium.impedance();
            let found = HalfPlane.current(&medium, &electric, 0.4, 0.0).unwrap().dot(Vec3::Z);
            assert!((found / scale - z).norm() < 1e-12, "{} {z}", found / scale);
            let found = HalfPlane.current(&medium, &magnetic, 0.4, 0.0).unwrap().dot(Vec3::X);
            assert!((found / scale - x).norm() < 1e-12, "{} {x}", found / scale);
        }
    }

    #[test]
    fn far_from_the_shadow_boundaries_it_is_geometric_optics() {
        let source = from([-0.6, -0.8, 0.0], [0.3, 0.2, 1.0]);
        let mirrored = |p: Vec3| {
            let image = free().incident(&source, Vec3::new(p.x, -p.y, p.z));
            let flip = |v: ComplexVector, sign: f64| {
                let [x, y, z] = v.components();
                ComplexVector::from_components([x * sign, y * -sign, z * sign])
            };
            Field { e: flip(image.e, -1.0), h: flip(image.h, 1.0) }
        };
        // Lit with a reflection, lit without one, and the shadow; the edge's wave falls as 1/√(kρ).
        for (degrees, lit, reflected) in [(40.0, 1.0, 1.0), (160.0, 1.0, 0.0), (320.0, 0.0, 0.0)] {
            let error = |rho: f64| {
                let p = place(rho, degrees);
                let expected = free().incident(&source, p) * lit + mirrored(p) * reflected;
                let found = HalfPlane.total(&free(), &source, p).unwrap();
                (found.e - expected.e).norm() + (found.h - expected.h).norm() * 377.0
            };
            let [near, far] = [error(1e4), error(1e6)];
            assert!(near < 0.02 && (near / far - 10.0).abs() < 0.01, "{degrees}: {near:e} {far:e}");
        }
    }

    #[test]
    fn the_edge_has_no_field_and_the_half_plane_no_current_beyond_it() {
        assert!(matches!(HalfPlane.total(&free(), &oblique(), Vec3::Z), Err(WaveError::NotFinite { .. })));
        let found = HalfPlane.current(&free(), &oblique(), -1.0, 0.0);
        assert!(matches!(found, Err(WaveError::Length { .. })));
    }
}
