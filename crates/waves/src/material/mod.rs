//! Materials: what a flat surface reflects and lets through.
//!
//! With the angle of incidence θ, the reflected and the transmitted wave are r and t times the
//! incident one, apart for E across the plane of incidence (TE, r⊥ of E) and E in it (TM, r∥ of
//! **H**): a perfect conductor has r⊥ = −1, r∥ = 1.
//!
//! | material | reflects | lets through |
//! |---|---|---|
//! | perfect conductor | everything | nothing |
//! | impedance | E_tan = Z_s n × H (M. A. Leontovich) | nothing |
//! | half-space | Fresnel | what is not reflected, into itself |
//! | slab | layers by recursion | to the other side |
//! | sheet | E_tan = Z_s J on both sides | to the other side |

mod fresnel;
mod itu;
mod slab;

pub use fresnel::half_space;
pub use itu::{ItuMaterial, itu_materials, itu_permittivity};
pub use slab::{Layer, slab};

use crate::medium::IMPEDANCE;
use crate::{Wave, WaveError};
use num_complex::Complex64;

/// What is reflected and let through at one angle.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Coefficients {
    /// r⊥ (of E) and r∥ (of H).
    pub reflected: [Complex64; 2],
    /// t⊥ (of E) and t∥ (of H), behind the surface.
    pub transmitted: [Complex64; 2],
}

impl Coefficients {
    /// Those of a perfect conductor.
    pub const CONDUCTOR: Self = Self {
        reflected: [Complex64::new(-1.0, 0.0), Complex64::new(1.0, 0.0)],
        transmitted: [Complex64::ZERO; 2],
    };
}

/// The material of a surface.
#[derive(Clone, Debug, PartialEq)]
pub enum Material {
    /// A perfect conductor.
    Conductor,
    /// A surface impedance Z_s, Ω.
    Impedance(Complex64),
    /// A relative permittivity ε′ − jε″ behind the surface without end.
    HalfSpace(Complex64),
    /// Layers, from the front to the back, in free space. The surface of the mesh is the front.
    Slab(Vec<Layer>),
    /// A sheet without thickness, of sheet impedance Z_s (Ω): E_tan = Z_s J, with free space on both
    /// sides.
    Sheet(Complex64),
}

impl Material {
    /// Refuses what would give energy away or has no decaying wave; `what` names it.
    ///
    /// # Errors
    /// [`WaveError::Material`] with the reason.
    pub fn check(&self, what: &str) -> Result<(), WaveError> {
        let fail = |reason| Err(WaveError::Material { what: what.to_owned(), reason });
        match self {
            Self::Impedance(z) if !z.is_finite() => fail("the surface impedance is not finite"),
            Self::Impedance(z) if z.re < 0.0 => fail("a surface impedance needs a real part of at least 0"),
            Self::Sheet(z) if !z.is_finite() => fail("the sheet impedance is not finite"),
            Self::Sheet(z) if z.re < 0.0 => fail("a sheet impedance needs a real part of at least 0"),
            Self::Conductor | Self::Impedance(_) | Self::Sheet(_) => Ok(()),
            Self::HalfSpace(permittivity) => check_permittivity(*permittivity, what),
            Self::Slab(layers) if layers.is_empty() => fail("a slab needs at least one layer"),
            Self::Slab(layers) => layers.iter().try_for_each(|layer| {
                if !(layer.thickness > 0.0 && layer.thickness.is_finite()) {
                    return fail("the thickness of a layer must be finite and above 0");
                }
                check_permittivity(layer.permittivity, what)
            }),
        }
    }

    /// What is reflected and let through at cos θ (0 … 1).
    #[must_use]
    pub fn coefficients(&self, wave: &Wave, cos: f64) -> Coefficients {
        let nothing = [Complex64::ZERO; 2];
        match self {
            Self::Conductor => Coefficients::CONDUCTOR,
            Self::Impedance(z) => Coefficients { reflected: impedance(*z, cos), transmitted: nothing },
            Self::HalfSpace(permittivity) => {
                Coefficients { reflected: half_space(*permittivity, cos).reflected, transmitted: nothing }
            }
            Self::Slab(layers) => slab(layers, wave, cos),
            Self::Sheet(z) => sheet(*z, cos),
        }
    }

