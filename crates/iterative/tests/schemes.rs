//! What is particular to single schemes, against their formulas by plain loops and against closed
//! forms.

// Tests end where something is missing; indices follow the formulas.
#![allow(clippy::needless_range_loop, clippy::unwrap_used)]

use fredholm_iterative::{
    BlockGaussSeidel, BlockJacobi, CgPsi, CgTheta, Chebyshev, Frame, GaussSeidel, Gmres, GroupShooting, Hgs1,
    Hgs2, Hybrid, Jacobi, Minres, MultilevelShooting, Neumann, PcgCholesky, PcgJacobi, Progressive, Sor,
    Ssor, Sur, with_ambient,
};
use fredholm_linop::{
    Columns, Lazy, LinearOperator, MultiVector, PackedSymmetric, Progress, Quiet, Report, SecondKind, Solver,
    Stop, StopReason, Symmetry,
};
use std::ops::ControlFlow;

const N: usize = 24;

/// A closed scene of N patches: G symmetric, areas its row sums, reflectance and light without a
/// pattern.
struct Scene {
    coupling: PackedSymmetric<f64>,
    areas: Vec<f64>,
    factor: MultiVector<f64>,
    b: MultiVector<f64>,
}

fn scattered(at: usize) -> f64 {
    ((at + 1) as f64 * 0.618_033_988_749_895).fract()
}

fn scene() -> Scene {
    let entry = |i: usize, j: usize| if i == j { 0.0 } else { scattered(i * i + 7 * j).powi(2) };
    let packed = (0..N).flat_map(|i| (0..=i).map(move |j| entry(i, j))).collect();
    let coupling = PackedSymmetric::new(N, packed).unwrap();
    let areas = coupling.row_sums();
    let factor = MultiVector::from_fn(N, 1, |i, _| (0.5 + 0.4 * scattered(3 * i)) / areas[i]);
    let b = MultiVector::from_fn(N, 1, |i, _| if i % 5 == 0 { 1.0 + scattered(i) } else { 0.0 });
    Scene { coupling, areas, factor, b }
}

impl Scene {
    fn system(&self) -> SecondKind<'_, f64> {
        SecondKind::new(&self.coupling, self.factor.clone()).unwrap()
    }

    fn a(&self, i: usize, j: usize) -> f64 {
        f64::from(u8::from(i == j)) - self.factor.row(i)[0] * self.coupling.get(i, j)
    }

    fn residual(&self, x: &[f64]) -> Vec<f64> {
        (0..N).map(|i| self.b.row(i)[0] - (0..N).map(|j| self.a(i, j) * x[j]).sum::<f64>()).collect()
    }

    /// All iterates from 0 on, and the report.
    fn follow(&self, solver: &dyn Solver<f64>, iterations: usize) -> (Vec<Vec<f64>>, Report) {
        let mut iterates = Vec::new();
        let mut observer = |progress: &Progress<'_, f64>| {
            iterates.push(progress.x.vector(0));
            ControlFlow::Continue(())
        };
        let stop = Stop { tolerance: 0.0, max_iterations: iterations };
        let mut x = MultiVector::zeros(N, 1);
        let report = solver.solve(&self.system(), &self.b, &mut x, &stop, &mut observer).unwrap();
        (iterates, report)
    }

    fn last(&self, solver: &dyn Solver<f64>, iterations: usize) -> Vec<f64> {
        self.follow(solver, iterations).0.pop().unwrap()
    }
}

fn norm(v: &[f64]) -> f64 {
    v.iter().map(|x| x * x).sum::<f64>().sqrt()
}

fn distance(u: &[f64], v: &[f64]) -> f64 {
    norm(&u.iter().zip(v).map(|(u, v)| u - v).collect::<Vec<_>>())
}

