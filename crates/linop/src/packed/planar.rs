//! Vectors one after the other, as the inner loops read them in long runs: entry (i, l) at
//! l · dim + i.

use crate::MultiVector;

/// Vectors one after the other.
pub(super) struct Planar {
    dim: usize,
    data: Vec<f64>,
}

impl Planar {
    pub fn zeros(dim: usize, rhs_count: usize) -> Self {
        Self { dim, data: vec![0.0; dim * rhs_count] }
    }

    pub fn copied(v: &MultiVector<f64>) -> Self {
        let mut copy = Self::zeros(v.dim(), v.rhs_count());
        v.rows().enumerate().for_each(|(i, row)| copy.set_row(i, row));
        copy
    }

    /// L vectors from vector `first` on.
    #[inline(always)]
    pub fn vectors<const L: usize>(&self, first: usize) -> [&[f64]; L] {
        std::array::from_fn(|l| &self.data[(first + l) * self.dim..(first + l + 1) * self.dim])
    }

    /// Entry i of all vectors.
    pub fn row(&self, i: usize) -> impl Iterator<Item = f64> {
        self.data.iter().skip(i).step_by(self.dim.max(1)).copied()
    }

    pub fn set_row(&mut self, i: usize, row: &[f64]) {
        for (rhs, &value) in self.data.chunks_exact_mut(self.dim.max(1)).zip(row) {
            rhs[i] = value;
        }
    }

    pub fn clear_row(&mut self, i: usize) {
        self.data.iter_mut().skip(i).step_by(self.dim.max(1)).for_each(|value| *value = 0.0);
    }

    pub fn view_mut(&mut self) -> PlanarMut<'_> {
        PlanarMut { dim: self.dim, data: &mut self.data }
    }
}

/// Vectors one after the other in memory that is kept elsewhere.
pub(super) struct PlanarMut<'a> {
    dim: usize,
    data: &'a mut [f64],
}

impl<'a> PlanarMut<'a> {
    /// Vectors of equal length that fill `data`.
    pub fn new(dim: usize, data: &'a mut [f64]) -> Self {
        Self { dim, data }
    }

    /// The same for a while.
    pub fn view_mut(&mut self) -> PlanarMut<'_> {
        PlanarMut { dim: self.dim, data: self.data }
    }

    /// One vector.
    pub fn vector(&self, rhs: usize) -> &[f64] {
        &self.data[rhs * self.dim..(rhs + 1) * self.dim]
    }

    /// L vectors from vector `first` on.
    #[inline(always)]
    pub fn vectors_mut<const L: usize>(&mut self, first: usize) -> [&mut [f64]; L] {
        let mut vectors = self.data[first * self.dim..].chunks_exact_mut(self.dim.max(1));
        std::array::from_fn(|_| vectors.next().unwrap_or_default())
    }

    /// Adds to entry i of all vectors.
    pub fn add_row(&mut self, i: usize, row: impl Iterator<Item = f64>) {
        for (rhs, value) in self.data.chunks_exact_mut(self.dim.max(1)).zip(row) {
            rhs[i] += value;
        }
    }
}
