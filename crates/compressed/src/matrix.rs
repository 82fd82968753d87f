//! The hierarchical matrix and its products.

use crate::block_diagonal::Diagonal;
use crate::clusters::{Cluster, Tree};
use crate::cross::Block;
use crate::number::{Times, add_product};
use crate::{CompressionError, Entries};
use faer::{Mat, MatMut, MatRef};
use fredholm_linop::{LinearOperator, MultiVector, Scalar, Steps, Symmetry, Watch};
use fredholm_mesh::Vec3;
use rayon::prelude::*;
use std::marker::PhantomData;
use std::ops::Range;

/// Far blocks of each level that are computed for the prediction of memory.
const SAMPLES: usize = 3;
/// Right-hand sides that are multiplied together.
pub(crate) const TOGETHER: usize = 16;
/// The finest tolerance: entries have errors of 6e-8 in single precision.
const FINEST_TOLERANCE: f64 = 1e-6;

/// How a matrix is compressed.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Settings {
    /// Relative error of every block in the Frobenius norm, between 1e-6 and 0.5: blocks are stored
    /// in single precision.
    pub tolerance: f64,
    /// Most groups of a cluster that is not halved.
    pub leaf: usize,
    /// Size of the smaller of two clusters over their distance up to which they are far.
    pub eta: f64,
    /// Most bytes of the blocks.
    pub limit: u64,
}

impl Default for Settings {
    fn default() -> Self {
        Self { tolerance: 1e-4, leaf: 48, eta: 1.0, limit: u64::MAX }
    }
}

/// What a compressed matrix is made of.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Summary {
    /// Blocks that are stored whole.
    pub whole: usize,
    /// Blocks of low rank.
    pub low_rank: usize,
    /// Largest rank.
    pub largest_rank: usize,
    /// Bytes of all blocks.
    pub bytes: u64,
    /// Bytes that were predicted from some blocks before the others were computed.
    pub predicted: u64,
    /// Bytes over those of the matrix stored whole in double precision.
    pub share: f64,
}

/// The unknowns of a cluster.
#[derive(Clone, Debug)]
pub(crate) struct Span {
    /// In the order of the tree.
    pub(crate) range: Range<usize>,
    /// The first half; the second follows it.
    pub(crate) halves: Option<usize>,
}

/// A block: its rows and columns in the order of the tree, and its entries in single precision.
pub(crate) struct Stored<T: Scalar> {
    pub(crate) rows: Range<usize>,
    pub(crate) columns: Range<usize>,
    /// What the entries are multiples of, a power of two: single precision spans fewer of them.
    pub(crate) unit: f64,
    pub(crate) kind: Kind<T::Single>,
}

pub(crate) enum Kind<S> {
    /// Row by row.
    Whole(Vec<S>),
    /// U Vᵀ, column by column.
    Low { u: Vec<S>, v: Vec<S> },
}

/// A square matrix in blocks, many of them of low rank.
pub struct Hierarchical<T: Scalar> {
    dim: usize,
    symmetry: Symmetry,
    /// Unknowns in the order of the tree.
    order: Vec<usize>,
    /// The clusters; the first has all unknowns.
    spans: Vec<Span>,
    /// Unknowns of the clusters that are not halved, in order.
    leaves: Vec<Range<usize>>,
    blocks: Vec<Stored<T>>,
    /// Blocks that reach the rows of each leaf, and those that do by symmetry.
    reach: Vec<Vec<(usize, bool)>>,
    predicted: u64,
}