#[test]
fn neumann_sums_the_bounces() {
    let scene = scene();
    let (mut bounce, mut sum) = (scene.b.vector(0), vec![0.0; N]);
    for _ in 0..6 {
        (0..N).for_each(|i| sum[i] += bounce[i]);
        let k = |i: usize, j: usize| scene.factor.row(i)[0] * scene.coupling.get(i, j);
        bounce = (0..N).map(|i| (0..N).map(|j| k(i, j) * bounce[j]).sum()).collect();
    }
    assert!(distance(&scene.last(&Neumann, 6), &sum) < 1e-14);
}

#[test]
fn weighted_jacobi_is_its_formula() {
    let scene = scene();
    let mut x = vec![0.0; N];
    for _ in 0..4 {
        let residual = scene.residual(&x);
        (0..N).for_each(|i| x[i] += 0.7 * residual[i] / scene.a(i, i));
    }
    assert!(distance(&scene.last(&Jacobi { omega: 0.7 }, 4), &x) < 1e-14);
}

fn relax(scene: &Scene, x: &mut [f64], omega: f64, order: impl Iterator<Item = usize>) {
    for i in order {
        let others: f64 = (0..N).filter(|&j| j != i).map(|j| scene.a(i, j) * x[j]).sum();
        x[i] += omega * ((scene.b.row(i)[0] - others) / scene.a(i, i) - x[i]);
    }
}

#[test]
fn over_under_and_symmetric_relaxation_are_their_formulas() {
    let scene = scene();
    let (mut over, mut under, mut symmetric) = (vec![0.0; N], vec![0.0; N], vec![0.0; N]);
    for _ in 0..3 {
        relax(&scene, &mut over, 1.3, 0..N);
        relax(&scene, &mut under, 0.6, 0..N);
        relax(&scene, &mut symmetric, 1.2, (0..N).rev());
        relax(&scene, &mut symmetric, 1.2, 0..N);
    }
    assert!(distance(&scene.last(&Sor { omega: Some(1.3) }, 3), &over) < 1e-14);
    assert!(distance(&scene.last(&Sur { omega: 0.6 }, 3), &under) < 1e-14);
    assert!(distance(&scene.last(&Ssor { omega: 1.2 }, 3), &symmetric) < 1e-14);
    let (_, report) = scene.follow(&Ssor { omega: 1.2 }, 3);
    assert_eq!(report.work.entries_touched, 3 * 2 * scene.coupling.entries());
}

#[test]
fn an_automatic_factor_lies_between_one_and_two_and_converges() {
    let scene = scene();
    let (_, report) = scene.follow(&Sor { omega: None }, 200);
    let last = report.history.last().unwrap().residuals[0];
    assert!(last < 1e-14 && report.work.operator_applications > 1, "{last:e}");
}

#[test]
fn blocks_are_solved_exactly() {
    let scene = scene();
    let size = 5;
    // A block solve is many Gauss–Seidel steps within the block.
    let settle = |x: &mut Vec<f64>, start: &[f64], block: std::ops::Range<usize>| {
        for _ in 0..400 {
            for i in block.clone() {
                let value = |j: usize| if block.contains(&j) { x[j] } else { start[j] };
                let others: f64 = (0..N).filter(|&j| j != i).map(|j| scene.a(i, j) * value(j)).sum();
                x[i] = (scene.b.row(i)[0] - others) / scene.a(i, i);
            }
        }
    };
    let (mut jacobi, mut seidel) = (vec![0.0; N], vec![0.0; N]);
    for _ in 0..3 {
        let old = jacobi.clone();
        for first in (0..N).step_by(size) {
            let block = first..(first + size).min(N);
            settle(&mut jacobi, &old, block.clone());
            let newest = seidel.clone();
            settle(&mut seidel, &newest, block);
        }
    }
    assert!(distance(&scene.last(&BlockJacobi { size }, 3), &jacobi) < 1e-13);
    assert!(distance(&scene.last(&BlockGaussSeidel { size }, 3), &seidel) < 1e-13);
}

