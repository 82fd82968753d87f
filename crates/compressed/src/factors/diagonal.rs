//! A block on the diagonal, halved down to whole blocks: both triangles and D.

use super::block::{Block, Middle, between, bytes_of, low_product, oriented};
use crate::CompressionError;
use crate::block_diagonal::inverse as inverse_of;
use crate::number::{Number, Times, add_product};
use faer::linalg::matmul::matmul;
use faer::traits::math_utils::{one, zero};
use faer::{Accum, Mat, MatMut, MatRef, Par};
use fredholm_linop::{Scalar, Steps};
use rayon::prelude::*;

/// A triangle: L, or M of A = L D Mᵀ.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Side {
    Lower,
    Upper,
}

impl Side {
    fn other(self) -> Self {
        match self {
            Self::Lower => Self::Upper,
            Self::Upper => Self::Lower,
        }
    }
}

/// A block on the diagonal.
pub(super) enum Diagonal<N: Number> {
    /// A block of D and its inverse.
    Leaf { matrix: Mat<N>, inverse: Mat<N> },
    /// Both halves, and the blocks between them.
    Halved {
        /// Unknowns of the first half.
        at: usize,
        halves: Box<[Diagonal<N>; 2]>,
        /// Block 21, later of L.
        lower: Block<N>,
        /// The transpose of block 12, later block 21 of M; none where both triangles are the same.
        upper: Option<Block<N>>,
    },
}

/// What is asked of a factorisation, and who is told of it.
pub(super) struct Work<'a> {
    pub(super) tolerance: f64,
    /// Most bytes of the factors.
    pub(super) limit: u64,
    pub(super) steps: &'a Steps<'a>,
}

impl Work<'_> {
    /// Refuses factors of so many bytes where they are too many.
    pub(super) fn admit(&self, needed: u64) -> Result<(), CompressionError> {
        if needed > self.limit {
            return Err(CompressionError::Factors { needed, limit: self.limit });
        }
        Ok(())
    }
}

impl<N: Number> Diagonal<N> {
    pub(super) fn leaf(matrix: Mat<N>) -> Self {
        Self::Leaf { matrix, inverse: Mat::new() }
    }

    /// Bytes of both triangles and D, with what waits to be added to them.
    pub(super) fn bytes(&self) -> u64 {
        match self {
            // The inverse will be as large.
            Self::Leaf { matrix, .. } => 2 * bytes_of(matrix),
            Self::Halved { halves, lower, upper, .. } => {
                let halves = halves.iter().map(Self::bytes).sum::<u64>();
                halves + lower.bytes() + upper.as_ref().map_or(0, Block::bytes)
            }
        }
    }

    /// Puts L, D and M in the place of A, while `besides` bytes are held by other blocks.
    pub(super) fn factorise(&mut self, besides: u64, work: &Work<'_>) -> Result<(), CompressionError> {
        match self {
            Self::Leaf { matrix, inverse } => {
                let n = matrix.nrows();
                let block = work.steps.done();
                if work.steps.begin().is_break() {
                    return Err(CompressionError::Interrupted);
                }
                let double = |i: usize, j: usize| N::Double::from_single(matrix[(i, j)]);
                let entries = (0..n * n).map(|at| double(at / n, at % n)).collect();
                let found =
                    inverse_of(n, entries).ok_or(CompressionError::Singular { block: block as usize })?;
                *inverse = Mat::from_fn(n, n, |i, j| found[i * n + j].to_single());
                if inverse.col_iter().any(|column| column.iter().any(|x| !x.square().is_finite())) {
                    return Err(CompressionError::Singular { block: block as usize });
                }
                Ok(())
            }
            Self::Halved { halves, lower, upper, .. } => {
                let [first, second] = &mut **halves;
                let between = |lower: &Block<N>, upper: &Option<Block<N>>| {
                    lower.bytes() + upper.as_ref().map_or(0, Block::bytes)
                };
                first.factorise(besides + between(lower, upper) + second.bytes(), work)?;
                let first = &*first;
                let finish = |block: &mut Block<N>, side: Side| {
                    block.settle(work.tolerance);
                    first.solve_block(side.other(), block, work.tolerance);
                    first.divide_block(side == Side::Lower, block);
                };
                rayon::join(
                    || finish(lower, Side::Lower),
                    || upper.as_mut().map(|upper| finish(upper, Side::Upper)),
                );
                // The bytes are summed between the parallel steps, so that what is refused does not
                // depend on the order of the threads.
                let besides = besides + first.bytes() + between(lower, upper);
                work.admit(besides + second.bytes())?;
                let middle = Middle { diagonal: first, transposed: false };
                second.subtract(lower, upper.as_ref().unwrap_or(lower), Some(middle), work.tolerance);
                work.admit(besides + second.bytes())?;
                second.factorise(besides, work)
            }
        }
    }

    /// B ← B T⁻ᵀ with a triangle T.
    fn solve_block(&self, side: Side, block: &mut Block<N>, tolerance: f64) {
        let Self::Halved { halves, lower, upper, .. } = self else { return };
        let off = of_side(side, lower, upper.as_ref());
        match block {
            Block::Low(low) => self.solve(side, false, low.right().as_mut()),
            Block::Whole(matrix) => self.solve(side, false, matrix.transpose_mut()),
            // The columns are halved as the triangle is.
            Block::Parts(grid) => grid.rows().for_each(|row| {
                let [left, right] = row else { return };
                halves[0].solve_block(side, left, tolerance);
                right.subtract(left, off, None, tolerance);
                right.settle(tolerance);
                halves[1].solve_block(side, right, tolerance);
            }),
        }
    }

