//! A matrix whose columns are computed when they are asked for, and kept within a limit of memory.
//!
//! A shooting step reads one column of K, so that progressive radiosity starts at once on a matrix
//! that would not fit, or of which most is never needed. The columns used last are kept (least
//! recently used go first). What is kept decides the time and nothing else: a column has the same
//! bits whenever it is computed. There may be more columns than unknowns: sums of columns over
//! groups, which a step may shoot from as one.
//!
//! ```
//! use fredholm_linop::{Columns, Lazy, LinearOperator, Symmetry};
//!
//! /// k_ij = 1/(1 + i + j).
//! struct Hilbert(usize);
//!
//! impl Columns<f64> for Hilbert {
//!     fn dim(&self) -> usize {
//!         self.0
//!     }
//!
//!     fn symmetry(&self) -> Symmetry {
//!         Symmetry::Symmetric
//!     }
//!
//!     fn diagonal(&self, i: usize) -> f64 {
//!         1.0 / (1 + 2 * i) as f64
//!     }
//!
//!     fn column(&self, j: usize, out: &mut [f64]) {
//!         out.iter_mut().enumerate().for_each(|(i, entry)| *entry = 1.0 / (1 + i + j) as f64);
//!     }
//! }
//!
//! let hilbert = Hilbert(4);
//! let lazy = Lazy::new(&hilbert, 1 << 20);
//! let mut column = [0.0; 4];
//! lazy.column(2, 0, &mut column);
//! lazy.column(2, 0, &mut column);
//! assert_eq!((column[1], lazy.computed()), (0.25, 1));
//! ```

use crate::{LinearOperator, MultiVector, Scalar, Symmetry};
use rayon::prelude::*;
use std::sync::{Mutex, MutexGuard, PoisonError};

/// Columns computed at a time by an application, each by one thread.
const COLUMNS_TOGETHER: usize = 32;
/// Marks a column that is not kept.
const NOT_KEPT: usize = usize::MAX;

/// What computes the columns of a square matrix.
pub trait Columns<T: Scalar>: Sync {
    /// Number of unknowns.
    fn dim(&self) -> usize;

    /// Number of columns: the unknowns, unless there are sums of columns too.
    fn count(&self) -> usize {
        self.dim()
    }

    /// Symmetry of the matrix.
    fn symmetry(&self) -> Symmetry;

    /// k_ii, without the rest of a column.
    fn diagonal(&self, i: usize) -> T;

    /// Column j, below [`count`](Self::count): `out[i]` = k_ij, the same bits every time.
    fn column(&self, j: usize, out: &mut [T]);
}

/// An operator over computed columns. It serves any number of right-hand sides.
pub struct Lazy<'a, T> {
    columns: &'a dyn Columns<T>,
    kept: Mutex<Kept<T>>,
}

/// The columns that are kept.
struct Kept<T> {
    /// Place of every column among the slots, or [`NOT_KEPT`].
    places: Vec<usize>,
    slots: Vec<Slot<T>>,
    most: usize,
    clock: u64,
    computed: u64,
}

struct Slot<T> {
    column: usize,
    used: u64,
    entries: Vec<T>,
}

impl<'a, T: Scalar> Lazy<'a, T> {
    /// Keeps as many columns as fit `bytes`, maybe none.
    #[must_use]
    pub fn new(columns: &'a dyn Columns<T>, bytes: u64) -> Self {
        let (dim, count) = (columns.dim(), columns.count());
        let one = (dim as u64).saturating_mul(size_of::<T>() as u64).max(1);
        let most = usize::try_from(bytes / one).unwrap_or(usize::MAX).min(count);
        let kept = Kept { places: vec![NOT_KEPT; count], slots: Vec::new(), most, clock: 0, computed: 0 };
        Self { columns, kept: Mutex::new(kept) }
    }

    /// Columns computed so far, those computed again included.
    #[must_use]
    pub fn computed(&self) -> u64 {
        self.kept().computed
    }

    /// Columns kept now.
    #[must_use]
    pub fn held(&self) -> usize {
        self.kept().slots.len()
    }

    fn kept(&self) -> MutexGuard<'_, Kept<T>> {
        self.kept.lock().unwrap_or_else(PoisonError::into_inner)
    }

    fn read(&self, j: usize, out: &mut [T]) {
        if self.kept().find(j, out) {
            return;
        }
        self.columns.column(j, out);
        self.kept().keep(j, out);
    }
}

impl<T: Scalar> Kept<T> {
    /// Copies column j to `out`, if it is kept.
    fn find(&mut self, j: usize, out: &mut [T]) -> bool {
        self.clock += 1;
        let Some(slot) = self.slots.get_mut(self.places[j]) else { return false };
        slot.used = self.clock;
        out.copy_from_slice(&slot.entries);
        true
    }

