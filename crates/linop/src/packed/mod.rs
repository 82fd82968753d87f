//! A real symmetric matrix whose lower triangle is stored once: g_ij = g_ji at i(i+1)/2 + j for j ≤
//! i.
//!
//! This holds G_ij = A_i F_ij (m²) of light: row i of the triangle has i + 1 entries, n(n+1)/2 in
//! all. Storage may be f32, which halves the memory at 6e-8 relative error an entry; arithmetic is
//! always f64.

#![allow(
    clippy::inline_always,
    reason = "what runs under the wide registers must be compiled into the function that has them"
)]

mod apply;
mod planar;
mod strip;
mod sweep;

use crate::{Dense, LinearOperator, LinopError, MultiVector, Relax, Sweep, Symmetry};
use rayon::prelude::*;
use std::ops::ControlFlow;

/// Rows taken at a time.
const ROWS_TOGETHER: usize = 4;
/// Fewest entries of a column worth a thread.
const FEWEST_ENTRIES_OF_A_THREAD: usize = 1 << 11;
/// Columns taken at a time: four rows of them stay in the innermost cache for both directions and
/// all right-hand sides.
const COLUMNS_OF_A_TILE: usize = 1 << 9;

mod sealed {
    pub trait Sealed {}
    impl Sealed for f64 {}
    impl Sealed for f32 {}
}

/// How an entry is stored: f64 or f32.
pub trait Storage: sealed::Sealed + Copy + Send + Sync + 'static {
    /// The nearest stored value.
    fn from_f64(value: f64) -> Self;
    /// The stored value, exactly.
    fn to_f64(self) -> f64;
}

impl Storage for f64 {
    fn from_f64(value: f64) -> Self {
        value
    }

    fn to_f64(self) -> f64 {
        self
    }
}

impl Storage for f32 {
    fn from_f64(value: f64) -> Self {
        value as f32
    }

    fn to_f64(self) -> f64 {
        f64::from(self)
    }
}

/// A symmetric matrix stored as its packed lower triangle. It serves any number of right-hand
/// sides.
#[derive(Clone, Debug, PartialEq)]
pub struct PackedSymmetric<S> {
    dim: usize,
    packed: Vec<S>,
}

impl<S: Storage> PackedSymmetric<S> {
    /// Takes the lower triangle with its diagonal, row by row: g_ij at i(i+1)/2 + j.
    ///
    /// # Errors
    /// [`LinopError::Length`] unless there are n(n+1)/2 entries.
    pub fn new(dim: usize, packed: Vec<S>) -> Result<Self, LinopError> {
        let expected = entries(dim);
        if packed.len() as u128 != expected {
            return Err(LinopError::Length {
                what: "the packed symmetric matrix",
                expected,
                found: packed.len(),
            });
        }
        Ok(Self { dim, packed })
    }

    /// Bytes that a matrix of this dimension takes.
    #[must_use]
    pub fn bytes(dim: usize) -> u64 {
        u64::try_from(entries(dim).saturating_mul(size_of::<S>() as u128)).unwrap_or(u64::MAX)
    }

    /// Number of rows, and of columns.
    #[must_use]
    pub fn dim(&self) -> usize {
        self.dim
    }

    /// Row i of the lower triangle: g_i0 … g_ii.
    ///
    /// # Panics
    /// There is no such row.
    #[must_use]
    pub fn packed_row(&self, i: usize) -> &[S] {
        let start = i * (i + 1) / 2;
        &self.packed[start..=start + i]
    }

    /// R rows of the lower triangle from row `first` on.
    fn packed_rows<const R: usize>(&self, first: usize) -> [&[S]; R] {
        std::array::from_fn(|r| self.packed_row(first + r))
    }

    /// g_ij, on either side of the diagonal.
    ///
    /// # Panics
    /// There is no such entry.
    #[must_use]
    pub fn get(&self, i: usize, j: usize) -> f64 {
        self.packed_row(i.max(j))[i.min(j)].to_f64()
    }

    /// Σ_j g_ij per row i; for light the closure of row i times A_i, m².
    #[must_use]
    pub fn row_sums(&self) -> Vec<f64> {
        let mut sums = MultiVector::zeros(self.dim, 1);
        self.apply(&MultiVector::from_fn(self.dim, 1, |_, _| 1.0), &mut sums);
        sums.as_slice().to_vec()
    }
}