    /// Bᵀ ← D⁻¹ Bᵀ, or D⁻ᵀ Bᵀ.
    fn divide_block(&self, transposed: bool, block: &mut Block<N>) {
        match block {
            Block::Low(low) => self.divide(transposed, low.right().as_mut()),
            Block::Whole(matrix) => self.divide(transposed, matrix.transpose_mut()),
            Block::Parts(grid) => grid.rows().for_each(|row| match (self, row) {
                (Self::Halved { halves, .. }, [left, right]) => {
                    halves[0].divide_block(transposed, left);
                    halves[1].divide_block(transposed, right);
                }
                (_, row) => row.iter_mut().for_each(|part| self.divide_block(transposed, part)),
            }),
        }
    }

    /// C −= A D Bᵀ.
    fn subtract(&mut self, a: &Block<N>, b: &Block<N>, middle: Option<Middle<'_, N>>, tolerance: f64) {
        if let Some([u, v]) = low_product(a, b, middle) {
            self.subtract_product(u.as_ref(), v.as_ref(), tolerance);
            return;
        }
        match self {
            Self::Leaf { matrix, .. } => {
                let mut block = Block::Whole(std::mem::replace(matrix, Mat::new()));
                block.subtract(a, b, middle, tolerance);
                if let Block::Whole(done) = block {
                    *matrix = done;
                }
            }
            Self::Halved { halves, lower, upper, .. } => {
                let [first, second] = &mut **halves;
                let on_diagonal = |half: &mut Self, at: usize| {
                    for (k, middle) in between(a, middle) {
                        half.subtract(a.part(at, k), b.part(at, k), middle, tolerance);
                    }
                };
                let beside = |block: &mut Block<N>, [a, b]: [&Block<N>; 2], middle: Option<Middle<'_, N>>| {
                    for (k, middle) in between(a, middle) {
                        block.subtract(a.part(1, k), b.part(0, k), middle, tolerance);
                    }
                };
                rayon::join(
                    || rayon::join(|| on_diagonal(first, 0), || on_diagonal(second, 1)),
                    || {
                        rayon::join(
                            || beside(lower, [a, b], middle),
                            || {
                                upper
                                    .as_mut()
                                    .map(|upper| beside(upper, [b, a], middle.map(Middle::transpose)))
                            },
                        )
                    },
                );
            }
        }
    }

    /// C −= U Vᵀ.
    fn subtract_product(&mut self, u: MatRef<'_, N>, v: MatRef<'_, N>, tolerance: f64) {
        match self {
            Self::Leaf { matrix, .. } => {
                matmul(matrix.as_mut(), Accum::Add, u, v.transpose(), -one::<N>(), Par::Seq);
            }
            Self::Halved { at, halves, lower, upper } => {
                let ((u_first, u_second), (v_first, v_second)) = (u.split_at_row(*at), v.split_at_row(*at));
                let [first, second] = &mut **halves;
                rayon::join(
                    || {
                        rayon::join(
                            || first.subtract_product(u_first, v_first, tolerance),
                            || second.subtract_product(u_second, v_second, tolerance),
                        )
                    },
                    || {
                        rayon::join(
                            || lower.add(-one::<N>(), u_second, v_first, tolerance),
                            || {
                                upper
                                    .as_mut()
                                    .map(|upper| upper.add(-one::<N>(), v_second, u_first, tolerance))
                            },
                        )
                    },
                );
            }
        }
    }

    /// x ← T⁻¹ x with a triangle T, or T⁻ᵀ x.
    pub(super) fn solve<X: Times<N>>(&self, side: Side, transposed: bool, x: MatMut<'_, X>) {
        if let Self::Halved { at, halves, lower, upper } = self {
            let (first, second) = x.split_at_row_mut(*at);
            let mut order = [(&halves[0], first), (&halves[1], second)];
            // Tᵀ has its block above the diagonal, so that the second half comes first.
            if transposed {
                order.reverse();
            }
            let [(own, mut x), (other, mut y)] = order;
            own.solve(side, transposed, x.as_mut());
            let off = of_side(side, lower, upper.as_ref());
            off.multiply(transposed, x.as_ref(), y.as_mut(), -one::<X>());
            other.solve(side, transposed, y);
        }
    }

    /// x ← D⁻¹ x, or D⁻ᵀ x.
    pub(super) fn divide<X: Times<N>>(&self, transposed: bool, mut x: MatMut<'_, X>) {
        match self {
            Self::Leaf { inverse, .. } => {
                let old = x.to_owned();
                x.fill(zero());
                add_product(oriented(inverse, transposed), old.as_ref(), x, one());
            }
            Self::Halved { at, halves, .. } => {
                let (first, second) = x.split_at_row_mut(*at);
                halves[0].divide(transposed, first);
                halves[1].divide(transposed, second);
            }
        }
    }

    /// y += D x, or Dᵀ x.
    pub(super) fn multiply(&self, transposed: bool, x: MatRef<'_, N>, y: MatMut<'_, N>) {
        match self {
            Self::Leaf { matrix, .. } => add_product(oriented(matrix, transposed), x, y, one::<N>()),
            Self::Halved { at, halves, .. } => {
                let ((x_first, x_second), (first, second)) = (x.split_at_row(*at), y.split_at_row_mut(*at));
                halves[0].multiply(transposed, x_first, first);
                halves[1].multiply(transposed, x_second, second);
            }
        }
    }
}

/// The block below the diagonal of a triangle.
fn of_side<'a, N: Number>(side: Side, lower: &'a Block<N>, upper: Option<&'a Block<N>>) -> &'a Block<N> {
    match (side, upper) {
        (Side::Upper, Some(upper)) => upper,
        _ => lower,
    }
}
