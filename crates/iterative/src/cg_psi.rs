//! Conjugate gradients on Ψ x = H b: Ψ = H A = D⁻¹ − K, H = D⁻¹.
//!
//! Source: M. Leblond, F. Rousselle, C. Renaud, Hybridization techniques for fast radiosity
//! solvers, Computer Graphics International 2000 (there CG_Ψ); M. R. Hestenes, E. Stiefel, Journal
//! of Research of the National Bureau of Standards 49, 1952, DOI 10.6028/jres.049.044. H spreads
//! over the areas and reflectances of the patches, and with it the condition of Ψ: that of Θ is the
//! smaller one as a rule, see [`CgTheta`](crate::CgTheta).
//!
//! Requires a coupling that is known to be symmetric (Hermitian, for complex unknowns), D real and
//! ≥ 0, and Ψ positive definite, which light has with ρ < 1. Unknowns with d_i = 0, black patches,
//! are set to b_i before the first step.
//!
//! Cost of an iteration: one application.
//!
//! ```
//! use fredholm_iterative::CgPsi;
//! use fredholm_linop::{MultiVector, PackedSymmetric, Quiet, SecondKind, Solver, Stop, StopReason};
//!
//! // x = b + K x with K = [0 ½; ½ 0] and b = (1, 1): x = (2, 2).
//! let coupling = PackedSymmetric::new(2, vec![0.0, 0.5, 0.0])?;
//! let a = SecondKind::new(&coupling, MultiVector::from_vec(2, 1, vec![1.0, 1.0])?)?;
//! let b = MultiVector::from_vec(2, 1, vec![1.0, 1.0])?;
//! let mut x = MultiVector::zeros(2, 1);
//! let stop = Stop { tolerance: 1e-12, max_iterations: 100 };
//! let report = CgPsi.solve(&a, &b, &mut x, &stop, &mut Quiet)?;
//! assert_eq!(report.reason, StopReason::Converged);
//! assert!((x.row(0)[0] - 2.0).abs() < 1e-11);
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```

use crate::core::{Conjugate, Metric, Weights, solve_by_steps};
use fredholm_linop::{Context, Halt, Iteration, MultiVector, Scalar, Scheme, SecondKind};

const NAME: &str = "cg-psi";

/// Conjugate gradients on Ψ.
#[derive(Clone, Copy, Debug, Default)]
pub struct CgPsi;

solve_by_steps!(CgPsi);

impl<T: Scalar> Scheme<T> for CgPsi {
    fn name(&self) -> &'static str {
        NAME
    }

    fn description(&self) -> &'static str {
        "Conjugate gradients on H A; slower than cg-theta where areas or reflectances differ much"
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
        let metric = Metric::new(NAME, a)?;
        let weights = Weights(metric.weights().clone());
        Ok(Box::new(Conjugate::new(NAME, (a, b), metric, weights)))
    }
}
