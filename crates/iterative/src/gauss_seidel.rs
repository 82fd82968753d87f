//! Gauss–Seidel: x_i = (b_i − Σ_{j≠i} a_ij x_j)/a_ii for i = 0 … n−1, with the x_j already relaxed.
//!
//! Source: Y. Saad, Iterative Methods for Sparse Linear Systems, 2nd ed., SIAM 2003, § 4.1, DOI
//! 10.1137/1.9780898718003. For light it gathers, for one patch after the other, what the others
//! send.
//!
//! Requires a_ii ≠ 0. Converges for strictly or irreducibly diagonally dominant matrices, which
//! light has with ρ < 1, and for Hermitian positive definite ones.
//!
//! Cost of an iteration: one sweep, which reads every stored entry once for all right-hand sides
//! and gives the residual for nothing. A starting guess other than 0 costs one sweep more.
//!
//! ```
//! use fredholm_iterative::GaussSeidel;
//! use fredholm_linop::{MultiVector, PackedSymmetric, Quiet, SecondKind, Solver, Stop, StopReason};
//!
//! // x = b + K x with K = [0 ½; ½ 0] and b = (1, 1): x = (2, 2).
//! let coupling = PackedSymmetric::new(2, vec![0.0, 0.5, 0.0])?;
//! let a = SecondKind::new(&coupling, MultiVector::from_vec(2, 1, vec![1.0, 1.0])?)?;
//! let b = MultiVector::from_vec(2, 1, vec![1.0, 1.0])?;
//! let mut x = MultiVector::zeros(2, 1);
//! let stop = Stop { tolerance: 1e-12, max_iterations: 100 };
//! let report = GaussSeidel.solve(&a, &b, &mut x, &stop, &mut Quiet)?;
//! assert_eq!(report.reason, StopReason::Converged);
//! assert!((x.row(0)[0] - 2.0).abs() < 1e-11);
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```

use crate::core::{Sweeping, divisors, relax_fully, solve_by_steps};
use fredholm_linop::{Context, Halt, Iteration, MultiVector, Scalar, Scheme, SecondKind};

const NAME: &str = "gauss-seidel";

/// Relaxes every unknown in order, over and over.
#[derive(Clone, Copy, Debug, Default)]
pub struct GaussSeidel;

solve_by_steps!(GaussSeidel);

impl<T: Scalar> Scheme<T> for GaussSeidel {
    fn name(&self) -> &'static str {
        NAME
    }

    fn description(&self) -> &'static str {
        "Gauss–Seidel: every unknown in order from the newest values of the others; robust for light"
    }

    // The sums on both sides of the diagonal and the product A x.
    fn bytes(&self, dim: usize, rhs_count: usize) -> u64 {
        (3 * size_of::<T>() as u64).saturating_mul(dim as u64).saturating_mul(rhs_count as u64)
    }

    fn begin<'a>(
        &self,
        a: &'a SecondKind<'a, T>,
        b: &'a MultiVector<T>,
        _: &mut Context<'_>,
    ) -> Result<Box<dyn Iteration<T> + 'a>, Halt> {
        divisors(NAME, a)?;
        Ok(Box::new(Sweeping::forward(a, b, relax_fully)))
    }
}
