//! Hybrid Gauss–Seidel, second case: z_k = α x_k + (1 − α) z_(k−1) with the α of smallest residual,
//! x_k one sweep from z_(k−1).
//!
//! Source: C. Brezinski, M. Redivo Zaglia, Hybrid procedures for solving linear systems, Numerische
//! Mathematik 67, 1994, DOI 10.1007/s002110050015; M. Leblond, F. Rousselle, C. Renaud,
//! Hybridization techniques for fast radiosity solvers, Computer Graphics International 2000. The
//! state of a sweep is linear in x, so that it is blended as the iterates are, and no product is
//! computed.
//!
//! Requires a_ii ≠ 0. ‖b − A z_k‖₂ never grows and is at most that of the sweep.
//!
//! Cost of an iteration: one sweep, and a few vector operations.
//!
//! ```
//! use fredholm_iterative::Hgs2;
//! use fredholm_linop::{MultiVector, PackedSymmetric, Quiet, SecondKind, Solver, Stop, StopReason};
//!
//! // x = b + K x with K = [0 ½; ½ 0] and b = (1, 1): x = (2, 2).
//! let coupling = PackedSymmetric::new(2, vec![0.0, 0.5, 0.0])?;
//! let a = SecondKind::new(&coupling, MultiVector::from_vec(2, 1, vec![1.0, 1.0])?)?;
//! let b = MultiVector::from_vec(2, 1, vec![1.0, 1.0])?;
//! let mut x = MultiVector::zeros(2, 1);
//! let stop = Stop { tolerance: 1e-12, max_iterations: 100 };
//! let report = Hgs2.solve(&a, &b, &mut x, &stop, &mut Quiet)?;
//! assert_eq!(report.reason, StopReason::Converged);
//! assert!((x.row(0)[0] - 2.0).abs() < 1e-11);
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```

use crate::core::{Blend, blend, divisors, relax_fully, solve_by_steps, visit_all};
use fredholm_linop::{
    Context, Halt, Iteration, LinearOperator, MultiVector, Scalar, Scheme, SecondKind, Sweep, Visit,
};

const NAME: &str = "hgs2";

/// Sweeps from the blended iterate.
#[derive(Clone, Copy, Debug, Default)]
pub struct Hgs2;

struct Blended<'a, T> {
    a: &'a SecondKind<'a, T>,
    b: &'a MultiVector<T>,
    sweep: Sweep<T>,
    product: MultiVector<T>,
}

solve_by_steps!(Hgs2);

impl<T: Scalar> Scheme<T> for Hgs2 {
    fn name(&self) -> &'static str {
        NAME
    }

    fn description(&self) -> &'static str {
        "Hybrid Gauss–Seidel 2: every sweep starts from the iterate blended for the smallest residual"
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
        let product = MultiVector::zeros(b.dim(), b.rhs_count());
        Ok(Box::new(Blended { a, b, sweep: Sweep::new(b.dim(), b.rhs_count()), product }))
    }
}

impl<T: Scalar> Iteration<T> for Blended<'_, T> {
    fn restart(&mut self, x: &mut MultiVector<T>, context: &mut Context<'_>) -> Result<(), Halt> {
        self.sweep = Sweep::new(x.dim(), x.rhs_count());
        if !x.is_zero() {
            visit_all(self.a, context, |_| (), |relax| self.a.sweep(x, &mut self.sweep, relax))?;
        }
        self.product.copy_from(self.sweep.product());
        Ok(())
    }

    fn advance(&mut self, x: &mut MultiVector<T>, context: &mut Context<'_>) -> Result<(), Halt> {
        let (state, mut z) = (self.sweep.clone(), x.clone());
        let rule = |visit: Visit<'_, T>| relax_fully(self.b, visit);
        visit_all(self.a, context, rule, |relax| self.a.sweep(x, &mut self.sweep, relax))?;
        let swept = Blend { x, product: self.sweep.product() };
        let alpha = blend(self.b, &swept, &mut z, &mut self.product);
        self.sweep.mix(&alpha, &state);
        *x = z;
        Ok(())
    }

    fn product(&self) -> &MultiVector<T> {
        &self.product
    }

    fn drifts(&self) -> bool {
        true
    }
}
