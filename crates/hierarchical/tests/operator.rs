//! The operator of the links: symmetric, closed, and equal to a dense matrix where the links are
//! fine.

#![allow(clippy::unwrap_used, reason = "a test that cannot run should panic, in its helpers too")]

mod common;
#[path = "common/objects.rs"]
mod objects;
#[path = "common/shapes.rs"]
mod shapes;

use common::{Bench, room};
use fredholm_coupling::form_factor::{PairIntegrator, Workspace};
use fredholm_linop::{LinearOperator, MultiVector, Symmetry};

/// Numbers that follow no pattern.
fn noise(n: usize, seed: u64) -> MultiVector<f64> {
    let mut state = seed;
    MultiVector::from_fn(n, 1, |_, _| {
        state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        (state >> 33) as f64 / f64::from(1 << 30) - 1.0
    })
}

#[test]
fn the_operator_is_symmetric_and_linear() {
    let bench = Bench::text(&room(0.5));
    let solution = bench.solve(0.02);
    let operator = solution.operator();
    let n = operator.dim();
    assert!(n > 30 && operator.symmetry() == Symmetry::Symmetric);
    let (x, y) = (noise(n, 1), noise(n, 2));
    let (mut gx, mut gy) = (MultiVector::zeros(n, 1), MultiVector::zeros(n, 1));
    operator.apply(&x, &mut gx);
    operator.apply(&y, &mut gy);
    let (one, other) = (y.dots(&gx)[0], x.dots(&gy)[0]);
    assert!((one - other).abs() < 1e-12 * gx.norms()[0] * y.norms()[0], "{one} {other}");
    let mut column = vec![0.0; n];
    operator.column(3, 0, &mut column);
    let mut row = vec![0.0; n];
    operator.row(3, 0, &mut row);
    assert!(row == column && column[3] == 0.0);
}

#[test]
fn several_bands_are_several_single_ones() {
    let bench = Bench::text(&room(0.5));
    let solution = bench.solve(0.05);
    let operator = solution.operator();
    let n = operator.dim();
    let (first, second) = (noise(n, 5), noise(n, 6));
    let both = MultiVector::from_fn(n, 2, |i, l| if l == 0 { first.row(i)[0] } else { second.row(i)[0] });
    let mut image = MultiVector::zeros(n, 2);
    operator.apply(&both, &mut image);
    for (rhs, x) in [first, second].iter().enumerate() {
        let mut single = MultiVector::zeros(n, 1);
        operator.apply(x, &mut single);
        assert_eq!(single.vector(0), image.vector(rhs));
    }
}

#[test]
fn faces_exchange_what_a_dense_matrix_says() {
    // The block alone is bright: where all radiosities are the same, any links would do.
    let lamp = "name = \"block\"\nmaterial = \"lamp\"";
    let text = room(0.5)
        .replace("exitance = 1\n", "exitance = 1\n[materials.lamp]\nreflectance = 0.5\nexitance = 9\n")
        .replace("name = \"block\"\nmaterial = \"wall\"", lamp);
    let bench = Bench::text(&text);
    let solution = bench.solve(0.005);
    let operator = solution.operator();
    let root = |i: usize| solution.tree.nodes()[operator.leaves()[i] as usize].root().unwrap();
    let integrator = PairIntegrator::new(bench.mesh.patches(), &bench.occluders, 1e-4);
    let (n, faces) = (operator.dim(), bench.mesh.len());
    let mut worst: f64 = 0.0;
    for from in [0, 7, faces - 1] {
        let unit = MultiVector::from_fn(n, 1, |i, _| if root(i) == from { 1.0 } else { 0.0 });
        let mut power = MultiVector::zeros(n, 1);
        operator.apply(&unit, &mut power);
        let mut found = vec![0.0; faces];
        (0..n).for_each(|i| found[root(i)] += power.row(i)[0]);
        let area = bench.mesh.patch(from).area();
        for (to, found) in found.into_iter().enumerate() {
            let exact = integrator.exchange(from, to, &mut Workspace::default()).value;
            worst = worst.max((found - exact).abs() / area);
        }
    }
    assert!(worst < 5e-3, "{worst:e}");
}

#[test]
fn a_closed_room_is_closed() {
    let bench = Bench::text(&room(0.5));
    let solution = bench.solve(0.01);
    let area: f64 = solution.system.elements().iter().map(|size| size.area).sum();
    let sums = solution.closure.iter().zip(solution.system.elements());
    let mean = sums.map(|(sum, size)| size.area * (sum - 1.0)).sum::<f64>() / area;
    assert!(mean.abs() < 5e-3, "{mean:e}");
}

#[test]
fn bent_clusters_keep_the_operator_symmetric_and_its_diagonal_true() {
    let solution = objects::bench("bowl", 800).solve(0.1);
    assert!(solution.links.iter().any(|link| link.a == link.b && link.exchange() > 0.0));
    let operator = solution.operator();
    let n = operator.dim();
    let (x, y) = (noise(n, 3), noise(n, 4));
    let (mut gx, mut gy) = (MultiVector::zeros(n, 1), MultiVector::zeros(n, 1));
    operator.apply(&x, &mut gx);
    operator.apply(&y, &mut gy);
    let (one, other) = (y.dots(&gx)[0], x.dots(&gy)[0]);
    assert!((one - other).abs() < 1e-12 * gx.norms()[0] * y.norms()[0], "{one} {other}");
    let (mut column, mut diagonal) = (vec![0.0; n], vec![0.0; n]);
    operator.diagonal(0, &mut diagonal);
    assert!(diagonal.iter().any(|&own| own > 0.0));
    for i in (0..n).step_by(37) {
        operator.column(i, 0, &mut column);
        assert!((column[i] - diagonal[i]).abs() <= 1e-12 * diagonal[i], "{i}: {} {}", column[i], diagonal[i]);
    }
}

#[test]
fn a_room_with_a_ring_is_closed() {
    let bench = objects::bench("ring", 800);
    let solution = bench.solve(0.02);
    let area: f64 = solution.system.elements().iter().map(|size| size.area).sum();
    let sums = solution.closure.iter().zip(solution.system.elements());
    let mean = sums.map(|(sum, size)| size.area * (sum - 1.0)).sum::<f64>() / area;
    println!("{mean:e}");
    assert!(mean.abs() < 1e-2, "{mean:e}");
}
