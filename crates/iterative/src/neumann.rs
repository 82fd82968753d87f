//! Successive approximations: x ← b + K x, with A = I − K. From x = 0 its iterates are the partial
//! sums of the Neumann series b + K b + K² b + …: for light, what has bounced at most k times.
//!
//! Source: Y. Saad, Iterative Methods for Sparse Linear Systems, 2nd ed., SIAM 2003, § 4.2
//! (Richardson's iteration with factor 1), DOI 10.1137/1.9780898718003.
//!
//! Requires nothing. Converges if the spectral radius of D K is below 1, as it is for light with
//! ρ < 1.
//!
//! Cost of an iteration: one application.
//!
//! ```
//! use fredholm_iterative::Neumann;
//! use fredholm_linop::{MultiVector, PackedSymmetric, Quiet, SecondKind, Solver, Stop, StopReason};
//!
//! // x = b + K x with K = [0 ½; ½ 0] and b = (1, 1): x = (2, 2).
//! let coupling = PackedSymmetric::new(2, vec![0.0, 0.5, 0.0])?;
//! let a = SecondKind::new(&coupling, MultiVector::from_vec(2, 1, vec![1.0, 1.0])?)?;
//! let b = MultiVector::from_vec(2, 1, vec![1.0, 1.0])?;
//! let mut x = MultiVector::zeros(2, 1);
//! let stop = Stop { tolerance: 1e-12, max_iterations: 100 };
//! let report = Neumann.solve(&a, &b, &mut x, &stop, &mut Quiet)?;
//! assert_eq!(report.reason, StopReason::Converged);
//! assert!((x.row(0)[0] - 2.0).abs() < 1e-11);
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```

use crate::core::{Identity, Stationary, solve_by_steps};
use fredholm_linop::{Context, Halt, Iteration, MultiVector, Scalar, Scheme, SecondKind};

const NAME: &str = "neumann";

/// Adds one bounce an iteration.
#[derive(Clone, Copy, Debug, Default)]
pub struct Neumann;

solve_by_steps!(Neumann);

impl<T: Scalar> Scheme<T> for Neumann {
    fn name(&self) -> &'static str {
        NAME
    }

    fn description(&self) -> &'static str {
        "Successive approximations: one bounce an iteration; the Neumann series"
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
        Ok(Box::new(Stationary::new(a, b, Identity)))
    }
}
