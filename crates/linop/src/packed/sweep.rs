//! The forward sweep over a packed lower triangle. Row i, g_i0 … g_i(i−1), gives L_i, and being
//! column i above the diagonal, it is read again from cache for U once x_i is set: every entry
//! comes from memory once a sweep.
//!
//! A few rows at a time share the sums over the columns before the first of them; those between
//! them follow as their unknowns are relaxed. The backward sweep has its L from the forward one and
//! reads each entry once, for U.

use super::planar::Planar;
use super::strip::{Add, Dot, Strip};
use super::{COLUMNS_OF_A_TILE, PackedSymmetric, ROWS_TOGETHER, Storage};
use crate::{MultiVector, Relax, Sweep, Visit};
use pulp::{Arch, Simd, WithSimd};
use std::ops::ControlFlow;

pub(super) fn sweep<S: Storage>(
    matrix: &PackedSymmetric<S>,
    x: &mut MultiVector<f64>,
    sweep: &mut Sweep<f64>,
    relax: &mut Relax<'_, f64>,
) -> ControlFlow<()> {
    let upper = Planar::copied(&sweep.upper);
    let mut pass = Pass::new(x, sweep, upper);
    let whole = matrix.dim() / ROWS_TOGETHER * ROWS_TOGETHER;
    for first in (0..whole).step_by(ROWS_TOGETHER) {
        pass.visit_rows::<S, ROWS_TOGETHER>(matrix.packed_rows(first), first, relax)?;
    }
    for first in whole..matrix.dim() {
        pass.visit_rows::<S, 1>(matrix.packed_rows(first), first, relax)?;
    }
    pass.keep_upper();
    sweep.complete();
    ControlFlow::Continue(())
}

pub(super) fn sweep_back<S: Storage>(
    matrix: &PackedSymmetric<S>,
    x: &mut MultiVector<f64>,
    sweep: &mut Sweep<f64>,
    relax: &mut Relax<'_, f64>,
) -> ControlFlow<()> {
    let upper = Planar::zeros(x.dim(), x.rhs_count());
    let mut pass = Pass::new(x, sweep, upper);
    let whole = matrix.dim() / ROWS_TOGETHER * ROWS_TOGETHER;
    for first in (whole..matrix.dim()).rev() {
        pass.visit_rows_back::<S, 1>(matrix.packed_rows(first), first, relax)?;
    }
    for first in (0..whole).step_by(ROWS_TOGETHER).rev() {
        pass.visit_rows_back::<S, ROWS_TOGETHER>(matrix.packed_rows(first), first, relax)?;
    }
    pass.keep_upper();
    ControlFlow::Continue(())
}

/// What a sweep works on, and what a visit shows, per right-hand side.
struct Pass<'a> {
    rhs_count: usize,
    x: &'a mut MultiVector<f64>,
    sweep: &'a mut Sweep<f64>,
    /// x and U as the inner loops read them.
    known: Planar,
    upper: Planar,
    /// L and x of the rows taken together.
    lower: Vec<f64>,
    factors: Vec<f64>,
    diagonal: Vec<f64>,
    off_diagonal: Vec<f64>,
    arch: Arch,
}

impl<'a> Pass<'a> {
    fn new(x: &'a mut MultiVector<f64>, sweep: &'a mut Sweep<f64>, upper: Planar) -> Self {
        let rhs_count = x.rhs_count();
        let (row, rows) = (vec![0.0; rhs_count], vec![0.0; ROWS_TOGETHER * rhs_count]);
        Self {
            rhs_count,
            known: Planar::copied(x),
            x,
            sweep,
            upper,
            lower: rows.clone(),
            factors: rows,
            diagonal: row.clone(),
            off_diagonal: row,
            arch: Arch::new(),
        }
    }

    /// Leaves U where the next sweep finds it.
    fn keep_upper(&mut self) {
        for i in 0..self.x.dim() {
            let values = self.upper.row(i);
            self.sweep.upper.row_mut(i).iter_mut().zip(values).for_each(|(upper, value)| *upper = value);
        }
    }

