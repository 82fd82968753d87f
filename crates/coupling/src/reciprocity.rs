//! How well A_i F_ij = A_j F_ji holds when both sides are computed.
//!
//! The matrix stores one value per pair. Here some pairs are computed a second time with the order of integration exchanged.

use crate::form_factor::{Method, PairIntegrator, Workspace};

/// Pairs looked at, and occluded ones among them that are compared.
const LOOKS: u64 = 20_000;
const COMPARED: usize = 100;
/// Fractional parts of the powers of 1/φ, φ³ = φ + 1: their multiples spread evenly over the unit square (M. Roberts, 2018).
const STEPS: [f64; 2] = [0.754_877_666_246_692_7, 0.569_840_290_998_053_2];

/// Largest difference of the two orders, relative to the smaller area (that is, of the larger form factor), over a fixed sample of
/// partly occluded pairs; `None` where the sample has none.
#[must_use]
pub fn reciprocity(integrator: &PairIntegrator) -> Option<f64> {
    let mut work = Workspace::default();
    let n = integrator.len() as f64;
    let pair = |k: u64| STEPS.map(|step| ((k as f64 * step).fract() * n) as usize);
    let mut defect = |[i, j]: [usize; 2]| {
        let (there, back) =
            (integrator.exchange_from(i, j, &mut work), integrator.exchange_from(j, i, &mut work));
        let occluded = there.method == Method::Clipped;
        occluded.then(|| (there.value - back.value).abs() / integrator.smaller_area(i, j))
    };
    (1..=LOOKS).map(pair).filter_map(&mut defect).take(COMPARED).reduce(f64::max)
}
