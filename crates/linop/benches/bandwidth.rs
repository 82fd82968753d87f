//! The products of 1, 3 and 8 bands beside a plain copy of the same memory, taken in turns so that
//! other load hits all alike.
//!
//! `cargo bench -p fredholm-linop --bench bandwidth`. The best of the rounds is shown: GB/s of
//! stored entries, of a copy GB/s read and written, and times relative to that of one band.

use fredholm_linop::{LinearOperator, MultiVector, PackedSymmetric, Storage, Sweep};
use rayon::prelude::*;
use std::ops::ControlFlow;
use std::time::Instant;

const DIM: usize = 8544;
const ROUNDS: usize = 40;

/// One thing to be measured.
struct Trial<'a> {
    name: String,
    bytes: f64,
    best: f64,
    run: Box<dyn FnMut() + 'a>,
}

impl<'a> Trial<'a> {
    fn new(name: impl Into<String>, bytes: u64, run: impl FnMut() + 'a) -> Self {
        Self { name: name.into(), bytes: bytes as f64, best: f64::INFINITY, run: Box::new(run) }
    }

    fn round(&mut self) {
        let start = Instant::now();
        (self.run)();
        self.best = self.best.min(start.elapsed().as_secs_f64());
    }
}

fn copy<S: Storage>(from: &[S], to: &mut [S]) {
    let parts = to.par_chunks_mut(1 << 17).zip(from.par_chunks(1 << 17));
    parts.for_each(|(to, from)| to.copy_from_slice(from));
}

fn measure<S: Storage>(storage: &str) -> Option<()> {
    let data: Vec<S> = (0..DIM * (DIM + 1) / 2).map(|at| S::from_f64((at % 1021) as f64 / 1021.0)).collect();
    let (from, mut to) = (data.clone(), data.clone());
    let matrix = PackedSymmetric::new(DIM, data).ok()?;
    let bytes = PackedSymmetric::<S>::bytes(DIM);
    let mut trials = vec![Trial::new("copy", 2 * bytes, || copy(&from, &mut to))];
    for rhs_count in [1, 3, 8] {
        let x = MultiVector::from_fn(DIM, rhs_count, |i, l| (i + l) as f64);
        let mut y = MultiVector::zeros(DIM, rhs_count);
        let matrix = &matrix;
        trials.push(Trial::new(format!("apply {rhs_count}"), bytes, move || matrix.apply(&x, &mut y)));
    }
    for rhs_count in [1, 3, 8] {
        let mut x = MultiVector::from_fn(DIM, rhs_count, |i, l| (i + l) as f64);
        let mut sweep = Sweep::new(DIM, rhs_count);
        let matrix = &matrix;
        trials.push(Trial::new(format!("sweep {rhs_count}"), bytes, move || {
            let _ = matrix.sweep(&mut x, &mut sweep, &mut |_| ControlFlow::Continue(()));
        }));
    }
    (0..ROUNDS).for_each(|_| trials.iter_mut().for_each(Trial::round));
    let copied = trials[0].bytes / trials[0].best;
    for trial in &trials {
        let (name, rate) = (&trial.name, trial.bytes / trial.best);
        let one =
            trials.iter().find(|one| one.name.split(' ').eq([name.split(' ').next().unwrap_or(""), "1"]));
        let relative = one.map_or(1.0, |one| trial.best / one.best);
        println!(
            "{storage} {name:8} {:7.2} ms {:6.1} GB/s {:5.0} % of a copy, {relative:.2} × one band",
            1e3 * trial.best,
            rate / 1e9,
            100.0 * rate / copied
        );
    }
    Some(())
}

fn main() {
    let _ = measure::<f64>("f64");
    let _ = measure::<f32>("f32");
}