    /// As it is met from behind: the layers in the opposite order.
    #[must_use]
    pub fn turned(&self) -> Self {
        match self {
            Self::Slab(layers) => Self::Slab(layers.iter().rev().copied().collect()),
            other => other.clone(),
        }
    }

    /// Thickness behind the surface of the mesh, m.
    #[must_use]
    pub fn thickness(&self) -> f64 {
        if let Self::Slab(layers) = self { layers.iter().map(|layer| layer.thickness).sum() } else { 0.0 }
    }
}

/// Leontovich's condition: r⊥ = (Z cos θ − η)/(Z cos θ + η), r∥ = (η cos θ − Z)/(η cos θ + Z).
///
/// M. A. Leontovich, Investigations on Radiowave Propagation II, Academy of Sciences, Moscow 1948;
/// T. B. A. Senior, J. L. Volakis, Approximate Boundary Conditions in Electromagnetics, IEE 1995, §
/// 2.2.
fn impedance(z: Complex64, cos: f64) -> [Complex64; 2] {
    let grazing = z * cos;
    let eta = IMPEDANCE * cos;
    // At grazing both numerators and denominators stay apart from 0 unless Z = 0, the conductor.
    let te =
        if z == Complex64::ZERO { -Complex64::ONE } else { (grazing - IMPEDANCE) / (grazing + IMPEDANCE) };
    let tm = if z == Complex64::ZERO { Complex64::ONE } else { (eta - z) / (eta + z) };
    [te, tm]
}

/// A thin sheet: with the tangential E continuous and E_tan = Z_s J, where J is the jump of n × H,
/// r⊥ = −η/(2 Z_s cos θ + η), r∥ = η cos θ/(2 Z_s + η cos θ) (of H), t = 1 + r⊥ and 1 − r∥.
///
/// T. B. A. Senior, J. L. Volakis, the same, § 2.4.
fn sheet(z: Complex64, cos: f64) -> Coefficients {
    // At grazing a conductor keeps its signs.
    let tm =
        if z == Complex64::ZERO { Complex64::ONE } else { IMPEDANCE * cos / (z * 2.0 + IMPEDANCE * cos) };
    let te = -IMPEDANCE / (z * (2.0 * cos) + IMPEDANCE);
    Coefficients { reflected: [te, tm], transmitted: [te + 1.0, Complex64::ONE - tm] }
}

/// The sheet impedance 1/(jωε₀ (ε − 1) d) of a thin layer of permittivity ε and thickness d (m), Ω.
///
/// E along the sheet drives the polarisation current jωε₀ (ε − 1) E through its thickness (R. F.
/// Harrington, J. R. Mautz, An impedance sheet approximation for thin dielectric shells, IEEE Trans.
/// Antennas Propag. 23 (1975) 531, doi:10.1109/TAP.1975.1141099). What E across the sheet does is
/// left out.
#[must_use]
pub fn sheet_impedance(permittivity: Complex64, thickness: f64, wave: &Wave) -> Complex64 {
    IMPEDANCE / ((permittivity - 1.0) * Complex64::new(0.0, wave.wavenumber() * thickness))
}

/// The surface impedance (1 + j) √(ωμ₀/2σ) of a good conductor of conductivity σ (S/m), Ω: what is
/// behind is deeper than the skin, and σ much above ωε₀ (T. B. A. Senior, J. L. Volakis, the same, §
/// 2.2).
#[must_use]
pub fn conductor_impedance(conductivity: f64, wave: &Wave) -> Complex64 {
    let size = (0.5 * IMPEDANCE * wave.wavenumber() / conductivity).sqrt();
    Complex64::new(size, size)
}

