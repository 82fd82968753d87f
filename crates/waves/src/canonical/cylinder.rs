//! Circular cylinders around z: a perfect conductor, and layers around a core that is dielectric or
//! conducting.
//!
//! With E_z = E₀ e_z Σ j⁻ⁿ J_n(κρ) e^{jn(φ − φ_i)} e^{−jk_z z} of the wave that comes and such an
//! H_z (φ_i the azimuth of its travel), what goes out is a series of H_n⁽²⁾(κρ); on a conductor
//! with −J_n(κa)/H_n⁽²⁾(κa) times E_z and −J_n′/H_n⁽²⁾′ times H_z (C. A. Balanis, Advanced
//! Engineering Electromagnetics, 2nd ed., Wiley 2012, § 11.5), on layers by two-by-two matrices (C.
//! F. Bohren, D. R. Huffman, Absorption and Scattering of Light by Small Particles, Wiley 1983, §
//! 8.4; `layers` beside this file).
//!
//! Widths are powers per length of the cylinder over the incident power density, with b_n the
//! amplitudes of E_z and η₀H_z that go out and i_n those that come in:
//!
//! ```text
//! scattering (4k/κ²) Σ |b_n|²/|E₀|²,   extinction −(4k/κ²) Re Σ i_n* b_n/|E₀|²
//! ```

use super::bessel::{outgoing, regular, terms};
use super::layers::{Amplitudes, Filling, Radial, Shell, applied, solve};
use super::{Medium, Oblique, finite};
use crate::medium::IMPEDANCE;
use crate::source::PlaneWave;
use crate::{ComplexVector, Field, Wave, WaveError};
use fredholm_mesh::Vec3;
use num_complex::Complex64;

/// A perfectly conducting circular cylinder around the z axis, without ends.
#[derive(Clone, Debug, PartialEq)]
pub struct ConductingCylinder(LayeredCylinder);

impl ConductingCylinder {
    /// The cylinder of this radius, m.
    ///
    /// # Errors
    /// [`WaveError::Length`] unless the radius is finite and above 0.
    pub fn new(radius: f64) -> Result<Self, WaveError> {
        LayeredCylinder::new(Some(radius), vec![]).map(Self)
    }

    /// The scattered field at `p` (m), exact at any distance; within it cancels the incident one.
    ///
    /// # Errors
    /// Those of [`LayeredCylinder::scattered`].
    pub fn scattered(&self, wave: &Wave, source: &PlaneWave, p: Vec3) -> Result<Field, WaveError> {
        self.0.scattered(wave, source, p)
    }

    /// The surface current J = n × H (A/m) at the azimuth `phi` (rad) and height `z` (m).
    ///
    /// # Errors
    /// Those of [`LayeredCylinder::scattered`].
    pub fn current(
        &self,
        wave: &Wave,
        source: &PlaneWave,
        phi: f64,
        z: f64,
    ) -> Result<ComplexVector, WaveError> {
        let normal = Vec3::new(phi.cos(), phi.sin(), 0.0);
        // The field at the same place, whichever side rounding puts it on.
        let p = normal * self.0.core + Vec3::Z * z;
        let total = self.0.outside(wave, source, p)? + Medium::free_space(wave).incident(source, p);
        Ok(total.h.crossed_by(normal))
    }

    /// Widths of extinction and of scattering, m.
    ///
    /// # Errors
    /// Those of [`LayeredCylinder::scattered`].
    pub fn widths(&self, wave: &Wave, source: &PlaneWave) -> Result<[f64; 2], WaveError> {
        self.0.widths(wave, source)
    }
}

/// Concentric circular layers around the z axis, without ends, in free space.
#[derive(Clone, Debug, PartialEq)]
pub struct LayeredCylinder {
    /// Radius of the conducting core, m; 0 where there is none.
    core: f64,
    /// Outer radius (m) and relative permittivity, from within.
    layers: Vec<(f64, Complex64)>,
}

