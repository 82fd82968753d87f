//! Chebyshev iteration: the residual polynomial is the Chebyshev polynomial of an interval that
//! holds the spectrum of A.
//!
//! Source: Y. Saad, Iterative Methods for Sparse Linear Systems, 2nd ed., SIAM 2003, algorithm
//! 12.1, DOI 10.1137/1.9780898718003. No inner products: nothing is summed over all unknowns. The
//! interval is that of 24 steps of the Lanczos process in the inner product of H = D⁻¹, widened by
//! a twentieth, or given.
//!
//! Requires a real spectrum in a positive interval. Without a given interval: a coupling that is
//! known to be symmetric (Hermitian, for complex unknowns), D real and ≥ 0, and Ψ positive
//! definite. An interval that leaves out small eigenvalues costs iterations only; eigenvalues above
//! twice its middle make it diverge.
//!
//! Cost of an iteration: one application. The automatic interval takes 24 applications first.
//!
//! ```
//! use fredholm_iterative::Chebyshev;
//! use fredholm_linop::{MultiVector, PackedSymmetric, Quiet, SecondKind, SolveError, Solver, Stop, StopReason};
//!
//! // x = b + K x with K = [0 ½; ½ 0] and b = (1, 1): x = (2, 2).
//! let coupling = PackedSymmetric::new(2, vec![0.0, 0.5, 0.0])?;
//! let a = SecondKind::new(&coupling, MultiVector::from_vec(2, 1, vec![1.0, 1.0])?)?;
//! let b = MultiVector::from_vec(2, 1, vec![1.0, 1.0])?;
//! let mut x = MultiVector::zeros(2, 1);
//! let stop = Stop { tolerance: 1e-12, max_iterations: 100 };
//! let report = Chebyshev::default().solve(&a, &b, &mut x, &stop, &mut Quiet)?;
//! assert_eq!(report.reason, StopReason::Converged);
//! assert!((x.row(0)[0] - 2.0).abs() < 1e-11);
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```

use crate::core::{Metric, lanczos, reals, solve_by_steps};
use fredholm_linop::{Context, Halt, Iteration, MultiVector, Scalar, Scheme, SecondKind, SolveError};

const NAME: &str = "chebyshev";
/// Steps of the Lanczos process.
const STEPS: usize = 24;
/// Share of its width by which the interval is widened on either side.
const INTERVAL_MARGIN: f64 = 0.05;

/// Chebyshev iteration.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Chebyshev {
    /// Lowest and highest eigenvalue of A, or automatic ones for each right-hand side.
    pub interval: Option<(f64, f64)>,
}

struct Steps<'a, T> {
    a: &'a SecondKind<'a, T>,
    b: &'a MultiVector<T>,
    /// Middle and half width of the interval, and ρ of the recurrence, per right-hand side.
    middle: Vec<f64>,
    half: Vec<f64>,
    rho: Vec<f64>,
    residual: MultiVector<T>,
    step: MultiVector<T>,
    product: MultiVector<T>,
}

solve_by_steps!(Chebyshev);

impl<T: Scalar> Scheme<T> for Chebyshev {
    fn name(&self) -> &'static str {
        NAME
    }

    fn description(&self) -> &'static str {
        "Chebyshev iteration over the interval of the spectrum; no inner products"
    }

    fn bytes(&self, dim: usize, rhs_count: usize) -> u64 {
        (5 * size_of::<T>() as u64).saturating_mul(dim as u64).saturating_mul(rhs_count as u64)
    }

    fn begin<'a>(
        &self,
        a: &'a SecondKind<'a, T>,
        b: &'a MultiVector<T>,
        context: &mut Context<'_>,
    ) -> Result<Box<dyn Iteration<T> + 'a>, Halt> {
        let intervals = self.intervals(a, context)?;
        let zeros = MultiVector::zeros(b.dim(), b.rhs_count());
        Ok(Box::new(Steps {
            a,
            b,
            middle: intervals.iter().map(|(low, high)| 0.5 * (low + high)).collect(),
            half: intervals.iter().map(|(low, high)| 0.5 * (high - low)).collect(),
            rho: Vec::new(),
            residual: zeros.clone(),
            step: zeros.clone(),
            product: zeros,
        }))
    }
}

impl Chebyshev {
    /// The interval of every right-hand side.
    fn intervals<T: Scalar>(
        &self,
        a: &SecondKind<'_, T>,
        context: &mut Context<'_>,
    ) -> Result<Vec<(f64, f64)>, Halt> {
        if let Some((low, high)) = self.interval {
            if 0.0 < low && low <= high && high.is_finite() {
                return Ok(vec![(low, high); a.factor().rhs_count()]);
            }
            let reason = format!("the interval is {low} … {high}, but must be above 0 and in order");
            return Err(SolveError::Unsuitable { solver: NAME, reason }.into());
        }
        let found = lanczos(a, &Metric::new(NAME, a)?, STEPS, false, context)?;
        let mut intervals = Vec::with_capacity(found.len());
        for (rhs, t) in found.iter().enumerate() {
            // Black unknowns have the eigenvalue 1.
            let last = t.diagonal.len().saturating_sub(1);
            let (low, high) = (t.eigenvalue(0).min(1.0), t.eigenvalue(last).max(1.0));
            if low <= 0.0 {
                return Err(SolveError::Indefinite { solver: NAME, rhs }.into());
            }
            let margin = INTERVAL_MARGIN * (high - low);
            intervals.push(((low - margin).max(0.5 * low), high + margin));
        }
        Ok(intervals)
    }
}

impl<T: Scalar> Steps<'_, T> {
    /// The factors of the old step and of the residual in the next step, per right-hand side.
    fn factors(&mut self) -> (Vec<f64>, Vec<f64>) {
        if self.rho.is_empty() {
            self.rho = self.half.iter().zip(&self.middle).map(|(half, middle)| half / middle).collect();
            return (vec![0.0; self.half.len()], self.middle.iter().map(|middle| middle.recip()).collect());
        }
        let mut factors = (Vec::new(), Vec::new());
        for ((rho, &middle), &half) in self.rho.iter_mut().zip(&self.middle).zip(&self.half) {
            // With σ = middle/half: ρ_new = 1/(2σ − ρ), written so that half = 0 is no exception.
            let scaled = 1.0 / (2.0 * middle - *rho * half);
            let new = half * scaled;
            factors.0.push(new * *rho);
            factors.1.push(2.0 * scaled);
            *rho = new;
        }
        factors
    }
}

impl<T: Scalar> Iteration<T> for Steps<'_, T> {
    fn restart(&mut self, x: &mut MultiVector<T>, context: &mut Context<'_>) -> Result<(), Halt> {
        self.rho.clear();
        context.start(self.a, x, &mut self.product)
    }

    fn advance(&mut self, x: &mut MultiVector<T>, context: &mut Context<'_>) -> Result<(), Halt> {
        context.poll()?;
        self.residual.set_difference(self.b, &self.product);
        let (old, new) = self.factors();
        let zeros = MultiVector::zeros(x.dim(), x.rhs_count());
        self.step.scale_and_add(&reals(&old), &zeros);
        self.step.add_scaled(&reals(&new), &self.residual);
        x.add_scaled(&vec![T::one(); x.rhs_count()], &self.step);
        context.apply(self.a, x, &mut self.product)
    }

    fn product(&self) -> &MultiVector<T> {
        &self.product
    }
}
