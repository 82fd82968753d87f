//! What is particular to dense LU: singular matrices, right-hand sides that share one, memory,
//! threads.

#![allow(clippy::float_cmp, clippy::needless_range_loop, clippy::unwrap_used)]

use fredholm_direct::{DenseLu, DenseScalar};
use fredholm_linop::{
    Dense, LinearOperator, LinopError, MultiVector, Observer, Progress, Quiet, Report, SecondKind,
    SolveError, Solver, Stop, StopReason,
};
use num_complex::Complex64;
use std::ops::ControlFlow;

const STOP: Stop = Stop { tolerance: 1e-12, max_iterations: 1 };

/// Entries in [−½, ½) without a pattern.
fn scattered(at: usize) -> f64 {
    ((at + 1) as f64 * 0.618_033_988_749_895).fract() - 0.5
}

fn solve<T: DenseScalar>(
    coupling: &dyn LinearOperator<T>,
    factor: MultiVector<T>,
    b: &MultiVector<T>,
    observer: &mut dyn Observer<T>,
) -> Result<(Report, MultiVector<T>), SolveError> {
    let a = SecondKind::new(coupling, factor)?;
    let mut x = MultiVector::zeros(b.dim(), b.rhs_count());
    DenseLu.solve(&a, b, &mut x, &STOP, observer).map(|report| (report, x))
}

fn ones(dim: usize, rhs_count: usize) -> MultiVector<f64> {
    MultiVector::from_fn(dim, rhs_count, |_, _| 1.0)
}

#[test]
fn singular_matrices_are_refused() {
    // A = 0, and a closed scene that reflects everything: A = I − F with Σ_j F_ij = 1.
    let unit = Dense::new(2, vec![1.0, 0.0, 0.0, 1.0]).unwrap();
    let refusal = solve(&unit, ones(2, 1), &ones(2, 1), &mut Quiet).unwrap_err();
    assert_eq!(refusal, SolveError::Singular { rhs: 0 });
    let n = 50;
    let mirror = |i: usize, j: usize| if i == j { 0.0 } else { 1.0 + scattered(i.max(j) * n + i.min(j)) };
    let sum = |i: usize| (0..n).map(|j| mirror(i, j)).sum::<f64>();
    let closed = Dense::new(n, (0..n * n).map(|at| mirror(at / n, at % n) / sum(at / n)).collect()).unwrap();
    let factor = MultiVector::from_fn(n, 2, |_, l| [0.99, 1.0][l]);
    let refusal = solve(&closed, factor, &ones(n, 2), &mut Quiet).unwrap_err();
    assert_eq!(refusal, SolveError::Singular { rhs: 1 });
}

#[test]
fn pivots_are_exchanged_where_the_diagonal_is_zero() {
    // A = [0 1 0; 0 0 1; 1 0 0], so x = (b_2, b_0, b_1).
    let coupling = Dense::new(3, vec![1.0, -1.0, 0.0, 0.0, 1.0, -1.0, -1.0, 0.0, 1.0]).unwrap();
    let b = MultiVector::from_vec(3, 1, vec![5.0, 6.0, 7.0]).unwrap();
    let (report, x) = solve(&coupling, ones(3, 1), &b, &mut Quiet).unwrap();
    assert_eq!((report.reason, x.as_slice()), (StopReason::Converged, &[7.0, 5.0, 6.0][..]));
}

