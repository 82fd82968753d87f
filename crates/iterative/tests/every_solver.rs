//! Every registered solver on every kind of system, against solutions known by construction.
//!
//! x is chosen, and b = A x is formed by plain loops over a full matrix. Solvers that need a
//! symmetric coupling must refuse the others.

#![allow(clippy::float_cmp, clippy::needless_range_loop, clippy::unwrap_used)]

use fredholm_linop::{
    Dense, LinearOperator, LinopError, MultiVector, Observer, PackedSymmetric, Progress, Quiet, Report,
    Scalar, SecondKind, SolveError, Solver, Stop, StopReason, Storage, Symmetry, build,
};
use num_complex::Complex64;
use std::ops::ControlFlow;

const STOP: Stop = Stop { tolerance: 1e-13, max_iterations: 1000 };

/// Those that need a symmetric coupling and factors of at least 0.
const SYMMETRIC: [&str; 9] =
    ["cg-psi", "cg-theta", "pcg-jacobi", "pcg-ssor", "pcg-ic", "chebyshev", "minres", "ldlt", "cholesky"];

/// Those that ask whether to go on at every unknown.
const BY_UNKNOWNS: [&str; 8] =
    ["gauss-seidel", "sor", "sur", "southwell", "progressive", "hgs1", "hgs2", "hybrid"];

/// Schemes with other options than the default ones.
const VARIANTS: [&str; 14] = [
    "jacobi:omega=0.7",
    "sor:omega=1.2",
    "ssor:omega=1.3",
    "progressive:overshoot=yes",
    "progressive:shots=7",
    "group-shooting:size=1",
    "group-shooting:size=1000",
    "block-jacobi:size=1",
    "block-gauss-seidel:size=7",
    "gmres:restart=4",
    "anderson:depth=1",
    "hgs1:sequence=progressive",
    "hybrid:first=sor:second=neumann",
    "hybrid:first=gmres:second=bicgstab",
];
const SYMMETRIC_VARIANTS: [&str; 5] = [
    "pcg-ic:threshold=0",
    "pcg-ssor:omega=1.4",
    "chebyshev:low=0.04:high=1.96",
    "hybrid:first=cg-theta:second=progressive",
    "hgs1:sequence=minres",
];

/// xorshift64*, uniform on [0, 1).
struct Random(u64);

impl Random {
    fn next(&mut self) -> f64 {
        self.0 ^= self.0 >> 12;
        self.0 ^= self.0 << 25;
        self.0 ^= self.0 >> 27;
        (self.0.wrapping_mul(0x2545_f491_4f6c_dd1d) >> 11) as f64 / (1u64 << 53) as f64
    }
}

fn random() -> Random {
    Random(0x9e37_79b9_7f4a_7c15)
}

fn real_solvers() -> Vec<Box<dyn Solver<f64>>> {
    fredholm_iterative::solvers().into_iter().chain(fredholm_direct::solvers()).collect()
}

fn complex_solvers() -> Vec<Box<dyn Solver<Complex64>>> {
    fredholm_iterative::solvers().into_iter().chain(fredholm_direct::solvers()).collect()
}

/// A scheme by its text.
fn made<T: Scalar>(text: &str) -> Box<dyn Solver<T>> {
    Box::new(build(&fredholm_iterative::entries::<T>(), text).unwrap())
}

/// The solvers that take couplings of any kind.
fn general<T: Scalar>(solvers: Vec<Box<dyn Solver<T>>>) -> Vec<Box<dyn Solver<T>>> {
    solvers.into_iter().filter(|solver| !SYMMETRIC.contains(&solver.name())).collect()
}

fn general_solvers() -> Vec<Box<dyn Solver<f64>>> {
    general(real_solvers())
}

/// K with its entries by a formula of the test, D, and the solution.
struct Case<T> {
    name: &'static str,
    coupling: Box<dyn LinearOperator<T>>,
    entry: Box<dyn Fn(usize, usize) -> T + Sync>,
    factor: MultiVector<T>,
    x: MultiVector<T>,
}

