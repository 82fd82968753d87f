//! A block off the diagonal: whole, of low rank, or in parts.

use super::diagonal::Diagonal;
use super::truncation::{product, truncated};
use crate::number::{Number, Times, add_product};
use faer::linalg::matmul::matmul;
use faer::traits::math_utils::one;
use faer::{Accum, Mat, MatMut, MatRef, Par};
use rayon::prelude::*;

/// Columns that wait before a block of low rank is truncated, at least.
const LEAST_WAITING: usize = 16;

/// Rows of a product that are worth the work of two threads, at least.
const LEAST_SHARED: usize = 512;

/// A block of the triangles.
pub(super) enum Block<N: Number> {
    /// All entries.
    Whole(Mat<N>),
    /// U Vᵀ.
    Low(Low<N>),
    /// A grid of blocks.
    Parts(Parts<N>),
}

/// U Vᵀ, and what is to be added to it.
pub(super) struct Low<N: Number> {
    u: Mat<N>,
    v: Mat<N>,
    waiting: Vec<[Mat<N>; 2]>,
}

/// A grid of blocks, row by row.
pub(super) struct Parts<N: Number> {
    /// Rows and columns of the parts.
    rows: Vec<usize>,
    columns: Vec<usize>,
    blocks: Vec<Block<N>>,
}

/// D between two blocks, or its transpose.
#[derive(Clone, Copy)]
pub(super) struct Middle<'a, N: Number> {
    pub(super) diagonal: &'a Diagonal<N>,
    pub(super) transposed: bool,
}

impl<N: Number> Middle<'_, N> {
    /// D x.
    fn times(self, x: MatRef<'_, N>) -> Mat<N> {
        let mut product = Mat::zeros(x.nrows(), x.ncols());
        self.diagonal.multiply(self.transposed, x, product.as_mut());
        product
    }

    pub(super) fn transpose(self) -> Self {
        Self { transposed: !self.transposed, ..self }
    }

    /// Part `k` of the `count` parts of the unknowns.
    fn part(self, k: usize, count: usize) -> Self {
        match self.diagonal {
            Diagonal::Halved { halves, .. } if count == 2 => Self { diagonal: &halves[k], ..self },
            _ => self,
        }
    }
}

impl<N: Number> Block<N> {
    pub(super) fn low(u: Mat<N>, v: Mat<N>) -> Self {
        Self::Low(Low { u, v, waiting: Vec::new() })
    }

    pub(super) fn parts(rows: Vec<usize>, columns: Vec<usize>, blocks: Vec<Self>) -> Self {
        Self::Parts(Parts { rows, columns, blocks })
    }

    /// Bytes, with what waits to be added.
    pub(super) fn bytes(&self) -> u64 {
        match self {
            Self::Whole(a) => bytes_of(a),
            Self::Low(low) => {
                let waiting = low.waiting.iter().flatten().map(bytes_of);
                bytes_of(&low.u) + bytes_of(&low.v) + waiting.sum::<u64>()
            }
            Self::Parts(grid) => grid.blocks.iter().map(Self::bytes).sum(),
        }
    }

