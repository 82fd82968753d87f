//! The hybrid of two schemes: both run by themselves, z_k = α x'_k + (1 − α) x''_k with the α of
//! smallest residual.
//!
//! Source: C. Brezinski, M. Redivo Zaglia, Hybrid procedures for solving linear systems, Numerische
//! Mathematik 67, 1994, DOI 10.1007/s002110050015; M. Leblond, F. Rousselle, C. Renaud,
//! Hybridization techniques for fast radiosity solvers, Computer Graphics International 2000. ‖b −
//! A z_k‖₂ is at most the smaller one of both schemes' residuals. With progressive radiosity as one
//! of them this is the hybrid that the second source proposes.
//!
//! Requires what both schemes require.
//!
//! Cost of an iteration: one of each scheme, and a few vector operations.
//!
//! ```
//! use fredholm_iterative::Hybrid;
//! use fredholm_linop::{MultiVector, PackedSymmetric, Quiet, SecondKind, Solver, Stop, StopReason};
//!
//! // x = b + K x with K = [0 ½; ½ 0] and b = (1, 1): x = (2, 2).
//! let coupling = PackedSymmetric::new(2, vec![0.0, 0.5, 0.0])?;
//! let a = SecondKind::new(&coupling, MultiVector::from_vec(2, 1, vec![1.0, 1.0])?)?;
//! let b = MultiVector::from_vec(2, 1, vec![1.0, 1.0])?;
//! let mut x = MultiVector::zeros(2, 1);
//! let stop = Stop { tolerance: 1e-12, max_iterations: 100 };
//! let report = Hybrid::default().solve(&a, &b, &mut x, &stop, &mut Quiet)?;
//! assert_eq!(report.reason, StopReason::Converged);
//! assert!((x.row(0)[0] - 2.0).abs() < 1e-11);
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```

use crate::core::{Blend, blend, solve_by_steps};
use crate::{GaussSeidel, Progressive};
use fredholm_linop::{Context, Halt, Iteration, MultiVector, Scalar, Scheme, SecondKind};

const NAME: &str = "hybrid";

/// Two schemes, blended.
pub struct Hybrid<T> {
    /// Gives x'.
    pub first: Box<dyn Scheme<T>>,
    /// Gives x''.
    pub second: Box<dyn Scheme<T>>,
}

impl<T: Scalar> Default for Hybrid<T> {
    fn default() -> Self {
        Self { first: Box::new(GaussSeidel), second: Box::new(Progressive::default()) }
    }
}

struct Pair<'a, T> {
    a: &'a SecondKind<'a, T>,
    b: &'a MultiVector<T>,
    schemes: [Box<dyn Iteration<T> + 'a>; 2],
    /// The iterates of both, once they have begun.
    iterates: Option<[MultiVector<T>; 2]>,
    product: MultiVector<T>,
}

solve_by_steps!(Hybrid<T>);

impl<T: Scalar> Scheme<T> for Hybrid<T> {
    fn name(&self) -> &'static str {
        NAME
    }

    fn description(&self) -> &'static str {
        "Hybrid of two schemes, run side by side and blended for the smallest residual"
    }

    fn bytes(&self, dim: usize, rhs_count: usize) -> u64 {
        let own = (5 * size_of::<T>() as u64).saturating_mul(dim as u64).saturating_mul(rhs_count as u64);
        own.saturating_add(Scheme::bytes(&self.first, dim, rhs_count)).saturating_add(Scheme::bytes(
            &self.second,
            dim,
            rhs_count,
        ))
    }

    fn begin<'a>(
        &self,
        a: &'a SecondKind<'a, T>,
        b: &'a MultiVector<T>,
        context: &mut Context<'_>,
    ) -> Result<Box<dyn Iteration<T> + 'a>, Halt> {
        let schemes = [self.first.begin(a, b, context)?, self.second.begin(a, b, context)?];
        Ok(Box::new(Pair {
            a,
            b,
            schemes,
            iterates: None,
            product: MultiVector::zeros(b.dim(), b.rhs_count()),
        }))
    }
}

impl<T: Scalar> Iteration<T> for Pair<'_, T> {
    /// Both begin where x is, and are untouched by what comes later.
    fn restart(&mut self, x: &mut MultiVector<T>, context: &mut Context<'_>) -> Result<(), Halt> {
        if self.iterates.is_some() {
            return context.apply(self.a, x, &mut self.product);
        }
        let mut iterates = [x.clone(), x.clone()];
        for (scheme, iterate) in self.schemes.iter_mut().zip(&mut iterates) {
            scheme.restart(iterate, context)?;
        }
        self.product.copy_from(self.schemes[0].product());
        self.iterates = Some(iterates);
        Ok(())
    }

    fn advance(&mut self, x: &mut MultiVector<T>, context: &mut Context<'_>) -> Result<(), Halt> {
        let Some(iterates) = &mut self.iterates else { return self.restart(x, context) };
        for (scheme, iterate) in self.schemes.iter_mut().zip(iterates.iter_mut()) {
            scheme.advance(iterate, context)?;
        }
        x.copy_from(&iterates[1]);
        self.product.copy_from(self.schemes[1].product());
        let first = Blend { x: &iterates[0], product: self.schemes[0].product() };
        blend(self.b, &first, x, &mut self.product);
        Ok(())
    }

    fn product(&self) -> &MultiVector<T> {
        &self.product
    }

    fn drifts(&self) -> bool {
        true
    }
}
