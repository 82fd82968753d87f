//! Successive relaxation: x_i += ω ((b_i − Σ_{j≠i} a_ij x_j)/a_ii − x_i) in order, with the x_j
//! already relaxed.
//!
//! Over-relaxation (SOR) for ω > 1, under-relaxation (SUR) for ω < 1. Source: D. M. Young,
//! Iterative Solution of Large Linear Systems, Academic Press 1971. Where no ω is given it is
//! Young's 2/(1 + √(1 − ρ(J)²)) for each right-hand side, ρ(J) by the power method; for matrices
//! that are not consistently ordered, such as full ones, that is a guess, and often too large.
//!
//! Requires a_ii ≠ 0 and 0 < ω < 2, outside of which it cannot converge (W. Kahan). Converges for
//! Hermitian positive definite matrices with any such ω (A. M. Ostrowski, Rendiconti di Matematica
//! 14, 1954), light with ρ < 1 included, and for M-matrices with ω ≤ 1, the slower the smaller.
//!
//! Cost of an iteration: one sweep. The automatic ω takes up to 30 applications first.
//!
//! ```
//! use fredholm_iterative::Sor;
//! use fredholm_linop::{MultiVector, PackedSymmetric, Quiet, SecondKind, Solver, Stop, StopReason};
//!
//! // x = b + K x with K = [0 ½; ½ 0] and b = (1, 1): x = (2, 2).
//! let coupling = PackedSymmetric::new(2, vec![0.0, 0.5, 0.0])?;
//! let a = SecondKind::new(&coupling, MultiVector::from_vec(2, 1, vec![1.0, 1.0])?)?;
//! let b = MultiVector::from_vec(2, 1, vec![1.0, 1.0])?;
//! let mut x = MultiVector::zeros(2, 1);
//! let stop = Stop { tolerance: 1e-12, max_iterations: 100 };
//! let report = Sor { omega: Some(1.1) }.solve(&a, &b, &mut x, &stop, &mut Quiet)?;
//! assert_eq!(report.reason, StopReason::Converged);
//! assert!((x.row(0)[0] - 2.0).abs() < 1e-11);
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```

use crate::core::{Sweeping, divisors, jacobi_radius, relax_by, solve_by_steps};
use fredholm_linop::{Context, Halt, Iteration, MultiVector, Scalar, Scheme, SecondKind, SolveError};

const NAME: &str = "sor";
const UNDER_RELAXED_NAME: &str = "sur";

/// Over-relaxation.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Sor {
    /// ω between 0 and 2, or an automatic one for each right-hand side.
    pub omega: Option<f64>,
}

/// Under-relaxation.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Sur {
    /// ω between 0 and 1.
    pub omega: f64,
}

impl Default for Sur {
    fn default() -> Self {
        Self { omega: 0.8 }
    }
}

solve_by_steps!(Sor);

impl<T: Scalar> Scheme<T> for Sor {
    fn name(&self) -> &'static str {
        NAME
    }

    fn description(&self) -> &'static str {
        "Successive over-relaxation: Gauss–Seidel steps lengthened by omega; automatic where not given"
    }

    // The state of the sweep, and the vector of the power method.
    fn bytes(&self, dim: usize, rhs_count: usize) -> u64 {
        (4 * size_of::<T>() as u64).saturating_mul(dim as u64).saturating_mul(rhs_count as u64)
    }

    fn begin<'a>(
        &self,
        a: &'a SecondKind<'a, T>,
        b: &'a MultiVector<T>,
        context: &mut Context<'_>,
    ) -> Result<Box<dyn Iteration<T> + 'a>, Halt> {
        let omega = factors(a, self.omega, context)?;
        Ok(Box::new(Sweeping::forward(a, b, move |b, visit| relax_by(&omega, b, visit))))
    }
}

solve_by_steps!(Sur);

impl<T: Scalar> Scheme<T> for Sur {
    fn name(&self) -> &'static str {
        UNDER_RELAXED_NAME
    }

    fn description(&self) -> &'static str {
        "Successive under-relaxation: Gauss–Seidel steps shortened by omega; slower than Gauss–Seidel for light"
    }

    fn bytes(&self, dim: usize, rhs_count: usize) -> u64 {
        Scheme::<T>::bytes(&Sor::default(), dim, rhs_count)
    }

    fn begin<'a>(
        &self,
        a: &'a SecondKind<'a, T>,
        b: &'a MultiVector<T>,
        _: &mut Context<'_>,
    ) -> Result<Box<dyn Iteration<T> + 'a>, Halt> {
        divisors(UNDER_RELAXED_NAME, a)?;
        check(UNDER_RELAXED_NAME, self.omega, 1.0)?;
        let omega = vec![self.omega; b.rhs_count()];
        Ok(Box::new(Sweeping::forward(a, b, move |b, visit| relax_by(&omega, b, visit))))
    }
}

/// ω of every right-hand side.
fn factors<T: Scalar>(
    a: &SecondKind<'_, T>,
    omega: Option<f64>,
    context: &mut Context<'_>,
) -> Result<Vec<f64>, Halt> {
    let divisors = divisors(NAME, a)?;
    match omega {
        Some(omega) => {
            check(NAME, omega, 2.0)?;
            Ok(vec![omega; divisors.rhs_count()])
        }
        None => Ok(jacobi_radius(a, &divisors, context)?.into_iter().map(young).collect()),
    }
}

/// Young's ω; 1 where Jacobi does not converge and nothing is known.
fn young(radius: f64) -> f64 {
    if radius < 1.0 { 2.0 / (1.0 + (1.0 - radius * radius).sqrt()) } else { 1.0 }
}

/// Refuses an ω that cannot converge, or is not what the name says.
pub(crate) fn check(solver: &'static str, omega: f64, below: f64) -> Result<(), SolveError> {
    if omega > 0.0 && omega < below {
        return Ok(());
    }
    let reason = format!("omega is {omega}, but must lie between 0 and {below}, both excluded");
    Err(SolveError::Unsuitable { solver, reason })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn youngs_factor_is_that_of_the_model_problem() {
        // ρ(J) = cos π/(n+1) gives ω = 2/(1 + sin π/(n+1)); n = 1 is ω = 1.
        let angle = std::f64::consts::PI / 11.0;
        assert!((young(angle.cos()) - 2.0 / (1.0 + angle.sin())).abs() < 1e-14);
        assert!((young(0.0) - 1.0).abs() < 1e-15 && (young(1.5) - 1.0).abs() < 1e-15);
    }
}
