//! Dense LDLᵀ of the symmetric form, real or complex: P Θ Pᵀ = L D Lᵀ with the pivots of Bunch and
//! Kaufman, Θ = I − Δ^½ K Δ^½ with the factors Δ of the unknowns, then
//! x = Δ^½ Pᵀ L⁻ᵀ D⁻¹ L⁻¹ P Δ^(−½) b.
//!
//! Source: J. R. Bunch, L. Kaufman, Math. Comp. 31 (1977) 163, DOI 10.1090/S0025-5718-1977-0428694-0.
//!
//! Requires a coupling that is known to be symmetric, factors that are at least 0 where they are
//! real, and a matrix that is not singular to working precision: the smallest pivot must exceed n ε
//! times the largest. It need not be definite, which `cholesky` asks for.
//!
//! Cost: one factorisation (n³/3 real operations, 4n³/3 for complex entries) for each different
//! matrix, half of LU. Memory: n² entries. In the history, iteration k has k matrices factorised;
//! the observer can stop the solver before each, not within one.
//!
//! ```
//! use fredholm_direct::DenseLdlt;
//! use fredholm_linop::{MultiVector, PackedSymmetric, Quiet, SecondKind, Solver, Stop, StopReason};
//!
//! // x = b + K x with K = [0 ½; ½ 0] and b = (1, 1): x = (2, 2).
//! let coupling = PackedSymmetric::new(2, vec![0.0, 0.5, 0.0])?;
//! let a = SecondKind::new(&coupling, MultiVector::from_vec(2, 1, vec![1.0, 1.0])?)?;
//! let b = MultiVector::from_vec(2, 1, vec![1.0, 1.0])?;
//! let mut x = MultiVector::zeros(2, 1);
//! let stop = Stop { tolerance: 1e-12, max_iterations: 1 };
//! let report = DenseLdlt.solve(&a, &b, &mut x, &stop, &mut Quiet)?;
//! assert_eq!(report.reason, StopReason::Converged);
//! assert!((x.row(0)[0] - 2.0).abs() < 1e-14);
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```

use crate::buffers;
use crate::bunch_kaufman::PANEL;
use crate::groups::{Ended, Run, in_groups};
use crate::scalar::DenseScalar;
use crate::symmetric_form::SymmetricForm;
use fredholm_linop::{
    LinearOperator, MultiVector, Observer, Report, SecondKind, SolveError, Solver, Stop, Symmetry,
};

const NAME: &str = "ldlt";

/// Factorises a symmetric matrix, once for all right-hand sides that share it.
#[derive(Clone, Copy, Debug, Default)]
pub struct DenseLdlt;

impl<T: DenseScalar> Solver<T> for DenseLdlt {
    fn name(&self) -> &'static str {
        NAME
    }

    fn description(&self) -> &'static str {
        "Dense LDLᵀ of a symmetric matrix, definite or not: exact to rounding, half the time of lu, n² memory"
    }

    // The matrix and a panel, the right-hand sides with the product and the light of black unknowns,
    // the roots of the factors, the entries of D beside its diagonal and the exchanges.
    fn bytes(&self, dim: usize, rhs_count: usize) -> u64 {
        let (n, entry, index) = (dim as u64, size_of::<T>() as u64, size_of::<usize>() as u64);
        let vectors = (rhs_count as u64).saturating_mul(4).saturating_add(PANEL as u64 + 4);
        n.saturating_add(vectors)
            .saturating_mul(entry)
            .saturating_add(index)
            .saturating_mul(n)
            .saturating_add(buffers::touched(dim, size_of::<T>()))
    }

    fn addresses(&self) -> u64 {
        buffers::thread_addresses()
    }

    fn solve(
        &self,
        a: &SecondKind<'_, T>,
        b: &MultiVector<T>,
        x: &mut MultiVector<T>,
        stop: &Stop,
        observer: &mut dyn Observer<T>,
    ) -> Result<Report, SolveError> {
        check_symmetric(a)?;
        in_groups(a, b, x, stop, observer, solve_all)
    }
}

/// Refuses a coupling that is not known to be symmetric, and factors without a root.
fn check_symmetric<T: DenseScalar>(a: &SecondKind<'_, T>) -> Result<(), SolveError> {
    let refuse = |reason: String| Err(SolveError::Unsuitable { solver: NAME, reason });
    let symmetric = match a.coupling().symmetry() {
        Symmetry::General => false,
        Symmetry::Symmetric => true,
        Symmetry::Hermitian => T::IS_REAL,
    };
    if !symmetric {
        return refuse("it needs a coupling that is known to be symmetric; gmres and lu do without".into());
    }
    let factor = a.factor();
    let Some(at) = factor.as_slice().iter().position(|d| d.root().is_none()) else { return Ok(()) };
    let (i, rhs) = (at / factor.rhs_count(), at % factor.rhs_count());
    let found = factor.as_slice()[at];
    refuse(format!(
        "real factors have to be at least 0, but that of unknown {i} in right-hand side {rhs} is {found:?}; lu takes any"
    ))
}

fn solve_all<T: DenseScalar>(run: &mut Run<'_, '_, T>, group: &[usize]) -> Result<(), Ended> {
    let (n, rhs) = (run.a.dim(), group[0]);
    let form = SymmetricForm::new(run.a, rhs, |d: T| d.root().unwrap_or_default());
    let factors = T::factorise_ldlt(n, form.lower(run, rhs)?);
    if factors.is_singular() {
        return Err(SolveError::Singular { rhs }.into());
    }
    let mut z = form.right_hand_sides(run, group);
    T::substitute_ldlt(&factors, &mut z);
    form.take(run, group, z);
    Ok(())
}