impl<T: Scalar> Hierarchical<T> {
    /// Compresses a matrix whose groups of unknowns are at these places (m), in parallel over the
    /// blocks.
    ///
    /// # Errors
    /// [`CompressionError::Places`], [`CompressionError::NotFinite`] and
    /// [`CompressionError::Setting`] for what does not fit, [`CompressionError::Memory`] where the
    /// blocks are predicted to take more than the limit, [`CompressionError::Interrupted`] where
    /// `watch` no longer wants it.
    pub fn new<E: Entries<T>>(
        entries: &E,
        places: &[Vec3],
        settings: Settings,
        watch: &dyn Watch,
    ) -> Result<Self, CompressionError> {
        let (builder, pairs) = Builder::new(entries, places, settings)?;
        let predicted = builder.predicted(&pairs);
        if predicted > settings.limit {
            return Err(CompressionError::Memory { needed: predicted, limit: settings.limit });
        }
        let steps = Steps::new(watch, pairs.len() as u64, "blocks");
        let stored = |&(row, column, far): &Pair| {
            if steps.begin().is_break() {
                return Err(CompressionError::Interrupted);
            }
            Ok(builder.stored(row, column, far))
        };
        let blocks: Vec<Stored<T>> =
            pairs.par_iter().with_max_len(1).map(stored).collect::<Result<_, _>>()?;
        let span =
            |(at, cluster): (usize, &Cluster)| Span { range: builder.unknowns(at), halves: cluster.halves };
        let spans: Vec<Span> = builder.tree.clusters.iter().enumerate().map(span).collect();
        let mut leaves: Vec<Range<usize>> =
            builder.tree.leaves().into_iter().map(|leaf| spans[leaf].range.clone()).collect();
        leaves.sort_by_key(|leaf| leaf.start);
        let reach = reach(&leaves, &blocks, entries.symmetry() == Symmetry::Symmetric);
        let starts = starts(entries, 0..entries.groups());
        let order = builder.tree.order.iter().flat_map(|&group| starts[group]..starts[group + 1]).collect();
        let dim = starts[entries.groups()];
        Ok(Self { dim, symmetry: entries.symmetry(), order, spans, leaves, blocks, reach, predicted })
    }

    /// Bytes that it will take, from three blocks of each size.
    ///
    /// # Errors
    /// Those of [`new`](Self::new) for what does not fit.
    pub fn predicted_bytes<E: Entries<T>>(
        entries: &E,
        places: &[Vec3],
        settings: Settings,
    ) -> Result<u64, CompressionError> {
        let (builder, pairs) = Builder::new(entries, places, settings)?;
        Ok(builder.predicted(&pairs))
    }

    /// What it is made of.
    #[must_use]
    pub fn summary(&self) -> Summary {
        let rank = |block: &Stored<T>| match &block.kind {
            Kind::Whole(_) => None,
            Kind::Low { u, .. } => Some(u.len() / block.rows.len().max(1)),
        };
        let ranks: Vec<usize> = self.blocks.iter().filter_map(rank).collect();
        let bytes: u64 = self.blocks.iter().map(Stored::bytes).sum();
        Summary {
            whole: self.blocks.len() - ranks.len(),
            low_rank: ranks.len(),
            largest_rank: ranks.into_iter().max().unwrap_or(0),
            bytes,
            predicted: self.predicted,
            share: bytes as f64 / (self.dim as f64).powi(2) / size_of::<T>() as f64,
        }
    }

    /// The largest unit of the blocks, a power of two.
    pub(crate) fn unit(&self) -> f64 {
        self.blocks.iter().map(|block| block.unit).fold(f64::MIN_POSITIVE, f64::max)
    }

    /// The number of clusters that are not halved.
    pub(crate) fn leaves(&self) -> usize {
        self.leaves.len()
    }

    /// The clusters.
    pub(crate) fn spans(&self) -> &[Span] {
        &self.spans
    }

    /// The blocks.
    pub(crate) fn blocks(&self) -> &[Stored<T>] {
        &self.blocks
    }

    /// Unknowns in the order of the tree.
    pub(crate) fn order(&self) -> &[usize] {
        &self.order
    }
}

