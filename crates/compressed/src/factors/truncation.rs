//! U Vᵀ with fewer columns: U = Q R, then V Rᵀ = Q₂ S with the largest columns first, of which
//! those are kept that the tolerance asks for; U′ = Q Sᵀ, V′ = Q₂. Since Q has orthonormal columns,
//! what is left out has the Frobenius norm of the rows of S that are left out (G. H. Golub, C. F.
//! Van Loan, Matrix Computations, 4th ed., Johns Hopkins University Press 2013, § 5.4.2).

use crate::Number;
use faer::dyn_stack::{MemBuffer, MemStack};
use faer::linalg::householder::{
    apply_block_householder_sequence_on_the_left_in_place_scratch,
    apply_block_householder_sequence_on_the_left_in_place_with_conj,
};
use faer::linalg::matmul::matmul;
use faer::linalg::qr::{col_pivoting, no_pivoting};
use faer::traits::math_utils::{one, zero};
use faer::{Accum, Conj, Mat, MatRef, Par, Spec};

/// The square of what counts as nothing beside entries of the order of 1, long before it is lost in
/// single precision.
const NOTHING: f64 = 1e-60;

/// The product of two matrices.
pub(super) fn product<N: Number>(a: MatRef<'_, N>, b: MatRef<'_, N>) -> Mat<N> {
    let mut c = Mat::zeros(a.nrows(), b.ncols());
    matmul(c.as_mut(), Accum::Replace, a, b, one(), Par::Seq);
    c
}

/// The factors of U Vᵀ with the fewest columns that leave `tolerance` times its Frobenius norm.
pub(super) fn truncated<N: Number>(u: Mat<N>, v: &Mat<N>, tolerance: f64) -> [Mat<N>; 2] {
    let [q, r] = orthogonal(u);
    let rest = product(v.as_ref(), r.transpose());
    // Columns are compared with the largest one, which has to be there, and to be more than nothing.
    if rest.col_iter().all(|column| column.iter().all(|&x| x.square() < NOTHING)) {
        return [Mat::zeros(q.nrows(), 0), Mat::zeros(v.nrows(), 0)];
    }
    let (basis, order, coefficients) = pivoted(rest);
    let size = coefficients.nrows();
    let row = |i: usize| (i..coefficients.ncols()).map(|j| coefficients[(i, j)].square()).sum::<f64>();
    let squares: Vec<f64> = (0..size).map(row).collect();
    let allowed = tolerance * tolerance * squares.iter().sum::<f64>();
    let (mut rank, mut left) = (size, 0.0);
    while rank > 0 && left + squares[rank - 1] <= allowed {
        rank -= 1;
        left += squares[rank];
    }
    // Column j of the coefficients is that of column order[j] of V Rᵀ.
    let mut sorted = Mat::zeros(q.ncols(), rank);
    for (j, &at) in order.iter().enumerate() {
        for i in 0..rank.min(j + 1) {
            sorted[(at, i)] = coefficients[(i, j)];
        }
    }
    [product(q.as_ref(), sorted.as_ref()), basis.subcols(0, rank).to_owned()]
}

/// Q and R with A = Q R.
fn orthogonal<N: Number>(mut a: Mat<N>) -> [Mat<N>; 2] {
    let (m, n) = a.shape();
    let size = m.min(n);
    let block = no_pivoting::factor::recommended_block_size::<N>(m, n);
    let mut factor = Mat::zeros(block, size);
    let scratch = no_pivoting::factor::qr_in_place_scratch::<N>(m, n, block, Par::Seq, Spec::default());
    let mut buffer = MemBuffer::new(scratch);
    let stack = MemStack::new(&mut buffer);
    no_pivoting::factor::qr_in_place(a.as_mut(), factor.as_mut(), Par::Seq, stack, Spec::default());
    let r = upper(&a);
    [columns_of(&a, &factor), r]
}

/// Q, the order of the columns and S with A P = Q S, the largest columns first.
fn pivoted<N: Number>(mut a: Mat<N>) -> (Mat<N>, Vec<usize>, Mat<N>) {
    let (m, n) = a.shape();
    let block = col_pivoting::factor::recommended_block_size::<N>(m, n);
    let mut factor = Mat::zeros(block, m.min(n));
    let scratch =
        col_pivoting::factor::qr_in_place_scratch::<usize, N>(m, n, block, Par::Seq, Spec::default());
    let mut buffer = MemBuffer::new(scratch);
    let (mut order, mut inverse) = (vec![0; n], vec![0; n]);
    col_pivoting::factor::qr_in_place(
        a.as_mut(),
        factor.as_mut(),
        &mut order,
        &mut inverse,
        Par::Seq,
        MemStack::new(&mut buffer),
        Spec::default(),
    );
    let r = upper(&a);
    (columns_of(&a, &factor), order, r)
}