impl<T: Scalar> Case<T> {
    fn system(&self) -> SecondKind<'_, T> {
        SecondKind::new(&*self.coupling, self.factor.clone()).unwrap()
    }

    /// A x by plain loops.
    fn product(&self, x: &MultiVector<T>) -> MultiVector<T> {
        MultiVector::from_fn(x.dim(), x.rhs_count(), |i, l| {
            let sum = (0..x.dim()).fold(T::zero(), |sum, j| sum + (self.entry)(i, j) * x.row(j)[l]);
            x.row(i)[l] - self.factor.row(i)[l] * sum
        })
    }

    fn solve(&self, solver: &dyn Solver<T>, observer: &mut dyn Observer<T>) -> (Report, MultiVector<T>) {
        let mut x = MultiVector::zeros(self.x.dim(), self.x.rhs_count());
        let report = solver.solve(&self.system(), &self.product(&self.x), &mut x, &STOP, observer).unwrap();
        (report, x)
    }
}

fn norm<T: Scalar>(v: &[T]) -> f64 {
    v.iter().map(|value| value.abs2()).sum::<f64>().sqrt()
}

fn difference<T: Scalar>(a: &[T], b: &[T]) -> Vec<T> {
    a.iter().zip(b).map(|(&a, &b)| a - b).collect()
}

/// K ≥ 0 with row sums 0.9, not symmetric, so that I − K is an M-matrix.
fn m_matrix(n: usize) -> Case<f64> {
    let mut random = random();
    let mut entries: Vec<f64> = (0..n * n).map(|_| random.next().powi(4)).collect();
    for row in entries.chunks_exact_mut(n) {
        let sum: f64 = row.iter().sum();
        for entry in row {
            *entry *= 0.9 / sum;
        }
    }
    let x = MultiVector::from_fn(n, 2, |_, _| random.next() - 0.5);
    let coupling = Box::new(Dense::new(n, entries.clone()).unwrap());
    let entry = Box::new(move |i: usize, j: usize| entries[i * n + j]);
    let factor = MultiVector::from_fn(n, 2, |_, l| [1.0, 0.5][l]);
    Case { name: "M-matrix", coupling, entry, factor, x }
}

/// A closed scene: G_ij = G_ji ≥ 0, A_i = Σ_j G_ij, reflectances up to 0.95 in three bands.
fn radiosity<S: Storage>(n: usize) -> Case<f64> {
    let mut random = random();
    let mut packed: Vec<S> = (0..n * (n + 1) / 2).map(|_| S::from_f64(random.next().powi(3))).collect();
    (0..n).for_each(|i| packed[i * (i + 1) / 2 + i] = S::from_f64(0.0));
    let copy = packed.clone();
    let entry = move |i: usize, j: usize| copy[i.max(j) * (i.max(j) + 1) / 2 + i.min(j)].to_f64();
    let areas: Vec<f64> = (0..n).map(|i| (0..n).map(|j| entry(i, j)).sum()).collect();
    let factor = MultiVector::from_fn(n, 3, |i, _| 0.95 * random.next().sqrt() / areas[i]);
    let x = MultiVector::from_fn(n, 3, |_, l| (random.next() + 0.1) * [1.0, 1e3, 1e-3][l]);
    let coupling = Box::new(PackedSymmetric::new(n, packed).unwrap());
    Case { name: "radiosity", coupling, entry: Box::new(entry), factor, x }
}

/// Complex K with Σ_j |k_ij| = 0.8, so that I − K is strictly diagonally dominant.
fn complex_dominant(n: usize) -> Case<Complex64> {
    let mut random = random();
    let mut draw = move || Complex64::new(random.next() - 0.5, random.next() - 0.5);
    let mut entries: Vec<Complex64> = (0..n * n).map(|_| draw()).collect();
    for row in entries.chunks_exact_mut(n) {
        let sum: f64 = row.iter().map(|entry| entry.norm()).sum();
        for entry in row {
            *entry *= 0.8 / sum;
        }
    }
    let x = MultiVector::from_fn(n, 2, |_, _| draw());
    let coupling = Box::new(Dense::new(n, entries.clone()).unwrap());
    let entry = Box::new(move |i: usize, j: usize| entries[i * n + j]);
    let factor = MultiVector::from_fn(n, 2, |_, l| [Complex64::new(1.0, 0.0), Complex64::new(0.0, -1.0)][l]);
    Case { name: "complex dominant", coupling, entry, factor, x }
}

