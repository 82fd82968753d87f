//! The currents of a wave on a flat material: J = n × (H_i + H_r − H_t), M = −n × (E_i + E_r −
//! E_t).
//!
//! They radiate the reflected wave in front, and behind what takes the incident wave away and puts
//! the transmitted one in its place (the tangent plane approximation with the equivalence theorem:
//! C. A. Balanis, Advanced Engineering Electromagnetics, 2nd ed., Wiley 2012, § 7.8). Only sheets
//! let something through to their other side. Of a slab the mesh is the front, and the transmitted
//! wave is continued back to it, so that the phase behind is right.

use crate::material::{Coefficients, Material};
use crate::{ComplexVector, Current, Facet, Field, Kind, Wave};
use fredholm_mesh::Vec3;
use num_complex::Complex64;

/// The currents at a point of a facet, lit on `side` from the direction `towards` the source.
pub(super) fn fresnel(
    material: &Material,
    wave: &Wave,
    facet: &Facet,
    side: f64,
    towards: Vec3,
    incident: Field,
) -> Current {
    let normal = facet.normal * side;
    let cos = normal.dot(towards).clamp(0.0, 1.0);
    let [te, tm] = totals(material, wave, (side, cos), facet.kind);
    // Across the plane of incidence; at normal incidence any direction is.
    let across = normal.cross(towards).try_normalize().unwrap_or(facet.tangents[0]);
    let along = normal.cross(across);
    let Field { e, h } = incident;
    let total_e = part(e, across) * te.e + part(e, along) * tm.e;
    let total_h = part(h, along) * te.h + part(h, across) * tm.h;
    Current { j: total_h.crossed_by(normal), m: -total_e.crossed_by(normal) }
}

/// What the tangential parts are multiplied by.
struct Total {
    e: Complex64,
    h: Complex64,
}

/// 1 + r − t of E and H, TE and TM.
fn totals(material: &Material, wave: &Wave, (side, cos): (f64, f64), kind: Kind) -> [Total; 2] {
    let back = Complex64::cis(wave.wavenumber() * material.thickness() * cos);
    let found = if side > 0.0 {
        material.coefficients(wave, cos)
    } else {
        // The back is met first, a thickness before the mesh: the wave that it reflects is ahead by
        // twice that.
        let Coefficients { reflected, transmitted } = material.turned().coefficients(wave, cos);
        Coefficients { reflected: reflected.map(|r| r * back * back), transmitted }
    };
    let through = found.transmitted.map(|t| if kind == Kind::Sheet { t * back } else { Complex64::ZERO });
    let one = Complex64::ONE;
    let ([r_te, r_tm], [t_te, t_tm]) = (found.reflected, through);
    [
        Total { e: one + r_te - t_te, h: one - r_te - t_te },
        Total { e: one - r_tm - t_tm, h: one + r_tm - t_tm },
    ]
}

fn part(v: ComplexVector, direction: Vec3) -> ComplexVector {
    ComplexVector::along(direction, v.dot(direction))
}

#[cfg(test)]
mod tests {
    use crate::material::{Layer, Material};
    use crate::source::PlaneWave;
    use crate::surface::plate;
    use crate::{Complex64, ComplexVector, PhysicalOptics, Sampling, Shadow, Source, Wave};
    use fredholm_mesh::Vec3;

    /// F of a 3λ plate of a material, lit along `travel`.
    fn far(material: &Material, travel: Vec3, polarisation: Vec3, to: Vec3) -> ComplexVector {
        let wave = Wave::new(1e9).unwrap();
        let edge = wave.wavelength() / 6.0;
        let sheet = plate(3.0 * wave.wavelength(), edge).unwrap().made_of(vec![material.clone()]).unwrap();
        let source = PlaneWave::new(travel, polarisation, 1.0.into()).unwrap();
        let sources: [&dyn Source; 1] = [&source];
        let optics = PhysicalOptics::new(&sheet, wave, &sources, Shadow::Geometric).unwrap();
        optics.radiator(Sampling::Tolerance(1e-6)).far_field(&[to]).unwrap()[0].amplitude
    }

    /// The mirror direction has r, and straight on 1 − t, times what a perfect conductor has there:
    /// exactly, since a sheet of uniform current radiates plane waves.
    #[test]
    fn the_mirror_and_the_shadow_have_the_coefficients_of_the_material() {
        let wave = Wave::new(1e9).unwrap();
        let layer = Layer { permittivity: Complex64::new(4.0, -0.5), thickness: 0.03 };
        let materials = [
            Material::Slab(vec![layer]),
            Material::Impedance(Complex64::new(100.0, 50.0)),
            Material::HalfSpace(Complex64::new(3.0, -1.0)),
        ];
        for travel in [Vec3::Y, Vec3::new(0.6, 0.8, 0.0), Vec3::new(0.28, -0.96, 0.0)] {
            let mirror = Vec3::new(travel.x, -travel.y, travel.z);
            for (mode, polarisation) in [Vec3::Z, travel.cross(Vec3::Z)].into_iter().enumerate() {
                for material in &materials {
                    let found = material.coefficients(&wave, travel.y.abs());
                    let conductor = [-1.0, 1.0][mode];
                    // The normal is −y: along −y the wave meets the back, a thickness early.
                    let depth = if travel.y < 0.0 { material.thickness() } else { 0.0 };
                    let ahead = Complex64::cis(2.0 * wave.wavenumber() * depth * travel.y.abs());
                    let ratio = found.reflected[mode] * ahead / conductor;
                    let (got, full) = (
                        far(material, travel, polarisation, mirror),
                        far(&Material::Conductor, travel, polarisation, mirror),
                    );
                    assert!(
                        (got - full * ratio).norm() < 1e-12 * full.norm(),
                        "{material:?} {travel} {mode}"
                    );
                    let delay = wave.wavenumber() * material.thickness() * travel.y.abs();
                    let lost = Complex64::ONE - found.transmitted[mode] * Complex64::cis(delay);
                    let (got, full) = (
                        far(material, travel, polarisation, travel),
                        far(&Material::Conductor, travel, polarisation, travel),
                    );
                    assert!((got - full * lost).norm() < 1e-12 * full.norm(), "{material:?} {travel} {mode}");
                }
            }
        }
    }
}