    /// y += factor · A x, or Aᵀ x.
    pub(super) fn multiply<X: Times<N>>(
        &self,
        transposed: bool,
        x: MatRef<'_, X>,
        y: MatMut<'_, X>,
        factor: X,
    ) {
        match self {
            Self::Whole(a) => add_product(oriented(a, transposed), x, y, factor),
            Self::Low(low) => {
                let (left, right) = if transposed { (&low.v, &low.u) } else { (&low.u, &low.v) };
                let mut inner = Mat::zeros(right.ncols(), x.ncols());
                add_product(right.transpose(), x, inner.as_mut(), one());
                add_product(left.as_ref(), inner.as_ref(), y, factor);
            }
            Self::Parts(grid) => {
                let own = if transposed { &grid.columns } else { &grid.rows };
                let part = |k: usize, mut y: MatMut<'_, X>| {
                    for at in grid.of_line(k, transposed) {
                        let [row, column] = grid.range(at);
                        let other = if transposed { row } else { column };
                        grid.blocks[at].multiply(transposed, x.subrows(other.0, other.1), y.as_mut(), factor);
                    }
                };
                match own[..] {
                    [first, second] if first + second >= LEAST_SHARED => {
                        let (above, below) = y.split_at_row_mut(first);
                        rayon::join(|| part(0, above), || part(1, below));
                    }
                    _ => {
                        let mut rest = y;
                        for (k, &size) in own.iter().enumerate() {
                            let (next, left) = rest.split_at_row_mut(size);
                            part(k, next);
                            rest = left;
                        }
                    }
                }
            }
        }
    }

    /// A x, or Aᵀ x.
    fn times(&self, transposed: bool, x: MatRef<'_, N>) -> Mat<N> {
        let [rows, columns] = self.shape();
        let mut y = Mat::zeros(if transposed { columns } else { rows }, x.ncols());
        self.multiply(transposed, x, y.as_mut(), one::<N>());
        y
    }

    /// All entries.
    pub(super) fn whole(self) -> Mat<N> {
        match self {
            Self::Whole(a) => a,
            other => {
                let [_, columns] = other.shape();
                let unit = Mat::<N>::identity(columns, columns);
                other.times(false, unit.as_ref())
            }
        }
    }

    fn shape(&self) -> [usize; 2] {
        match self {
            Self::Whole(a) => [a.nrows(), a.ncols()],
            Self::Low(low) => [low.u.nrows(), low.v.nrows()],
            Self::Parts(grid) => [grid.rows.iter().sum(), grid.columns.iter().sum()],
        }
    }

    /// Rows of the parts; of a whole block all.
    fn heights(&self) -> Vec<usize> {
        match self {
            Self::Parts(grid) => grid.rows.clone(),
            Self::Whole(_) | Self::Low(_) => vec![self.shape()[0]],
        }
    }

    /// A part of the grid; the block itself where it has none.
    pub(super) fn part(&self, row: usize, column: usize) -> &Self {
        match self {
            Self::Parts(grid) => &grid.blocks[row * grid.columns.len() + column],
            Self::Whole(_) | Self::Low(_) => self,
        }
    }

    /// Adds factor · U Vᵀ.
    pub(super) fn add(&mut self, factor: N, u: MatRef<'_, N>, v: MatRef<'_, N>, tolerance: f64) {
        match self {
            Self::Whole(a) => matmul(a.as_mut(), Accum::Add, u, v.transpose(), factor, Par::Seq),
            Self::Low(low) => low.wait([scaled(u, factor), v.to_owned()], tolerance),
            Self::Parts(grid) => {
                for at in 0..grid.blocks.len() {
                    let [row, column] = grid.range(at);
                    let (u, v) = (u.subrows(row.0, row.1), v.subrows(column.0, column.1));
                    grid.blocks[at].add(factor, u, v, tolerance);
                }
            }
        }
    }

    /// Truncates all that waits.
    pub(super) fn settle(&mut self, tolerance: f64) {
        match self {
            Self::Whole(_) => {}
            Self::Low(low) => low.settle(tolerance),
            Self::Parts(grid) => grid.blocks.par_iter_mut().for_each(|part| part.settle(tolerance)),
        }
    }

    /// C −= A D Bᵀ, where nothing waits in A and B.
    pub(super) fn subtract(&mut self, a: &Self, b: &Self, middle: Option<Middle<'_, N>>, tolerance: f64) {
        if let Some([u, v]) = low_product(a, b, middle) {
            self.add(-one::<N>(), u.as_ref(), v.as_ref(), tolerance);
            return;
        }
        match self {
            Self::Whole(c) => {
                if let (Self::Whole(left), Self::Whole(right)) = (a, b) {
                    let left = times_middle(left, middle);
                    matmul(c.as_mut(), Accum::Add, left.as_ref(), right.transpose(), -one::<N>(), Par::Seq);
                    return;
                }
                // Rows and columns of a whole block are clusters that are not halved.
                for (k, middle) in between(a, middle) {
                    self.subtract(a.part(0, k), b.part(0, k), middle, tolerance);
                }
            }
            Self::Low(low) => {
                let [u, v] = truncated_product(a, b, middle, tolerance);
                low.wait([scaled(u.as_ref(), -one::<N>()), v], tolerance);
            }
            Self::Parts(grid) => {
                let columns = grid.columns.len();
                grid.blocks.par_iter_mut().enumerate().for_each(|(at, part)| {
                    for (k, middle) in between(a, middle) {
                        part.subtract(a.part(at / columns, k), b.part(at % columns, k), middle, tolerance);
                    }
                });
            }
        }
    }
}

