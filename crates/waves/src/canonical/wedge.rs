//! A perfectly conducting wedge.
//!
//! Between the faces φ = 0 and φ = nπ a plane wave from the azimuth φ′ has, with κ and k_z as in
//! `canonical` and ε₀ = 1, ε_m = 2 else,
//!
//! ```text
//! E_z = (4/n) E_z0 Σ_{m≥1} j^{m/n} J_{m/n}(κρ) sin(mφ/n) sin(mφ′/n) e^{−jk_z z}
//! H_z = (2/n) H_z0 Σ_{m≥0} ε_m j^{m/n} J_{m/n}(κρ) cos(mφ/n) cos(mφ′/n) e^{−jk_z z}
//! ```
//!
//! (J. J. Bowman, T. B. A. Senior, P. L. E. Uslenghi, Electromagnetic and Acoustic Scattering by
//! Simple Shapes, North-Holland 1969, ch. 6; C. A. Balanis, Advanced Engineering Electromagnetics,
//! 2nd ed., Wiley 2012, § 11.6.)

use super::bessel::{pair, terms};
use super::{Medium, Oblique, finite};
use crate::source::PlaneWave;
use crate::{Field, WaveError};
use fredholm_mesh::Vec3;
use num_complex::Complex64;
use std::f64::consts::{FRAC_PI_2, PI, TAU};

/// Angles that differ by less are the same face.
const ON_FACE: f64 = 1e-12;

/// The angle 0 … 2π of a direction across z; y = −0 on the positive side of x is 2π.
pub(super) fn azimuth(x: f64, y: f64) -> f64 {
    let angle = y.atan2(x);
    if angle.is_sign_negative() { angle + TAU } else { angle }
}

/// A perfectly conducting wedge with its edge along z and its faces at the azimuths 0 and nπ; what
/// lies beyond is the conductor. n = 1 is a plane, n = 2 a half-plane.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ConductingWedge {
    n: f64,
}

impl ConductingWedge {
    /// The wedge of the open angle nπ, 0 < n ≤ 2.
    ///
    /// # Errors
    /// [`WaveError::Wedge`] for another n.
    pub fn new(n: f64) -> Result<Self, WaveError> {
        if n > 0.0 && n <= 2.0 { Ok(Self { n }) } else { Err(WaveError::Wedge { value: n }) }
    }

    /// The total field at `p` (m), 0 in the conductor. The work grows with |κρ|; with losses, what
    /// is much weaker than e^{|Im κ|ρ} is lost in rounding.
    ///
    /// # Errors
    /// [`WaveError::Travel`] for a wave along the edge or out of the conductor,
    /// [`WaveError::NotFinite`] on the edge and where the series has no value.
    pub fn total(&self, medium: &Medium, source: &PlaneWave, p: Vec3) -> Result<Field, WaveError> {
        let seen = Oblique::new(medium, source)?;
        let from = self.open(-source.travel());
        let from = from.ok_or(WaveError::Travel { what: "leads out of the conductor" })?;
        if !p.is_finite() {
            return Err(WaveError::NotFinite { what: "a coordinate of the place" });
        }
        let Some(phi) = self.open(p) else { return Ok(Field::ZERO) };
        let rho = p.x.hypot(p.y);
        let z = seen.kappa * rho;
        let last = (self.n * terms(z.norm()) as f64).ceil() as usize;
        // u, ∂u/∂ρ and ∂u/(ρ∂φ) of E_z and H_z, over 2/n.
        let mut sums = [[Complex64::ZERO; 3]; 2];
        for m in 0..=last {
            let order = m as f64 / self.n;
            let [value, next] = pair(order, z)?;
            let weight = if m == 0 { 1.0 } else { 2.0 } * Complex64::cis(FRAC_PI_2 * order);
            let around = value * (order / rho);
            let slope = around - next * seen.kappa;
            let (sin, cos) = (order * phi).sin_cos();
            let (sin_from, cos_from) = (order * from).sin_cos();
            let shares = [([sin, cos], sin_from), ([cos, -sin], cos_from)];
            for (sum, ([same, turned], share)) in sums.iter_mut().zip(shares) {
                let share = weight * share;
                sum[0] += share * value * same;
                sum[1] += share * slope * same;
                sum[2] += share * around * turned;
            }
        }
        let (sin, cos) = (p.y / rho, p.x / rho);
        let of = |i: usize| {
            let [value, along, across] =
                sums[i].map(|sum| sum * seen.axial[i] * seen.along(p.z) * (2.0 / self.n));
            [value, along * cos - across * sin, along * sin + across * cos]
        };
        finite(medium.field([seen.kz, seen.kappa], of(0), of(1)))
    }