/// Hermitian K with Σ_j |k_ij| ≤ 0.8, so that I − D K is similar to a positive definite matrix for
/// 0 ≤ D ≤ 1.
fn hermitian(n: usize) -> Case<Complex64> {
    mirrored(n, Symmetry::Hermitian)
}

/// Complex K with k_ij = k_ji and Σ_j |k_ij| ≤ 0.8, complex D with |D| ≤ 1.
fn complex_symmetric(n: usize) -> Case<Complex64> {
    mirrored(n, Symmetry::Symmetric)
}

fn mirrored(n: usize, symmetry: Symmetry) -> Case<Complex64> {
    let hermitian = symmetry == Symmetry::Hermitian;
    let mut random = random();
    let mut draw = move || Complex64::new(random.next() - 0.5, random.next() - 0.5);
    let mut entries = vec![Complex64::new(0.0, 0.0); n * n];
    for i in 0..n {
        for j in 0..i {
            let entry = draw() * (0.8 / n as f64);
            (entries[i * n + j], entries[j * n + i]) = (entry, if hermitian { entry.conj() } else { entry });
        }
        let entry = draw() / n as f64;
        entries[i * n + i] = if hermitian { entry.re.into() } else { entry };
    }
    let x = MultiVector::from_fn(n, 2, |_, _| draw());
    let coupling = Dense::new(n, entries.clone()).unwrap().with_symmetry(symmetry).unwrap();
    let entry = Box::new(move |i: usize, j: usize| entries[i * n + j]);
    let black = |i: usize, l: usize| if (i + l).is_multiple_of(5) { 0.0 } else { 0.3 + 0.7 * l as f64 };
    let phase = |i: usize| if hermitian { 0.0 } else { i as f64 };
    let factor = MultiVector::from_fn(n, 2, |i, l| Complex64::from_polar(black(i, l), phase(i)));
    let name = if hermitian { "Hermitian" } else { "complex symmetric" };
    Case { name, coupling: Box::new(coupling), entry, factor, x }
}

/// The radiosity system with every third unknown black in the second band.
fn partly_black(n: usize) -> Case<f64> {
    let mut case = radiosity::<f64>(n);
    (0..n).step_by(3).for_each(|i| case.factor.row_mut(i)[1] = 0.0);
    Case { name: "partly black", ..case }
}

fn refuses<T: Scalar>(case: &Case<T>, solver: &dyn Solver<T>) {
    let mut x = MultiVector::zeros(case.x.dim(), case.x.rhs_count());
    let refusal =
        solver.solve(&case.system(), &case.product(&case.x), &mut x, &STOP, &mut Quiet).unwrap_err();
    assert!(matches!(&refusal, SolveError::Unsuitable { solver: name, .. } if *name == solver.name()));
    assert!(refusal.to_string().contains("a coupling that is known to be"), "{refusal}");
}

/// Whether a solver is for couplings like this.
fn takes<T: Scalar>(coupling: &dyn LinearOperator<T>, solver: &str) -> bool {
    let any = !SYMMETRIC.contains(&solver);
    match coupling.symmetry() {
        Symmetry::General => any,
        Symmetry::Symmetric => any || T::IS_REAL || solver == "ldlt",
        Symmetry::Hermitian => T::IS_REAL || solver != "ldlt",
    }
}

