//! The exact scattering of a plane wave by a sphere, perfectly conducting or dielectric: the series
//! of Mie; in the files beside it those of other boundaries.
//!
//! G. Mie, Ann. Phys. 330 (1908) 377, doi:10.1002/andp.19083300302; here as C. F. Bohren, D. R.
//! Huffman, Absorption and Scattering of Light by Small Particles, Wiley 1983, § 4.3 and 4.4, whose
//! time factor e^{−iωt} makes ours the conjugate. For E_i = x̂ e^{ikz}, with x = ka, ψ(x) = x j_n,
//! ξ(x) = x h_n and E_n = iⁿ (2n + 1)/(n(n + 1)),
//!
//! ```text
//! E_s = Σ E_n (i a_n N_n − b_n M_n)
//! conductor:   a_n = ψ_n′(x)/ξ_n′(x),                    b_n = ψ_n(x)/ξ_n(x)
//! dielectric:  a_n = (m ψ_n′ − D_n ψ_n)/(m ξ_n′ − D_n ξ_n),  b_n = (ψ_n′ − m D_n ψ_n)/(ξ_n′ − m D_n ξ_n)
//! ```
//!
//! where m = √ε and D_n = ψ_n′(mx)/ψ_n(mx), which is computed downwards (eq. 4.89).
//!
//! Backscatter: σ/(πa²) = |Σ (−1)ⁿ (2n + 1)/(ξ_n ξ_n′)|²/x² (C. A. Balanis, Advanced Engineering
//! Electromagnetics, 2nd ed., Wiley 2012, eq. 11-247). Lengths in metres.

mod impedance;
mod layered;
mod shell;

pub use impedance::ImpedanceSphere;
pub use layered::LayeredSphere;
pub use shell::ResistiveShell;

use crate::source::PlaneWave;
use crate::{ComplexVector, Wave, WaveError};
use fredholm_mesh::Vec3;
use num_complex::Complex64;

/// Distance from the centre, in radii, below which the field inside is that at it.
const LEAST_DISTANCE: f64 = 1e-6;

/// A perfectly conducting sphere around the origin.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ConductingSphere {
    radius: f64,
}

impl ConductingSphere {
    /// The sphere of this radius, m.
    ///
    /// # Errors
    /// [`WaveError::Length`] unless the radius is finite and above 0.
    pub fn new(radius: f64) -> Result<Self, WaveError> {
        if radius > 0.0 && radius.is_finite() {
            Ok(Self { radius })
        } else {
            Err(WaveError::Length { what: "the radius of the sphere", value: radius })
        }
    }

    /// σ/(πa²) straight back.
    #[must_use]
    pub fn backscatter(&self, wave: &Wave) -> f64 {
        let x = wave.wavenumber() * self.radius;
        let outgoing = Riccati::new(x, terms(x));
        let term = |n: usize| {
            let sign = if n.is_multiple_of(2) { 1.0 } else { -1.0 };
            sign * (2 * n + 1) as f64 / (outgoing.xi(n) * outgoing.xi_slope(n))
        };
        (1..=terms(x)).map(term).sum::<Complex64>().norm_sqr() / (x * x)
    }

    /// The scattered E (V/m) at `p` (m, outside), exact at any distance.
    #[must_use]
    pub fn scattered(&self, wave: &Wave, source: &PlaneWave, p: Vec3) -> ComplexVector {
        let x = wave.wavenumber() * self.radius;
        let inner = Riccati::new(x, terms(x));
        let term = |n: usize| [inner.psi_slope(n) / inner.xi_slope(n), inner.psi(n) / inner.xi(n)];
        Series((1..=terms(x)).map(term).collect()).scattered(wave, source, p)
    }
}

/// A homogeneous dielectric sphere around the origin, in free space.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct DielectricSphere {
    radius: f64,
    permittivity: Complex64,
}

