//! The system matrix of a Fredholm equation of the second kind: A = I − D K, D diagonal.
//!
//! For light K = G with G_ij = A_i F_ij (m²), and D = ρ_i/A_i (1/m²) per band, so that A = I − R F.

use crate::{
    Dense, LinearOperator, LinopError, MultiVector, Relax, Scalar, SolveError, Sweep, Symmetry, Visit,
};
use std::ops::ControlFlow;

/// A = I − D K around any operator K, with a diagonal D for each right-hand side.
#[derive(Clone)]
pub struct SecondKind<'a, T> {
    coupling: &'a dyn LinearOperator<T>,
    factor: MultiVector<T>,
}

impl<'a, T: Scalar> SecondKind<'a, T> {
    /// `factor` is D: d_i of right-hand side l in row i.
    ///
    /// # Errors
    /// [`LinopError::Factor`] if it does not fit the coupling, [`LinopError::NotFinite`] if it
    /// holds NaN or infinity.
    pub fn new(coupling: &'a dyn LinearOperator<T>, factor: MultiVector<T>) -> Result<Self, LinopError> {
        let (found, rhs_count) = (factor.dim(), factor.rhs_count());
        let (expected, operator_rhs) = (coupling.dim(), coupling.rhs_count().unwrap_or(rhs_count));
        if (found, rhs_count) != (expected, operator_rhs) {
            return Err(LinopError::Factor { found, rhs_count, expected, operator_rhs });
        }
        if let Some((unknown, rhs)) = factor.not_finite() {
            return Err(LinopError::NotFinite { what: "the diagonal factor", unknown, rhs });
        }
        Ok(Self { coupling, factor })
    }

    /// K.
    #[must_use]
    pub fn coupling(&self) -> &dyn LinearOperator<T> {
        self.coupling
    }

    /// D.
    #[must_use]
    pub fn factor(&self) -> &MultiVector<T> {
        &self.factor
    }

    /// Whether two right-hand sides have the same matrix, as far as that is known without reading
    /// K.
    #[must_use]
    pub fn same_matrix(&self, rhs: usize, other: usize) -> bool {
        let equal = |i| self.factor.row(i)[rhs] == self.factor.row(i)[other];
        rhs == other || (self.coupling.rhs_count().is_none() && (0..self.factor.dim()).all(equal))
    }

    /// Whether A is self-adjoint in the inner product Σ_i conj(u_i) v_i/d_i, so that D⁻¹ A is
    /// Hermitian: K symmetric (Hermitian for complex unknowns), D real and ≥ 0.
    ///
    /// # Errors
    /// [`SolveError::Unsuitable`] for this solver, where that is not so or not known.
    pub fn check_self_adjoint(&self, solver: &'static str) -> Result<(), SolveError> {
        let refuse = |reason| Err(SolveError::Unsuitable { solver, reason });
        let symmetric = match self.coupling.symmetry() {
            Symmetry::General => false,
            Symmetry::Symmetric => T::IS_REAL,
            Symmetry::Hermitian => true,
        };
        if !symmetric {
            let needed = if T::IS_REAL { "symmetric" } else { "Hermitian" };
            return refuse(format!(
                "it needs a coupling that is known to be {needed}; gmres and lu do without"
            ));
        }
        let wrong = |&d: &T| d != T::from_real(d.re()) || d.re() < 0.0;
        let Some(at) = self.factor.as_slice().iter().position(wrong) else { return Ok(()) };
        let (i, rhs) = (at / self.factor.rhs_count(), at % self.factor.rhs_count());
        let found = self.factor.as_slice()[at];
        refuse(format!(
            "it needs factors that are real and at least 0, but that of unknown {i} in right-hand side {rhs} is {found:?}"
        ))
    }

    /// r −= A e_j s: what a step s (per right-hand side) of unknown j takes from a residual.
    /// `column` is dim entries of scratch. Returns the entries of K read.
    pub fn subtract_column(
        &self,
        j: usize,
        step: &[T],
        residual: &mut MultiVector<T>,
        column: &mut [T],
    ) -> u64 {
        residual.row_mut(j).iter_mut().zip(step).for_each(|(r, &step)| *r -= step);
        // Right-hand sides that share a column are taken together.
        let together = if self.coupling.rhs_count().is_some() { 1 } else { step.len().max(1) };
        let mut reads = 0;
        for first in (0..step.len()).step_by(together) {
            self.coupling.column(j, first, column);
            reads += column.len() as u64;
            for (i, &entry) in column.iter().enumerate() {
                let (residual, factor) = (residual.row_mut(i), self.factor.row(i));
                for l in first..first + together {
                    residual[l] += factor[l] * entry * step[l];
                }
            }
        }
        reads
    }

