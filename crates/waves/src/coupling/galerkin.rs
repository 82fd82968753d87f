//! Galerkin with constant currents on the facets: K_ab as the mean over the observer of the
//! integral over the source, both by Gauss rules from kR, the distance and the size; close pairs by
//! the nearly singular rule from every point of the observer.
//!
//! R. F. Harrington, Field Computation by Moment Methods, Macmillan 1968, § 1-3.

use super::dense::assemble;
use super::pair::integral;
use super::sides::sign;
use super::{Block, View, block};
use crate::rule::{points_for_distance, points_for_phase, regular};
use crate::{ComplexVector, Facet, Scatterer, Shadow, Wave, WaveError};
use fredholm_linop::Dense;
use num_complex::Complex64;

/// Points a side of the observer where the source is too close for any bound.
const CLOSE_POINTS: usize = 6;

/// The matrix K (2N × 2N for N facets), `tolerance` relative to a block.
///
/// # Errors
/// [`WaveError::NotClosed`] where the shadow asks for closed bodies; [`WaveError::CentresOnly`] for
/// the equation on two surfaces; [`WaveError::Linop`] where it does not fit in memory.
pub fn galerkin(
    scatterer: &Scatterer,
    wave: &Wave,
    shadow: Shadow,
    tolerance: f64,
) -> Result<Dense<Complex64>, WaveError> {
    shadow.check(scatterer)?;
    if shadow == Shadow::ExactDual {
        return Err(WaveError::CentresOnly);
    }
    scatterer.check_conductor("the coupling of currents")?;
    let (facets, view) = (scatterer.facets(), View::new(scatterer, shadow));
    assemble(facets.len(), |p, q| {
        let (observer, source) = (&facets[p], &facets[q]);
        let sign = sign(observer, source, observer.centre - source.centre, shadow);
        if p == q || sign == 0.0 || view.as_ref().is_some_and(|view| !view.sees(p, q)) {
            return Block::default();
        }
        block(observer, source, mean(wave, observer, source, tolerance), sign, shadow)
    })
}

/// The mean of G over the observer.
fn mean(wave: &Wave, p: &Facet, q: &Facet, tolerance: f64) -> ComplexVector {
    let distance = p.centre.distance(q.centre) / (0.5 * p.diameter.max(q.diameter));
    let phase = points_for_phase(wave.wavenumber() * p.edge(), tolerance);
    let points =
        points_for_distance(distance, tolerance).unwrap_or(CLOSE_POINTS).min(CLOSE_POINTS).max(phase);
    let rule = regular(p, points).into_iter();
    rule.map(|(x, weight)| integral(wave, x, q, tolerance) * (weight / p.area)).sum()
}
