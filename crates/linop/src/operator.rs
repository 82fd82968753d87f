//! What a solver may ask of a matrix, stored or not: y = K x.

use crate::sweep::{sweep_back_by_columns, sweep_by_rows};
use crate::{Dense, LinopError, MultiVector, Relax, Scalar, Sweep};
use std::ops::ControlFlow;

/// What is known of the symmetry of a matrix.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Symmetry {
    /// Nothing.
    #[default]
    General,
    /// k_ij = k_ji. For real entries this is the same as Hermitian.
    Symmetric,
    /// k_ij = conj(k_ji).
    Hermitian,
}

/// A square matrix, stored or not. One matrix may serve all right-hand sides, or each right-hand
/// side may have its own.
///
/// Only [`dim`](Self::dim) and [`apply`](Self::apply) are required. What is asked by default goes
/// through them and may be slow, so an operator overrides what it can do better.
///
/// Vectors must fit: dim × any number of right-hand sides, or dim × [`rhs_count`](Self::rhs_count)
/// where that is given. Those that do not are an error of the caller, and methods may panic.
/// Solvers check before they begin.
pub trait LinearOperator<T: Scalar>: Sync {
    /// Number of unknowns.
    fn dim(&self) -> usize;

    /// y = K x, all right-hand sides in one pass over memory. The old values of `y` do not matter.
    fn apply(&self, x: &MultiVector<T>, y: &mut MultiVector<T>);

    /// Number of right-hand sides if each has its own matrix, `None` if one matrix serves any
    /// number of right-hand sides.
    fn rhs_count(&self) -> Option<usize> {
        None
    }

    /// Symmetry of the matrices of all right-hand sides.
    fn symmetry(&self) -> Symmetry {
        Symmetry::General
    }

    /// Entries read by one application to all right-hand sides, for work counters.
    fn entries(&self) -> u64 {
        (self.dim() as u64).saturating_mul(self.dim() as u64)
    }

    /// Column j of the matrix of a right-hand side: `out[i]` = k_ij. By default one application.
    fn column(&self, j: usize, rhs: usize, out: &mut [T]) {
        let mut unit = MultiVector::zeros(self.dim(), self.rhs_count().unwrap_or(1));
        let rhs = if self.rhs_count().is_some() { rhs } else { 0 };
        unit.row_mut(j)[rhs] = T::one();
        let mut image = MultiVector::zeros(unit.dim(), unit.rhs_count());
        self.apply(&unit, &mut image);
        out.iter_mut().enumerate().for_each(|(i, out)| *out = image.row(i)[rhs]);
    }

    /// Row i of the matrix of a right-hand side: `out[j]` = k_ij. By default one column if the
    /// matrix is symmetric, all columns if it is not.
    fn row(&self, i: usize, rhs: usize, out: &mut [T]) {
        match self.symmetry() {
            Symmetry::Symmetric => self.column(i, rhs, out),
            Symmetry::Hermitian => {
                self.column(i, rhs, out);
                for entry in out {
                    *entry = entry.conj();
                }
            }
            Symmetry::General => {
                let mut column = vec![T::zero(); self.dim()];
                for (j, out) in out.iter_mut().enumerate() {
                    self.column(j, rhs, &mut column);
                    *out = column[i];
                }
            }
        }
    }

    /// Row i of the matrix of a right-hand side up to the diagonal: `out[j]` = k_ij for the i + 1
    /// entries of `out`. By default a whole row.
    fn lower_row(&self, i: usize, rhs: usize, out: &mut [T]) {
        let mut row = vec![T::zero(); self.dim()];
        self.row(i, rhs, &mut row);
        out.copy_from_slice(&row[..=i]);
    }

    /// Diagonal of the matrix of a right-hand side: `out[i]` = k_ii. By default all columns.
    fn diagonal(&self, rhs: usize, out: &mut [T]) {
        let mut column = vec![T::zero(); self.dim()];
        for (i, out) in out.iter_mut().enumerate() {
            self.column(i, rhs, &mut column);
            *out = column[i];
        }
    }

    /// The matrix of a right-hand side. By default all columns.
    ///
    /// # Errors
    /// [`LinopError::Memory`] if it does not fit.
    fn dense(&self, rhs: usize) -> Result<Dense<T>, LinopError> {
        let mut dense = Dense::zeros(self.dim())?;
        let mut column = vec![T::zero(); self.dim()];
        for j in 0..self.dim() {
            self.column(j, rhs, &mut column);
            column.iter().enumerate().for_each(|(i, &entry)| dense.row_slice_mut(i)[j] = entry);
        }
        Ok(dense)
    }

    /// Visits the unknowns in order, lets `relax` change each, and ends with K x of the new x in
    /// [`Sweep::product`], all right-hand sides in one pass over memory. See [`Sweep`].
    ///
    /// A break of `relax` ends the sweep there. The unknowns visited keep their new values; `sweep`
    /// is then of no further use.
    fn sweep(
        &self,
        x: &mut MultiVector<T>,
        sweep: &mut Sweep<T>,
        relax: &mut Relax<'_, T>,
    ) -> ControlFlow<()> {
        sweep_by_rows(self, x, sweep, relax)
    }

    /// Visits the unknowns from the last to the first and leaves U of the new x in `sweep`, which
    /// must come from a complete forward [`sweep`](Self::sweep) of the same x; [`Sweep::product`]
    /// is out of date until the next one.
    ///
    /// A break of `relax` ends the sweep there. The unknowns visited keep their new values; `sweep`
    /// is then of no further use.
    fn sweep_back(
        &self,
        x: &mut MultiVector<T>,
        sweep: &mut Sweep<T>,
        relax: &mut Relax<'_, T>,
    ) -> ControlFlow<()> {
        sweep_back_by_columns(self, x, sweep, relax)
    }
}