    /// The azimuth of a place or direction, if it is not in the conductor.
    fn open(self, p: Vec3) -> Option<f64> {
        let (angle, end) = (azimuth(p.x, p.y), self.n * PI);
        if angle <= end + ON_FACE {
            Some(angle.min(end))
        } else if angle >= TAU - ON_FACE {
            Some(0.0)
        } else {
            None
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::ComplexVector;
    use crate::canonical::tests::{from, maxwell_gap, oblique, wave_of};

    fn media() -> [Medium; 2] {
        let wave = wave_of(3.0);
        [Medium::free_space(&wave), Medium::of(&wave, Complex64::new(2.5, -1.5)).unwrap()]
    }

    fn place(rho: f64, angle: f64) -> Vec3 {
        Vec3::new(rho * angle.cos(), rho * angle.sin(), 0.3)
    }

    /// The incident wave and its images by turns of 2nπ and mirrors, each seen from the other side:
    /// a corner of the angle π/N has 2N of them.
    fn images(medium: &Medium, source: &PlaneWave, p: Vec3, corners: u32) -> Field {
        let step = TAU / f64::from(corners);
        let turned = |v: ComplexVector, angle: f64, flip: f64| {
            let [x, y, z] = v.components();
            let (sin, cos) = angle.sin_cos();
            ComplexVector::from_components([x * cos - y * flip * sin, x * sin + y * flip * cos, z])
        };
        (0..corners)
            .flat_map(|i| [(f64::from(i) * step, 1.0), (f64::from(i) * step, -1.0)])
            .map(|(angle, flip)| {
                // The place as the image sees it: turned back, then mirrored.
                let (sin, cos) = angle.sin_cos();
                let at = Vec3::new(p.x * cos + p.y * sin, flip * (p.y * cos - p.x * sin), p.z);
                let field = medium.incident(source, at);
                // E changes sign in a mirror, and the axial vector H does but there.
                Field { e: turned(field.e * flip, angle, flip), h: turned(field.h, angle, flip) }
            })
            .sum()
    }

    #[test]
    fn a_plane_and_corners_are_images() {
        let source = from([-0.9, -0.4, 0.3], [0.3, 0.2, 1.0]);
        for medium in media() {
            for corners in [1, 2, 3] {
                let n = 1.0 / f64::from(corners);
                let wedge = ConductingWedge::new(n).unwrap();
                for (rho, share) in [(1e-3, 0.3), (0.5, 0.9), (2.0, 0.1), (9.0, 0.6)] {
                    let p = place(rho, share * n * PI);
                    let expected = images(&medium, &source, p, corners);
                    let found = wedge.total(&medium, &source, p).unwrap();
                    let (size, eta) = (expected.e.norm() + found.e.norm(), medium.impedance().norm());
                    let gap = ((found.e - expected.e).norm() + (found.h - expected.h).norm() * eta) / size;
                    assert!(gap < 1e-11, "{corners} {p}: {gap:e}");
                }
            }
        }
    }

    #[test]
    fn it_obeys_maxwell_and_has_no_tangential_field_on_its_faces() {
        for medium in media() {
            for n in [0.4, 1.5, 1.9] {
                let wedge = ConductingWedge::new(n).unwrap();
                let source = from([-0.8, -0.3, 0.5], [0.3, 0.2, 1.0]);
                for share in [0.2, 0.7] {
                    let p = place(0.8, share * n * PI);
                    let gap = maxwell_gap(&medium, p, |p| wedge.total(&medium, &source, p).unwrap());
                    assert!(gap < 1e-8, "{n} {share}: {gap:e}");
                }
                for angle in [0.0, n * PI] {
                    for rho in [1e-6, 0.4, 5.0] {
                        let field = wedge.total(&medium, &source, place(rho, angle)).unwrap();
                        let normal = Vec3::new(-angle.sin(), angle.cos(), 0.0);
                        let tangential = field.e.crossed_by(normal).norm();
                        assert!(tangential < 1e-11 * (1.0 + field.e.norm()), "{n} {rho}: {tangential:e}");
                    }
                }
            }
        }
    }

    /// E across the edge grows as ρ^{1/n − 1} (Balanis, § 11.6).
    #[test]
    fn near_the_edge_it_goes_as_a_power_of_the_distance() {
        let wedge = ConductingWedge::new(1.5).unwrap();
        let source = from([-0.6, -0.8, 0.0], [0.8, -0.6, 0.0]);
        let e = |rho: f64| wedge.total(&media()[0], &source, place(rho, 2.0)).unwrap().e.norm();
        let power = (e(1e-9) / e(8e-9)).ln() / 8_f64.ln();
        assert!((power - 1.0 / 3.0).abs() < 1e-3, "{power}");
    }

    #[test]
    fn what_is_no_wedge_or_comes_out_of_it_is_refused() {
        for n in [0.0, -1.0, 2.1, f64::NAN] {
            assert!(matches!(ConductingWedge::new(n), Err(WaveError::Wedge { .. })), "{n}");
        }
        let wedge = ConductingWedge::new(1.5).unwrap();
        let medium = media()[0];
        let inside = Vec3::new(0.5, -0.5, 0.0);
        assert_eq!(wedge.total(&medium, &oblique(), inside), Ok(Field::ZERO));
        let out = from([-0.6, 0.5, 0.0], [0.0, 0.0, 1.0]);
        assert!(matches!(wedge.total(&medium, &out, Vec3::Y), Err(WaveError::Travel { .. })));
        assert!(matches!(wedge.total(&medium, &oblique(), Vec3::ZERO), Err(WaveError::NotFinite { .. })));
    }
}
