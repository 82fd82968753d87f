//! The far field of one bounce of plane waves in closed form: on a flat facet both the current and
//! the way to a far observer turn by a linear phase, so that a facet of any size is integrated
//! without error.
//!
//! With w = k (u − K̂), its part w_t along the facet, the sides Δ_i around the normal n and their
//! middles m_i (W. B. Gordon, IEEE Trans. Antennas Propag. 23 (1975) 590,
//! doi:10.1109/TAP.1975.1141105):
//!
//! ```text
//! ∫ e^{jw·q} dA = (1/(j|w_t|²)) Σ w_t·(Δ_i × n) e^{jw·m_i} sin(w·Δ_i/2)/(w·Δ_i/2)
//! ```
//!
//! Where the phase over the facet is below ½ rad that is a difference of near numbers, and Gauss
//! points take its place (relative error below 2e-8). Nothing has to be meshed in wavelengths then,
//! but the line between light and shadow.

use super::{FarField, Pattern};
use crate::medium::IMPEDANCE;
use crate::rule::regular;
use crate::source::{Origin, unit};
use crate::{ComplexVector, Current, Facet, Gate, PhysicalOptics, WaveError};
use fredholm_mesh::Vec3;
use num_complex::Complex64;
use rayon::prelude::*;
use std::f64::consts::TAU;

/// Phase over a facet below which Gauss points are used, rad, and their number a side.
const SMALL_PHASE: f64 = 0.5;
const POINTS: usize = 3;

impl PhysicalOptics<'_> {
    /// F (V) in these directions (any length), in parallel, exact for facets of any size; `None`
    /// where a source is no plane wave.
    ///
    /// # Errors
    /// [`WaveError::Direction`] for a direction that is none.
    pub fn linear_phase_far_field(&self, directions: &[Vec3]) -> Option<Result<Pattern, WaveError>> {
        let travels: Vec<Vec3> = self.origins().map(travel).collect::<Option<_>>()?;
        let sheets: Vec<Sheet> = travels.iter().enumerate().flat_map(|(s, &t)| self.sheets(s, t)).collect();
        let direction = |u: &Vec3| {
            let u = unit(*u, "the direction of a far receiver")?;
            Ok(FarField { direction: u, amplitude: self.far_amplitude(&sheets, u) })
        };
        Some(directions.par_iter().map(direction).collect())
    }

    /// The lit facets of a plane wave with their currents, the phase taken out.
    fn sheets(&self, source: usize, travel: Vec3) -> Vec<Sheet> {
        let k = self.wave().wavenumber();
        let lit = |&i: &usize| self.lit(source)[i] != 0.0;
        let sheet = |i: usize| {
            let centre = self.scatterer().facets()[i].centre;
            let ahead = Complex64::cis(k * travel.dot(centre));
            let Current { j, m } = self.of_source(source, i, centre);
            Sheet { facet: i, travel, current: Current { j: j * ahead, m: m * ahead } }
        };
        (0..self.scatterer().facets().len()).filter(lit).map(sheet).collect()
    }

    fn far_amplitude(&self, sheets: &[Sheet], u: Vec3) -> ComplexVector {
        let k = self.wave().wavenumber();
        let (mut j, mut m) = (ComplexVector::ZERO, ComplexVector::ZERO);
        for sheet in sheets {
            let facet = &self.scatterer().facets()[sheet.facet];
            let turned = self.gate() == Gate::ObserverSide && u.dot(facet.normal) <= 0.0;
            let weight = if turned { -1.0 } else { 1.0 };
            let integral = linear_phase_integral(facet, (u - sheet.travel) * k) * weight;
            j += sheet.current.j * integral;
            m += sheet.current.m * integral;
        }
        let across = j - ComplexVector::along(u, j.dot(u));
        (across * IMPEDANCE - m.crossed_by(u)) * Complex64::new(0.0, -k / (2.0 * TAU))
    }
}

/// A current J₀ e^{−jkK̂·q} on a facet.
struct Sheet {
    facet: usize,
    travel: Vec3,
    current: Current,
}

fn travel(origin: Origin) -> Option<Vec3> {
    if let Origin::Direction(travel) = origin { Some(travel) } else { None }
}

