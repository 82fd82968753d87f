//! Every operator, against plain loops over a full matrix.

#![allow(clippy::needless_range_loop, clippy::unwrap_used)]

mod common;

use common::{
    Case, Draw, Full, Random, assert_close, cases, draw_full, draw_vector, mirrored, packed, product,
    real_cases, second_kind,
};
use fredholm_linop::{LinearOperator, LinopError, MultiVector, PackedSymmetric, SecondKind, Sweep};
use num_complex::Complex64;
use std::ops::ControlFlow;

const TOLERANCE: f64 = 1e-12;

/// An operator, its matrices by plain loops, and a vector that fits.
struct Trial<'a, T> {
    name: String,
    operator: &'a dyn LinearOperator<T>,
    matrices: &'a [Full<T>],
    x: MultiVector<T>,
}

/// Checks every operator, and I − D K around it.
fn for_each_trial<T: Draw>(cases: &[Case<T>], random: &mut Random, check: fn(&Trial<'_, T>)) {
    for Case { name, operator, matrices } in cases {
        for rhs_count in operator.rhs_count().map_or(vec![1, 2, 3, 5], |rhs_count| vec![rhs_count]) {
            let (dim, operator) = (operator.dim(), &**operator);
            let name = format!("{name}, n = {dim}, {rhs_count} right-hand sides");
            let x = draw_vector(dim, rhs_count, random);
            let factor = draw_vector(dim, rhs_count, random);
            let system = SecondKind::new(operator, factor.clone()).unwrap();
            let matrices_of_system = second_kind(matrices, &factor);
            let name_of_system = format!("second kind around {name}");
            check(&Trial { name, operator, matrices, x: x.clone() });
            check(&Trial { name: name_of_system, operator: &system, matrices: &matrices_of_system, x });
        }
    }
}

fn for_all(sizes: &[usize], real: fn(&Trial<'_, f64>), complex: fn(&Trial<'_, Complex64>)) {
    let mut random = Random::new(7);
    for &dim in sizes {
        let mut reals = cases::<f64>(dim, &mut random);
        reals.extend(real_cases(dim, &mut random));
        for_each_trial(&reals, &mut random, real);
        let complexes = cases::<Complex64>(dim, &mut random);
        for_each_trial(&complexes, &mut random, complex);
    }
}

fn check_product<T: Draw>(trial: &Trial<'_, T>) {
    let mut y = MultiVector::from_fn(trial.x.dim(), trial.x.rhs_count(), |_, _| T::from_real(f64::NAN));
    trial.operator.apply(&trial.x, &mut y);
    let expected = product(trial.matrices, &trial.x);
    assert_close(y.as_slice(), expected.as_slice(), TOLERANCE, &trial.name);
}

#[test]
fn products_are_the_plain_sums() {
    for_all(&[1, 2, 13, 40], check_product, check_product);
}

#[test]
fn products_cut_into_many_runs_are_the_plain_sums() {
    let mut random = Random::new(1);
    for_each_trial(&real_cases(700, &mut random), &mut random, check_product);
}

fn check_entries<T: Draw>(trial: &Trial<'_, T>) {
    let n = trial.operator.dim();
    let (mut row, mut column, mut diagonal) = (vec![T::zero(); n], vec![T::zero(); n], vec![T::zero(); n]);
    for rhs in 0..trial.x.rhs_count() {
        let full = &trial.matrices[rhs % trial.matrices.len()];
        let dense = trial.operator.dense(rhs).unwrap();
        trial.operator.diagonal(rhs, &mut diagonal);
        for i in 0..n {
            trial.operator.row(i, rhs, &mut row);
            trial.operator.column(i, rhs, &mut column);
            let expected: Vec<T> = (0..n).map(|k| full[k][i]).collect();
            assert_close(&row, &full[i], TOLERANCE, &trial.name);
            trial.operator.lower_row(i, rhs, &mut row[..=i]);
            assert_close(&row[..=i], &full[i][..=i], TOLERANCE, &trial.name);
            assert_close(&column, &expected, TOLERANCE, &trial.name);
            assert_close(dense.row_slice(i), &full[i], TOLERANCE, &trial.name);
            assert_close(&diagonal[i..=i], &full[i][i..=i], TOLERANCE, &trial.name);
        }
    }
}

#[test]
fn rows_columns_and_diagonals_are_those_of_the_matrix() {
    for_all(&[1, 2, 9], check_entries, check_entries);
}

/// Two sweeps that add random steps, after one that changes nothing.
fn check_sweep<T: Draw>(trial: &Trial<'_, T>) {
    let (mut random, mut x) = (Random::new(3), trial.x.clone());
    let mut sweep = Sweep::new(trial.x.dim(), trial.x.rhs_count());
    for size in [0.0, 1.0, 1.0] {
        let mut shadow = x.clone();
        let mut next = 0;
        let flow = trial.operator.sweep(&mut x, &mut sweep, &mut |visit| {
            assert_eq!(visit.index, next);
            next += 1;
            let i = visit.index;
            let whole = product(trial.matrices, &shadow);
            for l in 0..shadow.rhs_count() {
                let diagonal = trial.matrices[l % trial.matrices.len()][i][i];
                let rest = whole.row(i)[l] - diagonal * shadow.row(i)[l];
                if size > 0.0 {
                    assert_close(&visit.off_diagonal[l..=l], &[rest], TOLERANCE, &trial.name);
                }
                assert_close(&visit.diagonal[l..=l], &[diagonal], TOLERANCE, &trial.name);
                visit.x[l] += T::draw(&mut random).scale(size);
            }
            shadow.row_mut(i).copy_from_slice(visit.x);
            ControlFlow::Continue(())
        });
        assert_eq!((flow, next), (ControlFlow::Continue(()), trial.x.dim()));
        let expected = product(trial.matrices, &x);
        assert_close(sweep.product().as_slice(), expected.as_slice(), TOLERANCE, &trial.name);
    }
}

#[test]
fn sweeps_see_the_newest_values_and_end_with_the_product() {
    for_all(&[1, 2, 13, 24], check_sweep, check_sweep);
}

/// Backward sweeps that add random steps, each between two forward ones.
fn check_sweep_back<T: Draw>(trial: &Trial<'_, T>) {
    let (mut random, mut x) = (Random::new(5), trial.x.clone());
    let mut sweep = Sweep::new(trial.x.dim(), trial.x.rhs_count());
    let _ = trial.operator.sweep(&mut x, &mut sweep, &mut |_| ControlFlow::Continue(()));
    for _ in 0..2 {
        let mut shadow = x.clone();
        let mut next = x.dim();
        let flow = trial.operator.sweep_back(&mut x, &mut sweep, &mut |visit| {
            next -= 1;
            assert_eq!(visit.index, next);
            let i = visit.index;
            let whole = product(trial.matrices, &shadow);
            for l in 0..shadow.rhs_count() {
                let diagonal = trial.matrices[l % trial.matrices.len()][i][i];
                let rest = whole.row(i)[l] - diagonal * shadow.row(i)[l];
                assert_close(&visit.off_diagonal[l..=l], &[rest], TOLERANCE, &trial.name);
                assert_close(&visit.diagonal[l..=l], &[diagonal], TOLERANCE, &trial.name);
                visit.x[l] += T::draw(&mut random);
            }
            shadow.row_mut(i).copy_from_slice(visit.x);
            ControlFlow::Continue(())
        });
        assert_eq!((flow, next), (ControlFlow::Continue(()), 0));
        let before = product(trial.matrices, &x);
        let _ = trial.operator.sweep(&mut x, &mut sweep, &mut |visit| {
            let i = visit.index;
            let diagonal = trial.matrices[0][i][i];
            let rest = before.row(i)[0] - diagonal * visit.x[0];
            assert_close(&visit.off_diagonal[..1], &[rest], TOLERANCE, &trial.name);
            ControlFlow::Continue(())
        });
        assert_close(sweep.product().as_slice(), before.as_slice(), TOLERANCE, &trial.name);
    }
}

#[test]
fn backward_sweeps_see_the_newest_values_and_leave_the_state_of_the_next_forward_one() {
    for_all(&[1, 2, 13, 24], check_sweep_back, check_sweep_back);
}

#[test]
fn states_of_sweeps_are_blended_as_the_vectors_are() {
    let mut random = Random::new(6);
    for case in real_cases(9, &mut random) {
        let rhs_count = case.operator.rhs_count().unwrap_or(2);
        let [u, v] = [0, 1].map(|_| draw_vector::<f64>(9, rhs_count, &mut random));
        let state = |x: &MultiVector<f64>| {
            let mut sweep = Sweep::new(9, rhs_count);
            let _ = case.operator.sweep(&mut x.clone(), &mut sweep, &mut |_| ControlFlow::Continue(()));
            sweep
        };
        let alpha: Vec<f64> = (0..rhs_count).map(|l| 0.3 + 1.1 * l as f64).collect();
        let mixed = MultiVector::from_fn(9, rhs_count, |i, l| {
            alpha[l] * u.row(i)[l] + (1.0 - alpha[l]) * v.row(i)[l]
        });
        let (mut blended, expected) = (state(&u), state(&mixed));
        blended.mix(&alpha, &state(&v));
        assert_close(blended.product().as_slice(), expected.product().as_slice(), TOLERANCE, &case.name);
        assert_close(blended.upper().as_slice(), expected.upper().as_slice(), TOLERANCE, &case.name);
    }
}

#[test]
fn a_sweep_ends_where_it_is_broken_off() {
    let mut random = Random::new(4);
    for case in real_cases(6, &mut random) {
        let mut x = MultiVector::zeros(6, 1);
        let flow = case.operator.sweep(&mut x, &mut Sweep::new(6, 1), &mut |visit| {
            if visit.index == 3 {
                return ControlFlow::Break(());
            }
            visit.x[0] = 1.0;
            ControlFlow::Continue(())
        });
        assert_eq!(flow, ControlFlow::Break(()));
        assert_eq!(x.as_slice(), [1.0, 1.0, 1.0, 0.0, 0.0, 0.0]);
    }
}

fn bits(v: &MultiVector<f64>) -> Vec<u64> {
    v.as_slice().iter().map(|value| value.to_bits()).collect()
}

#[test]
fn the_number_of_threads_changes_no_bit() {
    let mut random = Random::new(5);
    let mut operators = real_cases(600, &mut random);
    operators.push(cases::<f64>(600, &mut random).swap_remove(0));
    for case in operators {
        for rhs_count in [1, 2, 3] {
            let x = draw_vector(600, rhs_count, &mut random);
            let on = |threads| {
                let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
                let mut y = MultiVector::zeros(600, rhs_count);
                pool.install(|| case.operator.apply(&x, &mut y));
                bits(&y)
            };
            let one = on(1);
            assert!(
                [2, 3, 4].into_iter().all(|threads| on(threads) == one),
                "{}, {rhs_count} right-hand sides",
                case.name
            );
        }
    }
}

#[test]
fn single_precision_storage_is_within_a_millionth() {
    let mut random = Random::new(6);
    let positive = (0..200).map(|_| (0..200).map(|_| random.next()).collect()).collect();
    let full = mirrored(positive, |entry| entry);
    let x = MultiVector::from_fn(200, 3, |_, _| random.next());
    let (mut double, mut single) = (MultiVector::zeros(200, 3), MultiVector::zeros(200, 3));
    packed::<f64>(&full).apply(&x, &mut double);
    packed::<f32>(&full).apply(&x, &mut single);
    let ratios = single.as_slice().iter().zip(double.as_slice()).map(|(a, b)| (a / b - 1.0).abs());
    let worst = ratios.fold(0.0, f64::max);
    assert!(worst > 0.0 && worst < 1e-6, "{worst:e}");
}

#[test]
fn row_sums_are_the_plain_sums() {
    let full = mirrored(draw_full::<f64>(50, &mut Random::new(8)), |entry| entry);
    let sums: Vec<f64> = full.iter().map(|row| row.iter().sum()).collect();
    assert_close(&packed::<f64>(&full).row_sums(), &sums, TOLERANCE, "row sums");
}

#[test]
fn stored_entries_are_counted_once() {
    let mut random = Random::new(9);
    for case in real_cases(10, &mut random) {
        let system = SecondKind::new(&*case.operator, MultiVector::zeros(10, 3)).unwrap();
        assert_eq!((case.operator.entries(), system.entries()), (55, 55));
    }
}

#[test]
fn a_factor_that_does_not_fit_is_refused() {
    let coupling = PackedSymmetric::new(2, vec![0.0; 3]).unwrap();
    let wrong = LinopError::Factor { found: 3, rhs_count: 1, expected: 2, operator_rhs: 1 };
    assert_eq!(SecondKind::new(&coupling, MultiVector::zeros(3, 1)).err(), Some(wrong));
    let factor = MultiVector::from_vec(2, 2, vec![0.0, 0.0, 0.0, f64::NAN]).unwrap();
    let wrong = LinopError::NotFinite { what: "the diagonal factor", unknown: 1, rhs: 1 };
    assert_eq!(SecondKind::new(&coupling, factor).err(), Some(wrong));
    let per_rhs = cases::<f64>(2, &mut Random::new(1)).pop().unwrap();
    let wrong = LinopError::Factor { found: 2, rhs_count: 3, expected: 2, operator_rhs: 2 };
    assert_eq!(SecondKind::new(&*per_rhs.operator, MultiVector::zeros(2, 3)).err(), Some(wrong));
}

#[test]
fn right_hand_sides_of_equal_factors_have_the_same_matrix() {
    let coupling = PackedSymmetric::new(2, vec![0.0; 3]).unwrap();
    let factor = MultiVector::from_vec(2, 3, vec![0.5, 0.1, 0.5, 0.2, 0.2, 0.2]).unwrap();
    let system = SecondKind::new(&coupling, factor).unwrap();
    assert!(system.same_matrix(0, 2) && system.same_matrix(1, 1) && !system.same_matrix(0, 1));
    let per_rhs = cases::<f64>(2, &mut Random::new(1)).pop().unwrap();
    let system = SecondKind::new(&*per_rhs.operator, MultiVector::zeros(2, 2)).unwrap();
    assert!(!system.same_matrix(0, 1));
}

fn check_column_step<T: Draw>(trial: &Trial<'_, T>) {
    let n = trial.operator.dim();
    let mut random = Random::new(11);
    let factor: MultiVector<T> = draw_vector(n, trial.x.rhs_count(), &mut random);
    let system = SecondKind::new(trial.operator, factor.clone()).unwrap();
    let matrices = second_kind(trial.matrices, &factor);
    let (j, step) = (n / 2, draw_vector::<T>(1, trial.x.rhs_count(), &mut random));
    let mut residual = trial.x.clone();
    let reads = system.subtract_column(j, step.row(0), &mut residual, &mut vec![T::zero(); n]);
    let expected = MultiVector::from_fn(n, trial.x.rhs_count(), |i, l| {
        trial.x.row(i)[l] - matrices[l][i][j] * step.row(0)[l]
    });
    assert_close(residual.as_slice(), expected.as_slice(), TOLERANCE, &trial.name);
    assert_eq!(reads, (n * trial.operator.rhs_count().unwrap_or(1)) as u64);
}

#[test]
fn a_step_takes_its_column_from_the_residual() {
    for_all(&[1, 7], check_column_step, check_column_step);
}
