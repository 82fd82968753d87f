//! Stationary iteration: x += M⁻¹ (b − A x).

use super::Precondition;
use fredholm_linop::{Context, Halt, Iteration, MultiVector, Scalar, SecondKind};

/// The iteration of one M. One application of A each.
pub(crate) struct Stationary<'a, T, M> {
    a: &'a SecondKind<'a, T>,
    b: &'a MultiVector<T>,
    inverse: M,
    residual: MultiVector<T>,
    step: MultiVector<T>,
    product: MultiVector<T>,
}

impl<'a, T: Scalar, M: Precondition<T>> Stationary<'a, T, M> {
    pub fn new(a: &'a SecondKind<'a, T>, b: &'a MultiVector<T>, inverse: M) -> Self {
        let zeros = MultiVector::zeros(b.dim(), b.rhs_count());
        Self { a, b, inverse, residual: zeros.clone(), step: zeros.clone(), product: zeros }
    }
}

impl<T: Scalar, M: Precondition<T>> Iteration<T> for Stationary<'_, T, M> {
    fn restart(&mut self, x: &mut MultiVector<T>, context: &mut Context<'_>) -> Result<(), Halt> {
        context.start(self.a, x, &mut self.product)
    }

    fn advance(&mut self, x: &mut MultiVector<T>, context: &mut Context<'_>) -> Result<(), Halt> {
        self.residual.set_difference(self.b, &self.product);
        self.inverse.apply(&self.residual, &mut self.step, context)?;
        context.poll()?;
        x.add_scaled(&vec![T::one(); x.rhs_count()], &self.step);
        context.apply(self.a, x, &mut self.product)
    }

    fn product(&self) -> &MultiVector<T> {
        &self.product
    }
}