#[test]
fn progressive_radiosity_shoots_from_the_most_unshot_power() {
    let scene = scene();
    let (mut x, mut unshot) = (vec![0.0; N], scene.b.vector(0));
    for _ in 0..10 {
        let power = |i: &usize| scene.areas[*i] * unshot[*i].abs();
        let i = (0..N).max_by(|i, j| power(i).total_cmp(&power(j))).unwrap();
        let step = unshot[i] / scene.a(i, i);
        x[i] += step;
        (0..N).for_each(|k| unshot[k] -= scene.a(k, i) * step);
    }
    for areas in [Vec::new(), scene.areas.clone()] {
        let solver = Progressive { areas, overshoot: false, shots: Some(5) };
        let (iterates, report) = scene.follow(&solver, 2);
        assert!(distance(&iterates[2], &x) < 1e-14);
        assert_eq!(report.work.column_visits, 10);
    }
}

/// An integrating sphere: F_ij = A_j/ΣA, reflectance 0.8 everywhere, one patch shines.
fn sphere() -> (PackedSymmetric<f64>, Vec<f64>) {
    let areas: Vec<f64> = (0..N).map(|i| 0.5 + scattered(i)).collect();
    let total: f64 = areas.iter().sum();
    let packed = (0..N).flat_map(|i| (0..=i).map(move |j| (i, j)));
    let packed = packed.map(|(i, j)| areas[i] * areas[j] / total).collect();
    (PackedSymmetric::new(N, packed).unwrap(), areas)
}

#[test]
fn the_ambient_term_is_exact_in_an_integrating_sphere() {
    let (coupling, areas) = sphere();
    let (rho, total) = (0.8, areas.iter().sum::<f64>());
    let factor = MultiVector::from_fn(N, 1, |i, _| rho / areas[i]);
    let a = SecondKind::new(&coupling, factor).unwrap();
    let b = MultiVector::from_fn(N, 1, |i, _| f64::from(u8::from(i == 3)));
    // B = M + ρ E with the same E = Σ A M/(ΣA (1 − ρ)) everywhere.
    let irradiance = areas[3] / (total * (1.0 - rho));
    let exact: Vec<f64> = (0..N).map(|i| b.row(i)[0] + rho * irradiance).collect();
    for shots in [1, 2, 9] {
        let stop = Stop { tolerance: 0.0, max_iterations: 1 };
        let solver = Progressive { areas: areas.clone(), overshoot: false, shots: Some(shots) };
        let mut x = MultiVector::zeros(N, 1);
        solver.solve(&a, &b, &mut x, &stop, &mut Quiet).unwrap();
        let (mut product, mut residual) = (MultiVector::zeros(N, 1), b.clone());
        a.apply(&x, &mut product);
        residual.set_difference(&b, &product);
        let shown = with_ambient(&a, &areas, &x, &residual).unwrap();
        assert!(distance(&shown.vector(0), &exact) < 1e-13, "{shots} shots");
        assert!(distance(&x.vector(0), &exact) > 0.1);
    }
    assert!(with_ambient(&a, &areas[1..], &b, &b).is_err());
}

#[test]
fn overshooting_leaves_less_light_unshot() {
    let scene = scene();
    let unshot = |overshoot| {
        let solver = Progressive { areas: scene.areas.clone(), overshoot, shots: None };
        scene.follow(&solver, 3).1.history.pop().unwrap().residuals[0]
    };
    assert!(unshot(true) < unshot(false), "{:e} {:e}", unshot(true), unshot(false));
}

/// Columns of a matrix that is stored elsewhere.
struct Elsewhere<'a>(&'a PackedSymmetric<f64>);

impl Columns<f64> for Elsewhere<'_> {
    fn dim(&self) -> usize {
        self.0.dim()
    }

    fn symmetry(&self) -> Symmetry {
        Symmetry::Symmetric
    }

    fn diagonal(&self, i: usize) -> f64 {
        self.0.get(i, i)
    }

    fn column(&self, j: usize, out: &mut [f64]) {
        self.0.column(j, 0, out);
    }
}

