//! The symmetric form of (I − D K) x = b with K symmetric: Θ z = D^(−½) b, Θ = I − D^½ K D^½,
//! x = D^½ z.
//!
//! Unknowns with d_i = 0, black patches, are b_i, and their light moves to the right-hand side.
//! Θ has no entries of different size, whatever D.

use crate::groups::{Run, columns};
use fredholm_linop::{Dense, LinearOperator, MultiVector, Scalar, SecondKind, SolveError};

/// Rows that are turned into columns at a time: their entries of a column lie together in memory.
const ROWS: usize = 16;

/// The form for the right-hand sides of one matrix.
pub(crate) struct SymmetricForm<T> {
    /// D^½.
    roots: Vec<T>,
}

impl<T: Scalar> SymmetricForm<T> {
    /// `root` is that of a factor.
    pub fn new(a: &SecondKind<'_, T>, rhs: usize, root: impl Fn(T) -> T) -> Self {
        Self { roots: (0..a.dim()).map(|i| root(a.factor().row(i)[rhs])).collect() }
    }

    /// The lower triangle of Θ, column by column.
    pub fn lower(&self, run: &mut Run<'_, '_, T>, rhs: usize) -> Result<Vec<T>, SolveError> {
        let n = run.a.dim();
        let mut matrix = Dense::zeros(n)?.into_vec();
        let mut rows = vec![T::zero(); n * ROWS];
        for first in (0..n).step_by(ROWS) {
            let last = (first + ROWS).min(n);
            for i in first..last {
                run.a.coupling().lower_row(i, rhs, &mut rows[(i - first) * n..][..=i]);
            }
            for (j, column) in matrix.chunks_exact_mut(n.max(1)).enumerate().take(last) {
                for i in first.max(j)..last {
                    column[i] = -(rows[(i - first) * n + j] * (self.roots[i] * self.roots[j]));
                }
            }
        }
        (0..n).for_each(|i| matrix[i * n + i] += T::one());
        run.work.row_visits += n as u64;
        run.work.entries_touched += run.a.entries();
        Ok(matrix)
    }

    /// D^(−½) b for these right-hand sides, one after the other.
    pub fn right_hand_sides(&self, run: &mut Run<'_, '_, T>, group: &[usize]) -> Vec<T> {
        let mut all = columns(&right_side(run), group);
        let inverse = |root: T| if root == T::zero() { T::one() } else { T::one() / root };
        let scales: Vec<T> = self.roots.iter().map(|&root| inverse(root)).collect();
        multiply(&mut all, &scales);
        all
    }

    /// Takes x from z.
    pub fn take(&self, run: &mut Run<'_, '_, T>, group: &[usize], mut z: Vec<T>) {
        let factor = |root: T| if root == T::zero() { T::one() } else { root };
        let scales: Vec<T> = self.roots.iter().map(|&root| factor(root)).collect();
        multiply(&mut z, &scales);
        for (&rhs, solution) in group.iter().zip(z.chunks_exact(scales.len().max(1))) {
            run.x.set_vector(rhs, solution);
        }
    }
}

fn multiply<T: Scalar>(vectors: &mut [T], scales: &[T]) {
    for vector in vectors.chunks_exact_mut(scales.len().max(1)) {
        vector.iter_mut().zip(scales).for_each(|(value, &scale)| *value = *value * scale);
    }
}

/// b + D K b_black on the unknowns that reflect, b on the black ones.
fn right_side<T: Scalar>(run: &mut Run<'_, '_, T>) -> MultiVector<T> {
    let factor = run.a.factor();
    let mut right = run.b.clone();
    if factor.as_slice().iter().all(|&d| d != T::zero()) {
        return right;
    }
    let black = |i: usize, l: usize| if factor.row(i)[l] == T::zero() { run.b.row(i)[l] } else { T::zero() };
    let known = MultiVector::from_fn(run.b.dim(), run.b.rhs_count(), black);
    run.a.apply(&known, &mut run.product);
    run.work.operator_applications += 1;
    run.work.entries_touched += run.a.entries();
    // A known = known − D K known, which is known on the black unknowns.
    let terms = known.as_slice().iter().zip(run.product.as_slice());
    right
        .as_mut_slice()
        .iter_mut()
        .zip(terms)
        .for_each(|(right, (&known, &product))| *right += known - product);
    right
}
