//! How well A_i F_ij = A_j F_ji holds when both sides are computed.
//!
//! The matrix stores one value per pair. Here some pairs are computed a second time with the order
//! of integration exchanged.

use crate::form_factor::{Method, PairIntegrator, Workspace};
use crate::sample_pairs;

/// Pairs looked at, and occluded ones among them that are compared.
const PAIRS_LOOKED_AT: usize = 20_000;
const OCCLUDED_PAIRS_COMPARED: usize = 100;

/// Largest difference of the two orders, relative to the smaller area (that is, of the larger form
/// factor), over a fixed sample of partly occluded pairs; `None` where the sample has none. Where rows
/// have a budget, pairs behind many bodies are left out: their exact shadows, of which the assembly
/// asks few, would take longer than all the rest.
#[must_use]
pub fn reciprocity(integrator: &PairIntegrator) -> Option<f64> {
    let mut work = Workspace::default();
    let mut defect = |[i, j]: [usize; 2]| {
        if !integrator.is_quickly_exact(i, j) {
            return None;
        }
        let (there, back) =
            (integrator.exchange_from(i, j, &mut work), integrator.exchange_from(j, i, &mut work));
        let occluded = there.method == Method::Clipped;
        occluded.then(|| (there.value - back.value).abs() / integrator.smaller_area(i, j))
    };
    // A small scene has fewer pairs than that.
    let looks = PAIRS_LOOKED_AT.min(integrator.len().saturating_pow(2));
    sample_pairs(integrator.len())
        .take(looks)
        .filter_map(&mut defect)
        .take(OCCLUDED_PAIRS_COMPARED)
        .reduce(f64::max)
}
