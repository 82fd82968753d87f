//! Dense LU: A = L U by Gaussian elimination with partial pivoting, then x = U⁻¹ L⁻¹ b.
//!
//! Source: G. H. Golub, C. F. Van Loan, Matrix Computations, 4th ed., Johns Hopkins University
//! Press 2013, § 3.4.
//!
//! Requires a matrix that is not singular to working precision: the smallest pivot must exceed n ε
//! times the largest.
//!
//! Cost: one factorisation (2n³/3 real operations, 8n³/3 for complex entries) for each different
//! matrix, so one for all the right-hand sides that have the same. Memory: n² entries. The starting
//! guess does not matter, except that nothing is done if it meets the tolerance. In the history,
//! iteration k has k matrices factorised; the observer can stop the solver before each, not within
//! one.
//!
//! ```
//! use fredholm_direct::DenseLu;
//! use fredholm_linop::{Dense, MultiVector, Quiet, SecondKind, Solver, Stop, StopReason};
//!
//! // x = b + K x with K = [0 ½; ½ 0] and b = (1, 1): x = (2, 2).
//! let coupling = Dense::new(2, vec![0.0, 0.5, 0.5, 0.0])?;
//! let a = SecondKind::new(&coupling, MultiVector::from_vec(2, 1, vec![1.0, 1.0])?)?;
//! let b = MultiVector::from_vec(2, 1, vec![1.0, 1.0])?;
//! let mut x = MultiVector::zeros(2, 1);
//! let stop = Stop { tolerance: 1e-12, max_iterations: 1 };
//! let report = DenseLu.solve(&a, &b, &mut x, &stop, &mut Quiet)?;
//! assert_eq!(report.reason, StopReason::Converged);
//! assert!((x.row(0)[0] - 2.0).abs() < 1e-14);
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```

use crate::buffers;
use crate::factorisation::{Factorisation, scratch_bytes};
use crate::groups::{Ended, Run, columns, in_groups};
use crate::scalar::DenseScalar;
use fredholm_linop::{
    LinearOperator, MultiVector, Observer, Report, Scalar, SecondKind, SolveError, Solver, Stop,
};

/// Factorises the matrix, once for all right-hand sides that share it.
#[derive(Clone, Copy, Debug, Default)]
pub struct DenseLu;

impl<T: DenseScalar> Solver<T> for DenseLu {
    fn name(&self) -> &'static str {
        "lu"
    }

    fn description(&self) -> &'static str {
        "Dense LU with partial pivoting: exact to rounding, n² memory and n³ time; for up to some thousand unknowns"
    }

    // The matrix with the scratch of its factorisation, the right-hand sides with their scratch and
    // the product, and three permutations.
    fn bytes(&self, dim: usize, rhs_count: usize) -> u64 {
        let (n, entry, index) = (dim as u64, size_of::<T>() as u64, size_of::<usize>() as u64);
        let vectors = (rhs_count as u64).saturating_mul(3 * entry).saturating_add(3 * index);
        n.saturating_mul(entry)
            .saturating_add(vectors)
            .saturating_mul(n)
            .saturating_add(scratch_bytes::<T>(dim))
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
        in_groups(a, b, x, stop, observer, solve_all)
    }
}

fn solve_all<T: DenseScalar>(run: &mut Run<'_, '_, T>, group: &[usize]) -> Result<(), Ended> {
    let matrix = run.a.dense(group[0])?;
    run.work.row_visits += run.a.dim() as u64;
    run.work.entries_touched += run.a.entries();
    let factorisation = Factorisation::new(matrix.dim(), matrix.into_vec())?;
    if factorisation.is_singular(f64::EPSILON, Scalar::abs) {
        return Err(SolveError::Singular { rhs: group[0] }.into());
    }
    let mut solutions = columns(run.b, group);
    factorisation.solve(&mut solutions)?;
    for (&rhs, solution) in group.iter().zip(solutions.chunks_exact(run.a.dim())) {
        run.x.set_vector(rhs, solution);
    }
    Ok(())
}
