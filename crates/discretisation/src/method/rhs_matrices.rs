//! A dense matrix for each right-hand side, y = K_l x; right-hand sides with the same matrix share
//! it.

use fredholm_linop::{Dense, LinearOperator, LinopError, MultiVector};

/// `of_rhs[l]` is the index of the matrix of right-hand side l.
pub(super) struct RhsMatrices {
    pub(super) matrices: Vec<Dense<f64>>,
    pub(super) of_rhs: Vec<usize>,
    pub(super) dim: usize,
}

impl RhsMatrices {
    pub(super) fn of(&self, rhs: usize) -> &Dense<f64> {
        &self.matrices[self.of_rhs[rhs]]
    }
}

impl LinearOperator<f64> for RhsMatrices {
    fn dim(&self) -> usize {
        self.dim
    }

    fn apply(&self, x: &MultiVector<f64>, y: &mut MultiVector<f64>) {
        for rhs in 0..self.of_rhs.len() {
            let column = MultiVector::from_fn(x.dim(), 1, |i, _| x.row(i)[rhs]);
            let mut image = MultiVector::zeros(x.dim(), 1);
            self.of(rhs).apply(&column, &mut image);
            y.set_vector(rhs, image.as_slice());
        }
    }

    fn rhs_count(&self) -> Option<usize> {
        Some(self.of_rhs.len())
    }

    fn entries(&self) -> u64 {
        self.of_rhs.iter().map(|&at| self.matrices[at].entries()).sum()
    }

    fn row(&self, i: usize, rhs: usize, out: &mut [f64]) {
        self.of(rhs).row(i, rhs, out);
    }

    fn column(&self, j: usize, rhs: usize, out: &mut [f64]) {
        self.of(rhs).column(j, rhs, out);
    }

    fn diagonal(&self, rhs: usize, out: &mut [f64]) {
        self.of(rhs).diagonal(rhs, out);
    }

    fn dense(&self, rhs: usize) -> Result<Dense<f64>, LinopError> {
        self.of(rhs).dense(rhs)
    }
}
