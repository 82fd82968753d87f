//! Conjugate gradients in the inner product of a [`Metric`], preconditioned: the core of all the
//! variants.
//!
//! For a self-adjoint A that is positive definite in ⟨·,·⟩ and z = M⁻¹ r: q = A p, α = ⟨z, r⟩/⟨p,
//! q⟩, x += α p, r −= α q, p = z + β p, β = ⟨z, r⟩_new/⟨z, r⟩_old. Source: Y. Saad, Iterative
//! Methods for Sparse Linear Systems, 2nd ed., SIAM 2003, § 9.2, DOI 10.1137/1.9780898718003; M. R.
//! Hestenes, E. Stiefel, Journal of Research of the National Bureau of Standards 49, 1952, DOI
//! 10.6028/jres.049.044.

use super::{Metric, Precondition, minus, reals};
use fredholm_linop::{Context, Halt, Iteration, MultiVector, Scalar, SecondKind, SolveError};

/// One application of A and one of M⁻¹ an iteration.
pub(crate) struct Conjugate<'a, T, M> {
    solver: &'static str,
    a: &'a SecondKind<'a, T>,
    b: &'a MultiVector<T>,
    metric: Metric<T>,
    inverse: M,
    residual: MultiVector<T>,
    z: MultiVector<T>,
    direction: MultiVector<T>,
    image: MultiVector<T>,
    product: MultiVector<T>,
    /// ⟨z, r⟩ per right-hand side; empty before the first step from a new start.
    power: Vec<f64>,
}

impl<'a, T: Scalar, M: Precondition<T>> Conjugate<'a, T, M> {
    pub fn new(
        solver: &'static str,
        (a, b): (&'a SecondKind<'a, T>, &'a MultiVector<T>),
        metric: Metric<T>,
        inverse: M,
    ) -> Self {
        let zeros = MultiVector::zeros(b.dim(), b.rhs_count());
        Self {
            solver,
            a,
            b,
            metric,
            inverse,
            residual: zeros.clone(),
            z: zeros.clone(),
            direction: zeros.clone(),
            image: zeros.clone(),
            product: zeros,
            power: Vec::new(),
        }
    }

    /// The first direction.
    fn aim(&mut self, x: &mut MultiVector<T>, context: &mut Context<'_>) -> Result<(), Halt> {
        let state = (&mut self.product, &mut self.residual);
        self.metric.eliminate(self.a, self.b, x, state, context)?;
        self.inverse.apply(&self.residual, &mut self.z, context)?;
        self.power = self.metric.real_dots(&self.z, &self.residual);
        self.direction.copy_from(&self.z);
        Ok(())
    }

    /// The next direction.
    fn turn(&mut self, context: &mut Context<'_>) -> Result<(), Halt> {
        self.inverse.apply(&self.residual, &mut self.z, context)?;
        let power = self.metric.real_dots(&self.z, &self.residual);
        let beta: Vec<f64> = power.iter().zip(&self.power).map(|(&new, &old)| ratio(new, old)).collect();
        self.direction.scale_and_add(&reals(&beta), &self.z);
        self.power = power;
        Ok(())
    }

    /// α per right-hand side.
    fn lengths(&self) -> Result<Vec<T>, Halt> {
        let curvature = self.metric.real_dots(&self.direction, &self.image);
        match curvature.iter().position(|&value| value < 0.0) {
            Some(rhs) => Err(SolveError::Indefinite { solver: self.solver, rhs }.into()),
            None => Ok(self.power.iter().zip(&curvature).map(|(&z, &p)| T::from_real(ratio(z, p))).collect()),
        }
    }
}

/// u/v, or 0 where a right-hand side is solved exactly.
fn ratio(u: f64, v: f64) -> f64 {
    if v == 0.0 { 0.0 } else { u / v }
}

impl<T: Scalar, M: Precondition<T>> Iteration<T> for Conjugate<'_, T, M> {
    fn restart(&mut self, x: &mut MultiVector<T>, context: &mut Context<'_>) -> Result<(), Halt> {
        context.start(self.a, x, &mut self.product)?;
        self.residual.set_difference(self.b, &self.product);
        self.power.clear();
        Ok(())
    }

    fn advance(&mut self, x: &mut MultiVector<T>, context: &mut Context<'_>) -> Result<(), Halt> {
        if self.power.is_empty() {
            self.aim(x, context)?;
        }
        context.apply(self.a, &self.direction, &mut self.image)?;
        let alpha = self.lengths()?;
        x.add_scaled(&alpha, &self.direction);
        self.product.add_scaled(&alpha, &self.image);
        self.residual.add_scaled(&minus(&alpha), &self.image);
        self.turn(context)
    }

    fn product(&self) -> &MultiVector<T> {
        &self.product
    }

    fn drifts(&self) -> bool {
        true
    }
}
