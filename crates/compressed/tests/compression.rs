//! Compressed matrices against the whole ones: errors, memory, threads, solutions.

#![allow(clippy::unwrap_used, reason = "a test that cannot go on has failed")]

use fredholm_compressed::{
    BlockDiagonal, CompressionError, Entries, Factors, Hierarchical, Preconditioned, Settings,
};
use fredholm_iterative::Gmres;
use fredholm_linop::{
    LinearOperator, MultiVector, Quiet, SecondKind, Solver, Stop, StopReason, Symmetry, Watch,
};
use fredholm_mesh::Vec3;
use num_complex::Complex64;
use std::ops::ControlFlow;

/// e^{−jkR}/R between points of a sphere, with its own diagonal; `skew` makes it unsymmetric. Two
/// unknowns a point.
struct Waves {
    places: Vec<Vec3>,
    k: f64,
    skew: f64,
}

impl Waves {
    fn new(count: usize, k: f64, skew: f64) -> Self {
        let place = |i: usize| {
            let height = (2 * i + 1) as f64 / count as f64 - 1.0;
            let (sin, cos) = (2.399_963 * i as f64).sin_cos();
            let ring = (1.0 - height * height).sqrt();
            Vec3::new(ring * cos, ring * sin, height)
        };
        Self { places: (0..count).map(place).collect(), k, skew }
    }

    fn entry(&self, i: usize, j: usize, kinds: usize) -> Complex64 {
        if i == j {
            return if kinds == 1 { Complex64::new(0.5, 0.0) } else { Complex64::from(40.0) };
        }
        let d = self.places[i] - self.places[j];
        let r = d.length();
        Complex64::cis(-self.k * r) / r * (1.0 + self.skew * d.x) * if kinds == 1 { 0.5 } else { 1.0 }
    }
}

impl Entries<Complex64> for Waves {
    type Set = Vec<usize>;

    fn groups(&self) -> usize {
        self.places.len()
    }

    fn width(&self, group: usize) -> usize {
        width(group)
    }

    fn symmetry(&self) -> Symmetry {
        if self.skew == 0.0 { Symmetry::Symmetric } else { Symmetry::General }
    }

    fn prepare(&self, groups: &[usize]) -> Vec<usize> {
        groups.to_vec()
    }

    fn fill(&self, rows: &Vec<usize>, columns: &Vec<usize>, out: &mut [Complex64]) {
        let columns = unknowns(columns.iter().copied());
        let rows = unknowns(rows.iter().copied());
        for (row, out) in rows.into_iter().zip(out.chunks_exact_mut(columns.len().max(1))) {
            for (column, out) in columns.iter().zip(out) {
                *out = self.entry(row.0, column.0, row.1 ^ column.1);
            }
        }
    }
}

/// Every third group has one kind of unknown, the others two.
fn width(group: usize) -> usize {
    if group.is_multiple_of(3) { 1 } else { 2 }
}

/// Group and kind of the unknowns of some groups.
fn unknowns(groups: impl Iterator<Item = usize>) -> Vec<(usize, usize)> {
    groups.flat_map(|group| (0..width(group)).map(move |kind| (group, kind))).collect()
}

fn vector(dim: usize, rhs_count: usize) -> MultiVector<Complex64> {
    MultiVector::from_fn(dim, rhs_count, |i, l| Complex64::cis((i * i % 97 + 3 * l) as f64))
}

/// The product without compression.
fn whole(waves: &Waves, x: &MultiVector<Complex64>) -> MultiVector<Complex64> {
    let all = unknowns(0..waves.places.len());
    MultiVector::from_fn(x.dim(), x.rhs_count(), |i, l| {
        let term = |j: usize| waves.entry(all[i].0, all[j].0, all[i].1 ^ all[j].1) * x.row(j)[l];
        (0..x.dim()).map(term).sum()
    })
}

fn norm(x: &MultiVector<Complex64>) -> f64 {
    x.norms().iter().map(|norm| norm * norm).sum::<f64>().sqrt()
}

#[test]
fn products_are_within_the_tolerance_and_memory_within_the_prediction() {
    for skew in [0.0, 0.3] {
        let waves = Waves::new(1500, 5.0, skew);
        let x = vector(2500, 2);
        let exact = whole(&waves, &x);
        let mut shares = Vec::new();
        for tolerance in [1e-2, 1e-4, 1e-6] {
            let settings = Settings { tolerance, leaf: 24, ..Settings::default() };
            let matrix = Hierarchical::new(&waves, &waves.places, settings, &Quiet).unwrap();
            let mut found = MultiVector::zeros(2500, 2);
            matrix.apply(&x, &mut found);
            found.add_scaled(&[-Complex64::ONE; 2], &exact);
            let error = norm(&found) / norm(&exact);
            assert!(error < tolerance && error > 1e-3 * tolerance, "{skew} {tolerance}: {error:e}");
            let summary = matrix.summary();
            let ratio = summary.bytes as f64 / summary.predicted as f64;
            assert!((0.7..1.4).contains(&ratio) && summary.low_rank > 100, "{summary:?}");
            shares.push(summary.share);
        }
        assert!(shares[0] < shares[1] && shares[1] < shares[2] && shares[0] < 0.6, "{shares:?}");
    }
}

