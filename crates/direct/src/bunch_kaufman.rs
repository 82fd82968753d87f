//! P A Pᵀ = L D Lᵀ of a symmetric matrix, real or complex, with D of blocks of one or two rows.
//!
//! Source: J. R. Bunch, L. Kaufman, Math. Comp. 31 (1977) 163, DOI 10.1090/S0025-5718-1977-0428694-0;
//! G. H. Golub, C. F. Van Loan, Matrix Computations, 4th ed., Johns Hopkins University Press 2013,
//! § 4.4. Nothing is conjugated: a complex symmetric matrix is not Hermitian.
//!
//! Columns are eliminated panel by panel: within a panel each column is brought up to date when it
//! is its turn, so that its pivot can be chosen; what lies to the right gets the whole panel at once,
//! by the products of faer. Cost: n³/3 real or 4n³/3 complex operations, half of LU.

use crate::factorisation::par;
use faer::linalg::matmul::matmul;
use faer::linalg::matmul::triangular::{self, BlockStructure};
use faer::linalg::triangular_solve::{
    solve_unit_lower_triangular_in_place, solve_unit_upper_triangular_in_place,
};
use faer::traits::ComplexField;
use faer::{Accum, MatMut, MatRef};
use fredholm_linop::Scalar;
use num_complex::Complex64;

/// Columns of a panel: so many keep the products fast, and their own elimination small. Of 4,900
/// complex unknowns 32, 64 and 96 took 0.71, 0.65 and 0.61 of the time of LU.
pub(crate) const PANEL: usize = 96;

/// The bound (1 + √17)/8 of Bunch and Kaufman: a diagonal entry above this share of the largest of
/// its column is a pivot, and the growth is the least that is possible.
const PIVOT_SHARE: f64 = 0.640_388_203_202_208;

/// A number whose symmetric matrices are factorised. The functions are compiled here, once for each
/// kind: those of faer are generic and long.
pub trait Ldlt: Sized {
    /// The square root; none of a real number below 0.
    fn root(self) -> Option<Self>;
    /// Factorises the lower triangle of a matrix, column by column.
    fn factorise_ldlt(dim: usize, lower: Vec<Self>) -> Factors<Self>;
    /// Solves for right-hand sides one after the other.
    fn substitute_ldlt(factors: &Factors<Self>, b: &mut [Self]);
}

macro_rules! ldlt {
    ($($number:ty, $root:expr;)*) => {$(
        impl Ldlt for $number {
            fn root(self) -> Option<Self> {
                $root(self)
            }

            fn factorise_ldlt(dim: usize, lower: Vec<Self>) -> Factors<Self> {
                factorise(dim, lower)
            }

            fn substitute_ldlt(factors: &Factors<Self>, b: &mut [Self]) {
                substitute(factors, b);
            }
        }
    )*};
}

ldlt! {
    f64, |number: f64| (number >= 0.0).then(|| number.sqrt());
    Complex64, |number: Complex64| Some(number.sqrt());
}

/// The factors of one matrix, in the memory that held it.
#[derive(Debug)]
pub struct Factors<T> {
    dim: usize,
    /// L below the diagonal and D on it, column by column. Above it is what was there.
    lower: Vec<T>,
    /// The entry of D below its diagonal in every column; 0 where no block of two rows begins.
    below: Vec<T>,
    /// Rows that were exchanged, one after the other: step i exchanged i with `exchanged[i]`.
    exchanged: Vec<usize>,
}

impl<T: Scalar> Factors<T> {
    /// The sizes of the blocks of D, in order.
    fn blocks(&self) -> impl Iterator<Item = (usize, Block<T>)> {
        let mut at = 0;
        std::iter::from_fn(move || {
            let first = at;
            let entry = |i: usize| self.lower[i * self.dim + i];
            let block = match self.below.get(first)? {
                below if *below == T::zero() => Block::One(entry(first)),
                below => Block::Two(entry(first), *below, entry(first + 1)),
            };
            at += block.rows();
            Some((first, block))
        })
    }

    /// Whether the smallest block of D is lost in the rounding of the largest, or is no number.
    pub(crate) fn is_singular(&self) -> bool {
        let sizes: Vec<[f64; 2]> = self.blocks().map(|(_, block)| block.sizes()).collect();
        let largest = sizes.iter().map(|[_, largest]| *largest).fold(0.0, f64::max);
        let rounding = f64::EPSILON * self.dim as f64 * largest;
        // Written so that NaN is singular.
        !sizes.iter().all(|[smallest, _]| *smallest > rounding)
    }
}