/// The upper triangle, or trapezium.
fn upper<N: Number>(a: &Mat<N>) -> Mat<N> {
    Mat::from_fn(a.nrows().min(a.ncols()), a.ncols(), |i, j| if i <= j { a[(i, j)] } else { zero() })
}

/// The orthonormal columns of a sequence of reflections.
fn columns_of<N: Number>(reflections: &Mat<N>, factor: &Mat<N>) -> Mat<N> {
    let (m, size) = (reflections.nrows(), factor.ncols());
    let mut q = Mat::<N>::identity(m, size);
    let scratch = apply_block_householder_sequence_on_the_left_in_place_scratch::<N>(m, factor.nrows(), size);
    apply_block_householder_sequence_on_the_left_in_place_with_conj(
        reflections.subcols(0, size),
        factor.as_ref(),
        Conj::No,
        q.as_mut(),
        Par::Seq,
        MemStack::new(&mut MemBuffer::new(scratch)),
    );
    q
}

#[cfg(test)]
mod tests {
    use super::*;
    use num_complex::Complex32;

    /// Columns of which each is about a third of the one before, on the left and on the right.
    fn factor(rows: usize, columns: usize, seed: usize) -> Mat<Complex32> {
        Mat::from_fn(rows, columns, |i, j| {
            let angle = ((i + 1) * (j + seed) * (i + 3) % 101) as f32;
            Complex32::cis(angle) * 0.3_f32.powi(j as i32)
        })
    }

    fn norm(a: &Mat<Complex32>) -> f64 {
        a.col_iter()
            .flat_map(|column| column.iter().map(|x| x.square()).collect::<Vec<_>>())
            .sum::<f64>()
            .sqrt()
    }

    #[test]
    fn what_is_left_out_is_within_the_tolerance_and_little_more_is_kept_than_has_to_be() {
        for (m, n, rank) in [(60, 40, 20), (12, 50, 20), (50, 12, 20), (9, 8, 3)] {
            let (u, v) = (factor(m, rank, 2), factor(n, rank, 5));
            let whole = product(u.as_ref(), v.transpose());
            for tolerance in [0.3, 1e-2, 1e-4] {
                let [left, right] = truncated(u.clone(), &v, tolerance);
                let error = norm(&(&product(left.as_ref(), right.transpose()) - &whole)) / norm(&whole);
                // Every column is smaller than the one before by a factor of ten, on both sides.
                let needed = (tolerance.ln() / 0.09_f64.ln()).ceil() as usize;
                assert!(error <= 1.01 * tolerance, "{m} {n} {tolerance}: {error:e}");
                assert!(left.ncols() <= needed + 2, "{m} {n} {tolerance}: {}", left.ncols());
            }
        }
        // Columns whose squares single precision cannot hold.
        for small in [1e-12_f32, 1e-18, 1e-21, 1e-30, 1e-38, 1e-44] {
            let scaled = |a: Mat<Complex32>, few: bool| {
                let scale = |j: usize| if few && j < 3 { 1.0 } else { small };
                Mat::from_fn(a.nrows(), a.ncols(), |i, j| a[(i, j)] * scale(j))
            };
            for (few, both) in [(true, false), (false, false), (false, true)] {
                let (u, v) = (scaled(factor(40, 8, 2), few), factor(30, 8, 5));
                let v = if both { scaled(v, few) } else { v };
                let whole = product(u.as_ref(), v.transpose());
                let [left, right] = truncated(u, &v, 1e-3);
                let error = norm(&(&product(left.as_ref(), right.transpose()) - &whole));
                assert!(error <= 1.1e-3 * norm(&whole) + 1e-19, "{small} {few} {both}: {error:e}");
            }
        }
        for rank in [0, 2] {
            let [left, right] = truncated(Mat::<f32>::zeros(5, rank), &Mat::zeros(4, rank), 1e-3);
            assert!(left.shape() == (5, 0) && right.shape() == (4, 0));
        }
    }
}
