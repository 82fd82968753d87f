//! A = L D Mᵀ of a hierarchical matrix, in the same blocks.
//!
//! L and M are triangles of blocks with ones on the diagonal, D has the blocks on the diagonal; of
//! a symmetric matrix M = L. With halves 1 and 2 of the unknowns,
//!
//! ```text
//! A₁₁ = L₁₁ D₁ M₁₁ᵀ,   L₂₁ = A₂₁ M₁₁⁻ᵀ D₁⁻¹,   M₂₁ = A₁₂ᵀ L₁₁⁻ᵀ D₁⁻ᵀ,
//! A₂₂ − L₂₁ D₁ M₂₁ᵀ = L₂₂ D₂ M₂₂ᵀ,
//! ```
//!
//! and so on in the halves (W. Hackbusch, Hierarchical Matrices: Algorithms and Analysis, Springer
//! 2015, § 7.6). The part above the diagonal is stored transposed, so that both triangles take the
//! same steps. What is added to a block of low rank waits until it has as many columns as the
//! block, then all of it is truncated to the tolerance. The factors are in single precision, and
//! solve in double precision: few of their digits count, but an iterative solver that finds the
//! others wants the same operator at every step.
//!
//! Each block is changed in the same order of steps by any number of threads, so that the bits are
//! the same.

mod block;
mod diagonal;
mod truncation;

use crate::matrix::{Kind, Span, Stored, TOGETHER, check_tolerance};
use crate::{CompressionError, Hierarchical, Number, Times};
use block::Block;
use diagonal::{Diagonal, Side, Work};
use faer::Mat;
use fredholm_linop::{LinearOperator, MultiVector, Scalar, Steps, Symmetry, Watch};
use rayon::prelude::*;
use std::collections::HashMap;
use std::ops::Range;

/// The factors of a hierarchical matrix: a direct solver to their tolerance, and the preconditioner
/// for any other.
pub struct Factors<T: Scalar>
where
    T: Times<T::Single>,
    T::Single: Number<Double = T>,
{
    order: Vec<usize>,
    symmetry: Symmetry,
    /// What the factors of D are multiples of.
    unit: f64,
    diagonal: Diagonal<T::Single>,
}

impl<T: Scalar> Factors<T>
where
    T: Times<T::Single>,
    T::Single: Number<Double = T>,
{
    /// Factorises a matrix with truncations to a relative `tolerance` of each block (1e-6 to 0.5),
    /// if the factors take at most `limit` bytes. Between two counts of these bytes, what waits to be
    /// truncated may take as much as the blocks of low rank that it is added to.
    ///
    /// # Errors
    /// [`CompressionError::Setting`] for a tolerance out of range, [`CompressionError::Singular`]
    /// for a block on the diagonal that has no inverse, [`CompressionError::Factors`] where the
    /// factors grow above the limit, [`CompressionError::Interrupted`] where `watch` no longer wants
    /// them.
    pub fn new(
        matrix: &Hierarchical<T>,
        tolerance: f64,
        limit: u64,
        watch: &dyn Watch,
    ) -> Result<Self, CompressionError> {
        check_tolerance(tolerance)?;
        let unit = matrix.unit();
        let steps = Steps::new(watch, matrix.leaves() as u64, "blocks of the diagonal");
        let work = Work { tolerance, limit, steps: &steps };
        // They begin as a copy of the blocks.
        work.admit(matrix.summary().bytes)?;
        let mut diagonal = Nested::new(matrix, unit).diagonal(0);
        work.admit(diagonal.bytes())?;
        diagonal.factorise(0, &work)?;
        Ok(Self { order: matrix.order().to_vec(), symmetry: matrix.symmetry(), unit, diagonal })
    }

    /// Bytes of the factors, at most the limit.
    #[must_use]
    pub fn bytes(&self) -> u64 {
        self.diagonal.bytes()
    }
}

impl<T: Scalar> LinearOperator<T> for Factors<T>
where
    T: Times<T::Single>,
    T::Single: Number<Double = T>,
{
    fn dim(&self) -> usize {
        self.order.len()
    }

    /// y ≈ A⁻¹ x.
    fn apply(&self, x: &MultiVector<T>, y: &mut MultiVector<T>) {
        let columns: Vec<usize> = (0..x.rhs_count()).collect();
        let solved = |columns: &[usize]| {
            let entry = |i: usize, j: usize| x.row(self.order[i])[columns[j]];
            let mut b = Mat::from_fn(self.dim(), columns.len(), entry);
            self.diagonal.solve(Side::Lower, false, b.as_mut());
            self.diagonal.divide(false, b.as_mut());
            self.diagonal.solve(Side::Upper, true, b.as_mut());
            b
        };
        let parts: Vec<Mat<T>> = columns.par_chunks(TOGETHER).map(solved).collect();
        for (columns, part) in columns.chunks(TOGETHER).zip(parts) {
            for (i, &at) in self.order.iter().enumerate() {
                for (j, &rhs) in columns.iter().enumerate() {
                    y.row_mut(at)[rhs] = part[(i, j)].scale(self.unit.recip());
                }
            }
        }
    }

    fn symmetry(&self) -> Symmetry {
        self.symmetry
    }

    fn entries(&self) -> u64 {
        self.bytes() / size_of::<T::Single>() as u64
    }
}