    /// Visits the unknowns of R rows, the columns before `first` together.
    fn visit_rows<S: Storage, const R: usize>(
        &mut self,
        rows: [&[S]; R],
        first: usize,
        relax: &mut Relax<'_, f64>,
    ) -> ControlFlow<()> {
        self.arch.dispatch(Gather { pass: self, rows, first });
        for (r, row) in rows.iter().enumerate() {
            self.visit(&row[first..], first, r, relax)?;
        }
        self.arch.dispatch(Scatter { pass: self, rows, first });
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
        let (index, own) = (first + r, r * self.rhs_count..(r + 1) * self.rhs_count);
        for (k, entry) in row[..r].iter().enumerate() {
            let above = &self.factors[k * self.rhs_count..(k + 1) * self.rhs_count];
            let lower = self.lower[own.clone()].iter_mut();
            lower.zip(above).for_each(|(sum, x)| *sum += entry.to_f64() * x);
        }
        let parts = self.upper.row(index).zip(&self.lower[own.clone()]);
        self.off_diagonal.iter_mut().zip(parts).for_each(|(sum, (upper, lower))| *sum = upper + lower);
        self.upper.clear_row(index);
        self.relax(row, first, r, relax)?;
        let entry = row[r].to_f64();
        let known = self.lower[own.clone()].iter().zip(self.x.row(index));
        let product = self.sweep.product.row_mut(index).iter_mut();
        product.zip(known).for_each(|(product, (lower, x))| *product = *lower + entry * *x);
        self.sweep.lower.row_mut(index).copy_from_slice(&self.lower[own]);
        ControlFlow::Continue(())
    }

    /// Shows an unknown, takes its new value and adds it to U of those before it among the rows
    /// taken together.
    fn relax<S: Storage>(
        &mut self,
        row: &[S],
        first: usize,
        r: usize,
        relax: &mut Relax<'_, f64>,
    ) -> ControlFlow<()> {
        let index = first + r;
        self.diagonal.fill(row[r].to_f64());
        let (off_diagonal, diagonal, x) = (&self.off_diagonal, &self.diagonal, self.x.row_mut(index));
        relax(Visit { index, off_diagonal, diagonal, x: &mut *x })?;
        self.known.set_row(index, x);
        self.factors[r * self.rhs_count..(r + 1) * self.rhs_count].copy_from_slice(x);
        for (k, entry) in row[..r].iter().enumerate() {
            self.upper.view_mut().add_row(first + k, x.iter().map(|x| entry.to_f64() * x));
        }
        ControlFlow::Continue(())
    }

    /// Visits the unknowns of R rows from the last to the first, and adds to the columns before
    /// `first` together.
    fn visit_rows_back<S: Storage, const R: usize>(
        &mut self,
        rows: [&[S]; R],
        first: usize,
        relax: &mut Relax<'_, f64>,
    ) -> ControlFlow<()> {
        for (r, row) in rows.iter().enumerate().rev() {
            let parts = self.upper.row(first + r).zip(self.sweep.lower.row(first + r));
            self.off_diagonal.iter_mut().zip(parts).for_each(|(sum, (upper, lower))| *sum = upper + lower);
            self.relax(&row[first..], first, r, relax)?;
        }
        self.arch.dispatch(Scatter { pass: self, rows, first });
        ControlFlow::Continue(())
    }
}

/// L of R rows over the columns before `first`.
struct Gather<'p, 'a, 'm, S, const R: usize> {
    pass: &'p mut Pass<'a>,
    rows: [&'m [S]; R],
    first: usize,
}

impl<S: Storage, const R: usize> WithSimd for Gather<'_, '_, '_, S, R> {
    type Output = ();

    #[inline(always)]
    fn with_simd<V: Simd>(self, simd: V) {
        let Self { pass, rows, first } = self;
        pass.lower.fill(0.0);
        for from in (0..first).step_by(COLUMNS_OF_A_TILE) {
            let tile = rows.map(|row| &row[from..(from + COLUMNS_OF_A_TILE).min(first)]);
            let (strip, sums) = (Strip { rows: &tile, from }, &mut pass.lower[..R * pass.rhs_count]);
            Dot { strip, x: &pass.known, sums }.with_simd(simd);
        }
    }
}

/// What R relaxed unknowns add to U of those before `first`.
struct Scatter<'p, 'a, 'm, S, const R: usize> {
    pass: &'p mut Pass<'a>,
    rows: [&'m [S]; R],
    first: usize,
}

impl<S: Storage, const R: usize> WithSimd for Scatter<'_, '_, '_, S, R> {
    type Output = ();

    #[inline(always)]
    fn with_simd<V: Simd>(self, simd: V) {
        let Self { pass, rows, first } = self;
        for from in (0..first).step_by(COLUMNS_OF_A_TILE) {
            let tile = rows.map(|row| &row[from..(from + COLUMNS_OF_A_TILE).min(first)]);
            let (strip, factors) = (Strip { rows: &tile, from }, &pass.factors[..R * pass.rhs_count]);
            Add { strip, factors, u: pass.upper.view_mut() }.with_simd(simd);
        }
    }
}
