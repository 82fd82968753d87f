//! A square matrix with every entry stored, row by row: y_i = Σ_j k_ij x_j.

use crate::{LinearOperator, LinopError, MultiVector, Scalar, Symmetry};
use rayon::prelude::*;

/// A square matrix stored row by row: k_ij at i · dim + j. It serves any number of right-hand
/// sides.
#[derive(Clone, Debug, PartialEq)]
pub struct Dense<T> {
    dim: usize,
    entries: Vec<T>,
    symmetry: Symmetry,
}

impl<T: Scalar> Dense<T> {
    /// Takes the entries of `dim` rows.
    ///
    /// # Errors
    /// [`LinopError::Length`] unless there are dim² entries.
    pub fn new(dim: usize, entries: Vec<T>) -> Result<Self, LinopError> {
        let expected = dim as u128 * dim as u128;
        if entries.len() as u128 != expected {
            return Err(LinopError::Length { what: "the dense matrix", expected, found: entries.len() });
        }
        Ok(Self { dim, entries, symmetry: Symmetry::General })
    }

    /// All zeros.
    ///
    /// # Errors
    /// [`LinopError::Memory`] if dim² entries do not fit.
    pub fn zeros(dim: usize) -> Result<Self, LinopError> {
        let refused = LinopError::Memory { what: "a dense matrix", bytes: Self::bytes(dim) };
        let len = dim.checked_mul(dim).ok_or_else(|| refused.clone())?;
        // Memory that the system hands out is zero: what stays so is never touched.
        let entries = bytemuck::allocation::try_zeroed_vec(len).map_err(|()| refused)?;
        Ok(Self { dim, entries, symmetry: Symmetry::General })
    }

    /// The same matrix as one that is known to have this symmetry, as some solvers ask for.
    ///
    /// # Errors
    /// [`LinopError::Asymmetric`] where an entry contradicts it.
    pub fn with_symmetry(self, symmetry: Symmetry) -> Result<Self, LinopError> {
        let mirrored = |i: usize, j: usize| match symmetry {
            Symmetry::General => self.get(i, j),
            Symmetry::Symmetric => self.get(j, i),
            Symmetry::Hermitian => self.get(j, i).conj(),
        };
        let pairs = (0..self.dim).flat_map(|i| (0..=i).map(move |j| (i, j)));
        match pairs.into_iter().find(|&(i, j)| self.get(i, j) != mirrored(i, j)) {
            Some((row, column)) => Err(LinopError::Asymmetric { row, column }),
            None => Ok(Self { symmetry, ..self }),
        }
    }

    /// Bytes that dim² entries take.
    #[must_use]
    pub fn bytes(dim: usize) -> u64 {
        (dim as u64).saturating_mul(dim as u64).saturating_mul(size_of::<T>() as u64)
    }

    /// Number of rows, and of columns.
    #[must_use]
    pub fn dim(&self) -> usize {
        self.dim
    }

    /// k_ij.
    ///
    /// # Panics
    /// There is no such entry.
    #[must_use]
    pub fn get(&self, i: usize, j: usize) -> T {
        self.row_slice(i)[j]
    }

    /// Row i.
    ///
    /// # Panics
    /// There is no such row.
    #[must_use]
    pub fn row_slice(&self, i: usize) -> &[T] {
        &self.entries[i * self.dim..(i + 1) * self.dim]
    }

    /// Row i. The matrix is then no longer known to be symmetric.
    ///
    /// # Panics
    /// There is no such row.
    pub fn row_slice_mut(&mut self, i: usize) -> &mut [T] {
        self.symmetry = Symmetry::General;
        &mut self.entries[i * self.dim..(i + 1) * self.dim]
    }

    /// The entries, row by row.
    #[must_use]
    pub fn as_slice(&self) -> &[T] {
        &self.entries
    }

    /// The entries, row by row.
    #[must_use]
    pub fn into_vec(self) -> Vec<T> {
        self.entries
    }
}

impl<T: Scalar> LinearOperator<T> for Dense<T> {
    fn dim(&self) -> usize {
        self.dim
    }

    // Each thread sums whole rows in their order, so the number of threads changes no bit.
    fn apply(&self, x: &MultiVector<T>, y: &mut MultiVector<T>) {
        let rhs_count = x.rhs_count().max(1);
        y.as_mut_slice().par_chunks_mut(rhs_count).enumerate().with_min_len(16).for_each(|(i, y)| {
            y.fill(T::zero());
            for (&entry, x) in self.row_slice(i).iter().zip(x.as_slice().chunks_exact(rhs_count)) {
                y.iter_mut().zip(x).for_each(|(y, &x)| *y += entry * x);
            }
        });
    }

    fn symmetry(&self) -> Symmetry {
        self.symmetry
    }

    fn row(&self, i: usize, _rhs: usize, out: &mut [T]) {
        out.copy_from_slice(self.row_slice(i));
    }

    fn column(&self, j: usize, _rhs: usize, out: &mut [T]) {
        out.iter_mut().enumerate().for_each(|(i, out)| *out = self.get(i, j));
    }

    fn diagonal(&self, _rhs: usize, out: &mut [T]) {
        out.iter_mut().enumerate().for_each(|(i, out)| *out = self.get(i, i));
    }

    fn dense(&self, _rhs: usize) -> Result<Dense<T>, LinopError> {
        let mut copy = Self::zeros(self.dim)?;
        copy.entries.copy_from_slice(&self.entries);
        copy.symmetry = self.symmetry;
        Ok(copy)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_wrong_number_of_entries_is_refused() {
        let wrong = LinopError::Length { what: "the dense matrix", expected: 4, found: 3 };
        assert_eq!(Dense::new(2, vec![0.0; 3]), Err(wrong));
    }

    #[test]
    fn a_symmetry_that_the_entries_contradict_is_refused() {
        let matrix = |last| Dense::new(2, vec![1.0, 2.0, last, 3.0]).unwrap();
        let symmetric = matrix(2.0).with_symmetry(Symmetry::Symmetric).unwrap();
        assert_eq!(symmetric.symmetry(), Symmetry::Symmetric);
        let refusal = matrix(5.0).with_symmetry(Symmetry::Hermitian);
        assert_eq!(refusal, Err(LinopError::Asymmetric { row: 1, column: 0 }));
        let mut changed = symmetric;
        changed.row_slice_mut(0)[1] = 7.0;
        assert_eq!(changed.symmetry(), Symmetry::General);
    }

    #[test]
    fn a_matrix_beyond_all_memory_is_refused() {
        for dim in [1 << 30, usize::MAX] {
            assert!(matches!(Dense::<f64>::zeros(dim), Err(LinopError::Memory { .. })));
        }
        assert_eq!(Dense::<f64>::bytes(1000), 8_000_000);
    }
}
