//! Conjugate gradients on Θ z = H^½ b, x = H^(−½) z: Θ = H^½ A H^(−½) = I − D^½ K D^½, H = D⁻¹.
//!
//! Source: M. Leblond, F. Rousselle, C. Renaud, Hybridization techniques for fast radiosity
//! solvers, Computer Graphics International 2000 (there CG_Θ); M. R. Hestenes, E. Stiefel, Journal
//! of Research of the National Bureau of Standards 49, 1952, DOI 10.6028/jres.049.044. It is
//! conjugate gradients on A in the inner product of H, which needs no square roots.
//!
//! Requires a coupling that is known to be symmetric (Hermitian, for complex unknowns), D real and
//! ≥ 0, and Ψ positive definite, which light has with ρ < 1. Unknowns with d_i = 0, black patches,
//! are set to b_i before the first step.
//!
//! Cost of an iteration: one application.
//!
//! ```
//! use fredholm_iterative::CgTheta;
//! use fredholm_linop::{MultiVector, PackedSymmetric, Quiet, SecondKind, Solver, Stop, StopReason};
//!
//! // x = b + K x with K = [0 ½; ½ 0] and b = (1, 1): x = (2, 2).
//! let coupling = PackedSymmetric::new(2, vec![0.0, 0.5, 0.0])?;
//! let a = SecondKind::new(&coupling, MultiVector::from_vec(2, 1, vec![1.0, 1.0])?)?;
//! let b = MultiVector::from_vec(2, 1, vec![1.0, 1.0])?;
//! let mut x = MultiVector::zeros(2, 1);
//! let stop = Stop { tolerance: 1e-12, max_iterations: 100 };
//! let report = CgTheta.solve(&a, &b, &mut x, &stop, &mut Quiet)?;
//! assert_eq!(report.reason, StopReason::Converged);
//! assert!((x.row(0)[0] - 2.0).abs() < 1e-11);
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```

use crate::core::{Conjugate, Identity, Metric, solve_by_steps};
use fredholm_linop::{Context, Halt, Iteration, MultiVector, Scalar, Scheme, SecondKind};

const NAME: &str = "cg-theta";

/// Conjugate gradients on Θ.
#[derive(Clone, Copy, Debug, Default)]
pub struct CgTheta;

solve_by_steps!(CgTheta);

impl<T: Scalar> Scheme<T> for CgTheta {
    fn name(&self) -> &'static str {
        NAME
    }

    fn description(&self) -> &'static str {
        "Conjugate gradients on the symmetrised system; fast for light, whatever the reflectance"
    }

    fn bytes(&self, dim: usize, rhs_count: usize) -> u64 {
        (6 * size_of::<T>() as u64).saturating_mul(dim as u64).saturating_mul(rhs_count as u64)
    }

    fn begin<'a>(
        &self,
        a: &'a SecondKind<'a, T>,
        b: &'a MultiVector<T>,
        _: &mut Context<'_>,
    ) -> Result<Box<dyn Iteration<T> + 'a>, Halt> {
        Ok(Box::new(Conjugate::new(NAME, (a, b), Metric::new(NAME, a)?, Identity)))
    }
}
