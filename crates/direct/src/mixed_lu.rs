//! LU in mixed precision: A ≈ L U in single precision, then x += U⁻¹ L⁻¹ (b − A x) in double until
//! nothing is gained.
//!
//! Source: N. J. Higham, Accuracy and Stability of Numerical Algorithms, 2nd ed., SIAM 2002, § 12,
//! DOI 10.1137/1.9780898718027; A. Buttari et al., International Journal of High Performance
//! Computing Applications 21, 2007, DOI 10.1177/1094342007084026.
//!
//! Requires a matrix that is not singular to single precision: condition below about 10⁶. A step
//! that does not halve the residual is the last.
//!
//! Cost: one factorisation in single precision for each different matrix, and one application and
//! 2n² operations a step; a step gains about seven digits less those of the condition. Memory: n²
//! entries of half the size. In the history every step is an iteration.
//!
//! ```
//! use fredholm_direct::MixedLu;
//! use fredholm_linop::{MultiVector, PackedSymmetric, Quiet, SecondKind, Solver, Stop, StopReason};
//!
//! // x = b + K x with K = [0 ½; ½ 0] and b = (1, 1): x = (2, 2).
//! let coupling = PackedSymmetric::new(2, vec![0.0, 0.5, 0.0])?;
//! let a = SecondKind::new(&coupling, MultiVector::from_vec(2, 1, vec![1.0, 1.0])?)?;
//! let b = MultiVector::from_vec(2, 1, vec![1.0, 1.0])?;
//! let mut x = MultiVector::zeros(2, 1);
//! let stop = Stop { tolerance: 1e-12, max_iterations: 1 };
//! let report = MixedLu.solve(&a, &b, &mut x, &stop, &mut Quiet)?;
//! assert_eq!(report.reason, StopReason::Converged);
//! assert!((x.row(0)[0] - 2.0).abs() < 1e-14);
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```

use crate::buffers;
use crate::factorisation::{Factorisation, scratch_bytes};
use crate::groups::{Ended, Run, columns, in_groups};
use crate::scalar::DenseScalar;
use fredholm_linop::{
    LinearOperator, LinopError, MultiVector, Observer, Report, Scalar, SecondKind, SolveError, Solver, Stop,
};

const NAME: &str = "lu-mixed";
/// Most steps for a matrix.
const STEPS: usize = 50;

/// Factorises in single precision, refines in double.
#[derive(Clone, Copy, Debug, Default)]
pub struct MixedLu;

impl<T: DenseScalar> Solver<T> for MixedLu {
    fn name(&self) -> &'static str {
        NAME
    }

    fn description(&self) -> &'static str {
        "Dense LU in single precision, refined in double: half the memory and time of lu"
    }

    // The matrix in single precision with its scratch, residuals, steps and product, a row and
    // three permutations.
    fn bytes(&self, dim: usize, rhs_count: usize) -> u64 {
        let (n, entry, index) = (dim as u64, size_of::<T>() as u64, size_of::<usize>() as u64);
        let vectors = (rhs_count as u64).saturating_mul(4).saturating_add(1).saturating_mul(entry);
        let line = n.saturating_mul(entry / 2).saturating_add(vectors).saturating_add(3 * index);
        line.saturating_mul(n)
            .saturating_add(scratch_bytes::<T::Low>(dim))
            .saturating_add(buffers::touched(dim, size_of::<T::Low>()))
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
        in_groups(a, b, x, stop, observer, |run, group| solve_all(run, group, stop.tolerance))
    }
}

fn solve_all<T: DenseScalar>(run: &mut Run<'_, '_, T>, group: &[usize], tolerance: f64) -> Result<(), Ended> {
    let matrix = read(run.a, group[0])?;
    run.work.row_visits += run.a.dim() as u64;
    run.work.entries_touched += run.a.entries();
    let factorisation = Factorisation::new(run.a.dim(), matrix)?;
    if factorisation.is_singular(f32::EPSILON.into(), |pivot| T::raise(pivot).abs()) {
        return Err(SolveError::Singular { rhs: group[0] }.into());
    }
    let mut last = f64::INFINITY;
    for _ in 0..STEPS {
        let (residuals, worst) = scaled_residuals(run, group);
        if worst <= tolerance || worst > 0.5 * last {
            break;
        }
        last = worst;
        step(run, &factorisation, group, &residuals)?;
        run.record()?;
    }
    Ok(())
}

/// x += s, from residuals that are scaled to be no smaller than single precision can hold.
fn step<T: DenseScalar>(
    run: &mut Run<'_, '_, T>,
    factorisation: &Factorisation<T::Low>,
    group: &[usize],
    residuals: &[(f64, Vec<T>)],
) -> Result<(), Ended> {
    let n = run.a.dim();
    let mut steps: Vec<T::Low> = residuals.iter().flat_map(|(_, r)| r.iter().map(|&r| r.lower())).collect();
    factorisation.solve(&mut steps)?;
    for ((&rhs, (norm, _)), steps) in group.iter().zip(residuals).zip(steps.chunks_exact(n)) {
        let old = run.x.vector(rhs);
        let new: Vec<T> = old.iter().zip(steps).map(|(&x, &s)| x + T::raise(s).scale(*norm)).collect();
        run.x.set_vector(rhs, &new);
    }
    Ok(())
}

/// ‖r‖₂ and r/‖r‖₂ of the right-hand sides, and the largest ‖r‖₂/‖b‖₂.
fn scaled_residuals<T: Scalar>(run: &Run<'_, '_, T>, group: &[usize]) -> (Vec<(f64, Vec<T>)>, f64) {
    let mut residual = run.b.clone();
    residual.set_difference(run.b, &run.product);
    let (norms, scales) = (residual.norms(), run.b.norms());
    let n = residual.dim();
    let inverse = |norm: f64| if norm > 0.0 { norm.recip() } else { 0.0 };
    let all = columns(&residual, group);
    let scaled = group
        .iter()
        .zip(all.chunks_exact(n))
        .map(|(&rhs, r)| (norms[rhs], r.iter().map(|&r| r.scale(inverse(norms[rhs]))).collect()));
    (scaled.collect(), group.iter().map(|&rhs| norms[rhs] / scales[rhs]).fold(0.0, f64::max))
}

/// A of a right-hand side in single precision, row by row.
fn read<T: DenseScalar>(a: &SecondKind<'_, T>, rhs: usize) -> Result<Vec<T::Low>, LinopError> {
    let n = a.dim();
    let bytes = (n as u64).saturating_mul(n as u64).saturating_mul(size_of::<T::Low>() as u64);
    let refused = LinopError::Memory { what: "a matrix in single precision", bytes };
    let count = n.checked_mul(n).ok_or_else(|| refused.clone())?;
    let mut matrix = Vec::new();
    matrix.try_reserve_exact(count).map_err(|_| refused)?;
    let mut row = vec![T::zero(); n];
    for i in 0..n {
        a.row(i, rhs, &mut row);
        matrix.extend(row.iter().map(|&entry| entry.lower()));
    }
    Ok(matrix)
}