/// The blocks of a matrix by their rows and columns.
struct Nested<'a, T: Scalar> {
    spans: &'a [Span],
    blocks: HashMap<(Range<usize>, Range<usize>), &'a Stored<T>>,
    symmetric: bool,
    unit: f64,
}

impl<'a, T: Scalar> Nested<'a, T>
where
    T: Times<T::Single>,
    T::Single: Number<Double = T>,
{
    fn new(matrix: &'a Hierarchical<T>, unit: f64) -> Self {
        let named = |block: &'a Stored<T>| ((block.rows.clone(), block.columns.clone()), block);
        Self {
            spans: matrix.spans(),
            blocks: matrix.blocks().iter().map(named).collect(),
            symmetric: matrix.symmetry() == Symmetry::Symmetric,
            unit,
        }
    }

    fn diagonal(&self, at: usize) -> Diagonal<T::Single> {
        let span = &self.spans[at];
        match span.halves {
            Some(first) => Diagonal::Halved {
                at: self.spans[first].range.len(),
                halves: Box::new([first, first + 1].map(|half| self.diagonal(half))),
                lower: self.block(first + 1, first, false),
                upper: (!self.symmetric).then(|| self.block(first, first + 1, true)),
            },
            None => Diagonal::leaf(self.block(at, at, false).whole()),
        }
    }

    /// A block of two clusters, or its transpose.
    fn block(&self, row: usize, column: usize, transposed: bool) -> Block<T::Single> {
        let [rows, columns] = [row, column].map(|at| self.spans[at].range.clone());
        match self.blocks.get(&(rows, columns)) {
            Some(stored) => self.stored(stored, [row, column], transposed),
            None => self.parts([row, column], transposed, &|row, column| self.block(row, column, transposed)),
        }
    }

    /// The blocks of the halves of two clusters.
    fn parts(
        &self,
        [row, column]: [usize; 2],
        transposed: bool,
        block: &dyn Fn(usize, usize) -> Block<T::Single>,
    ) -> Block<T::Single> {
        let halves = |at: usize| self.spans[at].halves.map_or(vec![at], |first| vec![first, first + 1]);
        let lengths = |at: usize| halves(at).iter().map(|&half| self.spans[half].range.len()).collect();
        let (own, other) = if transposed { (column, row) } else { (row, column) };
        let pair = |a: usize, b: usize| if transposed { block(b, a) } else { block(a, b) };
        let all = halves(own).into_iter().flat_map(|a| halves(other).into_iter().map(move |b| (a, b)));
        Block::parts(lengths(own), lengths(other), all.map(|(a, b)| pair(a, b)).collect())
    }

    fn stored(&self, stored: &Stored<T>, pair: [usize; 2], transposed: bool) -> Block<T::Single> {
        let factor = stored.unit / self.unit;
        let scaled = |x: T::Single| T::from_single(x).scale(factor).to_single();
        let (m, n) = (stored.rows.len(), stored.columns.len());
        match &stored.kind {
            Kind::Whole(entries) => {
                let entry = |i: usize, j: usize| {
                    scaled(entries[(i - stored.rows.start) * n + j - stored.columns.start])
                };
                self.whole(pair, transposed, &entry)
            }
            Kind::Low { u, v } => {
                let rank = u.len() / m.max(1);
                let u = Mat::from_fn(m, rank, |i, j| scaled(u[j * m + i]));
                let v = Mat::from_fn(n, rank, |i, j| v[j * n + i]);
                if transposed { Block::low(v, u) } else { Block::low(u, v) }
            }
        }
    }

    /// A whole block, cut down to clusters that are not halved: blocks that would have had too high
    /// a rank are stored whole between any clusters.
    fn whole(
        &self,
        [row, column]: [usize; 2],
        transposed: bool,
        entry: &dyn Fn(usize, usize) -> T::Single,
    ) -> Block<T::Single> {
        let [rows, columns] = [row, column].map(|at| &self.spans[at]);
        if rows.halves.is_some() || columns.halves.is_some() {
            return self.parts([row, column], transposed, &|row, column| {
                self.whole([row, column], transposed, entry)
            });
        }
        let ([m, n], [first, left]) =
            ([rows, columns].map(|span| span.range.len()), [rows, columns].map(|span| span.range.start));
        Block::Whole(if transposed {
            Mat::from_fn(n, m, |i, j| entry(first + j, left + i))
        } else {
            Mat::from_fn(m, n, |i, j| entry(first + i, left + j))
        })
    }
}
