//! Direct solvers beside calling faer on the same matrix, taken in turns so that other load hits
//! all alike: a real system like those of light, and a complex symmetric one like those of boundary
//! elements.
//!
//! `cargo bench -p fredholm-direct`. Shown are the best of the rounds in seconds, and what the
//! solver takes relative to another. The solver also turns the operator into a matrix, applies it
//! twice and checks the pivots.

use faer::linalg::solvers::Solve;
use faer::{Mat, Side};
use fredholm_direct::{Cholesky, DenseLdlt, DenseLu, DenseScalar, MixedLu};
use fredholm_linop::{
    Dense, LinearOperator, MultiVector, PackedSymmetric, Quiet, SecondKind, Solver, Stop, Symmetry,
};
use num_complex::Complex64;
use std::time::Instant;

const REAL_DIM: usize = 2500;
const REAL_ROUNDS: usize = 6;
/// That of a plate of 5 wavelengths with edges of a tenth.
const COMPLEX_DIM: usize = 4900;
const COMPLEX_ROUNDS: usize = 2;

fn timed(best: &mut f64, run: impl FnOnce()) {
    let start = Instant::now();
    run();
    *best = best.min(start.elapsed().as_secs_f64());
}

fn solve<T: DenseScalar>(solver: &dyn Solver<T>, a: &SecondKind<'_, T>, b: &MultiVector<T>) {
    let stop = Stop { tolerance: 1e-12, max_iterations: 1 };
    let _ = solver.solve(a, b, &mut MultiVector::zeros(b.dim(), 1), &stop, &mut Quiet);
}

fn real() -> Option<()> {
    let entry = |at: usize| ((at * 7919 % 1021) as f64 / 1021.0).powi(3);
    let packed = (0..REAL_DIM * (REAL_DIM + 1) / 2).map(entry).collect();
    let coupling = PackedSymmetric::<f64>::new(REAL_DIM, packed).ok()?;
    let areas = coupling.row_sums();
    let a = SecondKind::new(&coupling, MultiVector::from_fn(REAL_DIM, 1, |i, _| 0.7 / areas[i])).ok()?;
    let dense = a.dense(0).ok()?;
    let general = Mat::from_fn(REAL_DIM, REAL_DIM, |i, j| dense.get(i, j));
    let root = |i: usize| (0.7 / areas[i]).sqrt();
    let theta = |i: usize, j: usize| f64::from(u8::from(i == j)) - root(i) * coupling.get(i, j) * root(j);
    let symmetric = Mat::from_fn(REAL_DIM, REAL_DIM, theta);
    let b = MultiVector::from_fn(REAL_DIM, 1, |i, _| (i % 7) as f64 + 1.0);
    let right = Mat::from_fn(REAL_DIM, 1, |i, _| b.row(i)[0]);
    let [mut lu, mut plain_lu, mut cholesky, mut plain_cholesky, mut mixed, mut ldlt] = [f64::INFINITY; 6];
    for _ in 0..REAL_ROUNDS {
        timed(&mut plain_lu, || drop(general.partial_piv_lu().solve(&right)));
        timed(&mut lu, || solve(&DenseLu, &a, &b));
        timed(&mut plain_cholesky, || drop(symmetric.llt(Side::Lower).map(|llt| llt.solve(&right))));
        timed(&mut cholesky, || solve(&Cholesky, &a, &b));
        timed(&mut mixed, || solve(&MixedLu, &a, &b));
        timed(&mut ldlt, || solve(&DenseLdlt, &a, &b));
    }
    println!("real, n = {REAL_DIM}");
    println!("lu        {lu:.3} s, faer {plain_lu:.3} s: {:.2}", lu / plain_lu);
    println!("cholesky  {cholesky:.3} s, faer {plain_cholesky:.3} s: {:.2}", cholesky / plain_cholesky);
    println!("lu-mixed  {mixed:.3} s: {:.2} of lu", mixed / lu);
    println!("ldlt      {ldlt:.3} s: {:.2} of lu", ldlt / lu);
    Some(())
}

/// K_ij = −½ e^{−0.3j d}/(1 + d)^½ with d = |i − j|, so that I − K is symmetric and not Hermitian.
fn complex() -> Option<()> {
    let entry = |at: usize| {
        let distance = (at / COMPLEX_DIM).abs_diff(at % COMPLEX_DIM) as f64;
        Complex64::from_polar(-0.5 / (1.0 + distance).sqrt(), -0.3 * distance)
    };
    let entries = (0..COMPLEX_DIM * COMPLEX_DIM).map(entry).collect();
    let coupling = Dense::new(COMPLEX_DIM, entries).ok()?.with_symmetry(Symmetry::Symmetric).ok()?;
    let a = SecondKind::new(&coupling, MultiVector::from_fn(COMPLEX_DIM, 1, |_, _| Complex64::ONE)).ok()?;
    let b = MultiVector::from_fn(COMPLEX_DIM, 1, |i, _| Complex64::new((i % 7) as f64 + 1.0, 0.0));
    let [mut lu, mut mixed, mut ldlt] = [f64::INFINITY; 3];
    for _ in 0..COMPLEX_ROUNDS {
        timed(&mut lu, || solve(&DenseLu, &a, &b));
        timed(&mut mixed, || solve(&MixedLu, &a, &b));
        timed(&mut ldlt, || solve(&DenseLdlt, &a, &b));
    }
    println!("complex symmetric, n = {COMPLEX_DIM}");
    println!("lu        {lu:.3} s");
    println!("lu-mixed  {mixed:.3} s: {:.2} of lu", mixed / lu);
    println!("ldlt      {ldlt:.3} s: {:.2} of lu", ldlt / lu);
    Some(())
}

fn main() {
    if real().and_then(|()| complex()).is_none() {
        println!("a system could not be made");
    }
}
