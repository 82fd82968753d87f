//! Writing blocks into a matrix.

use super::Block;
use crate::WaveError;
use fredholm_linop::{Dense, LinopError};
use num_complex::Complex64;
use rayon::prelude::*;

/// The matrix of the blocks of all pairs (observer, source), in parallel over the rows.
pub(crate) fn assemble(
    facets: usize,
    block: impl Fn(usize, usize) -> Block + Sync,
) -> Result<Dense<Complex64>, WaveError> {
    let dim = 2 * facets;
    let bytes = Dense::<Complex64>::bytes(dim);
    let refused = LinopError::Memory { what: "the matrix of the currents", bytes };
    let length = dim.checked_mul(dim).ok_or_else(|| refused.clone())?;
    let mut entries = Vec::new();
    entries.try_reserve_exact(length).map_err(|_| refused)?;
    entries.resize(length, Complex64::ZERO);
    entries.par_chunks_mut(2 * dim.max(1)).enumerate().for_each(|(p, rows)| {
        let (first, second) = rows.split_at_mut(dim);
        for q in 0..facets {
            let [a, b] = block(p, q);
            first[2 * q..2 * q + 2].copy_from_slice(&a);
            second[2 * q..2 * q + 2].copy_from_slice(&b);
        }
    });
    Ok(Dense::new(dim, entries)?)
}