/// Bytes of a matrix, whose columns may be stored with gaps between them.
pub(super) fn bytes_of<N>(a: &Mat<N>) -> u64 {
    (a.col_stride().unsigned_abs() * a.ncols() * size_of::<N>()) as u64
}

/// A, or its transpose.
pub(super) fn oriented<N>(a: &Mat<N>, transposed: bool) -> MatRef<'_, N> {
    if transposed { a.transpose() } else { a.as_ref() }
}

/// The parts that two blocks have in common between them, with those of D.
pub(super) fn between<'a, N: Number>(
    a: &Block<N>,
    middle: Option<Middle<'a, N>>,
) -> impl Iterator<Item = (usize, Option<Middle<'a, N>>)> + use<'a, N> {
    let count = match a {
        Block::Parts(grid) => grid.columns.len(),
        Block::Whole(_) | Block::Low(_) => 1,
    };
    (0..count).map(move |k| (k, middle.map(|middle| middle.part(k, count))))
}

/// A D Bᵀ = U Vᵀ where one of both is of low rank.
pub(super) fn low_product<N: Number>(
    a: &Block<N>,
    b: &Block<N>,
    middle: Option<Middle<'_, N>>,
) -> Option<[Mat<N>; 2]> {
    let through = |x: &Mat<N>, transposed: bool| match middle {
        Some(middle) => (if transposed { middle.transpose() } else { middle }).times(x.as_ref()),
        None => x.to_owned(),
    };
    match (a, b) {
        (Block::Low(a), Block::Low(other)) if other.u.ncols() < a.u.ncols() => {
            let inner = product(a.v.transpose(), through(&other.v, false).as_ref());
            Some([product(a.u.as_ref(), inner.as_ref()), other.u.to_owned()])
        }
        (Block::Low(a), b) => Some([a.u.to_owned(), b.times(false, through(&a.v, true).as_ref())]),
        (a, Block::Low(b)) => Some([a.times(false, through(&b.v, false).as_ref()), b.u.to_owned()]),
        _ => None,
    }
}

/// A D Bᵀ = U Vᵀ to a tolerance.
fn truncated_product<N: Number>(
    a: &Block<N>,
    b: &Block<N>,
    middle: Option<Middle<'_, N>>,
    tolerance: f64,
) -> [Mat<N>; 2] {
    if let Some(low) = low_product(a, b, middle) {
        return low;
    }
    if let (Block::Whole(left), Block::Whole(right)) = (a, b) {
        return [times_middle(left, middle), right.to_owned()];
    }
    let [rows, columns] = [a, b].map(Block::heights);
    let below = |sizes: &[usize], at: usize| sizes[..at].iter().sum();
    let mut all = Vec::new();
    for (i, &height) in rows.iter().enumerate() {
        for (j, &breadth) in columns.iter().enumerate() {
            let product = |(k, middle)| truncated_product(a.part(i, k), b.part(j, k), middle, tolerance);
            let terms: Vec<_> = between(a, middle).map(|term| ([0; 2], product(term))).collect();
            all.push(([below(&rows, i), below(&columns, j)], sum(&terms, [height, breadth], tolerance)));
        }
    }
    sum(&all, [rows.iter().sum(), columns.iter().sum()], tolerance)
}

/// Factors of low rank, and their first row and column in a block.
type Placed<N> = ([usize; 2], [Mat<N>; 2]);

/// The sum of blocks of low rank to a tolerance.
fn sum<N: Number>(all: &[Placed<N>], sizes: [usize; 2], tolerance: f64) -> [Mat<N>; 2] {
    let [u, v] = beside(all, sizes);
    if all.len() > 1 { truncated(u, &v, tolerance) } else { [u, v] }
}

/// Factors beside each other, in a block of this size.
fn beside<N: Number>(all: &[Placed<N>], sizes: [usize; 2]) -> [Mat<N>; 2] {
    let rank = all.iter().map(|(_, [u, _])| u.ncols()).sum();
    let mut out = sizes.map(|size| Mat::zeros(size, rank));
    let mut first = 0;
    for (starts, parts) in all {
        let count = parts[0].ncols();
        for ((out, part), &start) in out.iter_mut().zip(parts).zip(starts) {
            out.as_mut().submatrix_mut(start, first, part.nrows(), count).copy_from(part);
        }
        first += count;
    }
    out
}

/// A D.
fn times_middle<N: Number>(a: &Mat<N>, middle: Option<Middle<'_, N>>) -> Mat<N> {
    match middle {
        Some(middle) => middle.transpose().times(a.transpose()).transpose().to_owned(),
        None => a.to_owned(),
    }
}

fn scaled<N: Number>(a: MatRef<'_, N>, factor: N) -> Mat<N> {
    Mat::from_fn(a.nrows(), a.ncols(), |i, j| a[(i, j)] * factor)
}

impl<N: Number> Low<N> {
    fn wait(&mut self, added: [Mat<N>; 2], tolerance: f64) {
        self.waiting.push(added);
        let count: usize = self.waiting.iter().map(|[u, _]| u.ncols()).sum();
        if count >= self.u.ncols().max(LEAST_WAITING) {
            self.settle(tolerance);
        }
    }

    fn settle(&mut self, tolerance: f64) {
        if self.waiting.is_empty() {
            return;
        }
        let sizes = [self.u.nrows(), self.v.nrows()];
        let own = [&mut self.u, &mut self.v].map(|factor| std::mem::replace(factor, Mat::new()));
        let waiting = std::mem::take(&mut self.waiting);
        let all: Vec<_> = std::iter::once(own).chain(waiting).map(|factors| ([0; 2], factors)).collect();
        [self.u, self.v] = sum(&all, sizes, tolerance);
    }

    /// The right factor.
    pub(super) fn right(&mut self) -> &mut Mat<N> {
        &mut self.v
    }
}

impl<N: Number> Parts<N> {
    /// First row and number of rows of a part, and the same of its columns.
    fn range(&self, at: usize) -> [(usize, usize); 2] {
        let (row, column) = (at / self.columns.len(), at % self.columns.len());
        let range = |sizes: &[usize], at: usize| (sizes[..at].iter().sum(), sizes[at]);
        [range(&self.rows, row), range(&self.columns, column)]
    }

    /// The parts of a row, or of a column.
    fn of_line(&self, k: usize, column: bool) -> impl Iterator<Item = usize> + use<N> {
        let (rows, columns) = (self.rows.len(), self.columns.len());
        let (first, step, count) = if column { (k, columns, rows) } else { (k * columns, 1, columns) };
        (0..count).map(move |at| first + at * step)
    }

    /// The rows of parts.
    pub(super) fn rows(&mut self) -> impl IndexedParallelIterator<Item = &mut [Block<N>]> {
        self.blocks.par_chunks_exact_mut(self.columns.len())
    }
}
