//! P M = L U of a small matrix, by elimination with partial pivoting.
//!
//! Source: G. H. Golub, C. F. Van Loan, Matrix Computations, 4th ed., Johns Hopkins University
//! Press 2013, § 3.4.

use fredholm_linop::Scalar;

/// The factors of an n × n matrix, row by row.
pub(crate) struct SmallLu<T> {
    n: usize,
    factors: Vec<T>,
    order: Vec<usize>,
}

impl<T: Scalar> SmallLu<T> {
    /// Factorises a matrix given row by row, or nothing where it is singular.
    pub fn new(n: usize, mut matrix: Vec<T>) -> Option<Self> {
        let mut order: Vec<usize> = (0..n).collect();
        for k in 0..n {
            let size = |i: usize| matrix[i * n + k].abs();
            let pivot = (k..n).max_by(|&i, &j| size(i).total_cmp(&size(j)))?;
            if size(pivot) == 0.0 || !size(pivot).is_finite() {
                return None;
            }
            order.swap(k, pivot);
            (0..n).for_each(|j| matrix.swap(k * n + j, pivot * n + j));
            eliminate(&mut matrix, n, k);
        }
        Some(Self { n, factors: matrix, order })
    }

    /// M⁻¹ v.
    pub fn solve(&self, v: &[T]) -> Vec<T> {
        let (n, f) = (self.n, &self.factors);
        let mut x: Vec<T> = self.order.iter().map(|&i| v[i]).collect();
        for i in 0..n {
            x[i] = (0..i).fold(x[i], |sum, j| sum - f[i * n + j] * x[j]);
        }
        for i in (0..n).rev() {
            x[i] = (i + 1..n).fold(x[i], |sum, j| sum - f[i * n + j] * x[j]) / f[i * n + i];
        }
        x
    }
}

fn eliminate<T: Scalar>(matrix: &mut [T], n: usize, k: usize) {
    for i in k + 1..n {
        let factor = matrix[i * n + k] / matrix[k * n + k];
        matrix[i * n + k] = factor;
        for j in k + 1..n {
            let above = matrix[k * n + j];
            matrix[i * n + j] -= factor * above;
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn rows_are_exchanged_where_a_pivot_is_zero() {
        // [0 2; 3 1] (1, 2) = (4, 5).
        let lu = SmallLu::new(2, vec![0.0, 2.0, 3.0, 1.0]).unwrap();
        assert_eq!(lu.solve(&[4.0, 5.0]), [1.0, 2.0]);
        assert!(SmallLu::new(2, vec![1.0, 2.0, 2.0, 4.0]).is_none());
    }

    #[test]
    fn a_matrix_times_its_solution_is_the_right_hand_side() {
        let entry =
            |i: usize, j: usize| ((i * 7 + j * 3) % 11) as f64 - 4.0 + f64::from(u8::from(i == j)) * 9.0;
        let lu = SmallLu::new(6, (0..36).map(|at| entry(at / 6, at % 6)).collect()).unwrap();
        let x = lu.solve(&[1.0, -2.0, 3.0, 0.5, 4.0, -1.0]);
        let row = |i: usize| (0..6).map(|j| entry(i, j) * x[j]).sum::<f64>();
        for (i, b) in [1.0, -2.0, 3.0, 0.5, 4.0, -1.0].into_iter().enumerate() {
            assert!((row(i) - b).abs() < 1e-13);
        }
    }
}
