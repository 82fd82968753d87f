//! A square matrix with every entry stored, row by row: y_i = Σ_j k_ij x_j.

use crate::{LinearOperator, LinopError, MultiVector, Scalar, Symmetry};
use rayon::prelude::*;

/// Rows and columns of a tile in which an entry is compared with its mirror image.
const SYMMETRY_TILE: usize = 64;

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

    /// Rows made one by one, on all threads: `make` gets the number of a row and zeros.
    ///
    /// # Errors
    /// [`LinopError::Memory`] if dim² entries do not fit.
    pub fn from_rows(dim: usize, make: impl Fn(usize, &mut [T]) + Sync) -> Result<Self, LinopError> {
        let mut matrix = Self::zeros(dim)?;
        matrix.entries.par_chunks_mut(dim.max(1)).enumerate().for_each(|(i, row)| make(i, row));
        Ok(matrix)
    }

    /// The same matrix as one that is known to have this symmetry, as some solvers ask for.
    ///
    /// # Errors
    /// [`LinopError::Asymmetric`] where an entry contradicts it.
    pub fn with_symmetry(self, symmetry: Symmetry) -> Result<Self, LinopError> {
        match self.asymmetry(symmetry) {
            Some((row, column)) => Err(LinopError::Asymmetric { row, column }),
            None => Ok(Self { symmetry, ..self }),
        }
    }

    /// The same matrix as one that is known to be symmetric, Hermitian where it is complex, if its
    /// entries are.
    #[must_use]
    pub fn with_found_symmetry(self) -> Self {
        let symmetry = if T::IS_REAL { Symmetry::Symmetric } else { Symmetry::Hermitian };
        if self.asymmetry(symmetry).is_none() { Self { symmetry, ..self } } else { self }
    }

    /// Row and column of an entry that contradicts a symmetry, if there is one.
    fn asymmetry(&self, symmetry: Symmetry) -> Option<(usize, usize)> {
        let mirrored = |i: usize, j: usize| match symmetry {
            Symmetry::General => self.get(i, j),
            Symmetry::Symmetric => self.get(j, i),
            Symmetry::Hermitian => self.get(j, i).conj(),
        };
        // In square tiles, since memory is read a line at a time.
        let ends = |first: usize, all: usize| (first + SYMMETRY_TILE).min(all);
        let starts = |all: usize| (0..all).step_by(SYMMETRY_TILE);
        let tiles = starts(self.dim).flat_map(|i| starts(ends(i, self.dim)).map(move |j| (i, j)));
        let pairs = tiles.flat_map(|(first, across)| {
            let below = first..ends(first, self.dim);
            below.flat_map(move |i| (across..ends(across, i + 1)).map(move |j| (i, j)))
        });
        pairs.into_iter().find(|&(i, j)| self.get(i, j) != mirrored(i, j))
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

    // Whole rows, or blocks of them, are the work of one thread and always the same, so the number of
    // threads changes no bit.
    fn apply(&self, x: &MultiVector<T>, y: &mut MultiVector<T>) {
        let rhs_count = x.rhs_count().max(1);
        if rhs_count >= LEAST_RHS_OF_BLOCKS {
            let rows = y.as_mut_slice().par_chunks_mut(rhs_count * ROWS_TOGETHER);
            rows.zip(self.entries.par_chunks(self.dim.max(1) * ROWS_TOGETHER))
                .for_each(|(y, rows)| T::multiply(rows, x.as_slice(), y, self.dim, rhs_count));
            return;
        }
        y.as_mut_slice().par_chunks_mut(rhs_count).enumerate().with_min_len(16).for_each(|(i, y)| {
            let row = self.row_slice(i);
            let mut columns = Columns { x: x.as_slice(), rhs_count, first: 0 };
            for y in y.chunks_mut(RHS_TOGETHER) {
                match y.len() {
                    1 => y.copy_from_slice(&columns.product::<1, 8>(row)),
                    2 => y.copy_from_slice(&columns.product::<2, 4>(row)),
                    3 => y.copy_from_slice(&columns.product::<3, 2>(row)),
                    _ => y.copy_from_slice(&columns.product::<RHS_TOGETHER, 2>(row)),
                }
                columns.first += y.len();
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

/// Right-hand sides from which on a block of rows is multiplied with all of them: fewer are limited
/// by the memory that brings the entries, more by arithmetic.
const LEAST_RHS_OF_BLOCKS: usize = 8;
/// Rows of such a block.
const ROWS_TOGETHER: usize = 96;
/// Right-hand sides that a row is multiplied with at a time.
const RHS_TOGETHER: usize = 4;

/// Right-hand sides from `first` on: x_j of right-hand side l at j · `rhs_count` + l.
struct Columns<'a, T> {
    x: &'a [T],
    rhs_count: usize,
    first: usize,
}

impl<T: Scalar> Columns<'_, T> {
    /// Σ_j k_ij x_j of K right-hand sides, as P sums of every P-th term each: a single sum would
    /// wait for the last addition at every term, longer than memory takes to bring the entry.
    fn product<const K: usize, const P: usize>(&self, row: &[T]) -> [T; K] {
        let mut sums = [[T::zero(); K]; P];
        let entries = row.chunks_exact(P);
        let rest = entries.remainder();
        let mut terms = self.x.chunks_exact(P * self.rhs_count);
        for (entries, x) in entries.zip(&mut terms) {
            for p in 0..P {
                let x = &x[p * self.rhs_count + self.first..][..K];
                (0..K).for_each(|k| sums[p][k] += entries[p] * x[k]);
            }
        }
        for (p, (&entry, x)) in rest.iter().zip(terms.remainder().chunks_exact(self.rhs_count)).enumerate() {
            (0..K).for_each(|k| sums[p][k] += entry * x[self.first + k]);
        }
        sums.into_iter().fold([T::zero(); K], |all, part| std::array::from_fn(|k| all[k] + part[k]))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Any number of unknowns and right-hand sides, whatever is left over of parts and groups.
    #[test]
    fn products_are_the_sums_of_their_terms() {
        let value = |i: usize| ((i * 7919 + 13) % 101) as f64 - 50.0;
        for dim in [1, 2, 3, 7, 8, 9, 16, 37, 100] {
            let entries: Vec<f64> = (0..dim * dim).map(value).collect();
            let matrix = Dense::new(dim, entries).unwrap();
            for rhs_count in [1, 2, 3, 4, 5, 7, 8, 9, 17] {
                let x = MultiVector::from_fn(dim, rhs_count, |j, l| value(3 * j + 31 * l));
                let mut y = MultiVector::from_fn(dim, rhs_count, |_, _| f64::NAN);
                matrix.apply(&x, &mut y);
                for i in 0..dim {
                    for l in 0..rhs_count {
                        // Whole numbers: every order of the sum gives the same.
                        let expected: f64 = (0..dim).map(|j| matrix.get(i, j) * x.row(j)[l]).sum();
                        assert!((y.row(i)[l] - expected).abs() < 0.5, "{dim} {rhs_count}: {i} {l}");
                    }
                }
            }
        }
    }

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
        assert_eq!(matrix(2.0).with_found_symmetry(), symmetric);
        assert_eq!(matrix(5.0).with_found_symmetry(), matrix(5.0));
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