impl LayeredCylinder {
    /// Layers by their outer radii (m) and relative permittivities ε′ − jε″, from the innermost,
    /// around a perfect conductor of the radius `core` (m), if there is one; else the innermost is
    /// the core.
    ///
    /// # Errors
    /// [`WaveError::Length`] unless the radii are finite, above 0 and grow, [`WaveError::Material`]
    /// unless each ε is finite with ε′ > 0 and ε″ ≥ 0.
    pub fn new(core: Option<f64>, layers: Vec<(f64, Complex64)>) -> Result<Self, WaveError> {
        let mut within = 0.0;
        for radius in core.into_iter().chain(layers.iter().map(|layer| layer.0)) {
            if !(radius > within && radius.is_finite()) {
                return Err(WaveError::Length { what: "the thickness of a layer", value: radius - within });
            }
            within = radius;
        }
        if within == 0.0 {
            return Err(WaveError::Length { what: "the radius of the cylinder", value: within });
        }
        if layers.iter().any(|(_, e)| !(e.re > 0.0 && e.im <= 0.0 && e.is_finite())) {
            let reason = "the permittivity ε′ − jε″ must be finite with ε′ > 0 and ε″ ≥ 0";
            return Err(WaveError::Material { what: "of the cylinder".into(), reason });
        }
        Ok(Self { core: core.unwrap_or(0.0), layers })
    }

    /// The scattered field at `p` (m), exact at any distance: the total one less the incident one,
    /// outside and in the layers. In the core it cancels the incident one.
    ///
    /// # Errors
    /// [`WaveError::Travel`] for a wave along the axis, [`WaveError::NotFinite`] where the series
    /// has no value.
    pub fn scattered(&self, wave: &Wave, source: &PlaneWave, p: Vec3) -> Result<Field, WaveError> {
        let rho = p.x.hypot(p.y);
        if rho >= self.radius() {
            return self.outside(wave, source, p);
        }
        let incident = Medium::free_space(wave).incident(source, p);
        if rho < self.core {
            return Ok(Field::ZERO - incident);
        }
        let at = self.layers.iter().position(|layer| rho < layer.0).unwrap_or_default();
        Ok(self.within(wave, source, p, at)? - incident)
    }

    /// Widths of extinction and of scattering, m: powers per length over the incident power
    /// density. Their difference is what is absorbed.
    ///
    /// # Errors
    /// Those of [`LayeredCylinder::scattered`], and [`WaveError::NotFinite`] without an amplitude.
    pub fn widths(&self, wave: &Wave, source: &PlaneWave) -> Result<[f64; 2], WaveError> {
        let series = Series::new(self, wave, source)?;
        let mut sums = [0.0; 2];
        for (incident, (scattered, _)) in series.incident.iter().zip(&series.orders) {
            for (i, b) in incident.iter().zip(scattered) {
                sums[0] -= (i.conj() * b).re;
                sums[1] += b.norm_sqr();
            }
        }
        let kappa = series.seen.kappa.re;
        let scale = 4.0 * wave.wavenumber() / (kappa * kappa * source.amplitude().norm_sqr());
        let widths = sums.map(|sum| sum * scale);
        if widths.iter().all(|width| width.is_finite()) {
            Ok(widths)
        } else {
            Err(WaveError::NotFinite { what: "a width of the cylinder" })
        }
    }

    fn radius(&self) -> f64 {
        self.layers.last().map_or(self.core, |layer| layer.0)
    }

    /// The scattered field outside.
    fn outside(&self, wave: &Wave, source: &PlaneWave, p: Vec3) -> Result<Field, WaveError> {
        let series = Series::new(self, wave, source)?;
        let filling = series.filling(Complex64::ONE);
        let z = filling.kappa * p.x.hypot(p.y);
        let (functions, phase) = (outgoing(z, series.last + 1)?, (z * -Complex64::I).exp());
        series.field(&filling, p, |i, m| shares(series.orders[i].0, functions[m] * phase))
    }

    /// The total field in a layer.
    fn within(&self, wave: &Wave, source: &PlaneWave, p: Vec3, at: usize) -> Result<Field, WaveError> {
        let series = Series::new(self, wave, source)?;
        let filling = series.filling(self.layers[at].1);
        let (kappa, rho) = (filling.kappa, p.x.hypot(p.y));
        let functions = regular(kappa * rho, series.last + 1)?;
        // As the exponentials of J grow from here to the outer radius and to the inner one.
        let fall = (kappa.im * (self.layers[at].0 - rho)).exp();
        let inner = if at == 0 { self.core } else { self.layers[at - 1].0 };
        if inner == 0.0 {
            let of = |i: usize| series.orders[i].1[at].a;
            return series.field(&filling, p, |i, m| shares(of(i), functions[m] * fall));
        }
        let through = (kappa.im * (self.layers[at].0 - inner)).exp();
        let phase = (kappa * (rho - inner) * -Complex64::I).exp() * through;
        let out = outgoing(kappa * rho, series.last + 1)?;
        series.field(&filling, p, |i, m| {
            let Amplitudes { t, a } = &series.orders[i].1[at];
            let [inwards, outwards] =
                [shares(*a, functions[m] * fall), shares(applied(t, *a), out[m] * phase)];
            [inwards[0] + outwards[0], inwards[1] + outwards[1]]
        })
    }
}