/// What is found with one, two and four threads.
fn with_threads<R: Send>(run: impl Fn() -> R + Sync) -> [R; 3] {
    [1, 2, 4].map(|threads| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
        pool.install(&run)
    })
}

#[test]
fn products_have_the_same_bits_for_any_number_of_threads() {
    let waves = Waves::new(600, 8.0, 0.0);
    let x = vector(1000, 1);
    let products = with_threads(|| {
        let matrix = Hierarchical::new(&waves, &waves.places, Settings::default(), &Quiet).unwrap();
        let mut y = MultiVector::zeros(1000, 1);
        matrix.apply(&x, &mut y);
        y
    });
    assert!(products[0] == products[1] && products[0] == products[2]);
}

#[test]
fn a_preconditioned_system_has_the_solution_of_the_whole_one() {
    let waves = Waves::new(500, 4.0, 0.2);
    let settings = Settings { tolerance: 1e-6, ..Settings::default() };
    let matrix = Hierarchical::new(&waves, &waves.places, settings, &Quiet).unwrap();
    let inverse = BlockDiagonal::new(&matrix).unwrap();
    let system = Preconditioned::new(&matrix, &inverse);
    let exact = vector(833, 1);
    let b = system.right_hand_side(&whole(&waves, &exact));
    let a = SecondKind::new(&system, MultiVector::from_fn(833, 1, |_, _| Complex64::ONE)).unwrap();
    let mut x = MultiVector::zeros(833, 1);
    let stop = Stop { tolerance: 1e-8, max_iterations: 900 };
    let report = Gmres { restart: 300 }.solve(&a, &b, &mut x, &stop, &mut Quiet).unwrap();
    assert_eq!(report.reason, StopReason::Converged);
    x.add_scaled(&[-Complex64::ONE], &exact);
    assert!(norm(&x) < 1e-4 * norm(&exact), "{:e}", norm(&x) / norm(&exact));
}

/// Wants nothing.
struct Ended;

impl Watch for Ended {
    fn go_on(&self) -> ControlFlow<()> {
        ControlFlow::Break(())
    }
}

#[test]
fn what_does_not_fit_is_refused() {
    let waves = Waves::new(300, 4.0, 0.0);
    let new = |places: &[Vec3], settings| Hierarchical::new(&waves, places, settings, &Quiet).map(|_| ());
    let short = new(&waves.places[1..], Settings::default());
    assert_eq!(short, Err(CompressionError::Places { expected: 300, found: 299 }));
    let bad = Settings { tolerance: 0.0, ..Settings::default() };
    assert!(matches!(new(&waves.places, bad), Err(CompressionError::Setting { .. })));
    let little = Settings { limit: 1000, ..Settings::default() };
    assert!(matches!(new(&waves.places, little), Err(CompressionError::Memory { limit: 1000, .. })));
    let ended = Hierarchical::new(&waves, &waves.places, Settings::default(), &Ended).map(|_| ());
    assert_eq!(ended, Err(CompressionError::Interrupted));
    let mut lost = waves.places.clone();
    lost[7] = Vec3::NAN;
    assert_eq!(new(&lost, Settings::default()), Err(CompressionError::NotFinite { group: 7 }));
}

/// ‖x − A⁻¹ A x‖/‖x‖ with the factors.
fn error_of(factors: &Factors<Complex64>, matrix: &Hierarchical<Complex64>) -> f64 {
    let exact = vector(matrix.dim(), 3);
    let mut b = MultiVector::zeros(matrix.dim(), 3);
    matrix.apply(&exact, &mut b);
    let mut x = MultiVector::zeros(matrix.dim(), 3);
    factors.apply(&b, &mut x);
    x.add_scaled(&[-Complex64::ONE; 3], &exact);
    norm(&x) / norm(&exact)
}

#[test]
fn factors_solve_to_their_tolerance() {
    for skew in [0.0, 0.3] {
        let waves = Waves::new(1500, 5.0, skew);
        let settings = Settings { tolerance: 1e-5, leaf: 24, ..Settings::default() };
        let matrix = Hierarchical::new(&waves, &waves.places, settings, &Quiet).unwrap();
        let mut bytes = Vec::new();
        for tolerance in [1e-2, 1e-3, 1e-4, 1e-5] {
            let factors = Factors::new(&matrix, tolerance, u64::MAX, &Quiet).unwrap();
            let error = error_of(&factors, &matrix);
            assert!(error < 3.0 * tolerance && error > 1e-3 * tolerance, "{skew} {tolerance}: {error:e}");
            bytes.push(factors.bytes());
        }
        assert!(bytes.is_sorted() && bytes[0] < bytes[3], "{bytes:?}");
    }
}

