//! The diagonal blocks of A, factorised: what block methods divide by.

use super::{Precondition, SmallLu};
use fredholm_linop::{Context, Halt, LinearOperator, MultiVector, Scalar, SecondKind, SolveError, Symmetry};
use std::ops::Range;

/// Blocks of unknowns size · k … size · (k + 1) − 1, the last one shorter where the size does not
/// divide.
pub(crate) struct Blocks<T> {
    size: usize,
    /// Per block, per right-hand side.
    factors: Vec<Vec<SmallLu<T>>>,
}

impl<T: Scalar> Blocks<T> {
    /// Reads the matrix once.
    ///
    /// # Errors
    /// [`SolveError::Unsuitable`] where a block has no inverse.
    pub fn new(
        solver: &'static str,
        a: &SecondKind<'_, T>,
        size: usize,
        context: &mut Context<'_>,
    ) -> Result<Self, Halt> {
        let mut factors = Vec::new();
        for first in (0..a.dim()).step_by(size) {
            context.poll()?;
            let block = first..(first + size).min(a.dim());
            let lu = |rhs| SmallLu::new(block.len(), read(a, &block, rhs));
            let of_block: Option<Vec<_>> = (0..a.factor().rhs_count()).map(lu).collect();
            let reason =
                || format!("the diagonal block of unknowns {first} … {} is singular; use lu", block.end - 1);
            factors.push(of_block.ok_or_else(|| SolveError::Unsuitable { solver, reason: reason() })?);
        }
        context.work.entries_touched += a.entries();
        Ok(Self { size, factors })
    }

    /// The unknowns of block k.
    pub fn range(&self, k: usize, dim: usize) -> Range<usize> {
        k * self.size..((k + 1) * self.size).min(dim)
    }

    /// Number of blocks.
    pub fn count(&self) -> usize {
        self.factors.len()
    }

    /// The steps that solve block k for its part of r: one row for each of its unknowns.
    pub fn steps(&self, k: usize, r: &MultiVector<T>) -> MultiVector<T> {
        let range = self.range(k, r.dim());
        let mut steps = MultiVector::zeros(range.len(), r.rhs_count());
        for (rhs, lu) in self.factors[k].iter().enumerate() {
            let part: Vec<T> = range.clone().map(|i| r.row(i)[rhs]).collect();
            steps.set_vector(rhs, &lu.solve(&part));
        }
        steps
    }
}

/// A block of A, row by row. Of a symmetric coupling only what is left of the diagonal is read.
fn read<T: Scalar>(a: &SecondKind<'_, T>, block: &Range<usize>, rhs: usize) -> Vec<T> {
    let n = block.len();
    let mut matrix = vec![T::zero(); n * n];
    let mut row = vec![T::zero(); a.dim()];
    for (at, i) in block.clone().enumerate() {
        let d = |k: usize| a.factor().row(k)[rhs];
        match a.coupling().symmetry() {
            Symmetry::General => {
                a.coupling().row(i, rhs, &mut row);
                (0..n).for_each(|j| matrix[at * n + j] = -(d(i) * row[block.start + j]));
            }
            symmetry => {
                a.coupling().lower_row(i, rhs, &mut row[..=i]);
                for j in 0..=at {
                    let entry = row[block.start + j];
                    let mirrored = if symmetry == Symmetry::Hermitian { entry.conj() } else { entry };
                    matrix[at * n + j] = -(d(i) * entry);
                    matrix[j * n + at] = -(d(block.start + j) * mirrored);
                }
            }
        }
    }
    (0..n).for_each(|at| matrix[at * n + at] += T::one());
    matrix
}

impl<T: Scalar> Precondition<T> for Blocks<T> {
    fn apply(&mut self, r: &MultiVector<T>, z: &mut MultiVector<T>, _: &mut Context<'_>) -> Result<(), Halt> {
        for k in 0..self.count() {
            let steps = self.steps(k, r);
            let range = self.range(k, r.dim());
            range.zip(steps.rows()).for_each(|(i, step)| z.row_mut(i).copy_from_slice(step));
        }
        Ok(())
    }
}
