//! Block Jacobi: x_S += A_SS⁻¹ (b − A x)_S for every block S of neighbouring unknowns, all at once.
//!
//! Source: Y. Saad, Iterative Methods for Sparse Linear Systems, 2nd ed., SIAM 2003, § 4.1.1,
//! DOI 10.1137/1.9780898718003. Blocks of 2 or 3 are the components of a vector unknown.
//!
//! Requires that no A_SS is singular. Converges for M-matrices and for block diagonally dominant
//! ones.
//!
//! Cost of an iteration: one application; the blocks take one reading of the matrix.
//!
//! ```
//! use fredholm_iterative::BlockJacobi;
//! use fredholm_linop::{MultiVector, PackedSymmetric, Quiet, SecondKind, Solver, Stop, StopReason};
//!
//! // x = b + K x with K = [0 ½; ½ 0] and b = (1, 1): x = (2, 2).
//! let coupling = PackedSymmetric::new(2, vec![0.0, 0.5, 0.0])?;
//! let a = SecondKind::new(&coupling, MultiVector::from_vec(2, 1, vec![1.0, 1.0])?)?;
//! let b = MultiVector::from_vec(2, 1, vec![1.0, 1.0])?;
//! let mut x = MultiVector::zeros(2, 1);
//! let stop = Stop { tolerance: 1e-12, max_iterations: 100 };
//! let report = BlockJacobi::default().solve(&a, &b, &mut x, &stop, &mut Quiet)?;
//! assert_eq!(report.reason, StopReason::Converged);
//! assert!((x.row(0)[0] - 2.0).abs() < 1e-11);
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```

use crate::core::{Blocks, Stationary, solve_by_steps};
use fredholm_linop::{Context, Halt, Iteration, MultiVector, Scalar, Scheme, SecondKind};

const NAME: &str = "block-jacobi";

/// Relaxes all blocks at once.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct BlockJacobi {
    /// Unknowns of a block; the last one is shorter where this does not divide their number.
    pub size: usize,
}

impl Default for BlockJacobi {
    fn default() -> Self {
        Self { size: 3 }
    }
}

solve_by_steps!(BlockJacobi);

impl<T: Scalar> Scheme<T> for BlockJacobi {
    fn name(&self) -> &'static str {
        NAME
    }

    fn description(&self) -> &'static str {
        "Block Jacobi: every block of unknowns from the old values of the others; for vector unknowns"
    }

    // The factors of the blocks with their orders, and three vectors.
    fn bytes(&self, dim: usize, rhs_count: usize) -> u64 {
        let vectors = (rhs_count as u64).saturating_mul((self.size as u64).saturating_add(4));
        vectors.saturating_mul(dim as u64).saturating_mul(size_of::<T>() as u64)
    }

    fn begin<'a>(
        &self,
        a: &'a SecondKind<'a, T>,
        b: &'a MultiVector<T>,
        context: &mut Context<'_>,
    ) -> Result<Box<dyn Iteration<T> + 'a>, Halt> {
        Ok(Box::new(Stationary::new(a, b, Blocks::new(NAME, a, self.size.max(1), context)?)))
    }
}