fn check<T: Scalar>(case: &Case<T>, solvers: &[Box<dyn Solver<T>>]) {
    let b = case.product(&case.x);
    for solver in solvers {
        if !takes(&*case.coupling, solver.name()) {
            refuses(case, &**solver);
            continue;
        }
        let name = format!("{} on {}", solver.name(), case.name);
        let (report, x) = case.solve(&**solver, &mut Quiet);
        assert_eq!(report.reason, StopReason::Converged, "{name}: {:?}", report.history.last());
        let product = case.product(&x);
        let last = &report.history[report.history.len() - 1];
        assert_eq!(last.iteration + 1, report.history.len(), "{name}");
        for l in 0..x.rhs_count() {
            let error = norm(&difference(&x.vector(l), &case.x.vector(l))) / norm(&case.x.vector(l));
            assert!(error < 1e-10, "{name}: error {error:e} in right-hand side {l}");
            let residual = norm(&difference(&b.vector(l), &product.vector(l))) / norm(&b.vector(l));
            assert!(
                (residual - last.residuals[l]).abs() < 5e-15,
                "{name}: residual {residual:e} in right-hand side {l}"
            );
            assert!((report.history[0].residuals[l] - 1.0).abs() < 1e-15, "{name}");
        }
        assert!(report.work.entries_touched >= case.coupling.entries(), "{name}");
        assert!(last.entries_touched <= report.work.entries_touched, "{name}");
    }
}

#[test]
fn every_solver_finds_the_solution_of_every_system() {
    check(&m_matrix(60), &real_solvers());
    check(&radiosity::<f64>(70), &real_solvers());
    check(&radiosity::<f32>(50), &real_solvers());
    check(&partly_black(50), &real_solvers());
    check(&complex_dominant(40), &complex_solvers());
    check(&hermitian(40), &complex_solvers());
    check(&complex_symmetric(40), &complex_solvers());
    check(&m_matrix(1), &real_solvers());
}

#[test]
fn options_change_the_way_and_not_the_solution() {
    let variants: Vec<_> = VARIANTS.into_iter().map(made).collect();
    let symmetric: Vec<_> = SYMMETRIC_VARIANTS.into_iter().map(made).collect();
    check(&radiosity::<f64>(60), &variants);
    check(&radiosity::<f64>(60), &symmetric);
    check(&m_matrix(40), &variants);
    let complex: Vec<_> = VARIANTS.into_iter().filter(|text| !text.contains("overshoot")).map(made).collect();
    check(&complex_dominant(30), &complex);
}

#[test]
fn two_hundred_random_m_matrices_are_solved() {
    let solvers = real_solvers();
    for seed in 0..200 {
        let n = 2 + seed % 13;
        let mut random = Random(0x9e37_79b9_7f4a_7c15 ^ (seed as u64) << 20);
        let scale = 0.3 + 0.65 * random.next();
        let symmetric = seed % 2 == 1;
        let mut entries: Vec<f64> = (0..n * n).map(|_| random.next().powi(2) / n as f64).collect();
        if symmetric {
            (0..n * n).for_each(|at| entries[at] = entries[at.min(at % n * n + at / n)]);
        }
        let sum = (0..n).map(|i| entries[i * n..(i + 1) * n].iter().sum::<f64>()).fold(0.0, f64::max);
        for entry in &mut entries {
            *entry *= scale / sum;
        }
        let kind = if symmetric { Symmetry::Symmetric } else { Symmetry::General };
        let coupling = Box::new(Dense::new(n, entries.clone()).unwrap().with_symmetry(kind).unwrap());
        let entry = Box::new(move |i: usize, j: usize| entries[i * n + j]);
        let factor = MultiVector::from_fn(n, 1, |_, _| 1.0);
        let x = MultiVector::from_fn(n, 1, |_, _| random.next() - 0.4);
        check(&Case { name: "random M-matrix", coupling, entry, factor, x }, &solvers);
    }
}

/// A matrix per right-hand side: K' = I − D K as the coupling of A = I − D' K' with D' = −½, so
/// that A = (3 I − D K)/2.
#[test]
fn every_solver_takes_a_matrix_per_right_hand_side() {
    let case = radiosity::<f64>(30);
    let inner = case.system();
    let a = SecondKind::new(&inner, MultiVector::from_fn(30, 3, |_, _| -0.5)).unwrap();
    let product = case.product(&case.x);
    let terms = |i: usize, l: usize| case.x.row(i)[l] + 0.5 * product.row(i)[l];
    let b = MultiVector::from_fn(30, 3, terms);
    for solver in general_solvers() {
        let mut x = MultiVector::zeros(30, 3);
        let report = solver.solve(&a, &b, &mut x, &STOP, &mut Quiet).unwrap();
        assert_eq!(report.reason, StopReason::Converged, "{}", solver.name());
        for l in 0..3 {
            let error = norm(&difference(&x.vector(l), &case.x.vector(l))) / norm(&case.x.vector(l));
            assert!(error < 1e-12, "{}: {error:e}", solver.name());
        }
    }
}

