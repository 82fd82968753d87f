//! A dense matrix for each lane, y = K_l x; lanes with the same matrix share it.

use fredholm_linop::{Dense, LinearOperator, LinopError, MultiVector};

/// `of_lane[l]` is the index of the matrix of lane l.
pub(super) struct LaneMatrices {
    pub(super) matrices: Vec<Dense<f64>>,
    pub(super) of_lane: Vec<usize>,
    pub(super) dim: usize,
}

impl LaneMatrices {
    pub(super) fn of(&self, lane: usize) -> &Dense<f64> {
        &self.matrices[self.of_lane[lane]]
    }
}

impl LinearOperator<f64> for LaneMatrices {
    fn dim(&self) -> usize {
        self.dim
    }

    fn apply(&self, x: &MultiVector<f64>, y: &mut MultiVector<f64>) {
        for lane in 0..self.of_lane.len() {
            let column = MultiVector::from_fn(x.dim(), 1, |i, _| x.row(i)[lane]);
            let mut image = MultiVector::zeros(x.dim(), 1);
            self.of(lane).apply(&column, &mut image);
            y.set_lane(lane, image.as_slice());
        }
    }

    fn lanes(&self) -> Option<usize> {
        Some(self.of_lane.len())
    }

    fn entries(&self) -> u64 {
        self.of_lane.iter().map(|&at| self.matrices[at].entries()).sum()
    }

    fn row(&self, i: usize, lane: usize, out: &mut [f64]) {
        self.of(lane).row(i, lane, out);
    }

    fn column(&self, j: usize, lane: usize, out: &mut [f64]) {
        self.of(lane).column(j, lane, out);
    }

    fn diagonal(&self, lane: usize, out: &mut [f64]) {
        self.of(lane).diagonal(lane, out);
    }

    fn dense(&self, lane: usize) -> Result<Dense<f64>, LinopError> {
        self.of(lane).dense(lane)
    }
}