/// A block of D.
#[derive(Clone, Copy)]
enum Block<T> {
    One(T),
    /// d₁₁, d₂₁ and d₂₂.
    Two(T, T, T),
}

impl<T: Scalar> Block<T> {
    fn rows(self) -> usize {
        match self {
            Self::One(_) => 1,
            Self::Two(..) => 2,
        }
    }

    /// About its smallest and its largest singular value.
    fn sizes(self) -> [f64; 2] {
        match self {
            Self::One(d) => [d.abs(); 2],
            Self::Two(a, b, c) => {
                let largest = a.abs().max(b.abs()).max(c.abs());
                [(a * c - b * b).abs() / largest, largest]
            }
        }
    }

    /// D⁻¹ (p, q), of which a block of one row takes p alone. Divided by d₂₁ first, which is the
    /// largest of a block of two rows, so that nothing overflows.
    fn divide(self, p: T, q: T) -> (T, T) {
        match self {
            Self::One(d) => (p / d, q),
            Self::Two(a, b, c) => {
                let (a, c, p, q) = (a / b, c / b, p / b, q / b);
                let determinant = a * c - T::one();
                ((c * p - q) / determinant, (a * q - p) / determinant)
            }
        }
    }
}

fn factorise<T: Scalar + ComplexField>(dim: usize, lower: Vec<T>) -> Factors<T> {
    let mut factors = Factors { dim, lower, below: vec![T::zero(); dim], exchanged: (0..dim).collect() };
    // Of every column of the panel, L D from its diagonal on; a block may reach one column further.
    let mut panel = vec![T::zero(); dim * (PANEL + 1).min(dim)];
    let mut first = 0;
    while first < dim {
        let end = eliminate(&mut factors, &mut panel, first);
        let matrix = MatMut::from_column_major_slice_mut(&mut factors.lower, dim, dim);
        let (done, rest) = matrix.split_at_col_mut(end);
        let left = done.submatrix(end, first, dim - end, end - first);
        let panel = MatRef::from_column_major_slice(&panel[..dim * (end - first)], dim, end - first);
        triangular::matmul(
            rest.subrows_mut(end, dim - end),
            BlockStructure::TriangularLower,
            Accum::Add,
            left,
            BlockStructure::Rectangular,
            panel.subrows(end, dim - end).transpose(),
            BlockStructure::Rectangular,
            -<T as Scalar>::one(),
            par(),
        );
        first = end;
    }
    factors
}

/// Eliminates the columns of a panel. Returns the first column behind it.
fn eliminate<T: Scalar + ComplexField>(factors: &mut Factors<T>, panel: &mut [T], first: usize) -> usize {
    let n = factors.dim;
    let end = (first + PANEL).min(n);
    let mut k = first;
    while k < end {
        update(factors, panel, [first, k], k);
        let candidate = pivot(factors, panel, [first, k]);
        let (row, rows) = match candidate {
            Pivot::Here => (k, 1),
            Pivot::Row(row) => (row, 1),
            Pivot::Pair(row) => (row, 2),
        };
        let last = k + rows - 1;
        exchange(factors, panel, first, [last, row]);
        factors.exchanged[last] = row;
        divide(factors, panel, first, [k, rows]);
        k += rows;
    }
    k
}

/// What eliminates a column.
enum Pivot {
    /// Its own diagonal entry.
    Here,
    /// That of a row below.
    Row(usize),
    /// The block of two rows of its own and that of a row below.
    Pair(usize),
}

/// Column `row` of what is left from row k on, as the panel so far leaves it, into the panel: that of
/// k itself into the place of column k, a candidate for an exchange with it into the one behind.
fn update<T: Scalar + ComplexField>(
    factors: &Factors<T>,
    panel: &mut [T],
    [first, k]: [usize; 2],
    row: usize,
) {
    let n = factors.dim;
    let place = k - first + usize::from(row != k);
    let (done, column) = panel.split_at_mut(place * n);
    let column = &mut column[..n];
    for (i, entry) in column.iter_mut().enumerate().take(row).skip(k) {
        *entry = factors.lower[i * n + row];
    }
    column[row..].copy_from_slice(&factors.lower[row * n + row..(row + 1) * n]);
    if k == first {
        return;
    }
    let count = k - first;
    let line: Vec<T> = (0..count).map(|j| done[j * n + row]).collect();
    let lower = MatRef::from_column_major_slice(&factors.lower, n, n);
    matmul(
        MatMut::from_column_major_slice_mut(&mut column[k..], n - k, 1),
        Accum::Add,
        lower.submatrix(k, first, n - k, count),
        MatRef::from_column_major_slice(&line, count, 1),
        -<T as Scalar>::one(),
        par(),
    );
}

