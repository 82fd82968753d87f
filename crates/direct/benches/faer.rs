//! LU and Cholesky through the solvers beside calling faer on the same matrix, taken in turns so
//! that other load hits all alike.
//!
//! `cargo bench -p fredholm-direct`. Shown are the best of the rounds in seconds, and what the
//! solver takes relative to faer. The solver also turns the operator into a matrix, applies it
//! twice and checks the pivots.

use faer::linalg::solvers::Solve;
use faer::{Mat, Side};
use fredholm_direct::{Cholesky, DenseLu, MixedLu};
use fredholm_linop::{LinearOperator, MultiVector, PackedSymmetric, Quiet, SecondKind, Solver, Stop};
use std::time::Instant;

const DIM: usize = 2500;
const ROUNDS: usize = 6;

fn timed(best: &mut f64, run: impl FnOnce()) {
    let start = Instant::now();
    run();
    *best = best.min(start.elapsed().as_secs_f64());
}

fn main() {
    let entry = |at: usize| ((at * 7919 % 1021) as f64 / 1021.0).powi(3);
    let packed = (0..DIM * (DIM + 1) / 2).map(entry).collect();
    let Ok(coupling) = PackedSymmetric::<f64>::new(DIM, packed) else { return };
    let areas = coupling.row_sums();
    let factor = MultiVector::from_fn(DIM, 1, |i, _| 0.7 / areas[i]);
    let Ok(a) = SecondKind::new(&coupling, factor) else { return };
    let Ok(dense) = a.dense(0) else { return };
    let general = Mat::from_fn(DIM, DIM, |i, j| dense.get(i, j));
    let root = |i: usize| (0.7 / areas[i]).sqrt();
    let theta = |i: usize, j: usize| f64::from(u8::from(i == j)) - root(i) * coupling.get(i, j) * root(j);
    let symmetric = Mat::from_fn(DIM, DIM, theta);
    let b = MultiVector::from_fn(DIM, 1, |i, _| (i % 7) as f64 + 1.0);
    let right = Mat::from_fn(DIM, 1, |i, _| b.row(i)[0]);
    let stop = Stop { tolerance: 1e-12, max_iterations: 1 };
    let solve = |solver: &dyn Solver<f64>| {
        let _ = solver.solve(&a, &b, &mut MultiVector::zeros(DIM, 1), &stop, &mut Quiet);
    };
    let [mut lu, mut plain_lu, mut cholesky, mut plain_cholesky, mut mixed] = [f64::INFINITY; 5];
    for _ in 0..ROUNDS {
        timed(&mut plain_lu, || drop(general.partial_piv_lu().solve(&right)));
        timed(&mut lu, || solve(&DenseLu));
        timed(&mut plain_cholesky, || drop(symmetric.llt(Side::Lower).map(|llt| llt.solve(&right))));
        timed(&mut cholesky, || solve(&Cholesky));
        timed(&mut mixed, || solve(&MixedLu));
    }
    println!("n = {DIM}");
    println!("lu        {lu:.3} s, faer {plain_lu:.3} s: {:.2}", lu / plain_lu);
    println!("cholesky  {cholesky:.3} s, faer {plain_cholesky:.3} s: {:.2}", cholesky / plain_cholesky);
    println!("lu-mixed  {mixed:.3} s: {:.2} of lu", mixed / lu);
}
