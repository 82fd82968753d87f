//! Writing blocks into a matrix.

use crate::WaveError;
use fredholm_linop::{Dense, LinopError};
use num_complex::Complex64;
use rayon::prelude::*;

/// The matrix of the W × W blocks of all pairs (observer, source), in parallel over the observers.
pub(crate) fn assemble<const W: usize>(
    facets: usize,
    block: impl Fn(usize, usize) -> [[Complex64; W]; W] + Sync,
) -> Result<Dense<Complex64>, WaveError> {
    let dim = W * facets;
    let bytes = Dense::<Complex64>::bytes(dim);
    let refused = LinopError::Memory { what: "the matrix of the currents", bytes };
    let length = dim.checked_mul(dim).ok_or_else(|| refused.clone())?;
    let mut entries = Vec::new();
    entries.try_reserve_exact(length).map_err(|_| refused)?;
    entries.resize(length, Complex64::ZERO);
    entries.par_chunks_mut(W * dim.max(1)).enumerate().for_each(|(p, rows)| {
        for q in 0..facets {
            for (row, entries) in rows.chunks_exact_mut(dim).zip(block(p, q)) {
                row[W * q..W * (q + 1)].copy_from_slice(&entries);
            }
        }
    });
    Ok(Dense::new(dim, entries)?)
}
