//! The forward sweep: relaxation of every unknown in order, with the product K x of the new x for
//! nothing.
//!
//! While unknowns i = 0 … n−1 are visited, split (K x)_i = L_i + k_ii x_i + U_i with L_i = Σ_{j<i}
//! k_ij x_j and U_i = Σ_{j>i} k_ij x_j. At the visit of i, L_i is summed with the x_j just relaxed
//! and U_i is known from before. Once x_i is set, k_ki x_i is added to U_k of all k < i: by the end
//! of the sweep, U belongs to the new x, and ‖b − A x‖ costs no second pass. Where the matrix is
//! symmetric, the entries k_ki are those that L_i has just read.
//!
//! A sweep that changes nothing computes U and K x of any starting x.
//!
//! The backward sweep visits i = n−1 … 0. At the visit of i, L_i is that of the forward sweep
//! before it, because no unknown before i has changed since, and U_i has gathered the x_j just
//! relaxed: only the part k_ki x_i, k < i, is read. It leaves U of the new x, from which the next
//! forward sweep starts; L and K x are then out of date. (V. Conrad, Y. Wallach, Numerische
//! Mathematik 32, 1979.)

use crate::{LinearOperator, MultiVector, Scalar, Symmetry};
use std::ops::ControlFlow;

/// What [`LinearOperator::sweep`] carries from one sweep to the next.
///
/// It belongs to one operator and one x, which nothing but sweeps may change between them. A new
/// one belongs to x = 0.
#[derive(Clone, Debug)]
pub struct Sweep<T> {
    pub(crate) lower: MultiVector<T>,
    pub(crate) upper: MultiVector<T>,
    pub(crate) product: MultiVector<T>,
}

impl<T: Scalar> Sweep<T> {
    /// The state of x = 0.
    #[must_use]
    pub fn new(dim: usize, rhs_count: usize) -> Self {
        let zeros = MultiVector::zeros(dim, rhs_count);
        Self { lower: zeros.clone(), upper: zeros.clone(), product: zeros }
    }

    /// K x of the x that the last complete sweep left.
    #[must_use]
    pub fn product(&self) -> &MultiVector<T> {
        &self.product
    }

    /// L_i = Σ_{j<i} k_ij x_j of the last forward sweep. An operator sets it at the visits of a
    /// forward sweep.
    pub fn lower_mut(&mut self) -> &mut MultiVector<T> {
        &mut self.lower
    }

    /// U_i = Σ_{j>i} k_ij x_j.
    #[must_use]
    pub fn upper(&self) -> &MultiVector<T> {
        &self.upper
    }

    /// Makes this the state of α x' + (1 − α) x'', α for each right-hand side, of which it is the
    /// state of x' and `other` that of x''. All parts are linear in x.
    ///
    /// # Panics
    /// The states do not have the same shape.
    pub fn mix(&mut self, alpha: &[T], other: &Self) {
        let rest: Vec<T> = alpha.iter().map(|&alpha| T::one() - alpha).collect();
        let parts = [
            (&mut self.lower, &other.lower),
            (&mut self.upper, &other.upper),
            (&mut self.product, &other.product),
        ];
        for (part, other) in parts {
            let zeros = MultiVector::zeros(part.dim(), part.rhs_count());
            part.scale_and_add(alpha, &zeros);
            part.add_scaled(&rest, other);
        }
    }

    /// U_i = Σ_{j>i} k_ij x_j, all unknowns and right-hand sides. An operator reads row i at visit
    /// i, sets it to 0, and adds to it from the later ones.
    pub fn upper_mut(&mut self) -> &mut MultiVector<T> {
        &mut self.upper
    }

    /// Where an operator leaves K x.
    pub fn product_mut(&mut self) -> &mut MultiVector<T> {
        &mut self.product
    }

    /// Moves U_i to `off_diagonal` and leaves 0 for what the later unknowns add.
    pub(crate) fn take_upper(&mut self, i: usize, off_diagonal: &mut [T]) {
        off_diagonal.copy_from_slice(self.upper.row(i));
        self.upper.row_mut(i).fill(T::zero());
    }

    /// `off_diagonal` = L_i + U_i.
    pub(crate) fn sum_parts(&self, i: usize, off_diagonal: &mut [T]) {
        let parts = self.lower.row(i).iter().zip(self.upper.row(i));
        off_diagonal.iter_mut().zip(parts).for_each(|(sum, (&lower, &upper))| *sum = lower + upper);
    }

    /// Turns the recorded L_i + k_ii x_i into K x.
    pub(crate) fn complete(&mut self) {
        self.product.as_mut_slice().iter_mut().zip(self.upper.as_slice()).for_each(|(p, &u)| *p += u);
    }
}

/// One unknown as a sweep presents it, all right-hand sides.
#[derive(Debug)]
pub struct Visit<'a, T> {
    /// Index i of the unknown.
    pub index: usize,
    /// Σ_{j≠i} k_ij x_j per right-hand side, with the x_j already relaxed.
    pub off_diagonal: &'a [T],
    /// k_ii per right-hand side.
    pub diagonal: &'a [T],
    /// x_i per right-hand side, to be set.
    pub x: &'a mut [T],
}

/// Sets x_i at each visit; a break stops the sweep.
pub type Relax<'a, T> = dyn FnMut(Visit<'_, T>) -> ControlFlow<()> + 'a;