/// The surface impedance η₀/√ε of a good conductor or dense dielectric, Ω.
#[must_use]
pub fn surface_impedance(permittivity: Complex64) -> Complex64 {
    IMPEDANCE / permittivity.sqrt()
}

fn check_permittivity(permittivity: Complex64, what: &str) -> Result<(), WaveError> {
    let fail = |reason| Err(WaveError::Material { what: what.to_owned(), reason });
    if !permittivity.is_finite() || permittivity == Complex64::ZERO {
        return fail("the permittivity must be finite and other than 0");
    }
    if permittivity.im > 0.0 {
        return fail(
            "the permittivity must not have a positive imaginary part, which is gain (e^{+jωt}: ε′ − jε″)",
        );
    }
    if permittivity.re < 0.0 && permittivity.im == 0.0 {
        return fail("a negative permittivity needs loss (a negative imaginary part)");
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;

    fn complex(re: f64, im: f64) -> Complex64 {
        Complex64::new(re, im)
    }

    fn all() -> Vec<Material> {
        let layer = |re, im, thickness| Layer { permittivity: complex(re, im), thickness };
        vec![
            Material::Conductor,
            Material::Impedance(complex(20.0, 35.0)),
            Material::Impedance(complex(0.0, -80.0)),
            Material::HalfSpace(complex(5.24, -0.687)),
            Material::HalfSpace(complex(2.0, 0.0)),
            Material::HalfSpace(complex(-3.0, -0.1)),
            Material::Slab(vec![layer(6.3, -0.2, 0.006)]),
            Material::Slab(vec![layer(4.0, 0.0, 0.02)]),
            Material::Slab(vec![layer(2.73, -0.1, 0.0125), layer(1.0, 0.0, 0.05), layer(2.73, -0.1, 0.0125)]),
            Material::Sheet(complex(200.0, 0.0)),
            Material::Sheet(complex(0.0, -150.0)),
            Material::Sheet(complex(30.0, 80.0)),
        ]
    }

    /// No material gives more than it gets, and one without loss gives it all back.
    #[test]
    fn power_is_balanced_at_every_angle() {
        let wave = Wave::new(2.4e9).unwrap();
        for material in all() {
            material.check("test").unwrap();
            for cos in [1.0, 0.9, 0.5, 0.1, 1e-3] {
                let Coefficients { reflected, transmitted } = material.coefficients(&wave, cos);
                for (r, t) in reflected.iter().zip(&transmitted) {
                    let power = r.norm_sqr() + t.norm_sqr();
                    assert!(power <= 1.0 + 1e-12, "{material:?} {cos}: {power}");
                    let lossless = match &material {
                        Material::Conductor => true,
                        Material::Impedance(z) | Material::Sheet(z) => z.re == 0.0,
                        Material::HalfSpace(_) => false,
                        Material::Slab(layers) => layers.iter().all(|layer| layer.permittivity.im == 0.0),
                    };
                    assert!(!lossless || (power - 1.0).abs() < 1e-12, "{material:?} {cos}: {power}");
                }
            }
        }
    }

    /// What gets through does not depend on the side; without loss, nor does how much is reflected.
    #[test]
    fn transmission_is_the_same_from_either_side() {
        let wave = Wave::new(2.4e9).unwrap();
        let layer = |re, im, thickness| Layer { permittivity: complex(re, im), thickness };
        let lossy =
            Material::Slab(vec![layer(5.2, -0.7, 0.02), layer(2.0, -0.1, 0.03), layer(9.0, -3.0, 0.004)]);
        let clear = Material::Slab(vec![layer(5.2, 0.0, 0.02), layer(2.0, 0.0, 0.03)]);
        for cos in [1.0, 0.6, 0.05] {
            for material in [&lossy, &clear] {
                let (front, back) =
                    (material.coefficients(&wave, cos), material.turned().coefficients(&wave, cos));
                for mode in 0..2 {
                    assert!((front.transmitted[mode] - back.transmitted[mode]).norm() < 1e-14);
                    let gap = front.reflected[mode].norm() - back.reflected[mode].norm();
                    assert!(gap.abs() < 1e-13 || *material == lossy, "{cos}: {gap}");
                }
            }
            let gap = lossy.coefficients(&wave, cos).reflected[0]
                - lossy.turned().coefficients(&wave, cos).reflected[0];
            assert!(gap.norm() > 1e-3 || cos < 0.1);
        }
    }

    #[test]
    fn a_dense_half_space_is_its_surface_impedance() {
        let dense = complex(1.0, -1e6);
        let wave = Wave::new(1e9).unwrap();
        for cos in [1.0, 0.5] {
            let exact = Material::HalfSpace(dense).coefficients(&wave, cos).reflected;
            let leontovich = Material::Impedance(surface_impedance(dense)).coefficients(&wave, cos).reflected;
            assert!(exact.iter().zip(&leontovich).all(|(a, b)| (a - b).norm() < 1e-8));
        }
    }

    /// A sheet without impedance is a conductor, and a thin layer is met across as its sheet, the
    /// error by half of kd and less.
    #[test]
    fn thin_layers_are_sheets() {
        let wave = Wave::new(1e9).unwrap();
        for cos in [1.0, 0.4, 0.0] {
            let found = Material::Sheet(Complex64::ZERO).coefficients(&wave, cos);
            assert_eq!(found, Coefficients::CONDUCTOR);
        }
        let permittivity = complex(4.0, -0.4);
        let errors = [2e-3, 1e-3].map(|thickness| {
            let layer = Material::Slab(vec![Layer { permittivity, thickness }]).coefficients(&wave, 1.0);
            let sheet = Material::Sheet(sheet_impedance(permittivity, thickness, &wave));
            let sheet = sheet.coefficients(&wave, 1.0);
            // The layer ends a thickness behind the sheet in its middle.
            let phase = Complex64::cis(wave.wavenumber() * thickness);
            let gap = (layer.reflected[0] * phase - sheet.reflected[0]).norm();
            gap.max((layer.transmitted[0] * phase - sheet.transmitted[0]).norm()) / sheet.reflected[0].norm()
        });
        assert!(errors[1] < 0.01 && errors[0] / errors[1] > 1.9, "{errors:?}");
    }

    /// Copper at 1 GHz: a skin of 2.09 µm, and a resistance of 1/(σδ) = 8.25 mΩ.
    #[test]
    fn a_good_conductor_is_a_dense_half_space() {
        let (wave, conductivity) = (Wave::new(1e9).unwrap(), 5.8e7);
        let z = conductor_impedance(conductivity, &wave);
        assert!((z.re - 8.25e-3).abs() < 5e-6 && z.re.to_bits() == z.im.to_bits(), "{z}");
        // ε = 1 − jσ/(ωε₀), with 1/(ωε₀) = η₀/k.
        let permittivity = complex(1.0, -conductivity * IMPEDANCE / wave.wavenumber());
        assert!((surface_impedance(permittivity) - z).norm() < 1e-8 * z.norm());
    }

    #[test]
    fn what_gives_energy_away_is_refused() {
        let layer = Layer { permittivity: complex(2.0, 0.0), thickness: 0.0 };
        let bad = [
            Material::Impedance(complex(-1.0, 0.0)),
            Material::Impedance(complex(f64::NAN, 0.0)),
            Material::HalfSpace(complex(2.0, 0.1)),
            Material::HalfSpace(complex(-2.0, 0.0)),
            Material::HalfSpace(Complex64::ZERO),
            Material::Slab(vec![]),
            Material::Slab(vec![layer]),
            Material::Sheet(complex(-1.0, 5.0)),
            Material::Sheet(complex(f64::INFINITY, 0.0)),
        ];
        for material in bad {
            assert!(matches!(material.check("bad"), Err(WaveError::Material { .. })), "{material:?}");
        }
    }
}
