//! Conjugate gradients on Ψ, preconditioned by a symmetric relaxation: A = C + L + U with C =
//! diag(A), M = (C/ω + L) (C/ω)⁻¹ (C/ω + U).
//!
//! Source: Y. Saad, Iterative Methods for Sparse Linear Systems, 2nd ed., SIAM 2003, § 10.2, DOI
//! 10.1137/1.9780898718003. M⁻¹ r is a forward substitution, a forward sweep from 0, and a backward
//! one; factors that are the same in every direction change nothing and are left out.
//!
//! Requires a coupling that is known to be symmetric (Hermitian, for complex unknowns), D real and
//! ≥ 0, and Ψ positive definite, which light has with ρ < 1. Unknowns with d_i = 0, black patches,
//! are set to b_i before the first step. Requires 0 < ω < 2.
//!
//! Cost of an iteration: one application and two sweeps, three readings of the matrix.
//!
//! ```
//! use fredholm_iterative::PcgSsor;
//! use fredholm_linop::{MultiVector, PackedSymmetric, Quiet, SecondKind, Solver, Stop, StopReason};
//!
//! // x = b + K x with K = [0 ½; ½ 0] and b = (1, 1): x = (2, 2).
//! let coupling = PackedSymmetric::new(2, vec![0.0, 0.5, 0.0])?;
//! let a = SecondKind::new(&coupling, MultiVector::from_vec(2, 1, vec![1.0, 1.0])?)?;
//! let b = MultiVector::from_vec(2, 1, vec![1.0, 1.0])?;
//! let mut x = MultiVector::zeros(2, 1);
//! let stop = Stop { tolerance: 1e-12, max_iterations: 100 };
//! let report = PcgSsor::default().solve(&a, &b, &mut x, &stop, &mut Quiet)?;
//! assert_eq!(report.reason, StopReason::Converged);
//! assert!((x.row(0)[0] - 2.0).abs() < 1e-11);
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```

use crate::core::{Conjugate, Metric, Precondition, divisors, solve_by_steps};
use crate::sor::check;
use fredholm_linop::{
    Context, Halt, Iteration, LinearOperator, MultiVector, Scalar, Scheme, SecondKind, Sweep, Visit,
};
use std::ops::ControlFlow;

const NAME: &str = "pcg-ssor";

/// Conjugate gradients preconditioned by symmetric relaxation.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PcgSsor {
    /// ω between 0 and 2.
    pub omega: f64,
}

impl Default for PcgSsor {
    fn default() -> Self {
        Self { omega: 1.0 }
    }
}

struct Substitutions<'a, T> {
    a: &'a SecondKind<'a, T>,
    omega: f64,
    sweep: Sweep<T>,
}

solve_by_steps!(PcgSsor);

impl<T: Scalar> Scheme<T> for PcgSsor {
    fn name(&self) -> &'static str {
        NAME
    }

    fn description(&self) -> &'static str {
        "Conjugate gradients preconditioned by symmetric relaxation; few iterations of three readings each"
    }

    fn bytes(&self, dim: usize, rhs_count: usize) -> u64 {
        (9 * size_of::<T>() as u64).saturating_mul(dim as u64).saturating_mul(rhs_count as u64)
    }

    fn begin<'a>(
        &self,
        a: &'a SecondKind<'a, T>,
        b: &'a MultiVector<T>,
        _: &mut Context<'_>,
    ) -> Result<Box<dyn Iteration<T> + 'a>, Halt> {
        divisors(NAME, a)?;
        check(NAME, self.omega, 2.0)?;
        let metric = Metric::new(NAME, a)?;
        let sweep = Sweep::new(b.dim(), b.rhs_count());
        let inverse = Substitutions { a, omega: self.omega, sweep };
        Ok(Box::new(Conjugate::new(NAME, (a, b), metric, inverse)))
    }
}

impl<T: Scalar> Precondition<T> for Substitutions<'_, T> {
    fn apply(
        &mut self,
        r: &MultiVector<T>,
        z: &mut MultiVector<T>,
        context: &mut Context<'_>,
    ) -> Result<(), Halt> {
        context.poll()?;
        z.fill(T::zero());
        self.sweep.upper_mut().fill(T::zero());
        let omega = self.omega;
        // (C/ω + L) y = r.
        let _ = self.a.sweep(z, &mut self.sweep, &mut |visit| {
            let Visit { index, off_diagonal, diagonal, x } = visit;
            let known = r.row(index).iter().zip(off_diagonal).zip(diagonal);
            x.iter_mut().zip(known).for_each(|(y, ((&r, &sum), &c))| *y = ((r - sum) / c).scale(omega));
            ControlFlow::Continue(())
        });
        // (C/ω + U) z = (C/ω) y.
        self.sweep.lower_mut().fill(T::zero());
        let _ = self.a.sweep_back(z, &mut self.sweep, &mut |visit| {
            let Visit { off_diagonal, diagonal, x, .. } = visit;
            let known = off_diagonal.iter().zip(diagonal);
            x.iter_mut().zip(known).for_each(|(z, (&sum, &c))| *z -= (sum / c).scale(omega));
            ControlFlow::Continue(())
        });
        context.work.row_visits += 2 * z.dim() as u64;
        context.work.entries_touched += 2 * self.a.entries();
        Ok(())
    }
}
