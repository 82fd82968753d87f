//! P Aᵀ = L U with partial pivoting, by faer; Aᵀ because that is what a matrix stored row by row is
//! column by column.
//!
//! Source: G. H. Golub, C. F. Van Loan, Matrix Computations, 4th ed., Johns Hopkins University
//! Press 2013, § 3.4. Cost: 2n³/3 real or 8n³/3 complex operations, and 2n² or 8n² for each
//! right-hand side.

use faer::dyn_stack::{MemBuffer, MemStack, StackReq};
use faer::linalg::lu::partial_pivoting::{factor, solve};
use faer::perm::PermRef;
use faer::traits::ComplexField;
use faer::{MatMut, MatRef, Par, Spec};
use fredholm_linop::LinopError;

/// The parts that faer cuts its work into. The bits of the result depend on this number, not on
/// that of the threads.
const PARTS: usize = 8;

/// The factors of one matrix, in the memory that held it.
pub(crate) struct Factorisation<T> {
    dim: usize,
    factors: Vec<T>,
    order: Vec<usize>,
    inverse_order: Vec<usize>,
}

impl<T: ComplexField + Copy> Factorisation<T> {
    /// Takes the entries row by row.
    ///
    /// # Errors
    /// [`LinopError::Memory`] if there is none for the scratch.
    pub fn new(dim: usize, mut factors: Vec<T>) -> Result<Self, LinopError> {
        let (mut order, mut inverse_order) = (vec![0; dim], vec![0; dim]);
        let mut scratch = scratch(factor::lu_in_place_scratch::<usize, T>(dim, dim, par(), Spec::default()))?;
        factor::lu_in_place(
            MatMut::from_column_major_slice_mut(&mut factors, dim, dim),
            &mut order,
            &mut inverse_order,
            par(),
            MemStack::new(&mut scratch),
            Spec::default(),
        );
        Ok(Self { dim, factors, order, inverse_order })
    }

    /// Whether the smallest pivot is lost in the rounding of the largest, or is no number.
    /// `epsilon` is the rounding of T.
    pub fn is_singular(&self, epsilon: f64, size: impl Fn(T) -> f64) -> bool {
        let pivots = || (0..self.dim).map(|i| size(self.factors[i * self.dim + i]));
        let largest = pivots().fold(0.0, f64::max);
        let rounding = epsilon * self.dim as f64 * largest;
        // Written so that NaN is singular.
        !pivots().all(|pivot| pivot > rounding)
    }

    /// Solves A x = b for right-hand sides stored one after the other.
    ///
    /// # Errors
    /// [`LinopError::Memory`] if there is none for the scratch.
    pub fn solve(&self, b: &mut [T]) -> Result<(), LinopError> {
        let columns = b.len() / self.dim.max(1);
        let factors = MatRef::from_column_major_slice(&self.factors, self.dim, self.dim);
        let order = PermRef::new_checked(&self.order, &self.inverse_order, self.dim);
        let mut scratch =
            scratch(solve::solve_transpose_in_place_scratch::<usize, T>(self.dim, columns, par()))?;
        solve::solve_transpose_in_place(
            factors,
            factors,
            order,
            MatMut::from_column_major_slice_mut(b, self.dim, columns),
            par(),
            MemStack::new(&mut scratch),
        );
        Ok(())
    }
}

/// Bytes of scratch that a factorisation takes besides the matrix; any number for those beyond all
/// memory.
pub(crate) fn scratch_bytes<T: ComplexField>(dim: usize) -> u64 {
    if dim > u32::MAX as usize {
        return u64::MAX;
    }
    factor::lu_in_place_scratch::<usize, T>(dim, dim, par(), Spec::default()).size_bytes() as u64
}

pub(crate) fn par() -> Par {
    Par::rayon(PARTS)
}

pub(crate) fn scratch(needed: StackReq) -> Result<MemBuffer, LinopError> {
    let bytes = needed.size_bytes() as u64;
    MemBuffer::try_new(needed)
        .map_err(|_| LinopError::Memory { what: "the scratch of a factorisation", bytes })
}