/// The sweep of an operator that is asked for each row, and each column unless it follows from the
/// row.
pub(crate) fn sweep_by_rows<T: Scalar, A: LinearOperator<T> + ?Sized>(
    a: &A,
    x: &mut MultiVector<T>,
    sweep: &mut Sweep<T>,
    relax: &mut Relax<'_, T>,
) -> ControlFlow<()> {
    let mut lines = Lines::new(a);
    let mut terms = Terms::new(x.rhs_count());
    for index in 0..x.dim() {
        lines.read_row(index);
        terms.gather(&lines, index, x, sweep);
        let Terms { off_diagonal, diagonal, .. } = &terms;
        relax(Visit { index, off_diagonal, diagonal, x: x.row_mut(index) })?;
        terms.record(index, x, sweep);
        lines.turn_into_column(index);
        lines.scatter(index, x, sweep);
    }
    sweep.complete();
    ControlFlow::Continue(())
}

/// The backward sweep of an operator that is asked for the part of each column above the diagonal.
pub(crate) fn sweep_back_by_columns<T: Scalar, A: LinearOperator<T> + ?Sized>(
    a: &A,
    x: &mut MultiVector<T>,
    sweep: &mut Sweep<T>,
    relax: &mut Relax<'_, T>,
) -> ControlFlow<()> {
    let mut lines = Lines::new(a);
    let mut terms = Terms::new(x.rhs_count());
    sweep.upper.fill(T::zero());
    for index in (0..x.dim()).rev() {
        lines.read_row(index);
        (0..x.rhs_count()).for_each(|l| terms.diagonal[l] = lines.of_rhs(l)[index]);
        sweep.sum_parts(index, &mut terms.off_diagonal);
        let Terms { off_diagonal, diagonal, .. } = &terms;
        relax(Visit { index, off_diagonal, diagonal, x: x.row_mut(index) })?;
        lines.turn_into_column(index);
        lines.scatter(index, x, sweep);
    }
    ControlFlow::Continue(())
}

/// A row or column of the matrix of each right-hand side, or one for all right-hand sides.
struct Lines<'a, T, A: ?Sized> {
    a: &'a A,
    lines: Vec<Vec<T>>,
}

impl<'a, T: Scalar, A: LinearOperator<T> + ?Sized> Lines<'a, T, A> {
    fn new(a: &'a A) -> Self {
        Self { a, lines: vec![vec![T::zero(); a.dim()]; a.rhs_count().unwrap_or(1)] }
    }

    fn of_rhs(&self, rhs: usize) -> &[T] {
        &self.lines[if self.a.rhs_count().is_some() { rhs } else { 0 }]
    }

    fn read_row(&mut self, i: usize) {
        self.lines.iter_mut().enumerate().for_each(|(rhs, line)| self.a.row(i, rhs, line));
    }

    /// U_k += k_ki x_i for k < i.
    fn scatter(&self, i: usize, x: &MultiVector<T>, sweep: &mut Sweep<T>) {
        for l in 0..x.rhs_count() {
            let (column, x) = (self.of_rhs(l), x.row(i)[l]);
            (0..i).for_each(|k| sweep.upper.row_mut(k)[l] += column[k] * x);
        }
    }

    /// Makes column i of row i.
    fn turn_into_column(&mut self, i: usize) {
        for (rhs, line) in self.lines.iter_mut().enumerate() {
            match self.a.symmetry() {
                Symmetry::Symmetric => {}
                Symmetry::Hermitian => line.iter_mut().for_each(|entry| *entry = entry.conj()),
                Symmetry::General => self.a.column(i, rhs, line),
            }
        }
    }
}

/// The terms of (K x)_i at a visit, per right-hand side.
struct Terms<T> {
    lower: Vec<T>,
    diagonal: Vec<T>,
    off_diagonal: Vec<T>,
}

impl<T: Scalar> Terms<T> {
    fn new(rhs_count: usize) -> Self {
        let zeros = vec![T::zero(); rhs_count];
        Self { lower: zeros.clone(), diagonal: zeros.clone(), off_diagonal: zeros }
    }

    fn gather<A>(&mut self, rows: &Lines<T, A>, i: usize, x: &MultiVector<T>, sweep: &mut Sweep<T>)
    where
        A: LinearOperator<T> + ?Sized,
    {
        sweep.take_upper(i, &mut self.off_diagonal);
        for l in 0..x.rhs_count() {
            let row = rows.of_rhs(l);
            self.lower[l] = (0..i).fold(T::zero(), |sum, j| sum + row[j] * x.row(j)[l]);
            self.off_diagonal[l] += self.lower[l];
            self.diagonal[l] = row[i];
        }
    }

    /// Keeps L_i, and L_i + k_ii x_i as the part of K x that is known.
    fn record(&self, i: usize, x: &MultiVector<T>, sweep: &mut Sweep<T>) {
        sweep.lower.row_mut(i).copy_from_slice(&self.lower);
        let terms = self.lower.iter().zip(&self.diagonal).zip(x.row(i));
        let product = sweep.product.row_mut(i).iter_mut();
        product.zip(terms).for_each(|(product, ((&lower, &diagonal), &x))| *product = lower + diagonal * x);
    }
}