#[test]
fn factors_take_at_most_the_limit_and_are_refused_alike_by_any_number_of_threads() {
    for skew in [0.0, 0.3] {
        let waves = Waves::new(900, 6.0, skew);
        let settings = Settings { leaf: 16, ..Settings::default() };
        let matrix = Hierarchical::new(&waves, &waves.places, settings, &Quiet).unwrap();
        let bytes = Factors::new(&matrix, 1e-4, u64::MAX, &Quiet).unwrap().bytes();
        let mut fitted = 0;
        for percent in [1, 40, 60, 80, 90, 97, 99, 100, 103, 120, 160, 200] {
            let limit = bytes * percent / 100;
            let outcomes =
                with_threads(|| Factors::new(&matrix, 1e-4, limit, &Quiet).map(|factors| factors.bytes()));
            match &outcomes[0] {
                Ok(held) => {
                    assert!(*held == bytes && *held <= limit, "{percent}");
                    fitted += 1;
                }
                Err(CompressionError::Factors { needed, limit: of }) => {
                    assert!(*needed > limit && *of == limit, "{percent}: {needed}");
                }
                Err(other) => panic!("{other}"),
            }
            assert!(outcomes[0] == outcomes[1] && outcomes[0] == outcomes[2], "{percent}: {outcomes:?}");
        }
        // What waits between two steps is little.
        assert!((3..=5).contains(&fitted), "{fitted}");
    }
}

/// Twice the same unknown, close to each other or far away.
struct Twins {
    waves: Waves,
    pair: [usize; 2],
}

impl Entries<Complex64> for Twins {
    type Set = Vec<usize>;

    fn groups(&self) -> usize {
        self.waves.groups()
    }

    fn width(&self, _: usize) -> usize {
        1
    }

    fn symmetry(&self) -> Symmetry {
        Symmetry::Symmetric
    }

    fn prepare(&self, groups: &[usize]) -> Vec<usize> {
        let [first, second] = self.pair;
        groups.iter().map(|&group| if group == second { first } else { group }).collect()
    }

    fn fill(&self, rows: &Vec<usize>, columns: &Vec<usize>, out: &mut [Complex64]) {
        for (&i, out) in rows.iter().zip(out.chunks_exact_mut(columns.len().max(1))) {
            columns.iter().zip(out).for_each(|(&j, out)| *out = self.waves.entry(i, j, 0));
        }
    }
}

#[test]
fn a_singular_matrix_has_no_factors_of_which_any_is_not_finite() {
    let mut waves = Waves::new(200, 2.0, 0.0);
    waves.places[51] = waves.places[50] + Vec3::new(1e-3, 0.0, 0.0);
    for second in [51, 199] {
        let twins = Twins { waves: Waves { places: waves.places.clone(), ..waves }, pair: [50, second] };
        let settings = Settings { leaf: 20, ..Settings::default() };
        let matrix = Hierarchical::new(&twins, &twins.waves.places, settings, &Quiet).unwrap();
        match Factors::new(&matrix, 1e-4, u64::MAX, &Quiet) {
            Err(error) => assert!(matches!(error, CompressionError::Singular { .. }), "{error}"),
            Ok(factors) => {
                let mut x = MultiVector::zeros(200, 1);
                factors.apply(&vector(200, 1), &mut x);
                assert!(norm(&x).is_finite(), "{second}");
            }
        }
    }
    let blocks = Twins { waves, pair: [50, 51] };
    let matrix = Hierarchical::new(&blocks, &blocks.waves.places, Settings::default(), &Quiet).unwrap();
    assert!(matches!(BlockDiagonal::new(&matrix), Err(CompressionError::Singular { .. })));
}

#[test]
fn factors_have_the_same_bits_for_any_number_of_threads() {
    for skew in [0.0, 0.2] {
        let waves = Waves::new(700, 8.0, skew);
        let settings = Settings { leaf: 16, ..Settings::default() };
        let matrix = Hierarchical::new(&waves, &waves.places, settings, &Quiet).unwrap();
        let b = vector(matrix.dim(), 20);
        let solutions = with_threads(|| {
            let factors = Factors::new(&matrix, 1e-3, u64::MAX, &Quiet).unwrap();
            let mut x = MultiVector::zeros(b.dim(), b.rhs_count());
            factors.apply(&b, &mut x);
            x
        });
        assert!(solutions[0] == solutions[1] && solutions[0] == solutions[2]);
    }
}

#[test]
fn small_matrices_have_factors_too() {
    for (count, skew) in [(0, 0.0), (0, 0.1), (1, 0.0), (1, 0.1), (2, 0.1), (5, 0.0), (5, 0.1)] {
        let waves = Waves::new(count, 1.0, skew);
        let settings = Settings { tolerance: 1e-6, leaf: 1, ..Settings::default() };
        let matrix = Hierarchical::new(&waves, &waves.places, settings, &Quiet).unwrap();
        let factors = Factors::new(&matrix, 1e-6, u64::MAX, &Quiet).unwrap();
        let error = error_of(&factors, &matrix);
        assert!(error < 1e-5 || count == 0, "{count} {skew}: {error:e}");
    }
}