#[test]
fn shooting_computes_no_more_columns_than_it_shoots() {
    let scene = scene();
    let elsewhere = Elsewhere(&scene.coupling);
    let lazy = Lazy::new(&elsewhere, 1 << 20);
    let system = SecondKind::new(&lazy, scene.factor.clone()).unwrap();
    let stop = Stop { tolerance: 0.0, max_iterations: 2 };
    let solver = Progressive { areas: scene.areas.clone(), overshoot: false, shots: Some(3) };
    let mut x = MultiVector::zeros(N, 1);
    solver.solve(&system, &scene.b, &mut x, &stop, &mut Quiet).unwrap();
    assert!(lazy.computed() <= 6 && lazy.computed() > 1, "{}", lazy.computed());
    assert_eq!(x.vector(0), scene.last(&solver, 2));
}

#[test]
fn a_group_of_all_patches_settles_at_once_and_one_of_one_is_progressive() {
    let scene = scene();
    let (_, report) = scene.follow(&GroupShooting { size: N }, 1);
    assert!(report.history[1].residuals[0] < 1e-14);
    let plain = scene.last(&Progressive::default(), 1);
    assert!(distance(&scene.last(&GroupShooting { size: 1 }, 1), &plain) < 1e-13);
}

#[test]
fn conjugate_gradients_have_the_smallest_error_of_their_space() {
    let scene = scene();
    let exact = scene.last(&GaussSeidel, 400);
    // ‖e‖² = eᵀ Ψ e.
    let energy = |x: &[f64]| {
        let e: Vec<f64> = x.iter().zip(&exact).map(|(x, e)| x - e).collect();
        let row = |i: usize| (0..N).map(|j| scene.a(i, j) * e[j]).sum::<f64>() / scene.factor.row(i)[0];
        (0..N).map(|i| e[i] * row(i)).sum::<f64>()
    };
    let best = |solver: &dyn Solver<f64>| energy(&scene.last(solver, 6));
    // Both spaces of CG on Θ are those of successive approximations, of which Jacobi is one
    // iterate.
    assert!(best(&CgTheta) < energy(&scene.last(&Neumann, 6)));
    assert!(best(&CgTheta) < energy(&scene.last(&Chebyshev::default(), 6)));
    assert!(best(&CgTheta) <= energy(&scene.last(&Minres, 6)));
    for solver in [&CgPsi as &dyn Solver<f64>, &CgTheta, &PcgJacobi] {
        let (iterates, _) = scene.follow(solver, 12);
        let energies: Vec<f64> = iterates.iter().map(|x| energy(x)).collect();
        assert!(energies.windows(2).all(|pair| pair[1] < pair[0]), "{}: {energies:?}", solver.name());
    }
    // a_ii = 1: the diagonal of Ψ is H.
    assert!(distance(&scene.last(&PcgJacobi, 5), &scene.last(&CgTheta, 5)) < 1e-13);
}

#[test]
fn the_whole_cholesky_factor_is_the_inverse() {
    let scene = scene();
    let (_, report) = scene.follow(&PcgCholesky { threshold: 0.0 }, 1);
    assert!(report.history[1].residuals[0] < 1e-13);
    let residual = |threshold| scene.follow(&PcgCholesky { threshold }, 4).1.history[4].residuals[0];
    assert!(residual(0.5) < residual(3.0), "{:e} {:e}", residual(0.5), residual(3.0));
}

#[test]
fn gmres_has_the_smallest_residual_of_its_space() {
    let scene = scene();
    let gmres = scene.follow(&Gmres { restart: 50 }, 6).1;
    for other in [&Neumann as &dyn Solver<f64>, &Minres, &CgTheta] {
        let (_, report) = scene.follow(other, 6);
        for k in 1..=6 {
            let (best, other) = (gmres.history[k].residuals[0], report.history[k].residuals[0]);
            assert!(best <= other * (1.0 + 1e-9), "{k}: {best:e} {other:e}");
        }
    }
}