#[test]
fn solvers_are_told_apart_by_name() {
    let mut names: Vec<_> = real_solvers().iter().map(|solver| solver.name()).collect();
    names.sort_unstable();
    let count = names.len();
    names.dedup();
    assert_eq!((names.len(), count), (complex_solvers().len(), complex_solvers().len()));
    assert!(real_solvers().iter().all(|solver| !solver.description().is_empty() && solver.bytes(10, 1) > 0));
}

#[test]
fn a_starting_guess_that_solves_is_left_alone() {
    let case = radiosity::<f64>(40);
    let b = case.product(&case.x);
    for solver in real_solvers() {
        let mut x = case.x.clone();
        let report = solver.solve(&case.system(), &b, &mut x, &STOP, &mut Quiet).unwrap();
        assert_eq!((report.reason, report.history.len()), (StopReason::Converged, 1), "{}", solver.name());
        assert_eq!(x, case.x, "{}", solver.name());
    }
}

#[test]
fn any_starting_guess_leads_to_the_solution() {
    let (general, symmetric) = (m_matrix(30), partly_black(30));
    for solver in real_solvers() {
        let case = if SYMMETRIC.contains(&solver.name()) { &symmetric } else { &general };
        let b = case.product(&case.x);
        let mut x = MultiVector::from_fn(30, case.x.rhs_count(), |i, l| (i * 7 % 5 + l) as f64);
        let residual = difference(&b.vector(1), &case.product(&x).vector(1));
        let report = solver.solve(&case.system(), &b, &mut x, &STOP, &mut Quiet).unwrap();
        let first = report.history[0].residuals[1];
        assert!((first / (norm(&residual) / norm(&b.vector(1))) - 1.0).abs() < 1e-13, "{}", solver.name());
        for l in 0..x.rhs_count() {
            let error = norm(&difference(&x.vector(l), &case.x.vector(l))) / norm(&case.x.vector(l));
            assert!(error < 1e-11, "{}: {error:e}", solver.name());
        }
    }
}

fn bits(v: &[f64]) -> Vec<u64> {
    v.iter().map(|value| value.to_bits()).collect()
}

#[test]
fn the_number_of_threads_changes_no_bit() {
    let case = radiosity::<f64>(400);
    for solver in real_solvers() {
        let on = |threads| {
            let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
            let (report, x) = pool.install(|| case.solve(&*solver, &mut Quiet));
            let residuals: Vec<Vec<u64>> =
                report.history.iter().map(|record| bits(&record.residuals)).collect();
            (bits(x.as_slice()), residuals, report.work)
        };
        let one = on(1);
        assert!(on(2) == one && on(4) == one, "{}", solver.name());
    }
}

#[test]
fn single_precision_storage_moves_the_solution_by_less_than_a_millionth() {
    let (double, single) = (radiosity::<f64>(50), radiosity::<f32>(50));
    let b = double.product(&double.x);
    let a = SecondKind::new(&*single.coupling, double.factor.clone()).unwrap();
    for solver in real_solvers() {
        let mut x = MultiVector::zeros(50, 3);
        solver.solve(&a, &b, &mut x, &STOP, &mut Quiet).unwrap();
        for l in 0..3 {
            let change = norm(&difference(&x.vector(l), &double.x.vector(l))) / norm(&x.vector(l));
            assert!(change > 0.0 && change < 1e-6, "{}: {change:e}", solver.name());
        }
    }
}

#[test]
fn no_light_has_no_radiosity() {
    let case = radiosity::<f64>(20);
    for solver in real_solvers() {
        let mut x = case.x.clone();
        let b = MultiVector::zeros(20, 3);
        let report = solver.solve(&case.system(), &b, &mut x, &STOP, &mut Quiet).unwrap();
        assert_eq!((report.reason, report.history.len()), (StopReason::Converged, 1), "{}", solver.name());
        assert_eq!(report.history[0].residuals, [0.0; 3]);
        assert!(x.as_slice().iter().all(|&value| value == 0.0), "{}", solver.name());
    }
}

