//! A block of low rank, A = U Vᵀ, and the smallest rank that keeps it to a tolerance.
//!
//! With orthonormal factors U = Q_u R_u and V = Q_v R_v, the singular values of A are those of the
//! small R_u R_vᵀ, which one-sided rotations find (G. H. Golub, C. F. Van Loan, Matrix
//! Computations, 4th ed., Johns Hopkins University Press 2013, § 8.6.3).

use fredholm_linop::Scalar;

/// Sweeps of rotations; six are usual.
const SWEEPS: usize = 30;
/// Product of two columns over the square of the Frobenius norm below which they are orthogonal:
/// what is left of columns that depend on others shrinks with every rotation, and would underflow
/// in the end.
const ORTHOGONAL_BELOW: f64 = 1e-32;

/// U and V, column by column.
#[derive(Clone, Debug)]
pub(crate) struct LowRank<T> {
    pub(crate) rank: usize,
    pub(crate) u: Vec<T>,
    pub(crate) v: Vec<T>,
}

impl<T: Scalar> LowRank<T> {
    /// From columns of U and V, with the least rank that leaves `tolerance` times the Frobenius
    /// norm.
    pub(crate) fn truncated(mut u: Vec<Vec<T>>, mut v: Vec<Vec<T>>, tolerance: f64) -> Self {
        let (left, right) = (orthonormal(&mut u), orthonormal(&mut v));
        let rank = u.len();
        // Column j of R_u R_vᵀ; the factors are upper triangles, stored column by column.
        let entry =
            |i: usize, j: usize| (i.max(j)..rank).fold(T::zero(), |sum, k| sum + left[k][i] * right[k][j]);
        let mut core: Vec<Vec<T>> = (0..rank).map(|j| (0..rank).map(|i| entry(i, j)).collect()).collect();
        let turns = rotate(&mut core);
        let mut values: Vec<(f64, usize)> =
            core.iter().enumerate().map(|(j, column)| (square(column), j)).collect();
        values.sort_by(|a, b| b.0.total_cmp(&a.0).then(a.1.cmp(&b.1)));
        let allowed = tolerance * tolerance * values.iter().map(|value| value.0).sum::<f64>();
        let mut dropped = 0.0;
        while let Some(&(value, _)) = values.last().filter(|(value, _)| dropped + value <= allowed) {
            dropped += value;
            values.pop();
        }
        let product = |basis: &[Vec<T>], factors: &[T]| {
            let mut sum = vec![T::zero(); basis.first().map_or(0, Vec::len)];
            for (column, &factor) in basis.iter().zip(factors) {
                sum.iter_mut().zip(column).for_each(|(sum, &x)| *sum += x * factor);
            }
            sum
        };
        let conjugate = |column: &[T]| column.iter().map(|x| x.conj()).collect::<Vec<_>>();
        Self {
            rank: values.len(),
            u: values.iter().flat_map(|&(_, j)| product(&u, &core[j])).collect(),
            v: values.iter().flat_map(|&(_, j)| product(&v, &conjugate(&turns[j]))).collect(),
        }
    }
}

/// Σ |x|².
pub(crate) fn square<T: Scalar>(x: &[T]) -> f64 {
    x.iter().map(|x| x.abs2()).sum()
}

/// Σ conj(x) y.
pub(crate) fn inner<T: Scalar>(x: &[T], y: &[T]) -> T {
    x.iter().zip(y).fold(T::zero(), |sum, (&x, &y)| sum + x.conj() * y)
}

/// Makes columns orthonormal by Gram and Schmidt, twice; returns the columns of the triangle R.
/// Columns that depend on those before become 0.
fn orthonormal<T: Scalar>(columns: &mut [Vec<T>]) -> Vec<Vec<T>> {
    let mut triangle = Vec::with_capacity(columns.len());
    for k in 0..columns.len() {
        let (before, rest) = columns.split_at_mut(k);
        let column = &mut rest[0];
        let original = square(column);
        let mut factors = vec![T::zero(); k + 1];
        for _ in 0..2 {
            for (j, other) in before.iter().enumerate() {
                let along = inner(other, column);
                factors[j] += along;
                column.iter_mut().zip(other).for_each(|(x, &y)| *x -= y * along);
            }
        }
        let length = square(column).sqrt();
        let kept = length > 1e-15 * original.sqrt();
        factors[k] = if kept { T::from_real(length) } else { T::zero() };
        let scale = if kept { length.recip() } else { 0.0 };
        for x in column.iter_mut() {
            *x = x.scale(scale);
        }
        triangle.push(factors);
    }
    // Columns of R with zeros below the diagonal.
    let rank = columns.len();
    for column in &mut triangle {
        column.resize(rank, T::zero());
    }
    triangle
}

/// Turns the columns of C into orthogonal ones, C W; returns W.
fn rotate<T: Scalar>(columns: &mut [Vec<T>]) -> Vec<Vec<T>> {
    let rank = columns.len();
    let unit = |j: usize| (0..rank).map(|i| if i == j { T::one() } else { T::zero() }).collect();
    let mut turns: Vec<Vec<T>> = (0..rank).map(unit).collect();
    let nothing = ORTHOGONAL_BELOW * columns.iter().map(|column| square(column)).sum::<f64>();
    for _ in 0..SWEEPS {
        let mut largest = 0.0_f64;
        for p in 0..rank {
            for q in p + 1..rank {
                let (a, b) = (square(&columns[p]), square(&columns[q]));
                let along = inner(&columns[p], &columns[q]);
                let size = along.abs();
                if size <= 1e-15 * (a * b).sqrt() || size <= nothing {
                    continue;
                }
                largest = largest.max(size / (a * b).sqrt());
                let zeta = (b - a) / (2.0 * size);
                let tangent = zeta.signum() / (zeta.abs() + zeta.hypot(1.0));
                let cosine = tangent.hypot(1.0).recip();
                let phase = along.conj().scale(size.recip());
                for pair in [&mut *columns, &mut *turns] {
                    turn(pair, [p, q], cosine, cosine * tangent, phase);
                }
            }
        }
        if largest < 1e-14 {
            break;
        }
    }
    turns
}

/// (x, y) → (c x − s e y, s x + c e y) for the columns p and q.
fn turn<T: Scalar>(columns: &mut [Vec<T>], [p, q]: [usize; 2], cosine: f64, sine: f64, phase: T) {
    let (first, second) = columns.split_at_mut(q);
    for (x, y) in first[p].iter_mut().zip(&mut second[0]) {
        let (old, other) = (*x, *y * phase);
        *x = old.scale(cosine) - other.scale(sine);
        *y = old.scale(sine) + other.scale(cosine);
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use num_complex::Complex64;

    /// What rotations leave of columns that depend on others underflows when it is squared.
    #[test]
    fn columns_that_have_become_nothing_are_left_alone() {
        let small = 1e-161;
        let columns = [[1.0, 0.0, 0.0], [small, small, 0.0], [0.0, small, small]];
        let mut columns = columns.map(|column| column.map(Complex64::from).to_vec()).to_vec();
        let turns = rotate(&mut columns);
        assert!(columns.iter().chain(&turns).flatten().all(|x| x.is_finite()), "{columns:?} {turns:?}");
        let low = LowRank::truncated(columns.clone(), columns, 1e-12);
        assert!(low.rank == 1 && low.u.iter().chain(&low.v).all(|x| x.is_finite()));
    }
}