#[test]
fn minres_never_grows_in_its_norm() {
    let scene = scene();
    let (iterates, _) = scene.follow(&Minres, 15);
    let size = |x: &[f64]| {
        let residual = scene.residual(x);
        (0..N).map(|i| residual[i] * residual[i] / scene.factor.row(i)[0]).sum::<f64>()
    };
    assert!(iterates.windows(2).all(|pair| size(&pair[1]) <= size(&pair[0]) * (1.0 + 1e-12) + 1e-28));
}

#[test]
fn chebyshev_keeps_the_bound_of_its_polynomial() {
    let scene = scene();
    let exact = scene.last(&GaussSeidel, 400);
    let (low, high) = (0.05, 1.95);
    let (iterates, _) = scene.follow(&Chebyshev { interval: Some((low, high)) }, 12);
    // In the norm of H: ‖e_k‖ ≤ ‖e_0‖/T_k(σ), σ = (high + low)/(high − low).
    let size = |x: &[f64]| {
        let terms = (0..N).map(|i| (x[i] - exact[i]).powi(2) / scene.factor.row(i)[0]);
        terms.sum::<f64>().sqrt()
    };
    let sigma: f64 = (high + low) / (high - low);
    for (k, x) in iterates.iter().enumerate() {
        let polynomial = (k as f64 * sigma.acosh()).cosh();
        assert!(size(x) <= size(&iterates[0]) / polynomial * (1.0 + 1e-10), "{k}");
    }
}

#[test]
fn hybrids_are_never_above_what_they_blend() {
    let scene = scene();
    let residuals = |solver: &dyn Solver<f64>| -> Vec<f64> {
        scene.follow(solver, 12).1.history.iter().map(|record| record.residuals[0]).collect()
    };
    let (seidel, shooting) = (residuals(&GaussSeidel), residuals(&Progressive::default()));
    let (first, second, both) =
        (residuals(&Hgs1::default()), residuals(&Hgs2), residuals(&Hybrid::default()));
    let above = |u: f64, v: f64| u > v * (1.0 + 1e-10) + 1e-15;
    for k in 0..=12 {
        assert!(!above(first[k], seidel[k]) && !above(both[k], seidel[k].min(shooting[k])), "{k}");
        assert!(k == 0 || !above(first[k], first[k - 1]) && !above(second[k], second[k - 1]), "{k}");
    }
    // Of this scene the second is the faster one.
    assert!(second[8] < seidel[8] && first[8] < seidel[8]);
}

#[test]
fn the_second_hybrid_sweeps_from_the_blended_iterate() {
    let scene = scene();
    let (mut z, mut x) = (vec![0.0; N], vec![0.0; N]);
    for _ in 0..5 {
        x.copy_from_slice(&z);
        relax(&scene, &mut x, 1.0, 0..N);
        let (first, second) = (scene.residual(&x), scene.residual(&z));
        let difference: Vec<f64> = first.iter().zip(&second).map(|(u, v)| u - v).collect();
        let across: f64 = difference.iter().zip(&second).map(|(u, v)| u * v).sum();
        let alpha = -across / difference.iter().map(|u| u * u).sum::<f64>();
        (0..N).for_each(|i| z[i] = alpha * x[i] + (1.0 - alpha) * z[i]);
    }
    assert!(distance(&scene.last(&Hgs2, 5), &z) < 1e-13);
    let (_, report) = scene.follow(&Hgs2, 5);
    assert_eq!(report.work.entries_touched, 5 * scene.coupling.entries());
}

#[test]
fn every_residual_of_the_history_is_that_of_its_iterate() {
    let scene = scene();
    for solver in fredholm_iterative::solvers::<f64>() {
        let (iterates, report) = scene.follow(&*solver, 9);
        assert_ne!(report.reason, StopReason::Diverged);
        for (x, record) in iterates.iter().zip(&report.history) {
            let residual = norm(&scene.residual(x)) / norm(&scene.b.vector(0));
            let error = (residual - record.residuals[0]).abs();
            assert!(error < 1e-14, "{}: {error:e}", solver.name());
        }
        assert!(report.history.windows(2).all(|pair| pair[0].entries_touched < pair[1].entries_touched));
    }
}