#[test]
fn a_dark_band_stays_dark_beside_lit_ones() {
    let mut case = radiosity::<f64>(40);
    case.x.set_vector(1, &[0.0; 40]);
    for solver in real_solvers() {
        let (report, x) = case.solve(&*solver, &mut Quiet);
        assert_eq!(report.reason, StopReason::Converged, "{}", solver.name());
        assert!(x.vector(1).iter().all(|&value| value == 0.0), "{}", solver.name());
        assert!(norm(&difference(&x.vector(0), &case.x.vector(0))) < 1e-10, "{}", solver.name());
        assert!(report.history.iter().all(|record| record.residuals[1] == 0.0), "{}", solver.name());
    }
}

#[test]
fn an_observer_can_stop_after_an_iteration() {
    let case = radiosity::<f64>(40);
    for solver in real_solvers() {
        let mut seen = None;
        let mut observer = |progress: &Progress<'_, f64>| {
            seen = Some(progress.x.clone());
            if progress.record.iteration == 1 { ControlFlow::Break(()) } else { ControlFlow::Continue(()) }
        };
        let (report, x) = case.solve(&*solver, &mut observer);
        assert_eq!((report.reason, report.history.len()), (StopReason::Interrupted, 2), "{}", solver.name());
        assert_eq!(seen, Some(x), "{}", solver.name());
        assert!(report.history[1].residuals[0] < 2.0, "{}", solver.name());
    }
}

/// Breaks at the given poll.
struct StopAtPoll(usize);

impl Observer<f64> for StopAtPoll {
    fn observe(&mut self, _: &Progress<'_, f64>) -> ControlFlow<()> {
        ControlFlow::Continue(())
    }

    fn poll(&mut self) -> ControlFlow<()> {
        self.0 -= 1;
        if self.0 == 0 { ControlFlow::Break(()) } else { ControlFlow::Continue(()) }
    }
}

#[test]
fn an_observer_can_stop_within_an_iteration() {
    let case = radiosity::<f64>(40);
    for solver in BY_UNKNOWNS.map(made) {
        let (report, x) = case.solve(&*solver, &mut StopAtPoll(56));
        assert_eq!(report.reason, StopReason::Interrupted, "{}", solver.name());
        if !["gauss-seidel", "southwell"].contains(&solver.name()) {
            continue;
        }
        assert_eq!(report.history.len(), 2, "{}", solver.name());
        let b = case.product(&case.x);
        let residual = norm(&difference(&b.vector(0), &case.product(&x).vector(0))) / norm(&b.vector(0));
        assert!(residual < report.history[1].residuals[0], "{}", solver.name());
    }
}

#[test]
fn iterations_are_limited() {
    let case = radiosity::<f64>(40);
    let stop = Stop { max_iterations: 3, ..STOP };
    for solver in fredholm_iterative::solvers() {
        let mut x = MultiVector::zeros(40, 3);
        let b = case.product(&case.x);
        let report = solver.solve(&case.system(), &b, &mut x, &stop, &mut Quiet).unwrap();
        assert_eq!(
            (report.reason, report.history.len()),
            (StopReason::IterationLimit, 4),
            "{}",
            solver.name()
        );
    }
}

/// A = [1 −3; −3 1], eigenvalues −2 and 4.
fn indefinite() -> Dense<f64> {
    Dense::new(2, vec![0.0, 3.0, 3.0, 0.0]).unwrap().with_symmetry(Symmetry::Symmetric).unwrap()
}

fn solve_indefinite(solver: &dyn Solver<f64>) -> Result<(Report, MultiVector<f64>), SolveError> {
    let coupling = indefinite();
    let a = SecondKind::new(&coupling, MultiVector::from_fn(2, 1, |_, _| 1.0)).unwrap();
    let b = MultiVector::from_vec(2, 1, vec![1.0, 5.0]).unwrap();
    let mut x = MultiVector::zeros(2, 1);
    solver.solve(&a, &b, &mut x, &STOP, &mut Quiet).map(|report| (report, x))
}

