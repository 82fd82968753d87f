//! A preconditioned matrix in the form that the solvers take.

use fredholm_linop::{LinearOperator, MultiVector, Scalar};

/// K = 1 − P A, so that [`SecondKind`](fredholm_linop::SecondKind) with the factor 1 is P A: what
/// iterative solvers converge on faster than on A. The right-hand side has to be multiplied by P,
/// too.
pub struct Preconditioned<'a, T> {
    matrix: &'a dyn LinearOperator<T>,
    preconditioner: &'a dyn LinearOperator<T>,
}

impl<'a, T: Scalar> Preconditioned<'a, T> {
    /// Takes A and P of the same dimension.
    #[must_use]
    pub fn new(matrix: &'a dyn LinearOperator<T>, preconditioner: &'a dyn LinearOperator<T>) -> Self {
        Self { matrix, preconditioner }
    }

    /// P b.
    #[must_use]
    pub fn right_hand_side(&self, b: &MultiVector<T>) -> MultiVector<T> {
        let mut product = MultiVector::zeros(b.dim(), b.rhs_count());
        self.preconditioner.apply(b, &mut product);
        product
    }
}

impl<T: Scalar> LinearOperator<T> for Preconditioned<'_, T> {
    fn dim(&self) -> usize {
        self.matrix.dim()
    }

    fn apply(&self, x: &MultiVector<T>, y: &mut MultiVector<T>) {
        let mut product = MultiVector::zeros(x.dim(), x.rhs_count());
        self.matrix.apply(x, &mut product);
        self.preconditioner.apply(&product, y);
        let pairs = y.as_mut_slice().iter_mut().zip(x.as_slice());
        pairs.for_each(|(y, &x)| *y = x - *y);
    }

    fn entries(&self) -> u64 {
        self.matrix.entries() + self.preconditioner.entries()
    }
}
