//! A sphere of layers around a core that is dielectric or conducting.
//!
//! In a layer of index m the radial function is u = ψ_n(mkr) − T ξ_n(mkr), and what goes on through
//! an interface is u and u′/m for the waves a_n, u/m and u′ for b_n (C. F. Bohren, D. R. Huffman, §
//! 8.1). With D = ψ_n′/ψ_n and G = ξ_n′/ξ_n, from the inner radius p to the outer one q of a layer
//!
//! ```text
//! τ = T ξ_n/ψ_n:   τ_p = (D u − u′)/(G u − u′),   τ_q = τ_p [ψ_n(p)/ψ_n(q)] [ξ_n(q)/ξ_n(p)]
//! u : u′ = (1 − τ_q) : (D − τ_q G)
//! ```
//!
//! where no factor grows: layers may be thick and lossy (W. Yang, Appl. Opt. 42 (2003) 1710,
//! doi:10.1364/AO.42.001710). Outside, a_n = (u ψ_n′ − u′ ψ_n)/(u ξ_n′ − u′ ξ_n), and b_n alike.

use super::{ConductingSphere, DielectricSphere, Riccati, Series, logarithmic_slopes, terms};
use crate::source::PlaneWave;
use crate::{ComplexVector, Wave, WaveError};
use fredholm_mesh::Vec3;
use num_complex::Complex64;

/// Concentric layers around the origin, in free space.
#[derive(Clone, Debug, PartialEq)]
pub struct LayeredSphere {
    /// Radius of the conducting core, m; 0 where there is none.
    core: f64,
    /// Outer radius (m) and relative permittivity, from within.
    layers: Vec<(f64, Complex64)>,
}

impl LayeredSphere {
    /// Layers by their outer radii (m) and relative permittivities ε′ − jε″, from the innermost,
    /// around a perfect conductor of the radius `core` (m), if there is one; else the innermost is
    /// the core.
    ///
    /// # Errors
    /// [`WaveError::Length`] unless the radii are finite, above 0 and grow, [`WaveError::Material`]
    /// unless each ε is finite with ε′ > 0 and ε″ ≥ 0.
    pub fn new(core: Option<f64>, layers: Vec<(f64, Complex64)>) -> Result<Self, WaveError> {
        let mut within = match core {
            Some(radius) => ConductingSphere::new(radius).map(|_| radius)?,
            None => 0.0,
        };
        for &(radius, permittivity) in &layers {
            DielectricSphere::new(radius, permittivity)?;
            if radius <= within {
                return Err(WaveError::Length { what: "the thickness of a layer", value: radius - within });
            }
            within = radius;
        }
        if within == 0.0 {
            return Err(WaveError::Length { what: "the radius of the sphere", value: within });
        }
        Ok(Self { core: core.unwrap_or(0.0), layers })
    }

    /// The scattered E (V/m) at `p` (m, outside), exact at any distance.
    #[must_use]
    pub fn scattered(&self, wave: &Wave, source: &PlaneWave, p: Vec3) -> ComplexVector {
        self.series(wave).scattered(wave, source, p)
    }

    /// Cross-sections of extinction and of scattering, m²; their difference is what is absorbed.
    #[must_use]
    pub fn cross_sections(&self, wave: &Wave) -> [f64; 2] {
        self.series(wave).cross_sections(wave)
    }