#[test]
fn relaxations_that_do_not_converge_end_as_diverged() {
    for name in ["neumann", "jacobi", "gauss-seidel", "sor", "sur", "ssor", "southwell", "progressive"] {
        let (report, _) = solve_indefinite(&*made(name)).unwrap();
        assert_eq!(report.reason, StopReason::Diverged, "{name}");
    }
}

#[test]
fn indefinite_systems_are_solved_or_refused_by_krylov_and_direct_methods() {
    for solver in real_solvers() {
        match solver.name() {
            "cg-psi" | "cg-theta" | "pcg-jacobi" | "pcg-ssor" | "pcg-ic" | "chebyshev" | "cholesky" => {
                let refusal = solve_indefinite(&*solver).unwrap_err();
                let expected = SolveError::Indefinite { solver: solver.name(), rhs: 0 };
                assert_eq!(refusal, expected);
            }
            "minres" | "gmres" | "bicgstab" | "anderson" | "lu" | "lu-mixed" | "ldlt" => {
                let (report, x) = solve_indefinite(&*solver).unwrap();
                assert_eq!(report.reason, StopReason::Converged, "{}", solver.name());
                // x = (−2, −1).
                assert!((x.row(0)[0] + 2.0).abs() < 1e-12 && (x.row(1)[0] + 1.0).abs() < 1e-12);
            }
            _ => {}
        }
    }
}

#[test]
fn options_that_do_not_fit_are_refused() {
    let entries = fredholm_iterative::entries::<f64>();
    for text in [
        "magic",
        "sor:omega=2",
        "sor:omega=0",
        "sur:omega=1",
        "gauss-seidel:omega=1",
        "gmres:restart=0",
        "chebyshev:low=0.1",
        "progressive:overshoot=maybe",
        "hybrid:first=magic",
        "jacobi:omega=-1",
    ] {
        assert!(build(&entries, text).is_err(), "{text}");
    }
    let case = complex_dominant(5);
    let b = case.product(&case.x);
    let mut x = MultiVector::zeros(5, 2);
    let overshooting = made::<Complex64>("progressive:overshoot=yes");
    let refusal = overshooting.solve(&case.system(), &b, &mut x, &STOP, &mut Quiet).unwrap_err();
    assert!(matches!(refusal, SolveError::Unsuitable { solver: "progressive", .. }));
}

#[test]
fn a_diagonal_of_zero_is_refused_by_those_that_divide_by_it() {
    // A = [1 0; 0 1] − [1 −1; −1 1] = [0 1; 1 0].
    let coupling = Dense::new(2, vec![1.0, -1.0, -1.0, 1.0]).unwrap();
    let a = SecondKind::new(&coupling, MultiVector::from_fn(2, 1, |_, _| 1.0)).unwrap();
    let b = MultiVector::from_vec(2, 1, vec![3.0, 4.0]).unwrap();
    for name in
        ["jacobi", "gauss-seidel", "sor", "sur", "ssor", "southwell", "progressive", "hgs1", "hgs2", "hybrid"]
    {
        let refusal = made(name).solve(&a, &b, &mut MultiVector::zeros(2, 1), &STOP, &mut Quiet).unwrap_err();
        assert!(matches!(&refusal, SolveError::Unsuitable { .. }), "{name}");
        assert!(refusal.to_string().contains("entry (0, 0) of right-hand side 0"), "{refusal}");
    }
    for name in ["gmres", "block-jacobi", "block-gauss-seidel", "group-shooting"] {
        let mut x = MultiVector::zeros(2, 1);
        made(name).solve(&a, &b, &mut x, &STOP, &mut Quiet).unwrap();
        assert!((x.row(0)[0] - 4.0).abs() < 1e-14 && (x.row(1)[0] - 3.0).abs() < 1e-14, "{name}");
    }
    for solver in general(fredholm_direct::solvers()) {
        let mut x = MultiVector::zeros(2, 1);
        solver.solve(&a, &b, &mut x, &STOP, &mut Quiet).unwrap();
        assert!((x.row(0)[0] - 4.0).abs() < 1e-13 && (x.row(1)[0] - 3.0).abs() < 1e-13);
    }
}

