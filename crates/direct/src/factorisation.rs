//! P Aᵀ = L U with partial pivoting, by faer; Aᵀ because that is what a matrix stored row by row is
//! column by column.
//!
//! Source: G. H. Golub, C. F. Van Loan, Matrix Computations, 4th ed., Johns Hopkins University
//! Press 2013, § 3.4. Cost: 2n³/3 real or 8n³/3 complex operations, and 2n² or 8n² for each
//! right-hand side.
//!
//! What calls faer is compiled here, once for each kind of number, and not wherever a solver is
//! used: its functions are generic and long.

use faer::dyn_stack::{MemBuffer, MemStack, StackReq};
use faer::linalg::lu::partial_pivoting::{factor, solve};
use faer::perm::PermRef;
use faer::{MatMut, MatRef, Par, Spec};
use fredholm_linop::LinopError;
use num_complex::{Complex32, Complex64};

/// The parts that faer cuts its work into. The bits of the result depend on this number, not on
/// that of the threads.
const PARTS: usize = 8;

/// A number whose matrices are factorised.
pub trait Lu: Copy {
    /// Scratch of [`Self::factorise`].
    fn scratch(dim: usize) -> StackReq;
    /// Puts L and U in the place of a matrix, column by column, and its order of rows and the
    /// inverse of that into `orders`.
    fn factorise(matrix: &mut [Self], orders: [&mut [usize]; 2], scratch: &mut MemBuffer);
    /// Scratch of [`Self::substitute`].
    fn substitution_scratch(dim: usize, columns: usize) -> StackReq;
    /// Solves with the transposed matrix for right-hand sides one after the other.
    fn substitute(factors: &[Self], orders: [&[usize]; 2], b: &mut [Self], scratch: &mut MemBuffer);
}

macro_rules! lu {
    ($($number:ty),*) => {$(
        impl Lu for $number {
            fn scratch(dim: usize) -> StackReq {
                factor::lu_in_place_scratch::<usize, Self>(dim, dim, par(), Spec::default())
            }

            fn factorise(matrix: &mut [Self], [order, inverse]: [&mut [usize]; 2], scratch: &mut MemBuffer) {
                let dim = order.len();
                factor::lu_in_place(
                    MatMut::from_column_major_slice_mut(matrix, dim, dim),
                    order,
                    inverse,
                    par(),
                    MemStack::new(scratch),
                    Spec::default(),
                );
            }

            fn substitution_scratch(dim: usize, columns: usize) -> StackReq {
                solve::solve_transpose_in_place_scratch::<usize, Self>(dim, columns, par())
            }

            fn substitute(
                factors: &[Self],
                [order, inverse]: [&[usize]; 2],
                b: &mut [Self],
                scratch: &mut MemBuffer,
            ) {
                let dim = order.len();
                let columns = b.len() / dim.max(1);
                let factors = MatRef::from_column_major_slice(factors, dim, dim);
                solve::solve_transpose_in_place(
                    factors,
                    factors,
                    PermRef::new_checked(order, inverse, dim),
                    MatMut::from_column_major_slice_mut(b, dim, columns),
                    par(),
                    MemStack::new(scratch),
                );
            }
        }
    )*};
}

lu!(f32, f64, Complex32, Complex64);

/// The factors of one matrix, in the memory that held it.
pub(crate) struct Factorisation<T> {
    dim: usize,
    factors: Vec<T>,
    order: Vec<usize>,
    inverse_order: Vec<usize>,
}

impl<T: Lu> Factorisation<T> {
    /// Takes the entries row by row.
    ///
    /// # Errors
    /// [`LinopError::Memory`] if there is none for the scratch.
    pub fn new(dim: usize, mut factors: Vec<T>) -> Result<Self, LinopError> {
        let (mut order, mut inverse_order) = (vec![0; dim], vec![0; dim]);
        T::factorise(&mut factors, [&mut order, &mut inverse_order], &mut scratch(T::scratch(dim))?);
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
        let needed = T::substitution_scratch(self.dim, b.len() / self.dim.max(1));
        T::substitute(&self.factors, [&self.order, &self.inverse_order], b, &mut scratch(needed)?);
        Ok(())
    }
}

/// Bytes of scratch that a factorisation takes besides the matrix; any number for those beyond all
/// memory.
pub(crate) fn scratch_bytes<T: Lu>(dim: usize) -> u64 {
    if dim > u32::MAX as usize {
        return u64::MAX;
    }
    T::scratch(dim).size_bytes() as u64
}

pub(crate) fn par() -> Par {
    Par::rayon(PARTS)
}

pub(crate) fn scratch(needed: StackReq) -> Result<MemBuffer, LinopError> {
    let bytes = needed.size_bytes() as u64;
    MemBuffer::try_new(needed)
        .map_err(|_| LinopError::Memory { what: "the scratch of a factorisation", bytes })
}
