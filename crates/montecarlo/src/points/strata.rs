//! Jittered, N-rooks and multi-jittered points, each sample by itself.
//!
//! n = a b cells, a the largest divisor of n up to √n. Multi-jittered: sample s has the cell (i, j)
//! = (s mod a, ⌊s/a⌋), in it the column σ(j) of b and the row τ(i) of a, so that each of the n
//! columns and n rows has one sample.

use super::PointSet;
use super::permutation::{hash, permuted};

/// The point of sample `s` of `n`; the pattern is the batch's, the jitter the sample's.
pub(super) fn place(set: PointSet, s: u32, n: u32, pattern: [u32; 4], jitter: [f64; 2]) -> [f64; 2] {
    let columns = divisor(n);
    let rows = n / columns;
    let within = |stratum: u32, of: u32, jitter: f64| (f64::from(stratum) + jitter) / f64::from(of);
    let point = match set {
        PointSet::NRooks => [0, 1].map(|axis| within(permuted(s, n, pattern[axis]), n, jitter[axis])),
        PointSet::MultiJittered => {
            let s = permuted(s, n, pattern[2]);
            let (i, j) = (s % columns, s / columns);
            // The column depends on the cell's row, shuffled for each column apart, and the other
            // way round.
            let across = permuted(j, rows, pattern[0] ^ hash(i));
            let up = permuted(i, columns, pattern[1] ^ hash(j));
            [within(i * rows + across, n, jitter[0]), within(j * columns + up, n, jitter[1])]
        }
        _ => {
            let s = permuted(s, n, pattern[0]);
            [within(s % columns, columns, jitter[0]), within(s / columns, rows, jitter[1])]
        }
    };
    // Rounding can reach 1.
    point.map(|x| x.min(1.0 - f64::EPSILON / 2.0))
}

/// The largest divisor up to the square root.
fn divisor(n: u32) -> u32 {
    let root = f64::from(n).sqrt() as u32;
    (1..=root.max(1)).rev().find(|d| n.is_multiple_of(*d)).unwrap_or(1)
}