#[test]
fn vectors_that_do_not_fit_are_refused() {
    let case = radiosity::<f64>(10);
    let b = case.product(&case.x);
    for solver in real_solvers() {
        let solve = |b: &MultiVector<f64>, dim, rhs_count| {
            let mut x = MultiVector::zeros(dim, rhs_count);
            solver.solve(&case.system(), b, &mut x, &STOP, &mut Quiet).unwrap_err()
        };
        assert!(matches!(solve(&b, 11, 3), SolveError::Shape { vector: "starting guess", .. }));
        assert!(matches!(solve(&MultiVector::zeros(10, 2), 10, 3), SolveError::Shape { found_rhs: 2, .. }));
        let nan = MultiVector::from_fn(10, 3, |_, _| f64::NAN);
        let refusal =
            SolveError::Linop(LinopError::NotFinite { what: "right-hand side", unknown: 0, rhs: 0 });
        assert_eq!(solve(&nan, 10, 3), refusal);
    }
}

/// The methods' own formulas, by plain loops.
mod formulas {
    use super::*;
    use fredholm_iterative::{GaussSeidel, Southwell};

    fn a(case: &Case<f64>, l: usize) -> impl Fn(usize, usize) -> f64 {
        move |i, j| f64::from(u8::from(i == j)) - case.factor.row(i)[l] * (case.entry)(i, j)
    }

    fn iterate(solver: &dyn Solver<f64>, case: &Case<f64>, iterations: usize) -> (Report, MultiVector<f64>) {
        let stop = Stop { tolerance: 0.0, max_iterations: iterations };
        let mut x = MultiVector::zeros(case.x.dim(), case.x.rhs_count());
        let b = case.product(&case.x);
        let report = solver.solve(&case.system(), &b, &mut x, &stop, &mut Quiet).unwrap();
        (report, x)
    }

    #[test]
    fn gauss_seidel_is_relaxation_in_order() {
        let case = m_matrix(20);
        let b = case.product(&case.x);
        let (report, x) = iterate(&GaussSeidel, &case, 3);
        for l in 0..2 {
            let a = a(&case, l);
            let mut u = [0.0; 20];
            for _ in 0..3 {
                for i in 0..20 {
                    let others: f64 = (0..20).filter(|&j| j != i).map(|j| a(i, j) * u[j]).sum();
                    u[i] = (b.row(i)[l] - others) / a(i, i);
                }
            }
            assert!(norm(&difference(&x.vector(l), &u)) < 1e-14);
        }
        assert_eq!((report.work.row_visits, report.work.entries_touched), (60, 1200));
        assert_eq!(report.work.operator_applications, 0);
    }

    #[test]
    fn southwell_takes_the_largest_residual_first() {
        let case = m_matrix(20);
        let b = case.product(&case.x);
        let (report, x) = iterate(&Southwell, &case, 2);
        let a = [a(&case, 0), a(&case, 1)];
        let weight = [norm(&b.vector(0)), norm(&b.vector(1))];
        let (mut u, mut r) = (MultiVector::<f64>::zeros(20, 2), b.clone());
        for _ in 0..40 {
            let size = |i: &usize| (0..2).map(|l| r.row(*i)[l].abs() / weight[l]).fold(0.0, f64::max);
            let i = (0..20).max_by(|i, j| size(i).total_cmp(&size(j))).unwrap();
            for l in 0..2 {
                let step = r.row(i)[l] / a[l](i, i);
                u.row_mut(i)[l] += step;
                (0..20).for_each(|k| r.row_mut(k)[l] -= a[l](k, i) * step);
            }
        }
        assert!(norm(&difference(x.as_slice(), u.as_slice())) < 1e-14);
        assert_eq!((report.work.column_visits, report.work.operator_applications), (40, 2));
        assert_eq!(report.work.entries_touched, 40 * 20 + 2 * 400);
    }
}
