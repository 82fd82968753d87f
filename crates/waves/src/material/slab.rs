//! Layers between two half-spaces of free space.
//!
//! From the last interface forwards, with the coefficients r₀₁ of the interface before a layer of
//! thickness d and r′, t′ of all behind it (M. Born, E. Wolf, Principles of Optics, 7th ed.,
//! Cambridge 1999, § 1.6; the recursion of P. Rouard 1937), δ = k d √(ε − sin²θ):
//!
//! ```text
//! r = (r₀₁ + r′ e^{−2jδ})/(1 + r₀₁ r′ e^{−2jδ}),   t = t₀₁ t′ e^{−jδ}/(1 + r₀₁ r′ e^{−2jδ})
//! ```
//!
//! No exponential grows, so layers may be as thick and lossy as they like. t leads from the front
//! to the back.

use super::Coefficients;
use super::fresnel::{admittances, slowness};
use crate::Wave;
use num_complex::Complex64;

/// A layer.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Layer {
    /// Relative permittivity ε′ − jε″.
    pub permittivity: Complex64,
    /// Thickness, m.
    pub thickness: f64,
}

/// Reflection and transmission of layers, from the front to the back, at cos θ (0 … 1).
#[must_use]
pub fn slab(layers: &[Layer], wave: &Wave, cos: f64) -> Coefficients {
    let sin_squared = 1.0 - cos * cos;
    let outside = [Complex64::from(cos); 2];
    let media: Vec<[Complex64; 2]> =
        layers.iter().map(|layer| admittances(layer.permittivity, sin_squared)).collect();
    let pair = [0, 1].map(|polarisation| {
        let front = |i: usize| if i == 0 { outside[polarisation] } else { media[i - 1][polarisation] };
        let (mut r, mut t) = interface(front(layers.len()), outside[polarisation]);
        for (i, layer) in layers.iter().enumerate().rev() {
            let delay = slowness(layer.permittivity, sin_squared) * (wave.wavenumber() * layer.thickness);
            let pass = (Complex64::new(0.0, -1.0) * delay).exp();
            let (first, through) = interface(front(i), media[i][polarisation]);
            let echo = r * pass * pass;
            t = through * t * pass / (first * echo + 1.0);
            r = (first + echo) / (first * echo + 1.0);
        }
        (r, t)
    });
    Coefficients { reflected: pair.map(|(r, _)| r), transmitted: pair.map(|(_, t)| t) }
}

/// r and t of an interface between two admittances.
fn interface(first: Complex64, second: Complex64) -> (Complex64, Complex64) {
    ((first - second) / (first + second), first * 2.0 / (first + second))
}

#[cfg(test)]
mod tests {
    use super::super::{half_space, itu_permittivity};
    use super::*;

    fn decibel(t: Complex64) -> f64 {
        20.0 * t.norm().log10()
    }

    /// |R| and |T| at 2.4 GHz, normal incidence, from an independent code.
    #[test]
    fn the_table_of_building_materials() {
        let wave = Wave::new(2.4e9).unwrap();
        let itu = |name| itu_permittivity(name, 2.4e9).unwrap();
        let table = [
            (itu("concrete"), 0.2, 0.404, -14.57),
            (itu("glass"), 0.006, 0.584, -1.91),
            (itu("wood"), 0.030, 0.274, -0.75),
            (itu("plasterboard"), 0.0125, 0.400, -1.07),
        ];
        for (permittivity, thickness, reflected, through) in table {
            let got = slab(&[Layer { permittivity, thickness }], &wave, 1.0);
            assert!(
                (got.reflected[0].norm() - reflected).abs() < 5.1e-4,
                "{permittivity}: {:?}",
                got.reflected[0].norm()
            );
            assert!(
                (decibel(got.transmitted[0]) - through).abs() < 5.1e-3,
                "{permittivity}: {}",
                decibel(got.transmitted[0])
            );
            // At normal incidence the two polarisations are one, but for the sign of H.
            assert!((got.reflected[0] + got.reflected[1]).norm() < 1e-14);
            assert!((got.transmitted[0] - got.transmitted[1]).norm() < 1e-14);
        }
    }

    #[test]
    fn half_a_wavelength_is_invisible_and_much_loss_is_a_half_space() {
        let wave = Wave::new(1e9).unwrap();
        let half = Layer { permittivity: 4.0.into(), thickness: 0.25 * wave.wavelength() };
        let got = slab(&[half], &wave, 1.0);
        assert!(got.reflected[0].norm() < 1e-14 && (got.transmitted[0] + 1.0).norm() < 1e-14);
        let permittivity = Complex64::new(5.0, -3.0);
        let thick = slab(&[Layer { permittivity, thickness: 1e6 }], &wave, 0.4);
        let endless = half_space(permittivity, 0.4);
        assert!(thick.reflected.iter().zip(&endless.reflected).all(|(a, b)| (a - b).norm() < 1e-14));
        assert!(thick.transmitted.iter().all(|t| t.norm() < 1e-300));
    }

    #[test]
    fn a_layer_cut_in_two_is_the_same() {
        let wave = Wave::new(3e9).unwrap();
        let permittivity = Complex64::new(3.7, -0.4);
        let layer = |thickness| Layer { permittivity, thickness };
        for cos in [1.0, 0.3] {
            let (whole, cut) =
                (slab(&[layer(0.05)], &wave, cos), slab(&[layer(0.02), layer(0.03)], &wave, cos));
            let gaps = [(whole.reflected, cut.reflected), (whole.transmitted, cut.transmitted)];
            assert!(gaps.iter().all(|(a, b)| (a[0] - b[0]).norm() + (a[1] - b[1]).norm() < 1e-14));
        }
    }
}