    fn series(&self, wave: &Wave) -> Series {
        let k = wave.wavenumber();
        let x = k * self.layers.last().map_or(self.core, |(radius, _)| *radius);
        let last = terms(x);
        // u and u′ of a_n and b_n for every order, first on the conductor.
        let mut inner =
            vec![[[Complex64::ONE, Complex64::ZERO], [Complex64::ZERO, Complex64::ONE]]; last + 1];
        let (mut within, mut index) = (self.core, Complex64::ONE);
        for &(radius, permittivity) in &self.layers {
            // The time factor of the series is the conjugate of ours.
            let m = permittivity.conj().sqrt();
            let outer = Slopes::new(m * (k * radius), last);
            if within == 0.0 {
                inner = outer.regular.iter().map(|slope| [[Complex64::ONE, *slope]; 2]).collect();
            } else {
                let change = m / index;
                let through = Through::new([m * (k * within), m * (k * radius)], last, outer);
                for (n, [a, b]) in inner.iter_mut().enumerate() {
                    *a = through.carried(n, [a[0], a[1] * change]);
                    *b = through.carried(n, [b[0] * change, b[1]]);
                }
            }
            (within, index) = (radius, m);
        }
        let at = Riccati::new(x, last);
        let term = |n: usize| {
            let [a, b] = inner[n];
            let share = |u: Complex64, slope: Complex64| {
                (u * at.psi_slope(n) - slope * at.psi(n)) / (u * at.xi_slope(n) - slope * at.xi(n))
            };
            [share(a[0], a[1] / index), share(b[0] / index, b[1])]
        };
        Series((1..=last).map(term).collect())
    }
}

/// ψ_n′/ψ_n and ξ_n′/ξ_n at a place, for n = 0 … last.
struct Slopes {
    regular: Vec<Complex64>,
    outgoing: Vec<Complex64>,
}

impl Slopes {
    fn new(z: Complex64, last: usize) -> Self {
        let mut outgoing = vec![Complex64::I];
        for n in 1..=last {
            let ratio = n as f64 / z;
            outgoing.push((ratio - outgoing[n - 1]).inv() - ratio);
        }
        Self { regular: logarithmic_slopes(z, last), outgoing }
    }
}

/// A layer between two radii.
struct Through {
    inner: Slopes,
    outer: Slopes,
    /// [ψ_n(p)/ψ_n(q)] [ξ_n(q)/ξ_n(p)].
    fall: Vec<Complex64>,
}

impl Through {
    /// Between two radii times the wavenumber in the layer.
    fn new([p, q]: [Complex64; 2], last: usize, outer: Slopes) -> Self {
        let inner = Slopes::new(p, last);
        // ξ₀(q)/ξ₀(p) = e^{i(q − p)}, and ψ₀ = sin, of which the growing part is taken out.
        let decayed = |z: Complex64| 1.0 - (z * Complex64::new(0.0, 2.0)).exp();
        let mut fall = vec![((q - p) * Complex64::new(0.0, 2.0)).exp() * decayed(p) / decayed(q)];
        for n in 1..=last {
            let step = |slopes: &Slopes, z: Complex64| {
                let ratio = n as f64 / z;
                // ψ_n/ψ_{n−1} and ξ_n/ξ_{n−1}.
                [(slopes.regular[n] + ratio).inv(), ratio - slopes.outgoing[n - 1]]
            };
            let ([psi_p, xi_p], [psi_q, xi_q]) = (step(&inner, p), step(&outer, q));
            fall.push(fall[n - 1] * (psi_p / psi_q) * (xi_q / xi_p));
        }
        Self { inner, outer, fall }
    }