impl<T: Scalar + Times<T::Single>> Diagonal<T> for Hierarchical<T> {
    fn diagonal_blocks(&self) -> Vec<(Vec<usize>, Vec<T>)> {
        let on_diagonal = |block: &Stored<T>| match &block.kind {
            Kind::Whole(entries) if block.rows == block.columns => {
                let entries = entries.iter().map(|&entry| T::from_single(entry).scale(block.unit));
                Some((self.order[block.rows.clone()].to_vec(), entries.collect()))
            }
            _ => None,
        };
        self.blocks.iter().filter_map(on_diagonal).collect()
    }
}

impl<T: Scalar + Times<T::Single>> Hierarchical<T> {
    /// A x, both in the order of the tree, a right-hand side a column: the parts of the leaves.
    fn product(&self, x: MatRef<'_, T>) -> Vec<Mat<T>> {
        let symmetric = self.symmetry == Symmetry::Symmetric;
        let inner: Vec<[Mat<T>; 2]> = self
            .blocks
            .par_iter()
            .map(|block| match &block.kind {
                Kind::Whole(_) => [Mat::new(), Mat::new()],
                Kind::Low { u, v } => {
                    let dots = |factor: &[T::Single], range: &Range<usize>| {
                        let x = x.subrows(range.start, range.len());
                        let rank = factor.len() / range.len().max(1);
                        let factor = MatRef::from_column_major_slice(factor, range.len(), rank);
                        let mut dots = Mat::zeros(rank, x.ncols());
                        add_product(factor.transpose(), x, dots.as_mut(), T::from_real(block.unit));
                        dots
                    };
                    let back = if symmetric { dots(u, &block.rows) } else { Mat::new() };
                    [dots(v, &block.columns), back]
                }
            })
            .collect();
        let part = |(leaf, reach): (&Range<usize>, &Vec<(usize, bool)>)| {
            let mut y = Mat::zeros(leaf.len(), x.ncols());
            for &(at, turned) in reach {
                self.blocks[at].add(leaf, x, &inner[at][usize::from(turned)], turned, y.as_mut());
            }
            y
        };
        self.leaves.par_iter().zip(&self.reach).map(part).collect()
    }
}

impl<T: Scalar> Stored<T> {
    fn numbers(&self) -> u64 {
        let numbers = match &self.kind {
            Kind::Whole(entries) => entries.len(),
            Kind::Low { u, v } => u.len() + v.len(),
        };
        numbers as u64
    }

    fn bytes(&self) -> u64 {
        self.numbers() * size_of::<T::Single>() as u64
    }

    /// Adds the rows of a leaf of the block, or of its transpose, times x. `inner` has the products
    /// with the other factor.
    fn add(&self, leaf: &Range<usize>, x: MatRef<'_, T>, inner: &Mat<T>, turned: bool, y: MatMut<'_, T>)
    where
        T: Times<T::Single>,
    {
        let (own, other) = if turned { (&self.columns, &self.rows) } else { (&self.rows, &self.columns) };
        let first = leaf.start - own.start;
        match &self.kind {
            Kind::Low { u, v } => {
                let factor =
                    MatRef::from_column_major_slice(if turned { v } else { u }, own.len(), inner.nrows());
                add_product(factor.subrows(first, leaf.len()), inner.as_ref(), y, T::one());
            }
            Kind::Whole(entries) => {
                let all = MatRef::from_row_major_slice(entries, self.rows.len(), self.columns.len());
                let all = if turned { all.transpose() } else { all };
                let x = x.subrows(other.start, other.len());
                add_product(all.subrows(first, leaf.len()), x, y, T::from_real(self.unit));
            }
        }
    }
}

impl<T: Scalar + Times<T::Single>> LinearOperator<T> for Hierarchical<T> {
    fn dim(&self) -> usize {
        self.dim
    }

