//! What a matrix has to offer to be compressed.

use fredholm_linop::{Scalar, Symmetry};

/// A square matrix of which blocks are computed on demand. Its unknowns come in groups that share a
/// place; those of a group follow each other, and those of the next group come after them.
pub trait Entries<T: Scalar>: Sync {
    /// Groups that are prepared for filling blocks.
    type Set: Send + Sync;

    /// Number of groups.
    fn groups(&self) -> usize;

    /// Unknowns of a group, at least 1.
    fn width(&self, _group: usize) -> usize {
        1
    }

    /// Symmetry of the matrix; of a symmetric one half of the blocks is computed.
    fn symmetry(&self) -> Symmetry;

    /// Prepares some groups.
    fn prepare(&self, groups: &[usize]) -> Self::Set;

    /// Writes the entries of all unknowns of some groups, row by row. The same sets give the same
    /// bits.
    fn fill(&self, rows: &Self::Set, columns: &Self::Set, out: &mut [T]);
}
