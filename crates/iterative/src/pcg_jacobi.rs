//! Conjugate gradients on Ψ = H A, preconditioned by its diagonal: z_i = r_i/a_ii.
//!
//! Source: Y. Saad, Iterative Methods for Sparse Linear Systems, 2nd ed., SIAM 2003, § 9.2, DOI
//! 10.1137/1.9780898718003. Where a_ii = 1, as on flat patches, diag(Ψ) = H, and this is conjugate
//! gradients on Θ.
//!
//! Requires a coupling that is known to be symmetric (Hermitian, for complex unknowns), D real and
//! ≥ 0, and Ψ positive definite, which light has with ρ < 1. Unknowns with d_i = 0, black patches,
//! are set to b_i before the first step.
//!
//! Cost of an iteration: one application.
//!
//! ```
//! use fredholm_iterative::PcgJacobi;
//! use fredholm_linop::{MultiVector, PackedSymmetric, Quiet, SecondKind, Solver, Stop, StopReason};
//!
//! // x = b + K x with K = [0 ½; ½ 0] and b = (1, 1): x = (2, 2).
//! let coupling = PackedSymmetric::new(2, vec![0.0, 0.5, 0.0])?;
//! let a = SecondKind::new(&coupling, MultiVector::from_vec(2, 1, vec![1.0, 1.0])?)?;
//! let b = MultiVector::from_vec(2, 1, vec![1.0, 1.0])?;
//! let mut x = MultiVector::zeros(2, 1);
//! let stop = Stop { tolerance: 1e-12, max_iterations: 100 };
//! let report = PcgJacobi.solve(&a, &b, &mut x, &stop, &mut Quiet)?;
//! assert_eq!(report.reason, StopReason::Converged);
//! assert!((x.row(0)[0] - 2.0).abs() < 1e-11);
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```

use crate::core::{Conjugate, Diagonal, Metric, divisors, solve_by_steps};
use fredholm_linop::{Context, Halt, Iteration, MultiVector, Scalar, Scheme, SecondKind};

const NAME: &str = "pcg-jacobi";

/// Conjugate gradients preconditioned by the diagonal.
#[derive(Clone, Copy, Debug, Default)]
pub struct PcgJacobi;

solve_by_steps!(PcgJacobi);

impl<T: Scalar> Scheme<T> for PcgJacobi {
    fn name(&self) -> &'static str {
        NAME
    }

    fn description(&self) -> &'static str {
        "Conjugate gradients preconditioned by the diagonal; the same as cg-theta on flat patches"
    }

    fn bytes(&self, dim: usize, rhs_count: usize) -> u64 {
        (7 * size_of::<T>() as u64).saturating_mul(dim as u64).saturating_mul(rhs_count as u64)
    }

    fn begin<'a>(
        &self,
        a: &'a SecondKind<'a, T>,
        b: &'a MultiVector<T>,
        _: &mut Context<'_>,
    ) -> Result<Box<dyn Iteration<T> + 'a>, Halt> {
        let diagonal = Diagonal { divisors: divisors(NAME, a)?, omega: 1.0 };
        Ok(Box::new(Conjugate::new(NAME, (a, b), Metric::new(NAME, a)?, diagonal)))
    }
}
