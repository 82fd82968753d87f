//! Symmetric relaxation: a backward sweep, i = n−1 … 0, then a forward one, x_i += ω ((b_i −
//! Σ_{j≠i} a_ij x_j)/a_ii − x_i).
//!
//! Symmetric Gauss–Seidel for ω = 1. Source: Y. Saad, Iterative Methods for Sparse Linear Systems,
//! 2nd ed., SIAM 2003, § 4.1, DOI 10.1137/1.9780898718003; the sums over the part of the row that
//! has not changed are kept from one sweep to the next (V. Conrad, Y. Wallach, Numerische
//! Mathematik 32, 1979).
//!
//! Requires a_ii ≠ 0 and 0 < ω < 2. Converges for Hermitian positive definite matrices with any
//! such ω; its iteration matrix then has real eigenvalues, which acceleration needs.
//!
//! Cost of an iteration: two sweeps, each of which reads every stored entry once; the backward one
//! does half the arithmetic.
//!
//! ```
//! use fredholm_iterative::Ssor;
//! use fredholm_linop::{MultiVector, PackedSymmetric, Quiet, SecondKind, Solver, Stop, StopReason};
//!
//! // x = b + K x with K = [0 ½; ½ 0] and b = (1, 1): x = (2, 2).
//! let coupling = PackedSymmetric::new(2, vec![0.0, 0.5, 0.0])?;
//! let a = SecondKind::new(&coupling, MultiVector::from_vec(2, 1, vec![1.0, 1.0])?)?;
//! let b = MultiVector::from_vec(2, 1, vec![1.0, 1.0])?;
//! let mut x = MultiVector::zeros(2, 1);
//! let stop = Stop { tolerance: 1e-12, max_iterations: 100 };
//! let report = Ssor::default().solve(&a, &b, &mut x, &stop, &mut Quiet)?;
//! assert_eq!(report.reason, StopReason::Converged);
//! assert!((x.row(0)[0] - 2.0).abs() < 1e-11);
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```

use crate::core::{Sweeping, divisors, relax_by, solve_by_steps};
use crate::sor::check;
use fredholm_linop::{Context, Halt, Iteration, MultiVector, Scalar, Scheme, SecondKind};

const NAME: &str = "ssor";

/// Relaxes in reverse order, then in order.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Ssor {
    /// ω between 0 and 2; 1 is symmetric Gauss–Seidel.
    pub omega: f64,
}

impl Default for Ssor {
    fn default() -> Self {
        Self { omega: 1.0 }
    }
}

solve_by_steps!(Ssor);

impl<T: Scalar> Scheme<T> for Ssor {
    fn name(&self) -> &'static str {
        NAME
    }

    fn description(&self) -> &'static str {
        "Symmetric over-relaxation: a sweep back and a sweep forth; symmetric Gauss–Seidel with omega 1"
    }

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
        check(NAME, self.omega, 2.0)?;
        let omega = vec![self.omega; b.rhs_count()];
        Ok(Box::new(Sweeping::back_and_forth(a, b, move |b, visit| relax_by(&omega, b, visit))))
    }
}
