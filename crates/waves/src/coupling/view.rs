//! Which facets see each other: one bit a pair.

use crate::{Facet, Scatterer, Shadow};
use rayon::prelude::*;

/// Rows of bits: bit q of row p is set where nothing blocks the segment between the centres.
#[derive(Clone, Debug)]
pub(crate) struct View {
    words: usize,
    bits: Vec<u64>,
}

impl View {
    /// The view of all facets, or `None` where every pair sees each other or the treatment does not
    /// ask.
    pub(crate) fn new(scatterer: &Scatterer, shadow: Shadow) -> Option<Self> {
        if shadow != Shadow::Geometric || !can_block(scatterer) {
            return None;
        }
        let count = scatterer.facets().len();
        let words = count.div_ceil(64);
        let rows = (0..count).into_par_iter().flat_map_iter(|p| row(scatterer, p, words));
        Some(Self { words, bits: rows.collect() })
    }

    /// Bytes that it takes, at most.
    pub(crate) fn bytes(scatterer: &Scatterer, shadow: Shadow) -> u64 {
        let facets = scatterer.facets().len();
        let row = 8 * facets.div_ceil(64) as u64;
        if shadow == Shadow::Geometric { row.saturating_mul(facets as u64) } else { 0 }
    }

    /// Whether p and q see each other.
    pub(crate) fn sees(&self, p: usize, q: usize) -> bool {
        self.bits[p * self.words + q / 64] >> (q % 64) & 1 == 1
    }
}

/// Whether some occluder has facets on both sides of its plane: else none can come between two.
fn can_block(scatterer: &Scatterer) -> bool {
    let margin = scatterer.occluders().tolerance();
    scatterer.occluders().patches().par_iter().any(|patch| {
        let height = |facet: &Facet| patch.normal().dot(facet.centre - patch.corner(0));
        let heights = || scatterer.facets().iter().map(height);
        heights().any(|height| height > margin) && heights().any(|height| height < -margin)
    })
}

fn row(scatterer: &Scatterer, p: usize, words: usize) -> Vec<u64> {
    let (facets, occluders) = (scatterer.facets(), scatterer.occluders());
    let mut bits = vec![0; words];
    for (q, facet) in facets.iter().enumerate() {
        // The same order of the ends in both rows of a pair: the same answer.
        let (a, b) = if p < q { (facets[p].centre, facet.centre) } else { (facet.centre, facets[p].centre) };
        bits[q / 64] |= u64::from(occluders.unoccluded(a, b)) << (q % 64);
    }
    bits
}