    /// Turns row i of K into row i of A.
    fn turn_row(&self, i: usize, rhs: usize, row: &mut [T]) {
        let factor = self.factor.row(i)[rhs];
        for entry in row.iter_mut() {
            *entry = -(factor * *entry);
        }
        row[i] += T::one();
    }

    /// Turns K x into A x.
    fn turn_product(&self, x: &MultiVector<T>, product: &mut MultiVector<T>) {
        let terms = self.factor.as_slice().iter().zip(x.as_slice());
        product.as_mut_slice().iter_mut().zip(terms).for_each(|(y, (&d, &x))| *y = x - d * *y);
    }
}

impl<T: Scalar> LinearOperator<T> for SecondKind<'_, T> {
    fn dim(&self) -> usize {
        self.factor.dim()
    }

    fn apply(&self, x: &MultiVector<T>, y: &mut MultiVector<T>) {
        self.coupling.apply(x, y);
        self.turn_product(x, y);
    }

    fn rhs_count(&self) -> Option<usize> {
        Some(self.factor.rhs_count())
    }

    fn entries(&self) -> u64 {
        self.coupling.entries()
    }

    fn row(&self, i: usize, rhs: usize, out: &mut [T]) {
        self.coupling.row(i, rhs, out);
        self.turn_row(i, rhs, out);
    }

    fn lower_row(&self, i: usize, rhs: usize, out: &mut [T]) {
        self.coupling.lower_row(i, rhs, out);
        self.turn_row(i, rhs, out);
    }

    fn column(&self, j: usize, rhs: usize, out: &mut [T]) {
        self.coupling.column(j, rhs, out);
        out.iter_mut().enumerate().for_each(|(i, entry)| *entry = -(self.factor.row(i)[rhs] * *entry));
        out[j] += T::one();
    }

    fn diagonal(&self, rhs: usize, out: &mut [T]) {
        self.coupling.diagonal(rhs, out);
        out.iter_mut()
            .enumerate()
            .for_each(|(i, entry)| *entry = T::one() - self.factor.row(i)[rhs] * *entry);
    }

    fn dense(&self, rhs: usize) -> Result<Dense<T>, LinopError> {
        let mut dense = self.coupling.dense(rhs)?;
        (0..self.dim()).for_each(|i| self.turn_row(i, rhs, dense.row_slice_mut(i)));
        Ok(dense)
    }

    fn sweep(
        &self,
        x: &mut MultiVector<T>,
        sweep: &mut Sweep<T>,
        relax: &mut Relax<'_, T>,
    ) -> ControlFlow<()> {
        let mut view = Turned::new(&self.factor);
        self.coupling.sweep(x, sweep, &mut |visit| relax(view.turn(visit)))?;
        self.turn_product(x, sweep.product_mut());
        ControlFlow::Continue(())
    }

    fn sweep_back(
        &self,
        x: &mut MultiVector<T>,
        sweep: &mut Sweep<T>,
        relax: &mut Relax<'_, T>,
    ) -> ControlFlow<()> {
        let mut view = Turned::new(&self.factor);
        self.coupling.sweep_back(x, sweep, &mut |visit| relax(view.turn(visit)))
    }
}

/// Turns what a visit shows of K into what it shows of A.
struct Turned<'a, T> {
    factor: &'a MultiVector<T>,
    off_diagonal: Vec<T>,
    diagonal: Vec<T>,
}

impl<'a, T: Scalar> Turned<'a, T> {
    fn new(factor: &'a MultiVector<T>) -> Self {
        let zeros = vec![T::zero(); factor.rhs_count()];
        Self { factor, off_diagonal: zeros.clone(), diagonal: zeros }
    }

    fn turn<'v>(&'v mut self, visit: Visit<'v, T>) -> Visit<'v, T> {
        for (l, &d) in self.factor.row(visit.index).iter().enumerate() {
            self.off_diagonal[l] = -(d * visit.off_diagonal[l]);
            self.diagonal[l] = T::one() - d * visit.diagonal[l];
        }
        Visit { off_diagonal: &self.off_diagonal, diagonal: &self.diagonal, ..visit }
    }
}
