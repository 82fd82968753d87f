//! Vectors lane by lane, as the inner loops read them in long runs: entry (i, l) at l · dim + i.

use crate::MultiVector;

/// Lanes one after the other.
pub(super) struct Planar {
    dim: usize,
    data: Vec<f64>,
}

impl Planar {
    pub fn zeros(dim: usize, lanes: usize) -> Self {
        Self { dim, data: vec![0.0; dim * lanes] }
    }

    pub fn copied(v: &MultiVector<f64>) -> Self {
        let mut copy = Self::zeros(v.dim(), v.lanes());
        v.rows().enumerate().for_each(|(i, row)| copy.set_row(i, row));
        copy
    }

    /// L lanes from lane `first` on.
    #[inline(always)]
    pub fn lanes<const L: usize>(&self, first: usize) -> [&[f64]; L] {
        std::array::from_fn(|l| &self.data[(first + l) * self.dim..(first + l + 1) * self.dim])
    }

    /// Entry i of all lanes.
    pub fn row(&self, i: usize) -> impl Iterator<Item = f64> {
        self.data.iter().skip(i).step_by(self.dim.max(1)).copied()
    }

    pub fn set_row(&mut self, i: usize, row: &[f64]) {
        for (lane, &value) in self.data.chunks_exact_mut(self.dim.max(1)).zip(row) {
            lane[i] = value;
        }
    }

    pub fn clear_row(&mut self, i: usize) {
        self.data.iter_mut().skip(i).step_by(self.dim.max(1)).for_each(|value| *value = 0.0);
    }

    pub fn view_mut(&mut self) -> PlanarMut<'_> {
        PlanarMut { dim: self.dim, data: &mut self.data }
    }
}

/// Lanes one after the other in memory that is kept elsewhere.
pub(super) struct PlanarMut<'a> {
    dim: usize,
    data: &'a mut [f64],
}

impl<'a> PlanarMut<'a> {
    /// Lanes of equal length that fill `data`.
    pub fn new(dim: usize, data: &'a mut [f64]) -> Self {
        Self { dim, data }
    }

    /// The same for a while.
    pub fn view_mut(&mut self) -> PlanarMut<'_> {
        PlanarMut { dim: self.dim, data: self.data }
    }

    /// One lane.
    pub fn lane(&self, lane: usize) -> &[f64] {
        &self.data[lane * self.dim..(lane + 1) * self.dim]
    }

    /// L lanes from lane `first` on.
    #[inline(always)]
    pub fn lanes_mut<const L: usize>(&mut self, first: usize) -> [&mut [f64]; L] {
        let mut lanes = self.data[first * self.dim..].chunks_exact_mut(self.dim.max(1));
        std::array::from_fn(|_| lanes.next().unwrap_or_default())
    }

    /// Adds to entry i of all lanes.
    pub fn add_row(&mut self, i: usize, row: impl Iterator<Item = f64>) {
        for (lane, value) in self.data.chunks_exact_mut(self.dim.max(1)).zip(row) {
            lane[i] += value;
        }
    }
}
