//! The product and the sweep of a packed symmetric matrix beside a plain read and a plain copy of
//! the same memory.
//!
//! `cargo bench -p fredholm-linop`. Throughput is in bytes of stored entries; of a copy, in bytes
//! read and written.

use criterion::{BenchmarkId, Criterion, SamplingMode, Throughput, criterion_group, criterion_main};
use fredholm_linop::{LinearOperator, MultiVector, PackedSymmetric, Storage, Sweep};
use rayon::prelude::*;
use std::hint::black_box;
use std::ops::ControlFlow;

/// Rows: 292 MB in f64.
const DIM: usize = 8544;

fn entries<S: Storage>() -> Vec<S> {
    (0..DIM * (DIM + 1) / 2).map(|at| S::from_f64((at % 1021) as f64 / 1021.0)).collect()
}

/// Sums in eight parts, so that memory and not the latency of an addition is the limit.
fn read<S: Storage>(data: &[S]) -> f64 {
    let sum = |block: &[S]| {
        let mut parts = [0.0; 8];
        for eight in block.as_chunks::<8>().0 {
            parts.iter_mut().zip(eight).for_each(|(part, entry)| *part += entry.to_f64());
        }
        parts.iter().sum::<f64>()
    };
    data.par_chunks(1 << 17).map(sum).sum()
}

fn copy<S: Storage>(from: &[S], to: &mut [S]) {
    let parts = to.par_chunks_mut(1 << 17).zip(from.par_chunks(1 << 17));
    parts.for_each(|(to, from)| to.copy_from_slice(from));
}

fn measure<S: Storage>(c: &mut Criterion, storage: &str) {
    let data = entries::<S>();
    let mut group = c.benchmark_group(format!("packed {storage}"));
    group.throughput(Throughput::Bytes(PackedSymmetric::<S>::bytes(DIM)));
    group.sample_size(10).sampling_mode(SamplingMode::Flat);
    group.bench_function("read", |bench| bench.iter(|| read(black_box(&data))));
    let mut copied = data.clone();
    group.throughput(Throughput::Bytes(2 * PackedSymmetric::<S>::bytes(DIM)));
    group.bench_function("copy", |bench| bench.iter(|| copy(black_box(&data), &mut copied)));
    drop(copied);
    group.throughput(Throughput::Bytes(PackedSymmetric::<S>::bytes(DIM)));
    let Ok(matrix) = PackedSymmetric::new(DIM, data) else { return };
    for rhs_count in [1, 3, 8] {
        let mut x = MultiVector::from_fn(DIM, rhs_count, |i, l| (i + l) as f64);
        let mut y = MultiVector::zeros(DIM, rhs_count);
        group.bench_function(BenchmarkId::new("apply", rhs_count), |bench| {
            bench.iter(|| matrix.apply(&x, &mut y));
        });
        let mut sweep = Sweep::new(DIM, rhs_count);
        group.bench_function(BenchmarkId::new("sweep", rhs_count), |bench| {
            bench.iter(|| matrix.sweep(&mut x, &mut sweep, &mut |_| ControlFlow::Continue(())));
        });
    }
}

fn packed(c: &mut Criterion) {
    measure::<f64>(c, "f64");
    measure::<f32>(c, "f32");
}

criterion_group!(benches, packed);
criterion_main!(benches);