    /// Keeps a computed column in place of the one used longest ago.
    fn keep(&mut self, j: usize, entries: &[T]) {
        self.computed += 1;
        if self.most == 0 || self.places[j] != NOT_KEPT {
            return;
        }
        if self.slots.len() < self.most {
            self.places[j] = self.slots.len();
            self.slots.push(Slot { column: j, used: self.clock, entries: entries.to_vec() });
            return;
        }
        let oldest = self.slots.iter().enumerate().min_by_key(|(_, slot)| slot.used).map(|(at, _)| at);
        if let Some(at) = oldest {
            let slot = &mut self.slots[at];
            self.places[slot.column] = NOT_KEPT;
            self.places[j] = at;
            (slot.column, slot.used) = (j, self.clock);
            slot.entries.copy_from_slice(entries);
        }
    }
}

impl<T: Scalar> LinearOperator<T> for Lazy<'_, T> {
    fn dim(&self) -> usize {
        self.columns.dim()
    }

    /// y = Σ_j k_j x_j in the order of j. Columns whose x_j is 0 are not computed.
    fn apply(&self, x: &MultiVector<T>, y: &mut MultiVector<T>) {
        y.fill(T::zero());
        let needed: Vec<usize> =
            (0..x.dim()).filter(|&j| x.row(j).iter().any(|&value| value != T::zero())).collect();
        let mut columns = vec![vec![T::zero(); self.dim()]; COLUMNS_TOGETHER.min(needed.len())];
        for group in needed.chunks(COLUMNS_TOGETHER) {
            columns.par_iter_mut().zip(group).for_each(|(column, &j)| self.read(j, column));
            for (column, &j) in columns.iter().zip(group) {
                let rhs_count = y.rhs_count().max(1);
                for (y, &entry) in y.as_mut_slice().chunks_exact_mut(rhs_count).zip(column) {
                    y.iter_mut().zip(x.row(j)).for_each(|(y, &x)| *y += entry * x);
                }
            }
        }
    }

    fn symmetry(&self) -> Symmetry {
        self.columns.symmetry()
    }

    fn column(&self, j: usize, _rhs: usize, out: &mut [T]) {
        self.read(j, out);
    }

    fn diagonal(&self, _rhs: usize, out: &mut [T]) {
        out.iter_mut().enumerate().for_each(|(i, out)| *out = self.columns.diagonal(i));
    }
}

#[cfg(test)]
#[allow(clippy::float_cmp, reason = "these results are exact")]
mod tests {
    use super::*;
    use crate::Dense;

    /// k_ij = 10 i + j.
    struct Numbered(usize);

    impl Columns<f64> for Numbered {
        fn dim(&self) -> usize {
            self.0
        }

        fn symmetry(&self) -> Symmetry {
            Symmetry::General
        }

        fn diagonal(&self, i: usize) -> f64 {
            (11 * i) as f64
        }

        fn column(&self, j: usize, out: &mut [f64]) {
            out.iter_mut().enumerate().for_each(|(i, entry)| *entry = (10 * i + j) as f64);
        }
    }

    #[test]
    fn the_column_used_longest_ago_goes_first() {
        let numbered = Numbered(5);
        let lazy = Lazy::new(&numbered, 2 * 5 * 8 + 7);
        let mut column = [0.0; 5];
        // 0 and 1 are kept, 0 is used again, so that 2 takes the place of 1.
        for (j, computed) in [(0, 1), (1, 2), (0, 2), (2, 3), (0, 3), (1, 4)] {
            lazy.column(j, 0, &mut column);
            assert_eq!((column[3], lazy.computed()), ((30 + j) as f64, computed));
            assert!(lazy.held() <= 2);
        }
    }

    #[test]
    fn nothing_is_kept_where_no_column_fits() {
        let numbered = Numbered(5);
        let lazy = Lazy::new(&numbered, 39);
        let mut column = [0.0; 5];
        (0..3).for_each(|_| lazy.column(4, 0, &mut column));
        assert_eq!((lazy.computed(), lazy.held(), column), (3, 0, [4.0, 14.0, 24.0, 34.0, 44.0]));
    }

    #[test]
    fn products_are_those_of_the_dense_matrix_and_compute_what_they_need() {
        let n = 70;
        let numbered = Numbered(n);
        let dense = Dense::new(n, (0..n * n).map(|at| (10 * (at / n) + at % n) as f64).collect()).unwrap();
        let x = MultiVector::from_fn(n, 2, |i, l| if i % 3 == 0 { 0.0 } else { (i + l) as f64 });
        for bytes in [0, 4096, 1 << 20] {
            let lazy = Lazy::new(&numbered, bytes);
            let (mut found, mut expected) = (MultiVector::zeros(n, 2), MultiVector::zeros(n, 2));
            lazy.apply(&x, &mut found);
            dense.apply(&x, &mut expected);
            assert_eq!(found, expected);
            assert_eq!(lazy.computed(), (0..n).filter(|i| i % 3 != 0).count() as u64);
        }
        let mut diagonal = vec![0.0; n];
        Lazy::new(&numbered, 0).diagonal(0, &mut diagonal);
        assert_eq!(diagonal[6], 66.0);
    }
}
