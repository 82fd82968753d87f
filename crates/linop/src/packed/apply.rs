//! y = G x from one read of the lower triangle: row i gives y_i += Σ_{j≤i} g_ij x_j, and y_j +=
//! g_ij x_i for j < i.
//!
//! Rows are cut into fixed runs of about equal numbers of entries, each run sums into a vector of
//! its own, and the vectors are added in the order of the runs: the number of threads changes no
//! bit.

use super::planar::{Planar, PlanarMut};
use super::strip::{Both, Strip};
use super::{COLUMNS_OF_A_TILE, PackedSymmetric, ROWS_TOGETHER, Storage};
use crate::MultiVector;
use pulp::{Arch, Simd, WithSimd};
use rayon::prelude::*;
use std::ops::Range;

/// Most runs of rows: enough to balance the threads, few enough for a vector each.
const MOST_RUNS: usize = 32;
/// Fewest entries worth a run.
const FEWEST_ENTRIES_OF_A_RUN: usize = 1 << 15;
/// Unknowns added at a time.
const UNKNOWNS_OF_A_BLOCK: usize = 1 << 10;

pub(super) fn apply<S: Storage>(matrix: &PackedSymmetric<S>, x: &MultiVector<f64>, y: &mut MultiVector<f64>) {
    let (planar, runs) = (Planar::copied(x), runs(matrix.dim()));
    // One piece of memory for all, which the next product is likely to be given again.
    let mut memory = vec![0.0; runs.iter().map(|rows| rows.end * x.rhs_count()).sum()];
    let mut parts = split(&mut memory, &runs, x.rhs_count());
    let tasks = parts.par_iter_mut().zip(runs).with_max_len(1);
    tasks.for_each(|(part, rows)| {
        Arch::new().dispatch(Whole(&mut Product::new(matrix, rows, x.rhs_count(), &planar, part.view_mut())));
    });
    let rhs_count = x.rhs_count().max(1);
    y.as_mut_slice().par_chunks_mut(UNKNOWNS_OF_A_BLOCK * rhs_count).enumerate().for_each(|(at, y)| {
        let mut sums = [0.0; UNKNOWNS_OF_A_BLOCK];
        for rhs in 0..x.rhs_count() {
            let sums = &mut sums[..y.len() / rhs_count];
            sums.fill(0.0);
            for part in &parts {
                let part = part.vector(rhs).iter().skip(at * UNKNOWNS_OF_A_BLOCK);
                sums.iter_mut().zip(part).for_each(|(sum, part)| *sum += part);
            }
            y.iter_mut().skip(rhs).step_by(rhs_count).zip(sums).for_each(|(y, sum)| *y = *sum);
        }
    });
}

/// For each run of rows its share of y: all right-hand sides up to the last of its rows.
fn split<'a>(mut memory: &'a mut [f64], runs: &[Range<usize>], rhs_count: usize) -> Vec<PlanarMut<'a>> {
    let mut parts = Vec::with_capacity(runs.len());
    for rows in runs {
        let (part, rest) = memory.split_at_mut(rows.end * rhs_count);
        parts.push(PlanarMut::new(rows.end, part));
        memory = rest;
    }
    parts
}

/// Runs of rows that depend on the dimension alone. Row i ends at about i²/2 entries, so equal
/// shares end at equal steps of i².
fn runs(dim: usize) -> Vec<Range<usize>> {
    let count = (dim * (dim + 1) / 2 / FEWEST_ENTRIES_OF_A_RUN).clamp(1, MOST_RUNS);
    let end = |run: usize| (dim as f64 * (run as f64 / count as f64).sqrt()).round() as usize;
    (0..count).map(|run| end(run)..end(run + 1)).collect()
}

/// What some rows of the triangle add to y.
struct Product<'a, S> {
    matrix: &'a PackedSymmetric<S>,
    rows: Range<usize>,
    rhs_count: usize,
    x: &'a Planar,
    /// y up to the last of the rows.
    y: PlanarMut<'a>,
    sums: Vec<f64>,
    factors: Vec<f64>,
}

/// All rows of a product.
struct Whole<'p, 'a, S>(&'p mut Product<'a, S>);

impl<S: Storage> WithSimd for Whole<'_, '_, S> {
    type Output = ();

    #[inline(always)]
    fn with_simd<V: Simd>(self, simd: V) {
        let Range { start, end } = self.0.rows;
        let whole = start + (end - start) / ROWS_TOGETHER * ROWS_TOGETHER;
        for first in (start..whole).step_by(ROWS_TOGETHER) {
            self.0.add_rows::<V, ROWS_TOGETHER>(simd, first);
        }
        for first in whole..end {
            self.0.add_rows::<V, 1>(simd, first);
        }
    }
}

impl<'a, S: Storage> Product<'a, S> {
    fn new(
        matrix: &'a PackedSymmetric<S>,
        rows: Range<usize>,
        rhs_count: usize,
        x: &'a Planar,
        y: PlanarMut<'a>,
    ) -> Self {
        let zeros = vec![0.0; ROWS_TOGETHER * rhs_count];
        Self { matrix, rows, rhs_count, x, y, sums: zeros.clone(), factors: zeros }
    }

    /// Rows first … first + R − 1: the columns before `first` together, then those of each row up
    /// to its diagonal.
    #[inline(always)]
    fn add_rows<V: Simd, const R: usize>(&mut self, simd: V, first: usize) {
        let rows = self.matrix.packed_rows::<R>(first);
        let count = R * self.rhs_count;
        self.sums.fill(0.0);
        for r in 0..R {
            let factors = &mut self.factors[r * self.rhs_count..(r + 1) * self.rhs_count];
            factors.iter_mut().zip(self.x.row(first + r)).for_each(|(factor, x)| *factor = x);
        }
        for from in (0..first).step_by(COLUMNS_OF_A_TILE) {
            let to = (from + COLUMNS_OF_A_TILE).min(first);
            let tile = rows.map(|row| &row[from..]);
            let strip = Strip { rows: &tile, from };
            let (sums, factors) = (&mut self.sums[..count], &self.factors[..count]);
            Both { strip, x: self.x, sums, factors, u: self.y.view_mut(), columns: to - from }
                .with_simd(simd);
        }
        (0..R).for_each(|r| self.add_corner(&rows[r][first..], first, r));
    }

    /// Row `first` + r from column `first` to the diagonal, and what the columns before have
    /// summed.
    fn add_corner(&mut self, row: &[S], first: usize, r: usize) {
        let own = r * self.rhs_count..(r + 1) * self.rhs_count;
        for (k, entry) in row[..r].iter().enumerate() {
            let entry = entry.to_f64();
            let above = &self.factors[k * self.rhs_count..(k + 1) * self.rhs_count];
            self.sums[own.clone()].iter_mut().zip(above).for_each(|(sum, x)| *sum += entry * x);
            let factors = self.factors[own.clone()].iter();
            self.y.add_row(first + k, factors.map(|x| entry * x));
        }
        let diagonal = row[r].to_f64();
        let known = self.sums[own.clone()].iter().zip(&self.factors[own]);
        self.y.add_row(first + r, known.map(|(sum, x)| *sum + diagonal * x));
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