impl DielectricSphere {
    /// The sphere of this radius (m) and relative permittivity ε′ − jε″.
    ///
    /// # Errors
    /// [`WaveError::Length`] unless the radius is finite and above 0, [`WaveError::Material`]
    /// unless ε is finite with ε′ > 0 and ε″ ≥ 0.
    pub fn new(radius: f64, permittivity: Complex64) -> Result<Self, WaveError> {
        ConductingSphere::new(radius)?;
        if permittivity.re > 0.0 && permittivity.im <= 0.0 && permittivity.is_finite() {
            return Ok(Self { radius, permittivity });
        }
        let reason = "the permittivity ε′ − jε″ must be finite with ε′ > 0 and ε″ ≥ 0";
        Err(WaveError::Material { what: "of the sphere".into(), reason })
    }

    /// The scattered E (V/m) at `p` (m, outside), exact at any distance.
    #[must_use]
    pub fn scattered(&self, wave: &Wave, source: &PlaneWave, p: Vec3) -> ComplexVector {
        self.series(wave).scattered(wave, source, p)
    }

    /// The total E (V/m) at `p` (m, inside).
    #[must_use]
    pub fn inside(&self, wave: &Wave, source: &PlaneWave, p: Vec3) -> ComplexVector {
        // Directions are lost at the centre, and the field changes with the square of the distance.
        let least = LEAST_DISTANCE * self.radius;
        let p = if p.length() < least { source.travel() * least } else { p };
        let x = wave.wavenumber() * self.radius;
        let (at, m) = (Riccati::new(x, terms(x)), self.index());
        // What arrives is the series with a_n = b_n = −1 of regular waves. H and E along the surface
        // are the same on both sides: two conditions for each order, u and u′, of which either may
        // have a zero of ψ_n or ψ_n′ before the unknown.
        let scattered = self.series(wave).0;
        let [z, surface] = [m * (wave.wavenumber() * p.length()), m * x];
        let [within, border] = [z, surface].map(|z| Regular::new(z, scattered.len()));
        let term = |(i, [a, b]): (usize, &[Complex64; 2])| {
            let n = i + 1;
            let (psi, slope) = (border.psi[n], border.slope(n));
            let inside = |u: Complex64, v: Complex64| {
                (psi.conj() * u + slope.conj() * v) / (psi.norm_sqr() + slope.norm_sqr())
            };
            let value = |c: &Complex64| c * at.xi(n) - at.psi(n);
            let change = |c: &Complex64| c * at.xi_slope(n) - at.psi_slope(n);
            [inside(value(a), m * change(a)), inside(m * value(b), change(b))]
        };
        let series = Series(scattered.iter().enumerate().map(term).collect());
        let growth = (within.exponent - border.exponent).exp();
        series.field(source, p, z, |n| [within.psi[n] * growth, within.slope(n) * growth])
    }

    /// Cross-sections of extinction and of scattering, m².
    #[must_use]
    pub fn cross_sections(&self, wave: &Wave) -> [f64; 2] {
        self.series(wave).cross_sections(wave)
    }

    /// √ε in the time factor of the series, which is the conjugate of ours.
    fn index(&self) -> Complex64 {
        self.permittivity.conj().sqrt()
    }

    fn series(&self, wave: &Wave) -> Series {
        let x = wave.wavenumber() * self.radius;
        let inner = Riccati::new(x, terms(x));
        let m = self.index();
        let slopes = logarithmic_slopes(m * x, terms(x));
        let term = |n: usize| {
            let (psi, psi_slope) = (inner.psi(n), inner.psi_slope(n));
            let (xi, xi_slope, d) = (inner.xi(n), inner.xi_slope(n), slopes[n]);
            [
                (m * psi_slope - d * psi) / (m * xi_slope - d * xi),
                (psi_slope - m * d * psi) / (xi_slope - m * d * xi),
            ]
        };
        Series((1..=terms(x)).map(term).collect())
    }
}