/// The pivot of column k, whose entries are up to date. Puts what eliminates it into its place, and
/// into that behind it for a block of two rows.
fn pivot<T: Scalar + ComplexField>(factors: &Factors<T>, panel: &mut [T], [first, k]: [usize; 2]) -> Pivot {
    let n = factors.dim;
    let place = (k - first) * n;
    let own = Scalar::abs(panel[place + k]);
    let (row, largest) = largest(&panel[place..place + n], k + 1, usize::MAX);
    // What is no number stays where it is, and is found by `is_singular`.
    if own < PIVOT_SHARE * largest {
        update(factors, panel, [first, k], row);
        let candidate = &panel[place + n..place + 2 * n];
        let (_, beside) = self::largest(candidate, k, row);
        if own * beside < PIVOT_SHARE * largest * largest {
            if Scalar::abs(candidate[row]) < PIVOT_SHARE * beside {
                return Pivot::Pair(row);
            }
            panel.copy_within(place + n..place + 2 * n, place);
            return Pivot::Row(row);
        }
    }
    Pivot::Here
}

/// The row of the largest entry from a row on, but for one, and its size; the first of equals.
fn largest<T: Scalar>(column: &[T], from: usize, but: usize) -> (usize, f64) {
    let mut found = (from, 0.0);
    for (i, entry) in column.iter().enumerate().skip(from) {
        let size = entry.abs();
        if size > found.1 && i != but {
            found = (i, size);
        }
    }
    found
}

/// Exchanges two rows and columns: of L so far and of the panel, and of what is to be eliminated.
fn exchange<T: Scalar>(factors: &mut Factors<T>, panel: &mut [T], first: usize, [upper, row]: [usize; 2]) {
    if upper == row {
        return;
    }
    let (n, lower) = (factors.dim, &mut factors.lower);
    for column in lower[..upper * n].chunks_exact_mut(n) {
        column.swap(upper, row);
    }
    for column in panel[..(upper - first + 1) * n].chunks_exact_mut(n) {
        column.swap(upper, row);
    }
    lower.swap(upper * n + upper, row * n + row);
    for i in upper + 1..row {
        lower.swap(upper * n + i, i * n + row);
    }
    for i in row + 1..n {
        lower.swap(upper * n + i, row * n + i);
    }
}

/// L = (L D) D⁻¹ of the columns of a block, into the matrix.
fn divide<T: Scalar>(factors: &mut Factors<T>, panel: &[T], first: usize, [k, rows]: [usize; 2]) {
    let n = factors.dim;
    let place = (k - first) * n;
    let one = &panel[place..place + n];
    if rows == 1 {
        let pivot = one[k];
        let column = &mut factors.lower[k * n..(k + 1) * n];
        column[k] = pivot;
        let inverse = T::one() / pivot;
        // A column of zeros has no pivot, and needs none.
        if pivot != T::zero() {
            column[k + 1..].iter_mut().zip(&one[k + 1..]).for_each(|(l, &w)| *l = w * inverse);
        }
        return;
    }
    let two = &panel[place + n..place + 2 * n];
    let block = Block::Two(one[k], one[k + 1], two[k + 1]);
    factors.below[k] = one[k + 1];
    let (left, right) = factors.lower[k * n..(k + 2) * n].split_at_mut(n);
    (left[k], left[k + 1], right[k + 1]) = (one[k], T::zero(), two[k + 1]);
    for i in k + 2..n {
        (left[i], right[i]) = block.divide(one[i], two[i]);
    }
}