/// Amplitudes of E_z and η₀H_z times a function; what is not there has no infinite value either.
fn shares(amplitudes: [Complex64; 2], value: Complex64) -> [Complex64; 2] {
    amplitudes.map(|amplitude| if amplitude == Complex64::ZERO { amplitude } else { amplitude * value })
}

/// The waves of a cylinder in a plane wave, for n = −last … last in terms of J_|n| and H_|n|.
struct Series {
    seen: Oblique,
    k: f64,
    cosine: f64,
    last: usize,
    /// Those that come.
    incident: Vec<[Complex64; 2]>,
    /// Those that go, and what is in the layers.
    orders: Vec<([Complex64; 2], Vec<Amplitudes>)>,
}

impl Series {
    fn new(cylinder: &LayeredCylinder, wave: &Wave, source: &PlaneWave) -> Result<Self, WaveError> {
        let (k, cosine) = (wave.wavenumber(), source.travel().z);
        let seen = Oblique::new(&Medium::free_space(wave), source)?;
        let last = terms(seen.kappa.re * cylinder.radius());
        let mut shells = Vec::with_capacity(cylinder.layers.len());
        let mut within = cylinder.core;
        for &(radius, permittivity) in &cylinder.layers {
            let at = |radius: f64| Radial::new(Filling::new(permittivity, k, cosine), radius, last);
            let inner = if within > 0.0 { Some(at(within)?) } else { None };
            shells.push(Shell { inner, outer: at(radius)? });
            within = radius;
        }
        let outside = Radial::new(Filling::new(Complex64::ONE, k, cosine), within, last)?;
        let axial = [seen.axial[0], seen.axial[1] * IMPEDANCE];
        let whole = last as i32;
        let coming = |n: i32| {
            let turn = Complex64::cis(-f64::from(n) * seen.azimuth) * Complex64::I.powi(-n.abs());
            axial.map(|value| value * turn)
        };
        let incident: Vec<_> = (-whole..=whole).map(coming).collect();
        let orders = (-whole..=whole).zip(&incident).map(|(n, i)| solve(n, *i, &shells, &outside)).collect();
        Ok(Self { seen, k, cosine, last, incident, orders })
    }

    fn filling(&self, permittivity: Complex64) -> Filling {
        Filling::new(permittivity, self.k, self.cosine)
    }

    /// The field of the waves whose E_z and η₀H_z are Σ f_i(|n|) e^{jnφ}, i = n + last, where
    /// f_i(m) has a cylinder function of order m. With those, (∂x + j∂y) f_n e^{jnφ} is −κ f_{n+1}
    /// e^{j(n+1)φ}, and (∂x − j∂y) f_n e^{jnφ} is κ f_{n−1} e^{j(n−1)φ}.
    fn field(
        &self,
        filling: &Filling,
        p: Vec3,
        term: impl Fn(usize, usize) -> [Complex64; 2],
    ) -> Result<Field, WaveError> {
        let turn = Complex64::cis(p.y.atan2(p.x));
        // E_z and η₀H_z, and κ⁻¹(∂x ± j∂y) of both.
        let mut sums = [[Complex64::ZERO; 2]; 3];
        for i in 0..self.orders.len() {
            let n = i as i32 - self.last as i32;
            let m = n.unsigned_abs() as usize;
            let inner = if m == 0 { term(i, 1).map(|f| -f) } else { term(i, m - 1) };
            let outer = term(i, m + 1).map(|f| -f);
            // For n < 0 the two change places.
            let (plus, minus) = if n < 0 { (inner, outer) } else { (outer, inner) };
            for (sum, (values, order)) in
                sums.iter_mut().zip([(term(i, m), n), (plus, n + 1), (minus, n - 1)])
            {
                let angle = turn.powi(order);
                sum[0] += values[0] * angle;
                sum[1] += values[1] * angle;
            }
        }
        let of = |i: usize| {
            let [plus, minus] = [sums[1][i], sums[2][i]].map(|sum| sum * filling.kappa * 0.5);
            [sums[0][i], plus + minus, (plus - minus) * -Complex64::I]
                .map(|value| value * self.seen.along(p.z))
        };
        let index = filling.permittivity.sqrt();
        let medium = Medium { k: index * self.k, eta: index.inv() * IMPEDANCE };
        let kz = Complex64::from(filling.kz);
        finite(medium.field([kz, filling.kappa], of(0), of(1).map(|value| value / IMPEDANCE)))
    }
}

#[cfg(test)]
mod tests;