/// Refuses a radius (m) that is none, and for a reason an impedance that gives energy away.
fn check_passive(
    radius: f64,
    impedance: Complex64,
    (what, reason): (&str, &'static str),
) -> Result<(), WaveError> {
    ConductingSphere::new(radius)?;
    if impedance.re >= 0.0 && impedance.is_finite() {
        return Ok(());
    }
    Err(WaveError::Material { what: what.into(), reason })
}

/// D_n = ψ_n′/ψ_n at z for n = 0 … last, downwards from far above the turning point.
fn logarithmic_slopes(z: Complex64, last: usize) -> Vec<Complex64> {
    let start = last.max(z.norm().ceil() as usize) + 30;
    let mut slopes = vec![Complex64::ZERO; start + 1];
    for n in (1..=start).rev() {
        let ratio = n as f64 / z;
        slopes[n - 1] = ratio - (slopes[n] + ratio).inv();
    }
    slopes.truncate(last + 1);
    slopes
}

/// a_n and b_n from n = 1 on.
struct Series(Vec<[Complex64; 2]>);

impl Series {
    /// Cross-sections of extinction and of scattering, m² (Bohren and Huffman, eq. 4.61 and 4.62).
    fn cross_sections(&self, wave: &Wave) -> [f64; 2] {
        let k = wave.wavenumber();
        let weighted = |value: fn(Complex64) -> f64| {
            let term = |(i, [a, b]): (usize, &[Complex64; 2])| (2 * i + 3) as f64 * (value(*a) + value(*b));
            self.0.iter().enumerate().map(term).sum::<f64>() * std::f64::consts::TAU / (k * k)
        };
        [weighted(|c| c.re), weighted(|c| c.norm_sqr())]
    }

    /// The field of outgoing waves.
    fn scattered(&self, wave: &Wave, source: &PlaneWave, p: Vec3) -> ComplexVector {
        let outer = Riccati::new(wave.wavenumber() * p.length(), self.0.len());
        self.field(source, p, outer.x.into(), |n| [outer.xi(n), outer.xi_slope(n)])
    }

    /// The field of regular waves in place of the outgoing ones.
    fn regular(&self, wave: &Wave, source: &PlaneWave, p: Vec3) -> ComplexVector {
        let inner = Riccati::new(wave.wavenumber() * p.length(), self.0.len());
        self.field(source, p, inner.x.into(), |n| [inner.psi(n).into(), inner.psi_slope(n).into()])
    }

    /// The field of waves with these radial functions and their slopes at `rho`, kr in the medium.
    fn field(
        &self,
        source: &PlaneWave,
        p: Vec3,
        rho: Complex64,
        radial: impl Fn(usize) -> [Complex64; 2],
    ) -> ComplexVector {
        let [x, y, z] =
            [source.polarisation(), source.travel().cross(source.polarisation()), source.travel()];
        let local = Vec3::new(p.dot(x), p.dot(y), p.dot(z));
        let (r, across) = (local.length(), local.x.hypot(local.y));
        let (cos_phi, sin_phi) = if across > 0.0 { (local.x / across, local.y / across) } else { (1.0, 0.0) };
        let [radial, polar, azimuthal] = self.sums(rho, radial, local.z / r, across / r);
        let out = p / r;
        let outward = x * cos_phi + y * sin_phi;
        let theta = outward * (local.z / r) - z * (across / r);
        let phi = y * cos_phi - x * sin_phi;
        let field = ComplexVector::along(out, radial * cos_phi)
            + ComplexVector::along(theta, polar * cos_phi)
            + ComplexVector::along(phi, azimuthal * -sin_phi);
        field.conj() * source.amplitude()
    }

    /// Σ E_n (i a_n N_n − b_n M_n) without cos φ (r, θ) and −sin φ (φ).
    fn sums(
        &self,
        rho: Complex64,
        radial: impl Fn(usize) -> [Complex64; 2],
        cos: f64,
        sin: f64,
    ) -> [Complex64; 3] {
        let mut sums = [Complex64::ZERO; 3];
        let (mut earlier, mut pi, mut phase) = (0.0, 1.0, Complex64::I);
        for (i, [a, b]) in self.0.iter().enumerate() {
            let n = i + 1;
            let order = n as f64;
            let tau = order * cos * pi - (order + 1.0) * earlier;
            let factor = phase * (2.0 * order + 1.0) / (order * (order + 1.0));
            let (a, b) = (factor * Complex64::I * a, factor * b);
            let [h, slope] = radial(n).map(|value| value / rho);
            sums[0] += a * h / rho * (order * (order + 1.0) * sin * pi);
            sums[1] += a * slope * tau - b * h * pi;
            sums[2] += a * slope * pi - b * h * tau;
            (earlier, pi) = (pi, ((2.0 * order + 1.0) * cos * pi - (order + 1.0) * earlier) / order);
            phase *= Complex64::I;
        }
        sums
    }
}

/// Terms that leave an error far below rounding (W. J. Wiscombe, Appl. Opt. 19 (1980) 1505,
/// doi:10.1364/AO.19.001505, with some more).
fn terms(x: f64) -> usize {
    (x + 4.05 * x.cbrt() + 10.0).ceil() as usize
}

/// ψ_n = x j_n(x) and ξ_n = x h_n⁽¹⁾(x) for n = 0 … last.
struct Riccati {
    x: f64,
    psi: Vec<f64>,
    xi: Vec<Complex64>,
}

impl Riccati {
    fn new(x: f64, last: usize) -> Self {
        // Below the turning point n = x both functions oscillate, and upwards is stable; beyond it
        // only χ = −x y_n grows.
        let (sin, cos) = x.sin_cos();
        let chi = upwards(x, last, cos, cos / x + sin);
        let psi = if x > last as f64 {
            upwards(x, last, sin, sin / x - cos)
        } else {
            Regular::new(x.into(), last).psi.iter().map(|value| value.re).collect()
        };
        let xi = psi.iter().zip(&chi).map(|(&psi, &chi)| Complex64::new(psi, -chi)).collect();
        Self { x, psi, xi }
    }

    fn psi(&self, n: usize) -> f64 {
        self.psi[n]
    }

    fn xi(&self, n: usize) -> Complex64 {
        self.xi[n]
    }

    fn psi_slope(&self, n: usize) -> f64 {
        self.psi[n - 1] - n as f64 / self.x * self.psi[n]
    }

    fn xi_slope(&self, n: usize) -> Complex64 {
        self.xi[n - 1] - self.xi[n] * (n as f64 / self.x)
    }
}

/// The solution of f_{n+1} = (2n + 1)/x f_n − f_{n−1} from its first two values.
fn upwards(x: f64, last: usize, zero: f64, one: f64) -> Vec<f64> {
    let mut values = vec![zero, one];
    for n in 1..last {
        values.push((2 * n + 1) as f64 / x * values[n] - values[n - 1]);
    }
    values
}

/// ψ_n(z) e^{−exponent} for n = 0 … last, exponent = |Im z|: nothing overflows.
struct Regular {
    z: Complex64,
    exponent: f64,
    psi: Vec<Complex64>,
}

impl Regular {
    /// Downwards from far above the turning point (J. C. P. Miller), scaled by the larger of ψ₀ and
    /// ψ₁.
    fn new(z: Complex64, last: usize) -> Self {
        let start = last.max(z.norm().ceil() as usize) + 30;
        let mut psi = vec![Complex64::ZERO; start + 2];
        psi[start] = 1e-100.into();
        for n in (1..=start).rev() {
            psi[n - 1] = (2 * n + 1) as f64 / z * psi[n] - psi[n + 1];
            if psi[n - 1].norm() > 1e100 {
                for value in &mut psi[n - 1..] {
                    *value *= 1e-200;
                }
            }
        }
        let exponent = z.im.abs();
        // cosh and sinh of Im z without their growth.
        let (cosh, sinh) = (0.5 + 0.5 * (-2.0 * exponent).exp(), -0.5 * (-2.0 * exponent).exp_m1());
        let (real_sin, real_cos) = z.re.sin_cos();
        let sinh = sinh.copysign(z.im);
        let sin = Complex64::new(real_sin * cosh, real_cos * sinh);
        let cos = Complex64::new(real_cos * cosh, -real_sin * sinh);
        let (zero, one) = (sin, sin / z - cos);
        let scale = if zero.norm() > one.norm() { zero / psi[0] } else { one / psi[1] };
        psi.truncate(last + 1);
        for value in &mut psi {
            *value *= scale;
        }
        Self { z, exponent, psi }
    }

    /// ψ_n′.
    fn slope(&self, n: usize) -> Complex64 {
        self.psi[n - 1] - self.psi[n] * (n as f64 / self.z)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::medium::SPEED_OF_LIGHT;
    use std::f64::consts::TAU;

    fn wave_of(k: f64) -> Wave {
        Wave::new(k * SPEED_OF_LIGHT / TAU).unwrap()
    }

    #[test]
    fn backscatter_of_the_tables() {
        let sphere = ConductingSphere::new(1.0).unwrap();
        let table =
            [(1.0, 3.6376), (2.0, 1.0081), (5.0, 1.1688), (10.0, 0.9292), (20.0, 0.9664), (50.0, 0.9959)];
        for (ka, expected) in table {
            assert!((sphere.backscatter(&wave_of(ka)) - expected).abs() < 5.1e-5, "{ka}");
        }
        // Rayleigh: 9 (ka)⁴.
        let ka: f64 = 1e-3;
        assert!((sphere.backscatter(&wave_of(ka)) / (9.0 * ka.powi(4)) - 1.0).abs() < 1e-5);
    }

    #[test]
    fn the_total_field_is_normal_to_the_sphere() {
        let (wave, sphere) = (wave_of(7.0), ConductingSphere::new(1.0).unwrap());
        let source = PlaneWave::new(Vec3::new(0.3, 1.0, -0.2), Vec3::Z, Complex64::new(0.5, 2.0)).unwrap();
        for p in
            [Vec3::X, Vec3::new(0.6, 0.0, 0.8), Vec3::new(-0.48, 0.64, -0.6), Vec3::NEG_Y, source.travel()]
        {
            use crate::Source;
            let total = sphere.scattered(&wave, &source, p) + source.field(&wave, p).e;
            assert!(total.crossed_by(p).norm() < 1e-11, "{p}: {:e}", total.crossed_by(p).norm());
            assert!(total.norm() < 6.0);
        }
    }

    #[test]
    fn far_away_it_is_the_backscatter() {
        let (wave, sphere) = (wave_of(5.0), ConductingSphere::new(1.0).unwrap());
        let source = PlaneWave::new(Vec3::Y, Vec3::Z, 1.0.into()).unwrap();
        // The phases of the orders differ by n (n + 1)/(2kr).
        let r = 1e6;
        let back = sphere.scattered(&wave, &source, Vec3::Y * -r).norm_squared() * 4.0 * r * r;
        let error = back / sphere.backscatter(&wave) - 1.0;
        assert!(error.abs() < 1e-6, "{error:e}");
    }

    #[test]
    fn a_dielectric_sphere_takes_what_it_scatters_and_no_less() {
        for (permittivity, lossless) in
            [(2.0.into(), true), (4.0.into(), true), (Complex64::new(10.0, -5.0), false)]
        {
            for ka in [0.05, 1.0, 6.0, 30.0] {
                let sphere = DielectricSphere::new(1.0, permittivity).unwrap();
                let [extinction, scattering] = sphere.cross_sections(&wave_of(ka));
                let absorbed = (extinction - scattering) / extinction;
                assert!(if lossless { absorbed.abs() < 1e-10 } else { absorbed > 0.1 }, "{ka}: {absorbed}");
            }
        }
    }

    #[test]
    fn a_small_dielectric_sphere_is_a_dipole_and_a_dense_one_a_conductor() {
        // Rayleigh: E = k² a³ (ε − 1)/(ε + 2) E₀/r across the dipole.
        let source = PlaneWave::new(Vec3::Y, Vec3::Z, 1.0.into()).unwrap();
        let permittivity = Complex64::new(4.0, -1.0);
        let (ka, r) = (1e-3, 1e6);
        let small = DielectricSphere::new(1.0, permittivity).unwrap();
        let found = small.scattered(&wave_of(ka), &source, Vec3::X * r).components()[2];
        let dipole = Complex64::cis(-ka * r) * ka * ka / r * (permittivity - 1.0) / (permittivity + 2.0);
        assert!((found - dipole).norm() < 2e-3 * dipole.norm(), "{found} {dipole}");
        let dense = DielectricSphere::new(1.0, Complex64::new(1e10, -1e10)).unwrap();
        let conductor = ConductingSphere::new(1.0).unwrap();
        for p in [Vec3::X * 1.5, Vec3::Y * 3.0, Vec3::new(-1.0, 0.5, 2.0)] {
            let [a, b] =
                [dense.scattered(&wave_of(3.0), &source, p), conductor.scattered(&wave_of(3.0), &source, p)];
            assert!((a - b).norm() < 1e-4 * b.norm(), "{p}");
        }
        assert!(DielectricSphere::new(1.0, Complex64::new(2.0, 0.1)).is_err());
    }

    #[test]
    fn the_field_inside_a_dielectric_sphere_goes_on_outside() {
        use crate::Source;
        let source = PlaneWave::new(Vec3::new(0.3, 1.0, -0.2), Vec3::Z, Complex64::new(0.5, 2.0)).unwrap();
        for (permittivity, ka) in
            [(2.0.into(), 3.0), (4.0.into(), std::f64::consts::PI), (Complex64::new(10.0, -5.0), 12.0)]
        {
            let (wave, sphere) = (wave_of(ka), DielectricSphere::new(1.0, permittivity).unwrap());
            for p in [Vec3::X, Vec3::new(0.6, 0.0, 0.8), Vec3::new(-0.48, 0.64, -0.6), source.travel()] {
                let outside = sphere.scattered(&wave, &source, p) + source.field(&wave, p).e;
                let inside = sphere.inside(&wave, &source, p);
                let along = (outside - inside).crossed_by(p).norm();
                let across = (outside.dot(p) - inside.dot(p) * permittivity).norm();
                assert!(along < 1e-10 && across < 1e-10, "{permittivity} {p}: {along:e} {across:e}");
            }
            // div E = 0, and E solves the wave equation of the material at any place.
            let (at, h) = (Vec3::new(0.3, -0.2, 0.4), 1e-3);
            let e = |p: Vec3| sphere.inside(&wave, &source, p);
            let ways = [Vec3::X, Vec3::Y, Vec3::Z].map(|way| way * h);
            let sum = ways.iter().fold(e(at) * -6.0, |sum, &way| sum + e(at + way) + e(at - way));
            let expected = e(at) * -(permittivity * (ka * h).powi(2));
            assert!((sum - expected).norm() < 1e-3 * expected.norm(), "{permittivity}");
            let divergence: Complex64 =
                ways.iter().map(|&way| (e(at + way) - e(at - way)).dot(way / h)).sum();
            assert!(divergence.norm() < 1e-3 * ka * h * e(at).norm(), "{divergence}");
        }
    }

    #[test]
    fn the_field_inside_is_known_for_no_contrast_and_for_small_spheres() {
        use crate::Source;
        let source = PlaneWave::new(Vec3::Y, Vec3::Z, 1.0.into()).unwrap();
        let nothing = DielectricSphere::new(1.0, 1.0.into()).unwrap();
        for p in [Vec3::ZERO, Vec3::new(0.1, 0.2, -0.6), Vec3::Y * 0.9] {
            let gap = nothing.inside(&wave_of(5.0), &source, p) - source.field(&wave_of(5.0), p).e;
            assert!(gap.norm() < 1e-5, "{p}: {:e}", gap.norm());
        }
        // 3/(ε + 2) of what arrives, at the centre and elsewhere.
        let permittivity = Complex64::new(4.0, -1.0);
        let small = DielectricSphere::new(1.0, permittivity).unwrap();
        for p in [Vec3::ZERO, Vec3::new(0.1, 0.2, -0.6)] {
            let found = small.inside(&wave_of(1e-3), &source, p);
            let expected = ComplexVector::along(Vec3::Z, 3.0 / (permittivity + 2.0));
            assert!((found - expected).norm() < 2e-3, "{p}: {found:?}");
        }
    }
}
