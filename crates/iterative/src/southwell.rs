//! Southwell: relax the unknown with the largest residual, x_i += r_i/a_ii, and take a_ki r_i/a_ii
//! from every r_k.
//!
//! Source: R. V. Southwell, Relaxation Methods in Engineering Science, Oxford 1940; for light in
//! its gathering form, S. J. Gortler, M. F. Cohen, P. Slusallek, Radiosity and relaxation methods,
//! IEEE Computer Graphics and Applications 14 (6), 1994, DOI 10.1109/38.329094. Several right-hand
//! sides are relaxed together: the unknown chosen has the largest
//! |r_il|/‖b_l‖₂ of all right-hand sides l, the first one of equals.
//!
//! Requires a_ii ≠ 0. Converges for strictly diagonally dominant matrices and for Hermitian
//! positive definite ones.
//!
//! Cost of an iteration: n relaxations, each of one column, and one application. The residual that
//! is reported and that the next n relaxations start from is computed anew, so that rounding does
//! not pile up in it.
//!
//! ```
//! use fredholm_iterative::Southwell;
//! use fredholm_linop::{MultiVector, PackedSymmetric, Quiet, SecondKind, Solver, Stop, StopReason};
//!
//! // x = b + K x with K = [0 ½; ½ 0] and b = (1, 1): x = (2, 2).
//! let coupling = PackedSymmetric::new(2, vec![0.0, 0.5, 0.0])?;
//! let a = SecondKind::new(&coupling, MultiVector::from_vec(2, 1, vec![1.0, 1.0])?)?;
//! let b = MultiVector::from_vec(2, 1, vec![1.0, 1.0])?;
//! let mut x = MultiVector::zeros(2, 1);
//! let stop = Stop { tolerance: 1e-12, max_iterations: 100 };
//! let report = Southwell.solve(&a, &b, &mut x, &stop, &mut Quiet)?;
//! assert_eq!(report.reason, StopReason::Converged);
//! assert!((x.row(0)[0] - 2.0).abs() < 1e-11);
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```

use crate::core::{Shooting, Step, divisors, quotients, solve_by_steps};
use fredholm_linop::{Context, Halt, Iteration, MultiVector, Scalar, Scheme, SecondKind};

const NAME: &str = "southwell";

/// Relaxes the unknown with the largest residual, over and over.
#[derive(Clone, Copy, Debug, Default)]
pub struct Southwell;

/// s = r_i/a_ii.
struct Relaxation;

solve_by_steps!(Southwell);

impl<T: Scalar> Scheme<T> for Southwell {
    fn name(&self) -> &'static str {
        NAME
    }

    fn description(&self) -> &'static str {
        "Southwell: the unknown with the largest residual first; few relaxations where the light is local"
    }

    // The residual, the product, the diagonal, the weights and one column.
    fn bytes(&self, dim: usize, rhs_count: usize) -> u64 {
        let vectors = (rhs_count as u64).saturating_mul(3).saturating_add(2);
        vectors.saturating_mul(dim as u64).saturating_mul(size_of::<T>() as u64)
    }

    fn begin<'a>(
        &self,
        a: &'a SecondKind<'a, T>,
        b: &'a MultiVector<T>,
        _: &mut Context<'_>,
    ) -> Result<Box<dyn Iteration<T> + 'a>, Halt> {
        let rule = (divisors(NAME, a)?, vec![1.0; b.dim()]);
        Ok(Box::new(Shooting::new(a, b, rule, Relaxation).with_anew_products()))
    }
}

impl<T: Scalar> Step<T> for Relaxation {
    fn prepare(&mut self, _: &MultiVector<T>) {}

    fn step(&self, _: usize, residual: &[T], diagonal: &[T]) -> Vec<T> {
        quotients(residual, diagonal)
    }
}
