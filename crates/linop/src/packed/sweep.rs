//! The forward sweep over a packed lower triangle. Row i, g_i0 … g_i(i−1), gives L_i, and being column i above the
//! diagonal, it is read again from cache for U once x_i is set: every entry comes from memory once a sweep.
//!
//! A few rows at a time share the sums over the columns before the first of them; those between them follow as
//! their unknowns are relaxed. The backward sweep has its L from the forward one and reads each entry once, for U.

use super::strip::Strip;
use super::{PackedSymmetric, ROWS, Storage};
use crate::{MultiVector, Relax, Sweep, Visit};
use std::ops::ControlFlow;

pub(super) fn sweep<S: Storage>(
    matrix: &PackedSymmetric<S>,
    x: &mut MultiVector<f64>,
    sweep: &mut Sweep<f64>,
    relax: &mut Relax<'_, f64>,
) -> ControlFlow<()> {
    let mut pass = Pass::new(x, sweep);
    let whole = matrix.dim() / ROWS * ROWS;
    for first in (0..whole).step_by(ROWS) {
        pass.visit_rows::<S, ROWS>(matrix.packed_rows(first), first, relax)?;
    }
    for first in whole..matrix.dim() {
        pass.visit_rows::<S, 1>(matrix.packed_rows(first), first, relax)?;
    }
    sweep.complete();
    ControlFlow::Continue(())
}

pub(super) fn sweep_back<S: Storage>(
    matrix: &PackedSymmetric<S>,
    x: &mut MultiVector<f64>,
    sweep: &mut Sweep<f64>,
    relax: &mut Relax<'_, f64>,
) -> ControlFlow<()> {
    sweep.upper.fill(0.0);
    let mut pass = Pass::new(x, sweep);
    let whole = matrix.dim() / ROWS * ROWS;
    for first in (whole..matrix.dim()).rev() {
        pass.visit_rows_back::<S, 1>(matrix.packed_rows(first), first, relax)?;
    }
    for first in (0..whole).step_by(ROWS).rev() {
        pass.visit_rows_back::<S, ROWS>(matrix.packed_rows(first), first, relax)?;
    }
    ControlFlow::Continue(())
}

/// What a sweep works on, and what a visit shows, per lane.
struct Pass<'a> {
    lanes: usize,
    x: &'a mut MultiVector<f64>,
    sweep: &'a mut Sweep<f64>,
    /// L of the rows taken together.
    lower: Vec<f64>,
    diagonal: Vec<f64>,
    off_diagonal: Vec<f64>,
}

impl<'a> Pass<'a> {
    fn new(x: &'a mut MultiVector<f64>, sweep: &'a mut Sweep<f64>) -> Self {
        let lanes = x.lanes();
        let zeros = vec![0.0; lanes];
        Self { lanes, x, sweep, lower: vec![0.0; ROWS * lanes], diagonal: zeros.clone(), off_diagonal: zeros }
    }

    /// Visits the unknowns of R rows, the columns before `first` together.
    fn visit_rows<S: Storage, const R: usize>(
        &mut self,
        rows: [&[S]; R],
        first: usize,
        relax: &mut Relax<'_, f64>,
    ) -> ControlFlow<()> {
        let (start, end) = (first * self.lanes, (first + R) * self.lanes);
        let before = Strip { rows: rows.map(|row| &row[..first]), lanes: self.lanes };
        self.lower.fill(0.0);
        before.dot(&self.x.as_slice()[..start], &mut self.lower[..R * self.lanes]);
        for (r, row) in rows.iter().enumerate() {
            self.visit(&row[first..], first, r, relax)?;
        }
        before.add(&self.x.as_slice()[start..end], &mut self.sweep.upper.as_mut_slice()[..start]);
        ControlFlow::Continue(())
    }

    /// Visits unknown `first` + r, whose row from column `first` to the diagonal is `row`.
    fn visit<S: Storage>(
        &mut self,
        row: &[S],
        first: usize,
        r: usize,
        relax: &mut Relax<'_, f64>,
    ) -> ControlFlow<()> {
        let (index, above) = (first + r, first * self.lanes..(first + r) * self.lanes);
        let corner = Strip { rows: [&row[..r]], lanes: self.lanes };
        let lower = &mut self.lower[r * self.lanes..(r + 1) * self.lanes];
        corner.dot(&self.x.as_slice()[above.clone()], lower);
        self.sweep.take_upper(index, &mut self.off_diagonal);
        self.off_diagonal.iter_mut().zip(&*lower).for_each(|(sum, lower)| *sum += lower);
        let entry = row[r].to_f64();
        self.diagonal.fill(entry);
        let (off_diagonal, diagonal, x) = (&self.off_diagonal, &self.diagonal, self.x.row_mut(index));
        relax(Visit { index, off_diagonal, diagonal, x: &mut *x })?;
        corner.add(x, &mut self.sweep.upper.as_mut_slice()[above]);
        let product = self.sweep.product.row_mut(index).iter_mut();
        product.zip(&*lower).zip(x).for_each(|((product, lower), x)| *product = *lower + entry * *x);
        self.sweep.lower.row_mut(index).copy_from_slice(lower);
        ControlFlow::Continue(())
    }

    /// Visits the unknowns of R rows from the last to the first, and adds to the columns before `first` together.
    fn visit_rows_back<S: Storage, const R: usize>(
        &mut self,
        rows: [&[S]; R],
        first: usize,
        relax: &mut Relax<'_, f64>,
    ) -> ControlFlow<()> {
        let (start, end) = (first * self.lanes, (first + R) * self.lanes);
        for (r, row) in rows.iter().enumerate().rev() {
            self.visit_back(&row[first..], first, r, relax)?;
        }
        let before = Strip { rows: rows.map(|row| &row[..first]), lanes: self.lanes };
        before.add(&self.x.as_slice()[start..end], &mut self.sweep.upper.as_mut_slice()[..start]);
        ControlFlow::Continue(())
    }

    /// Visits unknown `first` + r, whose row from column `first` to the diagonal is `row`.
    fn visit_back<S: Storage>(
        &mut self,
        row: &[S],
        first: usize,
        r: usize,
        relax: &mut Relax<'_, f64>,
    ) -> ControlFlow<()> {
        let (index, above) = (first + r, first * self.lanes..(first + r) * self.lanes);
        self.sweep.sum_parts(index, &mut self.off_diagonal);
        self.diagonal.fill(row[r].to_f64());
        let (off_diagonal, diagonal, x) = (&self.off_diagonal, &self.diagonal, self.x.row_mut(index));
        relax(Visit { index, off_diagonal, diagonal, x: &mut *x })?;
        let corner = Strip { rows: [&row[..r]], lanes: self.lanes };
        corner.add(x, &mut self.sweep.upper.as_mut_slice()[above]);
        ControlFlow::Continue(())
    }
}
