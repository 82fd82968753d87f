//! Hybrid Gauss–Seidel, first case: z_k = α x_k + (1 − α) z_(k−1) with the α of smallest residual,
//! x_k the iterates of an untouched sequence.
//!
//! Source: C. Brezinski, M. Redivo Zaglia, Hybrid procedures for solving linear systems, Numerische
//! Mathematik 67, 1994, DOI 10.1007/s002110050015; M. Leblond, F. Rousselle, C. Renaud,
//! Hybridization techniques for fast radiosity solvers, Computer Graphics International 2000. Any
//! scheme can give the sequence; by default it is Gauss–Seidel. ‖b − A z_k‖₂ is at most ‖b − A
//! x_k‖₂ and never grows. A z_k is blended as z_k is, and computed anew before it counts as
//! converged.
//!
//! Requires what the scheme of the sequence requires.
//!
//! Cost of an iteration: one of the sequence, and a few vector operations.
//!
//! ```
//! use fredholm_iterative::Hgs1;
//! use fredholm_linop::{MultiVector, PackedSymmetric, Quiet, SecondKind, Solver, Stop, StopReason};
//!
//! // x = b + K x with K = [0 ½; ½ 0] and b = (1, 1): x = (2, 2).
//! let coupling = PackedSymmetric::new(2, vec![0.0, 0.5, 0.0])?;
//! let a = SecondKind::new(&coupling, MultiVector::from_vec(2, 1, vec![1.0, 1.0])?)?;
//! let b = MultiVector::from_vec(2, 1, vec![1.0, 1.0])?;
//! let mut x = MultiVector::zeros(2, 1);
//! let stop = Stop { tolerance: 1e-12, max_iterations: 100 };
//! let report = Hgs1::default().solve(&a, &b, &mut x, &stop, &mut Quiet)?;
//! assert_eq!(report.reason, StopReason::Converged);
//! assert!((x.row(0)[0] - 2.0).abs() < 1e-11);
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```

use crate::GaussSeidel;
use crate::core::{Blend, blend, solve_by_steps};
use fredholm_linop::{Context, Halt, Iteration, MultiVector, Scalar, Scheme, SecondKind};

const NAME: &str = "hgs1";

/// Minimal residual smoothing of a sequence.
pub struct Hgs1<T> {
    /// What gives the sequence.
    pub sequence: Box<dyn Scheme<T>>,
}

impl<T: Scalar> Default for Hgs1<T> {
    fn default() -> Self {
        Self { sequence: Box::new(GaussSeidel) }
    }
}

struct Smoothed<'a, T> {
    a: &'a SecondKind<'a, T>,
    b: &'a MultiVector<T>,
    sequence: Box<dyn Iteration<T> + 'a>,
    /// The iterate of the sequence, once it has begun.
    x: Option<MultiVector<T>>,
    product: MultiVector<T>,
}

solve_by_steps!(Hgs1<T>);

impl<T: Scalar> Scheme<T> for Hgs1<T> {
    fn name(&self) -> &'static str {
        NAME
    }

    fn description(&self) -> &'static str {
        "Hybrid Gauss–Seidel 1: blended with the iterates of an untouched sequence for the smallest residual"
    }

    fn bytes(&self, dim: usize, rhs_count: usize) -> u64 {
        let own = (4 * size_of::<T>() as u64).saturating_mul(dim as u64).saturating_mul(rhs_count as u64);
        own.saturating_add(Scheme::bytes(&self.sequence, dim, rhs_count))
    }

    fn begin<'a>(
        &self,
        a: &'a SecondKind<'a, T>,
        b: &'a MultiVector<T>,
        context: &mut Context<'_>,
    ) -> Result<Box<dyn Iteration<T> + 'a>, Halt> {
        let sequence = self.sequence.begin(a, b, context)?;
        Ok(Box::new(Smoothed {
            a,
            b,
            sequence,
            x: None,
            product: MultiVector::zeros(b.dim(), b.rhs_count()),
        }))
    }
}

impl<T: Scalar> Iteration<T> for Smoothed<'_, T> {
    /// The sequence begins where x is, and is untouched by what comes later.
    fn restart(&mut self, x: &mut MultiVector<T>, context: &mut Context<'_>) -> Result<(), Halt> {
        if self.x.is_some() {
            return context.apply(self.a, x, &mut self.product);
        }
        let mut own = x.clone();
        self.sequence.restart(&mut own, context)?;
        self.product.copy_from(self.sequence.product());
        self.x = Some(own);
        Ok(())
    }

    fn advance(&mut self, x: &mut MultiVector<T>, context: &mut Context<'_>) -> Result<(), Halt> {
        let Some(own) = &mut self.x else { return self.restart(x, context) };
        self.sequence.advance(own, context)?;
        let iterate = Blend { x: own, product: self.sequence.product() };
        blend(self.b, &iterate, x, &mut self.product);
        Ok(())
    }

    fn product(&self) -> &MultiVector<T> {
        &self.product
    }

    fn drifts(&self) -> bool {
        true
    }
}