/// ∫ e^{jw·q} dA over a facet, m².
fn linear_phase_integral(facet: &Facet, w: Vec3) -> Complex64 {
    let patch = &facet.patch;
    let normal = patch.normal();
    let along = w - normal * normal.dot(w);
    if along.length() * facet.diameter < SMALL_PHASE {
        return regular(facet, POINTS).into_iter().map(|(q, weight)| Complex64::cis(w.dot(q)) * weight).sum();
    }
    let side = |i: usize| {
        let (a, b) = (patch.corner(i), patch.corner(i + 1));
        let half = 0.5 * w.dot(b - a);
        let sinc = if half == 0.0 { 1.0 } else { half.sin() / half };
        Complex64::cis(w.dot(a.midpoint(b))) * (along.dot((b - a).cross(normal)) * sinc)
    };
    let sum: Complex64 = (0..patch.sides()).map(side).sum();
    sum * Complex64::new(0.0, -1.0) * (facet.area / patch.area() / along.length_squared())
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::material::{Layer, Material};
    use crate::source::{HertzianDipole, PlaneWave};
    use crate::surface::{cube, facing_plates, plate, sphere};
    use crate::{Sampling, Scatterer, Shadow, Source, Wave, cross_section};
    use std::f64::consts::PI;

    fn directions() -> Vec<Vec3> {
        let turn = |i: i32| {
            Vec3::new((0.7 * f64::from(i)).sin(), (0.7 * f64::from(i)).cos(), 0.3 - 0.1 * f64::from(i))
        };
        (0..9).map(turn).collect()
    }

    /// Gauss points on a mesh in wavelengths, for two waves at once.
    fn check(body: &Scatterer, shadow: Shadow) {
        let wave = Wave::new(1e9).unwrap();
        let waves = [(Vec3::Y, Vec3::Z), (Vec3::new(0.4, 1.0, -0.3), Vec3::X)]
            .map(|(travel, along)| PlaneWave::new(travel, along, Complex64::new(0.8, -0.3)).unwrap());
        let sources: [&dyn Source; 2] = [&waves[0], &waves[1]];
        let optics = PhysicalOptics::new(body, wave, &sources, shadow).unwrap();
        let closed = optics.linear_phase_far_field(&directions()).unwrap().unwrap();
        let points = optics.radiator(Sampling::Tolerance(1e-9)).far_field(&directions()).unwrap();
        let largest = points.iter().map(|far| far.amplitude.norm()).fold(0.0, f64::max);
        for (a, b) in closed.iter().zip(&points) {
            let gap = (a.amplitude - b.amplitude).norm();
            assert!(gap < 1e-7 * largest, "{shadow:?}: {gap:e} of {largest:e}");
        }
    }

    #[test]
    fn the_closed_form_is_the_sum_of_many_points() {
        let edge = 0.1;
        for shadow in [Shadow::Geometric, Shadow::Radiated, Shadow::Thesis] {
            check(&facing_plates(0.6, 0.9, edge).unwrap(), shadow);
            check(&cube(0.5, edge).unwrap(), shadow);
            check(&sphere(0.4, edge).unwrap(), shadow);
        }
        let layer = Layer { permittivity: Complex64::new(4.0, -0.5), thickness: 0.03 };
        check(
            &plate(0.6, edge).unwrap().made_of(vec![Material::Slab(vec![layer])]).unwrap(),
            Shadow::Geometric,
        );
    }

    /// One facet of 20 wavelengths: 4πA²/λ² straight back, and the pattern of a uniform square
    /// beside.
    #[test]
    fn a_large_plate_needs_one_facet() {
        let wave = Wave::new(1e9).unwrap();
        let side = 20.0 * wave.wavelength();
        let whole = plate(side, side).unwrap();
        assert_eq!(whole.facets().len(), 1);
        let source = PlaneWave::new(Vec3::Y, Vec3::Z, 1.0.into()).unwrap();
        let sources: [&dyn Source; 1] = [&source];
        let optics = PhysicalOptics::new(&whole, wave, &sources, Shadow::Geometric).unwrap();
        let angle: f64 = 0.11;
        let beside = Vec3::new(angle.sin(), -angle.cos(), 0.0);
        let far = optics.linear_phase_far_field(&[Vec3::NEG_Y, beside]).unwrap().unwrap();
        let closed = 4.0 * PI * (side * side / wave.wavelength()).powi(2);
        let sigma = |i: usize| cross_section(far[i].amplitude.components()[2], 1.0.into()) / closed;
        assert!((sigma(0) - 1.0).abs() < 1e-7, "{}", sigma(0));
        let x = 0.5 * wave.wavenumber() * side * angle.sin();
        assert!((sigma(1) / (x.sin() / x).powi(2) - 1.0).abs() < 1e-9, "{}", sigma(1));
        let dipole = HertzianDipole::new(Vec3::NEG_Y * 9.0, Vec3::Z, 1.0.into()).unwrap();
        let sources: [&dyn Source; 1] = [&dipole];
        let optics = PhysicalOptics::new(&whole, wave, &sources, Shadow::Geometric).unwrap();
        assert!(optics.linear_phase_far_field(&[Vec3::NEG_Y]).is_none());
    }
}
