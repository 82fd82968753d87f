//! Jacobi: x_i += ω (b_i − Σ_j a_ij x_j)/a_ii, all unknowns at once; weighted if ω ≠ 1.
//!
//! Source: Y. Saad, Iterative Methods for Sparse Linear Systems, 2nd ed., SIAM 2003, § 4.1 and
//! § 13.2.2, DOI 10.1137/1.9780898718003. Where a_ii = 1, as on flat patches, ω = 1 is the Neumann
//! series.
//!
//! Requires a_ii ≠ 0 and 0 < ω. Converges with ω = 1 for strictly or irreducibly diagonally
//! dominant matrices, with ω < 2/λ_max(diag(A)⁻¹ A) for those that are similar to a Hermitian
//! positive definite one.
//!
//! Cost of an iteration: one application.
//!
//! ```
//! use fredholm_iterative::Jacobi;
//! use fredholm_linop::{MultiVector, PackedSymmetric, Quiet, SecondKind, Solver, Stop, StopReason};
//!
//! // x = b + K x with K = [0 ½; ½ 0] and b = (1, 1): x = (2, 2).
//! let coupling = PackedSymmetric::new(2, vec![0.0, 0.5, 0.0])?;
//! let a = SecondKind::new(&coupling, MultiVector::from_vec(2, 1, vec![1.0, 1.0])?)?;
//! let b = MultiVector::from_vec(2, 1, vec![1.0, 1.0])?;
//! let mut x = MultiVector::zeros(2, 1);
//! let stop = Stop { tolerance: 1e-12, max_iterations: 100 };
//! let report = Jacobi::default().solve(&a, &b, &mut x, &stop, &mut Quiet)?;
//! assert_eq!(report.reason, StopReason::Converged);
//! assert!((x.row(0)[0] - 2.0).abs() < 1e-11);
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```

use crate::core::{Diagonal, Stationary, divisors, solve_by_steps};
use fredholm_linop::{Context, Halt, Iteration, MultiVector, Scalar, Scheme, SecondKind};

const NAME: &str = "jacobi";

/// Relaxes all unknowns at once.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Jacobi {
    /// ω, above 0; the weighted method differs in nothing else.
    pub omega: f64,
}

impl Default for Jacobi {
    fn default() -> Self {
        Self { omega: 1.0 }
    }
}

solve_by_steps!(Jacobi);

impl<T: Scalar> Scheme<T> for Jacobi {
    fn name(&self) -> &'static str {
        NAME
    }

    fn description(&self) -> &'static str {
        "Jacobi: every unknown from the old values of the others; weighted with omega"
    }

    fn bytes(&self, dim: usize, rhs_count: usize) -> u64 {
        (4 * size_of::<T>() as u64).saturating_mul(dim as u64).saturating_mul(rhs_count as u64)
    }

    fn begin<'a>(
        &self,
        a: &'a SecondKind<'a, T>,
        b: &'a MultiVector<T>,
        _: &mut Context<'_>,
    ) -> Result<Box<dyn Iteration<T> + 'a>, Halt> {
        let divisors = divisors(NAME, a)?;
        Ok(Box::new(Stationary::new(a, b, Diagonal { divisors, omega: self.omega })))
    }
}
