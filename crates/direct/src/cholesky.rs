//! Dense Cholesky on the symmetric form: Θ = I − D^½ K D^½ = L Lᴴ, z = L⁻ᴴ L⁻¹ D^(−½) b, x = D^½ z.
//!
//! Source: G. H. Golub, C. F. Van Loan, Matrix Computations, 4th ed., Johns Hopkins University
//! Press 2013, § 4.2. Ψ = D^(−½) Θ D^(−½) has the same factor up to the scaling of its rows; Θ has
//! no entries of different size.
//!
//! Requires a coupling that is known to be symmetric (Hermitian, for complex unknowns), D real and
//! ≥ 0, and Θ positive definite, which light has with ρ < 1. Unknowns with d_i = 0, black patches,
//! are b_i, and their light moves to the right-hand side.
//!
//! Cost: one factorisation (n³/3 real operations, 4n³/3 for complex entries) for each different
//! matrix, half of LU. Memory: n² entries. In the history, iteration k has k matrices factorised;
//! the observer can stop the solver before each, not within one.
//!
//! ```
//! use fredholm_direct::Cholesky;
//! use fredholm_linop::{MultiVector, PackedSymmetric, Quiet, SecondKind, Solver, Stop, StopReason};
//!
//! // x = b + K x with K = [0 ½; ½ 0] and b = (1, 1): x = (2, 2).
//! let coupling = PackedSymmetric::new(2, vec![0.0, 0.5, 0.0])?;
//! let a = SecondKind::new(&coupling, MultiVector::from_vec(2, 1, vec![1.0, 1.0])?)?;
//! let b = MultiVector::from_vec(2, 1, vec![1.0, 1.0])?;
//! let mut x = MultiVector::zeros(2, 1);
//! let stop = Stop { tolerance: 1e-12, max_iterations: 1 };
//! let report = Cholesky.solve(&a, &b, &mut x, &stop, &mut Quiet)?;
//! assert_eq!(report.reason, StopReason::Converged);
//! assert!((x.row(0)[0] - 2.0).abs() < 1e-14);
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```

use crate::buffers;
use crate::factorisation::{par, scratch};
use crate::groups::{Ended, Run, in_groups};
use crate::scalar::DenseScalar;
use crate::symmetric_form::SymmetricForm;
use faer::dyn_stack::{MemBuffer, MemStack, StackReq};
use faer::linalg::cholesky::llt::{factor, solve};
use faer::{MatMut, MatRef, Spec};
use fredholm_linop::{LinearOperator, MultiVector, Observer, Report, SecondKind, SolveError, Solver, Stop};
use num_complex::Complex64;

const NAME: &str = "cholesky";

/// A number whose Hermitian matrices are factorised. The functions are compiled here, once for each
/// kind: those of faer are generic and long.
pub trait Llt: Copy {
    /// Scratch of [`Self::factorise_symmetric`].
    fn symmetric_scratch(n: usize) -> StackReq;
    /// Puts L of L Lᴴ in the place of a matrix, column by column. False where a pivot is not
    /// positive.
    fn factorise_symmetric(matrix: &mut [Self], n: usize, scratch: &mut MemBuffer) -> bool;
    /// Scratch of [`Self::substitute_symmetric`].
    fn symmetric_substitution_scratch(n: usize, columns: usize) -> StackReq;
    /// Solves for right-hand sides one after the other.
    fn substitute_symmetric(factor: &[Self], n: usize, b: &mut [Self], scratch: &mut MemBuffer);
}

macro_rules! llt {
    ($($number:ty),*) => {$(
        impl Llt for $number {
            fn symmetric_scratch(n: usize) -> StackReq {
                factor::cholesky_in_place_scratch::<Self>(n, par(), Spec::default())
            }

            fn factorise_symmetric(matrix: &mut [Self], n: usize, scratch: &mut MemBuffer) -> bool {
                let columns = MatMut::from_column_major_slice_mut(matrix, n, n);
                let (plain, stack) = (factor::LltRegularization::default(), MemStack::new(scratch));
                factor::cholesky_in_place(columns, plain, par(), stack, Spec::default()).is_ok()
            }

            fn symmetric_substitution_scratch(n: usize, columns: usize) -> StackReq {
                solve::solve_in_place_scratch::<Self>(n, columns, par())
            }

            fn substitute_symmetric(factor: &[Self], n: usize, b: &mut [Self], scratch: &mut MemBuffer) {
                let count = b.len() / n.max(1);
                let factor = MatRef::from_column_major_slice(factor, n, n);
                let columns = MatMut::from_column_major_slice_mut(b, n, count);
                solve::solve_in_place::<Self, Self>(factor, columns, par(), MemStack::new(scratch));
            }
        }
    )*};
}

llt!(f64, Complex64);

/// Factorises the symmetric form, once for all right-hand sides that share it.
#[derive(Clone, Copy, Debug, Default)]
pub struct Cholesky;

impl<T: DenseScalar> Solver<T> for Cholesky {
    fn name(&self) -> &'static str {
        NAME
    }

    fn description(&self) -> &'static str {
        "Dense Cholesky of the symmetrised system: exact to rounding, half the time of lu, n² memory"
    }

    // The matrix, the right-hand sides with the product and the light of black unknowns, and a
    // diagonal.
    fn bytes(&self, dim: usize, rhs_count: usize) -> u64 {
        let (n, entry) = (dim as u64, size_of::<T>() as u64);
        let vectors = (rhs_count as u64).saturating_mul(4).saturating_add(2);
        let matrix = n.saturating_add(vectors).saturating_mul(n).saturating_mul(entry);
        matrix.saturating_add(buffers::touched(dim, size_of::<T>()))
    }

    fn addresses(&self) -> u64 {
        buffers::thread_addresses()
    }

    fn solve(
        &self,
        a: &SecondKind<'_, T>,
        b: &MultiVector<T>,
        x: &mut MultiVector<T>,
        stop: &Stop,
        observer: &mut dyn Observer<T>,
    ) -> Result<Report, SolveError> {
        a.check_self_adjoint(NAME)?;
        in_groups(a, b, x, stop, observer, solve_all)
    }
}

fn solve_all<T: DenseScalar>(run: &mut Run<'_, '_, T>, group: &[usize]) -> Result<(), Ended> {
    let (n, rhs) = (run.a.dim(), group[0]);
    let form = SymmetricForm::new(run.a, rhs, |d: T| T::from_real(d.re().sqrt()));
    let mut matrix = form.lower(run, rhs)?;
    if !T::factorise_symmetric(&mut matrix, n, &mut scratch(T::symmetric_scratch(n))?) {
        return Err(SolveError::Indefinite { solver: NAME, rhs }.into());
    }
    let mut z = form.right_hand_sides(run, group);
    let needed = T::symmetric_substitution_scratch(n, group.len());
    T::substitute_symmetric(&matrix, n, &mut z, &mut scratch(needed)?);
    form.take(run, group, z);
    Ok(())
}