fn entries(dim: usize) -> u128 {
    dim as u128 * (dim as u128 + 1) / 2
}

impl<S: Storage> LinearOperator<f64> for PackedSymmetric<S> {
    fn dim(&self) -> usize {
        self.dim
    }

    fn apply(&self, x: &MultiVector<f64>, y: &mut MultiVector<f64>) {
        apply::apply(self, x, y);
    }

    fn symmetry(&self) -> Symmetry {
        Symmetry::Symmetric
    }

    fn entries(&self) -> u64 {
        self.packed.len() as u64
    }

    fn row(&self, i: usize, _rhs: usize, out: &mut [f64]) {
        let (left, right) = out.split_at_mut(i + 1);
        left.iter_mut().zip(self.packed_row(i)).for_each(|(out, entry)| *out = entry.to_f64());
        // Below the diagonal every entry lies in another page of memory: several threads wait for
        // several at once.
        let below = right.par_iter_mut().with_min_len(FEWEST_ENTRIES_OF_A_THREAD).enumerate();
        below.for_each(|(k, out)| *out = self.packed_row(i + 1 + k)[i].to_f64());
    }

    fn lower_row(&self, i: usize, _rhs: usize, out: &mut [f64]) {
        out.iter_mut().zip(self.packed_row(i)).for_each(|(out, entry)| *out = entry.to_f64());
    }

    fn column(&self, j: usize, rhs: usize, out: &mut [f64]) {
        self.row(j, rhs, out);
    }

    fn diagonal(&self, _rhs: usize, out: &mut [f64]) {
        out.iter_mut().enumerate().for_each(|(i, out)| *out = self.get(i, i));
    }

    fn dense(&self, rhs: usize) -> Result<Dense<f64>, LinopError> {
        let mut dense = Dense::zeros(self.dim)?;
        (0..self.dim).for_each(|i| self.row(i, rhs, dense.row_slice_mut(i)));
        Ok(dense)
    }

    fn sweep(
        &self,
        x: &mut MultiVector<f64>,
        sweep: &mut Sweep<f64>,
        relax: &mut Relax<'_, f64>,
    ) -> ControlFlow<()> {
        sweep::sweep(self, x, sweep, relax)
    }

    fn sweep_back(
        &self,
        x: &mut MultiVector<f64>,
        sweep: &mut Sweep<f64>,
        relax: &mut Relax<'_, f64>,
    ) -> ControlFlow<()> {
        sweep::sweep_back(self, x, sweep, relax)
    }
}

#[cfg(test)]
#[allow(clippy::float_cmp, reason = "these results are exact")]
mod tests {
    use super::*;

    #[test]
    fn entries_lie_where_the_formula_says() {
        let matrix = PackedSymmetric::new(3, vec![1.0, 2.0, 3.0, 4.0, 5.0, 6.0]).unwrap();
        let full = [[1.0, 2.0, 4.0], [2.0, 3.0, 5.0], [4.0, 5.0, 6.0]];
        let mut row = [0.0; 3];
        for (i, expected) in full.iter().enumerate() {
            matrix.row(i, 0, &mut row);
            assert_eq!(row, *expected);
            assert_eq!([0, 1, 2].map(|j| matrix.get(i, j)), *expected);
        }
        assert_eq!(matrix.packed_row(1), [2.0, 3.0]);
        assert_eq!(matrix.row_sums(), [7.0, 10.0, 15.0]);
        matrix.diagonal(0, &mut row);
        assert_eq!(row, [1.0, 3.0, 6.0]);
    }

    #[test]
    fn a_wrong_number_of_entries_is_refused() {
        let wrong = LinopError::Length { what: "the packed symmetric matrix", expected: 6, found: 5 };
        assert_eq!(PackedSymmetric::new(3, vec![0.0f32; 5]), Err(wrong));
        assert!(PackedSymmetric::new(usize::MAX, vec![0.0]).is_err());
    }

    #[test]
    fn memory_is_predicted_without_overflow() {
        assert_eq!(PackedSymmetric::<f64>::bytes(4), 80);
        assert_eq!(PackedSymmetric::<f32>::bytes(4), 40);
        assert_eq!(PackedSymmetric::<f64>::bytes(usize::MAX), u64::MAX);
    }

    #[test]
    fn an_empty_matrix_has_an_empty_product() {
        let matrix = PackedSymmetric::<f64>::new(0, Vec::new()).unwrap();
        assert!(matrix.row_sums().is_empty());
    }
}