    fn apply(&self, x: &MultiVector<T>, y: &mut MultiVector<T>) {
        for first in (0..x.rhs_count()).step_by(TOGETHER) {
            let count = TOGETHER.min(x.rhs_count() - first);
            let sorted = Mat::from_fn(self.dim, count, |i, rhs| x.row(self.order[i])[first + rhs]);
            let product = self.product(sorted.as_ref());
            for (leaf, part) in self.leaves.iter().zip(product) {
                for (i, &at) in self.order[leaf.clone()].iter().enumerate() {
                    let values = &mut y.row_mut(at)[first..first + count];
                    values.iter_mut().enumerate().for_each(|(rhs, value)| *value = part[(i, rhs)]);
                }
            }
        }
    }

    fn symmetry(&self) -> Symmetry {
        self.symmetry
    }

    fn entries(&self) -> u64 {
        self.blocks.iter().map(Stored::numbers).sum()
    }
}

/// What computes the blocks.
struct Builder<'a, T: Scalar, E: Entries<T>> {
    entries: &'a E,
    tree: Tree,
    /// The first unknown of every group in the order of the tree, and their number.
    starts: Vec<usize>,
    sets: Vec<Option<E::Set>>,
    tolerance: f64,
    scalar: PhantomData<T>,
}

/// Two clusters, and whether they are far enough apart for their block to be of low rank.
type Pair = (usize, usize, bool);

impl<'a, T: Scalar, E: Entries<T>> Builder<'a, T, E> {
    /// What computes the blocks, and the pairs of clusters that these are of.
    fn new(
        entries: &'a E,
        places: &[Vec3],
        settings: Settings,
    ) -> Result<(Self, Vec<Pair>), CompressionError> {
        check(entries.groups(), places, settings)?;
        let tree = Tree::new(places, settings.leaf);
        let pairs = tree.pairs(settings.eta, entries.symmetry() == Symmetry::Symmetric);
        let mut used = vec![false; tree.clusters.len()];
        for &(row, column, _) in &pairs {
            (used[row], used[column]) = (true, true);
        }
        let sets = (0..used.len()).map(|at| used[at].then(|| entries.prepare(tree.groups(at)))).collect();
        let starts = starts(entries, tree.order.iter().copied());
        Ok((Self { entries, tree, starts, sets, tolerance: settings.tolerance, scalar: PhantomData }, pairs))
    }

    /// The unknowns of a cluster, in the order of the tree.
    fn unknowns(&self, cluster: usize) -> Range<usize> {
        let Range { start, end } = self.tree.clusters[cluster].range;
        self.starts[start]..self.starts[end]
    }

    fn stored(&self, row: usize, column: usize, far: bool) -> Stored<T> {
        let [rows, columns] = [row, column].map(|at| self.unknowns(at));
        let (unit, kind) = self.kind(row, column, far);
        Stored { rows, columns, unit, kind }
    }

    fn kind(&self, row: usize, column: usize, far: bool) -> (f64, Kind<T::Single>) {
        let (Some(row_set), Some(column_set)) = (&self.sets[row], &self.sets[column]) else {
            return (1.0, Kind::Whole(Vec::new()));
        };
        let (rows, columns) = (self.tree.groups(row), self.tree.groups(column));
        let block = Block::new(self.entries, [rows, columns], [row_set, column_set]);
        if far && let Some(low) = block.compressed(self.tolerance) {
            let ((left, u), (right, v)) = (single(&low.u), single(&low.v));
            return (left * right, Kind::Low { u, v });
        }
        let (unit, entries) = single(&block.into_whole());
        (unit, Kind::Whole(entries))
    }

