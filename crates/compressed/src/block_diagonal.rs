//! The inverse of the blocks on the diagonal: the cheapest preconditioner that knows the strongest
//! couplings.

use crate::CompressionError;
use fredholm_linop::{LinearOperator, MultiVector, Scalar};
use rayon::prelude::*;

/// A matrix whose blocks on the diagonal are stored.
pub trait Diagonal<T: Scalar>: LinearOperator<T> {
    /// The blocks with their unknowns, row by row. Every unknown is in one of them.
    fn diagonal_blocks(&self) -> Vec<(Vec<usize>, Vec<T>)>;
}

/// The inverses of the blocks on the diagonal of a matrix.
pub struct BlockDiagonal<T> {
    dim: usize,
    /// Unknowns and the inverse of each block, row by row.
    blocks: Vec<(Vec<usize>, Vec<T>)>,
}

impl<T: Scalar> BlockDiagonal<T> {
    /// Inverts the blocks.
    ///
    /// # Errors
    /// [`CompressionError::Singular`] where one cannot be inverted.
    pub fn new(matrix: &impl Diagonal<T>) -> Result<Self, CompressionError> {
        let invert = |(block, (unknowns, entries)): (usize, (Vec<usize>, Vec<T>))| {
            let inverse = inverse(unknowns.len(), entries).ok_or(CompressionError::Singular { block })?;
            Ok((unknowns, inverse))
        };
        let blocks =
            matrix.diagonal_blocks().into_par_iter().enumerate().map(invert).collect::<Result<_, _>>()?;
        Ok(Self { dim: matrix.dim(), blocks })
    }
}

impl<T: Scalar> LinearOperator<T> for BlockDiagonal<T> {
    fn dim(&self) -> usize {
        self.dim
    }

    fn apply(&self, x: &MultiVector<T>, y: &mut MultiVector<T>) {
        for (unknowns, inverse) in &self.blocks {
            for (row, &i) in inverse.chunks_exact(unknowns.len()).zip(unknowns) {
                for rhs in 0..x.rhs_count() {
                    let terms = row.iter().zip(unknowns);
                    y.row_mut(i)[rhs] =
                        terms.fold(T::zero(), |sum, (&entry, &j)| sum + entry * x.row(j)[rhs]);
                }
            }
        }
    }

    fn entries(&self) -> u64 {
        self.blocks.iter().map(|block| block.1.len() as u64).sum()
    }
}

/// The inverse by Gauss and Jordan with partial pivoting; none where a pivot is lost in the
/// rounding of its row to single precision, in which the entries were stored.
pub(crate) fn inverse<T: Scalar>(n: usize, mut a: Vec<T>) -> Option<Vec<T>> {
    let mut inverse = vec![T::zero(); n * n];
    (0..n).for_each(|i| inverse[i * n + i] = T::one());
    let mut largest: Vec<f64> =
        a.chunks(n.max(1)).map(|row| row.iter().map(|x| x.abs()).fold(0.0, f64::max)).collect();
    for k in 0..n {
        let pivot =
            (k..n).fold(k, |best, i| if a[i * n + k].abs() > a[best * n + k].abs() { i } else { best });
        let size = a[pivot * n + k].abs();
        if size.is_nan() || size <= f64::from(f32::EPSILON) * largest[pivot] {
            return None;
        }
        largest.swap(k, pivot);
        for j in 0..n {
            a.swap(k * n + j, pivot * n + j);
            inverse.swap(k * n + j, pivot * n + j);
        }
        let scale = T::one() / a[k * n + k];
        for j in 0..n {
            a[k * n + j] = a[k * n + j] * scale;
            inverse[k * n + j] = inverse[k * n + j] * scale;
        }
        for i in (0..n).filter(|&i| i != k) {
            let factor = a[i * n + k];
            for j in 0..n {
                let (above, own) = (a[k * n + j], inverse[k * n + j]);
                a[i * n + j] -= factor * above;
                inverse[i * n + j] -= factor * own;
            }
        }
    }
    Some(inverse)
}
