//! y = G x from one read of the lower triangle: row i gives y_i += Σ_{j≤i} g_ij x_j, and y_j += g_ij x_i for j < i.
//!
//! Rows are cut into fixed runs of about equal numbers of entries, each run sums into a vector of its own, and the
//! vectors are added in the order of the runs: the number of threads changes no bit.

use super::strip::Strip;
use super::{PackedSymmetric, ROWS, Storage};
use crate::MultiVector;
use rayon::prelude::*;
use std::ops::Range;

/// Most runs of rows: enough to balance the threads, few enough for a vector each.
const RUNS: usize = 32;
/// Fewest entries worth a run.
const LEAST: usize = 1 << 15;
/// Unknowns added at a time.
const BLOCK: usize = 1 << 10;

pub(super) fn apply<S: Storage>(matrix: &PackedSymmetric<S>, x: &MultiVector<f64>, y: &mut MultiVector<f64>) {
    let partial: Vec<Vec<f64>> =
        runs(matrix.dim()).into_par_iter().map(|rows| Product::of_rows(matrix, rows, x)).collect();
    let block = BLOCK * x.lanes().max(1);
    y.as_mut_slice().par_chunks_mut(block).enumerate().for_each(|(at, y)| {
        y.fill(0.0);
        for partial in &partial {
            let from = (at * block).min(partial.len());
            y.iter_mut().zip(&partial[from..]).for_each(|(y, part)| *y += part);
        }
    });
}

/// Runs of rows that depend on the dimension alone. Row i ends at about i²/2 entries, so equal shares end at equal
/// steps of i².
fn runs(dim: usize) -> Vec<Range<usize>> {
    let count = (dim * (dim + 1) / 2 / LEAST).clamp(1, RUNS);
    let end = |run: usize| (dim as f64 * (run as f64 / count as f64).sqrt()).round() as usize;
    (0..count).map(|run| end(run)..end(run + 1)).collect()
}

/// What some rows of the triangle add to y.
struct Product<'a, S> {
    matrix: &'a PackedSymmetric<S>,
    x: &'a MultiVector<f64>,
    y: Vec<f64>,
    sums: Vec<f64>,
}

impl<'a, S: Storage> Product<'a, S> {
    /// y up to the last of the rows.
    fn of_rows(matrix: &'a PackedSymmetric<S>, rows: Range<usize>, x: &'a MultiVector<f64>) -> Vec<f64> {
        let lanes = x.lanes();
        let mut product = Self { matrix, x, y: vec![0.0; rows.end * lanes], sums: vec![0.0; ROWS * lanes] };
        let whole = rows.start + rows.len() / ROWS * ROWS;
        (rows.start..whole).step_by(ROWS).for_each(|first| product.add_rows::<ROWS>(first));
        (whole..rows.end).for_each(|first| product.add_rows::<1>(first));
        product.y
    }

    /// Rows first … first + R − 1: the columns before `first` together, then those of each row up to its diagonal.
    fn add_rows<const R: usize>(&mut self, first: usize) {
        let lanes = self.x.lanes();
        let rows = self.matrix.packed_rows::<R>(first);
        let (x_before, x) = self.x.as_slice().split_at(first * lanes);
        let (y_before, y) = self.y.split_at_mut(first * lanes);
        self.sums.fill(0.0);
        let before = Strip { rows: rows.map(|row| &row[..first]), lanes };
        before.dot(x_before, &mut self.sums[..R * lanes]);
        before.add(&x[..R * lanes], y_before);
        for (r, row) in rows.iter().enumerate() {
            let sums = &mut self.sums[r * lanes..(r + 1) * lanes];
            let (x_above, x) = x.split_at(r * lanes);
            let (y_above, y) = y.split_at_mut(r * lanes);
            let corner = Strip { rows: [&row[first..first + r]], lanes };
            corner.dot(x_above, sums);
            corner.add(&x[..lanes], y_above);
            let diagonal = row[first + r].to_f64();
            y.iter_mut().zip(x).zip(sums).for_each(|((y, x), sum)| *y += *sum + diagonal * x);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn runs_cover_the_rows_in_order_with_about_equal_entries() {
        for dim in [0, 1, 2, 500, 3000, 20_000] {
            let runs = runs(dim);
            assert_eq!((runs[0].start, runs[runs.len() - 1].end), (0, dim));
            assert!(runs.windows(2).all(|pair| pair[0].end == pair[1].start));
            let entries = |run: &Range<usize>| run.clone().map(|i| i + 1).sum::<usize>();
            let share = dim * (dim + 1) / 2 / runs.len();
            assert!(runs.iter().all(|run| entries(run).abs_diff(share) <= 2 * dim));
        }
    }
}
