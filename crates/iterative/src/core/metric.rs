//! The inner product in which A = I − D K is self-adjoint: ⟨u, v⟩ = Σ_i conj(u_i) v_i/d_i, for K
//! symmetric, D > 0.
//!
//! With H = D⁻¹, Ψ = H A and Θ = H^½ A H^(−½) are Hermitian (M. Leblond, Numerical Linear Algebra
//! with Applications 9, 2002: H-selfadjoint matrices), and a method for Ψ or Θ is one for A in this
//! inner product: ⟨u, v⟩ is uᴴ v for vectors of Θ. For light H = diag(A_i/ρ_i) up to a factor.
//!
//! An unknown with d_i = 0, a black patch, has x_i = b_i. It is set before the first step, and
//! weighs nothing.

use fredholm_linop::{Context, Halt, MultiVector, Scalar, SecondKind, SolveError};

/// 1/d_i, and 0 for black unknowns, per right-hand side.
pub(crate) struct Metric<T> {
    weights: MultiVector<T>,
}

impl<T: Scalar> Metric<T> {
    /// # Errors
    /// [`SolveError::Unsuitable`] where K is not known to be symmetric or D has an entry that is
    /// not real and ≥ 0.
    pub fn new(solver: &'static str, a: &SecondKind<'_, T>) -> Result<Self, SolveError> {
        a.check_self_adjoint(solver)?;
        let factor = a.factor();
        let weight = |d: T| if d == T::zero() { d } else { T::one() / d };
        Ok(Self {
            weights: MultiVector::from_fn(factor.dim(), factor.rhs_count(), |i, l| weight(factor.row(i)[l])),
        })
    }

    /// H.
    pub fn weights(&self) -> &MultiVector<T> {
        &self.weights
    }

    /// ⟨u, v⟩ per right-hand side where it is known to be real.
    pub fn real_dots(&self, u: &MultiVector<T>, v: &MultiVector<T>) -> Vec<f64> {
        let mut sums = vec![0.0; u.rhs_count()];
        for ((h, u), v) in self.weights.rows().zip(u.rows()).zip(v.rows()) {
            for (l, sum) in sums.iter_mut().enumerate() {
                *sum += (h[l] * (u[l].conj() * v[l])).re();
            }
        }
        sums
    }

    /// ⟨u, v⟩ per right-hand side.
    pub fn dots(&self, u: &MultiVector<T>, v: &MultiVector<T>) -> Vec<T> {
        let mut sums = vec![T::zero(); u.rhs_count()];
        for ((h, u), v) in self.weights.rows().zip(u.rows()).zip(v.rows()) {
            for (l, sum) in sums.iter_mut().enumerate() {
                *sum += h[l] * (u[l].conj() * v[l]);
            }
        }
        sums
    }

    /// Sets the black unknowns, so that their residuals are 0 from now on. `product` and `residual`
    /// are those of x before and after.
    pub fn eliminate(
        &self,
        a: &SecondKind<'_, T>,
        b: &MultiVector<T>,
        x: &mut MultiVector<T>,
        (product, residual): (&mut MultiVector<T>, &mut MultiVector<T>),
        context: &mut Context<'_>,
    ) -> Result<(), Halt> {
        let mut changed = false;
        for (at, &weight) in self.weights.as_slice().iter().enumerate() {
            if weight == T::zero() && x.as_slice()[at] != b.as_slice()[at] {
                x.as_mut_slice()[at] = b.as_slice()[at];
                changed = true;
            }
        }
        if changed {
            context.apply(a, x, product)?;
            residual.set_difference(b, product);
        }
        Ok(())
    }
}
