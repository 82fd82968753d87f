//! The second surface of the dual equation: points a depth δ behind the facets, inside the
//! conductor.
//!
//! There the total H vanishes. Adding j times that to the magnetic field equation,
//!
//! ```text
//! J = 2 n × (H_i(p) + j H_i(p − δn)) + K J + j K_δ J,   K_δ J = 2 n × H[J](p − δn),
//! ```
//!
//! leaves no current that solves it without a source, at any frequency, while δ < λ/2 (R. A. Shore,
//! A. D. Yaghjian, Dual-surface integral equations in electromagnetic scattering, IEEE Trans.
//! Antennas Propag. 53 (2005) 1706). δ = λ/4, less in small bodies, and behind each facet less
//! where the body is thin there.

use crate::{Facet, Scatterer, Shadow, Wave, WaveError};
use fredholm_mesh::Vec3;
use num_complex::Complex64;
use rayon::prelude::*;

/// What the inner equation is multiplied by.
pub(crate) const INNER_FACTOR: Complex64 = Complex64::I;
/// Most of the extent of the body that δ takes.
const MOST_SHARE_OF_EXTENT: f64 = 0.125;
/// Most of the way to the surface opposite that δ takes.
const MOST_SHARE_OF_THICKNESS: f64 = 0.4;
/// Least δ, in wavelengths.
const LEAST_DEPTH: f64 = 1e-4;

/// δ of a facet, m.
pub(crate) fn depth(scatterer: &Scatterer, wave: &Wave, facet: &Facet) -> f64 {
    let most = (0.25 * wave.wavelength()).min(MOST_SHARE_OF_EXTENT * scatterer.extent());
    // From the flat facet on: its node may be outside of it, on the curved surface.
    let opposite =
        scatterer.occluders().closest(facet.patch.centroid(), -facet.normal, most / MOST_SHARE_OF_THICKNESS);
    opposite.map_or(most, |hit| most.min(MOST_SHARE_OF_THICKNESS * hit.t))
}

/// The inner point of each facet; none where the treatment has no second surface.
pub(crate) fn inner_points(
    scatterer: &Scatterer,
    wave: &Wave,
    shadow: Shadow,
) -> Result<Option<Vec<Vec3>>, WaveError> {
    if shadow != Shadow::ExactDual {
        return Ok(None);
    }
    let depths: Vec<f64> = scatterer.facets().par_iter().map(|facet| depth(scatterer, wave, facet)).collect();
    if let Some(facet) = depths.iter().position(|&depth| depth < LEAST_DEPTH * wave.wavelength()) {
        return Err(WaveError::Thin { facet, depth: depths[facet] });
    }
    let inner = scatterer.facets().iter().zip(&depths);
    Ok(Some(inner.map(|(facet, depth)| facet.centre - facet.normal * *depth).collect()))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::surface::{cube, cuboid, sphere};

    #[test]
    fn inner_points_are_inside_or_refused() {
        let wave = Wave::new(1e9).unwrap();
        let depth = 0.25 * wave.wavelength();
        let ball = sphere(0.4, 0.05).unwrap();
        let points = inner_points(&ball, &wave, Shadow::ExactDual).unwrap().unwrap();
        assert!(points.iter().all(|p| (p.length() - (0.4 - depth)).abs() < 1e-12));
        assert_eq!(inner_points(&ball, &wave, Shadow::Exact), Ok(None));
        // A thin body takes a part of its thickness.
        let flat = cuboid(Vec3::new(1.0, 1.0, 0.06), 0.1).unwrap();
        let points = inner_points(&flat, &wave, Shadow::ExactDual).unwrap().unwrap();
        let inside = |p: &Vec3| p.x.abs() < 0.5 && p.y.abs() < 0.5 && p.z.abs() < 0.03;
        assert!(points.iter().all(inside), "{points:?}");
        let foil = cuboid(Vec3::new(1.0, 1.0, 1e-5), 0.1).unwrap();
        let refused = inner_points(&foil, &wave, Shadow::ExactDual);
        assert!(matches!(refused, Err(WaveError::Thin { .. })), "{refused:?}");
        // A small body takes a smaller depth.
        assert!(inner_points(&cube(0.1, 0.02).unwrap(), &wave, Shadow::ExactDual).is_ok());
    }
}