fn substitute<T: Scalar + ComplexField>(factors: &Factors<T>, b: &mut [T]) {
    let n = factors.dim;
    let count = b.len() / n.max(1);
    for column in b.chunks_exact_mut(n.max(1)) {
        factors.exchanged.iter().enumerate().for_each(|(i, &row)| column.swap(i, row));
    }
    let lower = MatRef::from_column_major_slice(&factors.lower, n, n);
    solve_unit_lower_triangular_in_place(lower, MatMut::from_column_major_slice_mut(b, n, count), par());
    for column in b.chunks_exact_mut(n.max(1)) {
        for (first, block) in factors.blocks() {
            let second = first + block.rows() - 1;
            let (p, q) = block.divide(column[first], column[second]);
            column[second] = q;
            column[first] = p;
        }
    }
    let upper = lower.transpose();
    solve_unit_upper_triangular_in_place(upper, MatMut::from_column_major_slice_mut(b, n, count), par());
    for column in b.chunks_exact_mut(n.max(1)) {
        factors.exchanged.iter().enumerate().rev().for_each(|(i, &row)| column.swap(i, row));
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Numbers in [−½, ½) by a formula.
    fn number(at: usize) -> f64 {
        ((at * 7919 + 13) % 10_007) as f64 / 10_007.0 - 0.5
    }

    /// A symmetric matrix that is not definite, with a diagonal that is `share` of the rest.
    fn matrix(n: usize, share: f64) -> Vec<Complex64> {
        let entry = |i: usize, j: usize| {
            let (low, high) = (i.min(j), i.max(j));
            let value = Complex64::new(number(low * n + high), number(high * (n + 3) + 31 * low));
            if i == j { value * share } else { value }
        };
        (0..n * n).map(|at| entry(at % n, at / n)).collect()
    }

    /// ‖A x − b‖/‖b‖ of two right-hand sides solved together.
    fn residual(n: usize, a: &[Complex64]) -> f64 {
        let b: Vec<Complex64> =
            (0..2 * n).map(|i| Complex64::new(number(3 * i), number(5 * i + 1))).collect();
        let factors = Complex64::factorise_ldlt(n, a.to_vec());
        assert!(!factors.is_singular());
        let mut x = b.clone();
        Complex64::substitute_ldlt(&factors, &mut x);
        let left =
            |rhs: usize, i: usize| -> Complex64 { (0..n).map(|j| a[j * n + i] * x[rhs * n + j]).sum() };
        let squares = (0..2 * n).map(|at| (left(at / n, at % n) - b[at]).norm_sqr()).sum::<f64>();
        (squares / b.iter().map(Complex64::norm_sqr).sum::<f64>()).sqrt()
    }

    #[test]
    fn systems_are_solved_with_any_pivots() {
        // Panels that are full, end with a block of two rows, or are short; a diagonal of zeros,
        // which no single row eliminates, and one that takes all.
        for n in [1, 2, 3, 5, PANEL - 1, PANEL, PANEL + 1, PANEL + 2, 2 * PANEL, 200, 301] {
            for share in [0.0, 0.3, 1.0, 50.0] {
                if n > 1 || share > 0.0 {
                    let found = residual(n, &matrix(n, share));
                    assert!(found < 1e-11, "{n} {share}: {found:e}");
                }
            }
        }
    }

    #[test]
    fn blocks_of_two_rows_stand_for_zeros_on_the_diagonal() {
        // [0 2; 2 0] (x, y) = (6, 10).
        let factors = f64::factorise_ldlt(2, vec![0.0, 2.0, 2.0, 0.0]);
        let mut b = [6.0, 10.0];
        f64::substitute_ldlt(&factors, &mut b);
        assert!((b[0] - 5.0).abs() < 1e-15 && (b[1] - 3.0).abs() < 1e-15);
    }

    #[test]
    fn singular_matrices_are_known() {
        for rows in [vec![0.0; 9], vec![1.0, 2.0, 3.0, 2.0, 4.0, 6.0, 3.0, 6.0, 9.0], vec![f64::NAN; 9]] {
            assert!(f64::factorise_ldlt(3, rows).is_singular());
        }
        let mut a = matrix(100, 1.0);
        for i in 0..100 {
            // Row 70 is row 20, and so are the columns.
            a[i * 100 + 70] = a[i * 100 + 20];
        }
        for i in 0..100 {
            a[70 * 100 + i] = a[20 * 100 + i];
        }
        assert!(Complex64::factorise_ldlt(100, a).is_singular());
    }

    #[test]
    fn the_bits_do_not_depend_on_the_number_of_threads() {
        let with = |threads: usize| {
            let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
            pool.install(|| Complex64::factorise_ldlt(300, matrix(300, 0.3)).lower)
        };
        assert!(with(1) == with(2) && with(1) == with(3));
    }
}