#[test]
fn right_hand_sides_with_the_same_matrix_share_one_factorisation() {
    let n = 12;
    let coupling = Dense::new(n, (0..n * n).map(|at| scattered(at) / 12.0).collect()).unwrap();
    let b = MultiVector::from_fn(n, 4, |i, l| scattered(i * 4 + l));
    for (factors, count) in [([0.5; 4], 1), ([0.5, 0.7, 0.5, 0.7], 2), ([0.1, 0.2, 0.3, 0.4], 4)] {
        let factor = MultiVector::from_fn(n, 4, |_, l| factors[l]);
        let (report, x) = solve(&coupling, factor, &b, &mut Quiet).unwrap();
        assert_eq!((report.reason, report.history.len()), (StopReason::Converged, count + 1));
        assert_eq!(report.work.row_visits, (n * count) as u64);
        for l in 0..4 {
            let rest = |i: usize| (0..n).map(|j| coupling.get(i, j) * x.row(j)[l]).sum::<f64>();
            let worst = (0..n).map(|i| (x.row(i)[l] - factors[l] * rest(i) - b.row(i)[l]).abs());
            assert!(worst.fold(0.0, f64::max) < 1e-15);
        }
    }
}

#[test]
fn an_observer_stops_it_before_the_next_factorisation() {
    let coupling = Dense::new(2, vec![0.0, 0.5, 0.5, 0.0]).unwrap();
    let factor = MultiVector::from_vec(2, 2, vec![1.0, 0.5, 1.0, 0.5]).unwrap();
    let mut observer = |progress: &Progress<'_, f64>| match progress.record.iteration {
        1 => ControlFlow::Break(()),
        _ => ControlFlow::Continue(()),
    };
    let (report, x) = solve(&coupling, factor, &ones(2, 2), &mut observer).unwrap();
    assert_eq!(report.reason, StopReason::Interrupted);
    assert_eq!(x.vector(1), [0.0, 0.0]);
    assert!(x.vector(0).iter().all(|value| (value - 2.0).abs() < 1e-15));
}

fn bits_on<T: DenseScalar>(threads: usize, n: usize, draw: fn(usize) -> T) -> Vec<[u64; 2]> {
    let coupling = Dense::new(n, (0..n * n).map(draw).collect()).unwrap();
    let factor = MultiVector::from_fn(n, 1, |_, _| T::from_real(1.0 / n as f64));
    let b = MultiVector::from_fn(n, 1, |i, _| draw(i));
    let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
    let (_, x) = pool.install(|| solve(&coupling, factor, &b, &mut Quiet)).unwrap();
    let real = |z: T| (z + z.conj()).scale(0.5).abs().to_bits();
    x.as_slice().iter().map(|&z| [real(z), z.abs().to_bits()]).collect()
}

#[test]
fn the_number_of_threads_changes_no_bit() {
    let complex = |at| Complex64::new(scattered(at), scattered(at * at + 7));
    let (real_one, complex_one) = (bits_on(1, 700, scattered), bits_on(1, 350, complex));
    for threads in [2, 3, 4] {
        assert_eq!(bits_on(threads, 700, scattered), real_one);
        assert_eq!(bits_on(threads, 350, complex), complex_one);
    }
}

/// K = 0 of any size, without storage.
struct Nothing(usize);

impl LinearOperator<f64> for Nothing {
    fn dim(&self) -> usize {
        self.0
    }

    fn apply(&self, _: &MultiVector<f64>, y: &mut MultiVector<f64>) {
        y.fill(0.0);
    }
}

#[test]
fn a_matrix_beyond_all_memory_is_refused() {
    let n = 1 << 22;
    let refusal = solve(&Nothing(n), ones(n, 1), &ones(n, 1), &mut Quiet).unwrap_err();
    assert!(matches!(refusal, SolveError::Linop(LinopError::Memory { bytes, .. }) if bytes == 1 << 47));
}

#[test]
fn memory_is_predicted_without_overflow() {
    let bytes = |n, rhs_count| Solver::<Complex64>::bytes(&DenseLu, n, rhs_count);
    // Matrix, vectors, permutation, and what products pack: 512 rows of entries at a time.
    let known = 16_000_000 + 3 * 16_000 + 3 * 8_000 + 512 * 16_000;
    // The scratch of the factorisation is small beside the matrix.
    assert!(bytes(1000, 1) > known && bytes(1000, 1) < known + known / 10);
    assert_eq!(bytes(usize::MAX, 3), u64::MAX);
}
