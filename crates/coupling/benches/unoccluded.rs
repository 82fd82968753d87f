//! Exchanges of all pairs of the unit cube with 24 × 24 patches a wall.
//!
//! `cargo bench -p fredholm-coupling --bench unoccluded`; the CPU seconds are printed first,
//! criterion measures wall time.

#![allow(clippy::unwrap_used, missing_docs)]

use criterion::{Criterion, criterion_group, criterion_main};
use fredholm_coupling::form_factor::{Exchange, Unoccluded, Work};
use fredholm_mesh::{Patch, Vec3};
use std::hint::black_box;

/// The unit cube, each wall n × n patches that face inwards.
fn cube(n: usize) -> Vec<Patch> {
    let at = |k: usize| k as f64 / n as f64;
    let wall = |axis: usize, high: bool| {
        let put = move |u: f64, v: f64| {
            let mut x = [0.0; 3];
            (x[axis], x[(axis + 1) % 3], x[(axis + 2) % 3]) = (f64::from(high), u, v);
            Vec3::from(x)
        };
        let cell = move |k: usize| {
            let (u, v) = ([at(k / n), at(k / n + 1)], [at(k % n), at(k % n + 1)]);
            let [a, b, c, d] = [put(u[0], v[0]), put(u[1], v[0]), put(u[1], v[1]), put(u[0], v[1])];
            Patch::quad(if high { [a, d, c, b] } else { [a, b, c, d] }).unwrap().unwrap()
        };
        (0..n * n).map(cell)
    };
    (0..6).flat_map(|k| wall(k / 2, k % 2 == 1)).collect()
}

/// All pairs; the largest defect of a row sum of F.
fn closure(patches: &[Patch], tolerance: f64) -> f64 {
    let list: Vec<&Patch> = patches.iter().collect();
    let exchanges = Unoccluded::new(&list, tolerance);
    let (mut work, mut sums) = (Work::default(), vec![0.0; patches.len()]);
    let js: Vec<u32> = (0..patches.len() as u32).collect();
    let mut row = vec![Exchange::NONE; patches.len()];
    for i in 0..patches.len() {
        exchanges.row(i, &js[..i], &mut work, &mut row);
        for (j, exchange) in row[..i].iter().enumerate() {
            sums[i] += exchange.value;
            sums[j] += exchange.value;
        }
    }
    let defect = |(sum, patch): (f64, &Patch)| (sum / patch.area() - 1.0).abs();
    sums.into_iter().zip(patches).map(defect).fold(0.0, f64::max)
}

/// CPU seconds of this process, where the system tells them (Linux).
fn cpu() -> Option<f64> {
    let stat = std::fs::read_to_string("/proc/self/schedstat").ok()?;
    Some(stat.split(' ').next()?.parse::<f64>().ok()? * 1e-9)
}

fn cube24(c: &mut Criterion) {
    let patches = cube(24);
    let mut group = c.benchmark_group("unit cube, 6 x 24 x 24 patches");
    group.sample_size(10);
    for (tolerance, goal) in [(1e-6, 1e-6), (1e-12, 1e-12)] {
        let start = cpu();
        let defect = closure(&patches, tolerance);
        let spent = cpu().zip(start).map(|(end, start)| end - start);
        println!("T = {tolerance:e}: {spent:.3?} CPU s, row sums within {defect:.1e}");
        assert!(defect < goal, "row sums off by {defect:e}");
        group.bench_function(format!("T = {tolerance:e}, row sums within {defect:.1e}"), |b| {
            b.iter(|| black_box(closure(&patches, tolerance)));
        });
    }
}

criterion_group!(benches, cube24);
criterion_main!(benches);