    /// u and u′ at the outer radius from those at the inner one, both in the layer.
    fn carried(&self, n: usize, [u, slope]: [Complex64; 2]) -> [Complex64; 2] {
        let of = |slopes: &Slopes| [slopes.regular[n], slopes.outgoing[n]];
        let [d, g] = of(&self.inner);
        let share = (d * u - slope) / (g * u - slope) * self.fall[n];
        let [d, g] = of(&self.outer);
        [1.0 - share, d - share * g]
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

    fn source() -> PlaneWave {
        PlaneWave::new(Vec3::Y, Vec3::Z, 1.0.into()).unwrap()
    }

    /// Relative difference of two fields at places near and far.
    fn difference(
        wave: &Wave,
        found: &LayeredSphere,
        exact: impl Fn(&PlaneWave, Vec3) -> ComplexVector,
    ) -> f64 {
        let ways = [Vec3::X, Vec3::NEG_Y, Vec3::new(-0.48, 0.64, -0.6), Vec3::Y];
        let places = ways.into_iter().flat_map(|way| [1.01, 2.0, 1e4].map(|r| way * r));
        let gap = |p: Vec3| {
            let exact = exact(&source(), p);
            (found.scattered(wave, &source(), p) - exact).norm() / exact.norm()
        };
        places.map(gap).fold(0.0, f64::max)
    }

    #[test]
    fn one_material_is_the_sphere_of_mie_however_it_is_cut() {
        for permittivity in [Complex64::from(4.0), Complex64::new(3.0, -0.5), Complex64::new(10.0, -8.0)] {
            for ka in [0.3, 4.0, 15.0] {
                let wave = wave_of(ka);
                let ball = DielectricSphere::new(1.0, permittivity).unwrap();
                for radii in [vec![1.0], vec![0.6, 1.0], vec![0.2, 0.21, 0.9, 1.0]] {
                    let layers = radii.into_iter().map(|radius| (radius, permittivity)).collect();
                    let cut = LayeredSphere::new(None, layers).unwrap();
                    let gap = difference(&wave, &cut, |source, p| ball.scattered(&wave, source, p));
                    assert!(gap < 1e-9, "{permittivity} {ka}: {gap:e}");
                }
            }
        }
    }

    #[test]
    fn a_conductor_is_itself_with_a_coat_of_nothing_and_hides_in_a_dense_one() {
        let wave = wave_of(4.0);
        let of = |radius: f64| ConductingSphere::new(radius).unwrap();
        let bare = LayeredSphere::new(Some(1.0), vec![]).unwrap();
        assert!(difference(&wave, &bare, |source, p| of(1.0).scattered(&wave, source, p)) < 1e-11);
        let air = LayeredSphere::new(Some(0.7), vec![(1.0, Complex64::ONE)]).unwrap();
        assert!(difference(&wave, &air, |source, p| of(0.7).scattered(&wave, source, p)) < 1e-11);
        let dense = LayeredSphere::new(Some(0.7), vec![(1.0, Complex64::new(1e10, -1e10))]).unwrap();
        assert!(difference(&wave, &dense, |source, p| of(1.0).scattered(&wave, source, p)) < 1e-4);
        // A core of the densest dielectric is a conductor, too.
        let coat = (1.0, Complex64::new(2.5, -0.2));
        let metal = LayeredSphere::new(Some(0.7), vec![coat]).unwrap();
        let core = LayeredSphere::new(None, vec![(0.7, Complex64::new(1e12, -1e12)), coat]).unwrap();
        let gap = difference(&wave, &core, |source, p| metal.scattered(&wave, source, p));
        assert!(gap < 1e-4, "{gap:e}");
    }

    #[test]
    fn what_is_not_absorbed_is_scattered_through_any_layers() {
        let clear = vec![(0.4, 2.0.into()), (0.8, 6.0.into()), (1.0, 1.5.into())];
        let lossy = vec![(0.4, 2.0.into()), (0.8, Complex64::new(6.0, -1.0)), (1.0, 1.5.into())];
        for core in [None, Some(0.3)] {
            for ka in [0.2, 2.0, 11.0, 40.0] {
                let absorbed = |layers: &Vec<(f64, Complex64)>| {
                    let sphere = LayeredSphere::new(core, layers.clone()).unwrap();
                    let [extinction, scattering] = sphere.cross_sections(&wave_of(ka));
                    (extinction - scattering) / extinction
                };
                assert!(absorbed(&clear).abs() < 1e-8, "{core:?} {ka}: {:e}", absorbed(&clear));
                assert!(absorbed(&lossy) > 1e-3, "{core:?} {ka}: {:e}", absorbed(&lossy));
            }
        }
    }

    #[test]
    fn radii_that_do_not_grow_are_refused() {
        let new = |core, layers: &[(f64, f64)]| {
            LayeredSphere::new(core, layers.iter().map(|&(r, e)| (r, e.into())).collect()).map(|_| ())
        };
        for (core, layers) in [
            (None, &[][..]),
            (Some(0.0), &[]),
            (Some(1.0), &[(0.9, 2.0)]),
            (None, &[(1.0, 2.0), (1.0, 3.0)]),
            (None, &[(f64::NAN, 2.0)]),
        ] {
            assert!(matches!(new(core, layers), Err(WaveError::Length { .. })), "{core:?} {layers:?}");
        }
        assert!(matches!(new(None, &[(1.0, -2.0)]), Err(WaveError::Material { .. })));
    }
}