/// A closed scene whose sixes see nothing of themselves and reflect alike.
fn walls() -> Scene {
    let entry = |i: usize, j: usize| if i / 6 == j / 6 { 0.0 } else { scattered(i * i + 7 * j).powi(2) };
    let packed = (0..N).flat_map(|i| (0..=i).map(move |j| entry(i, j))).collect();
    let coupling = PackedSymmetric::new(N, packed).unwrap();
    let areas = coupling.row_sums();
    let factor = MultiVector::from_fn(N, 1, |i, _| (0.5 + 0.1 * (i / 6) as f64) / areas[i]);
    let b = MultiVector::from_fn(N, 1, |i, _| if i < 6 { 1.0 + scattered(i) } else { 0.0 });
    Scene { coupling, areas, factor, b }
}

/// Columns of the elements, then their sums over sixes and threes.
struct Summed<'a>(&'a PackedSymmetric<f64>, Vec<std::ops::Range<usize>>);

impl Columns<f64> for Summed<'_> {
    fn dim(&self) -> usize {
        N
    }

    fn count(&self) -> usize {
        self.1.len()
    }

    fn symmetry(&self) -> Symmetry {
        Symmetry::General
    }

    fn diagonal(&self, _: usize) -> f64 {
        0.0
    }

    fn column(&self, g: usize, out: &mut [f64]) {
        (0..N).for_each(|i| out[i] = self.1[g].clone().map(|j| self.0.get(i, j)).sum());
    }
}

#[test]
fn shooting_from_groups_and_elements_reaches_the_solution_and_saves_columns() {
    let scene = walls();
    let (iterates, _) = scene.follow(&GaussSeidel, 200);
    let exact = iterates.last().unwrap();
    let order: Vec<u32> = (0..N as u32).collect();
    let single: Vec<_> = (0..N).map(|i| i..i + 1).collect();
    let sums = (0..N).step_by(6).map(|i| i..i + 6).chain((0..N).step_by(3).map(|i| i..i + 3));
    let groups: Vec<_> = single.iter().cloned().chain(sums).collect();
    let shots = |groups: &[std::ops::Range<usize>], share: f64| {
        let columns = Summed(&scene.coupling, groups.to_vec());
        let lazy = Lazy::new(&columns, 1 << 20);
        let frame = Frame { order: &order, groups, areas: &scene.areas };
        let mut shooting = MultilevelShooting::new(&lazy, frame, scene.factor.clone(), &scene.b).unwrap();
        let mut shots = 0;
        while shooting.distributed() < share && shooting.shoot().is_some() {
            shots += 1;
        }
        (shots, lazy.computed(), shooting.radiosity().vector(0))
    };
    let (_, _, found) = shots(&groups, 1.0 - 1e-12);
    let largest = exact.iter().copied().fold(0.0, f64::max);
    for i in 0..N {
        assert!((found[i] - exact[i]).abs() < 1e-10 * largest, "{i}: {} {}", found[i], exact[i]);
    }
    let ((few, computed, _), (many, all, _)) = (shots(&groups, 0.9), shots(&single, 0.9));
    assert!(
        few < many && 2 * computed < all,
        "{few} shots of {computed} columns, {many} of {all} from elements"
    );
}

#[test]
fn a_frame_of_another_size_is_refused() {
    let scene = walls();
    let halves = [0..N / 2, N / 2..N];
    let columns = Summed(&scene.coupling, halves.to_vec());
    let lazy = Lazy::new(&columns, 0);
    let frame = Frame { order: &[0, 1], groups: &halves, areas: &scene.areas };
    assert!(MultilevelShooting::new(&lazy, frame, scene.factor.clone(), &scene.b).is_err());
}