    /// Bytes of all blocks: near ones are counted, far ones taken to be like some of their level.
    fn predicted(&self, pairs: &[Pair]) -> u64 {
        let size = |at: usize| self.unknowns(at).len();
        let whole = |&(row, column, _): &Pair| (size(row) * size(column)) as u64;
        let near: u64 = pairs.iter().filter(|pair| !pair.2).map(whole).sum();
        // Blocks with sides within a factor of two are of one level.
        let level = |pair: &Pair| (size(pair.0) + size(pair.1)).ilog2() as usize;
        let mut levels: Vec<Vec<Pair>> = vec![Vec::new(); 64];
        pairs.iter().filter(|pair| pair.2).for_each(|pair| levels[level(pair)].push(*pair));
        let far = levels.par_iter().map(|pairs| {
            let step = (pairs.len() / SAMPLES).max(1);
            let some: Vec<_> = pairs.iter().skip(step / 2).step_by(step).take(SAMPLES).collect();
            let stored: u64 =
                some.iter().map(|&&(row, column, far)| self.stored(row, column, far).bytes()).sum();
            let of = |pair: &Pair| (size(pair.0) + size(pair.1)) as u64;
            let [all, seen] = [pairs.iter().map(of).sum::<u64>(), some.into_iter().map(of).sum()];
            (stored as f64 * all as f64 / seen.max(1) as f64) as u64
        });
        near * size_of::<T::Single>() as u64 + far.sum::<u64>()
    }
}

fn check(groups: usize, places: &[Vec3], settings: Settings) -> Result<(), CompressionError> {
    if places.len() != groups {
        return Err(CompressionError::Places { expected: groups, found: places.len() });
    }
    if let Some(group) = places.iter().position(|place| !place.is_finite()) {
        return Err(CompressionError::NotFinite { group });
    }
    let refuse = |what, value, expected| Err(CompressionError::Setting { what, value, expected });
    check_tolerance(settings.tolerance)?;
    if !(settings.eta > 0.0 && settings.eta.is_finite()) {
        return refuse("eta of the compression", settings.eta, "finite and above 0");
    }
    if settings.leaf == 0 {
        return refuse("the size of the smallest clusters", 0.0, "at least 1");
    }
    Ok(())
}

/// Refuses tolerances that single precision does not hold, and those that say nothing.
pub(crate) fn check_tolerance(tolerance: f64) -> Result<(), CompressionError> {
    if (FINEST_TOLERANCE..=0.5).contains(&tolerance) {
        return Ok(());
    }
    let (what, expected) = ("the tolerance of the compression", "between 1e-6 and 0.5");
    Err(CompressionError::Setting { what, value: tolerance, expected })
}

/// The first unknown of each of some groups one after the other, and the number of all.
pub(crate) fn starts<T: Scalar, E: Entries<T>>(
    entries: &E,
    groups: impl Iterator<Item = usize>,
) -> Vec<usize> {
    let mut end = 0;
    let ends = groups.map(|group| {
        end += entries.width(group);
        end
    });
    std::iter::once(0).chain(ends).collect()
}

/// For every leaf the blocks that reach its rows, in their order.
fn reach<T: Scalar>(
    leaves: &[Range<usize>],
    blocks: &[Stored<T>],
    symmetric: bool,
) -> Vec<Vec<(usize, bool)>> {
    let mut reach = vec![Vec::new(); leaves.len()];
    let mut add = |range: &Range<usize>, at: usize, turned: bool| {
        let first = leaves.partition_point(|leaf| leaf.start < range.start);
        let last = leaves.partition_point(|leaf| leaf.start < range.end);
        reach[first..last].iter_mut().for_each(|list| list.push((at, turned)));
    };
    for (at, block) in blocks.iter().enumerate() {
        add(&block.rows, at, false);
        if symmetric && block.rows != block.columns {
            add(&block.columns, at, true);
        }
    }
    reach
}

/// Numbers in single precision, and the power of two that they are multiples of.
fn single<T: Scalar>(numbers: &[T]) -> (f64, Vec<T::Single>) {
    let largest = numbers.iter().map(|number| number.abs2()).fold(0.0, f64::max).sqrt();
    // That of a block of zeros is the smallest, since the largest of all blocks counts elsewhere.
    let unit = if largest.is_finite() { largest.max(f64::MIN_POSITIVE).log2().floor().exp2() } else { 1.0 };
    let inverse = unit.recip();
    (unit, numbers.iter().map(|number| number.scale(inverse).to_single()).collect())
}
