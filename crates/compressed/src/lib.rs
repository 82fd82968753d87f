//! Hierarchical matrices: couplings of all with all in little memory, from entries that are
//! computed on demand.
//!
//! Unknowns are sorted into a tree of clusters. Two clusters that are far from each other, compared
//! with their size, couple by a block of low rank, which is found from few of its rows and columns
//! (adaptive cross approximation); blocks of close ones are stored whole. W. Hackbusch,
//! Hierarchical Matrices: Algorithms and Analysis, Springer 2015, doi:10.1007/978-3-662-47324-5.
//!
//! Every block is approximated to a relative tolerance in the Frobenius norm, so that the error of
//! a product is at most about the tolerance times the norm of the matrix. Blocks are stored in
//! single precision, which is far finer, and multiplied in double precision. Products and blocks
//! have the same bits for any number of threads: a block is the work of one thread, and each part
//! of a product is summed in the order of the blocks.
//!
//! Beside them stand multilevel fast multipoles ([`Multipole`]), for matrices whose unknowns have
//! far fields: from some thousand unknowns on they take less of everything.

mod block_diagonal;
mod clusters;
mod cross;
mod entries;
mod error;
mod factors;
mod low_rank;
mod matrix;
mod multipole;
mod number;
mod preconditioned;

pub use block_diagonal::{BlockDiagonal, Diagonal};
pub use entries::Entries;
pub use error::CompressionError;
pub use factors::Factors;
pub use matrix::{Hierarchical, Settings, Summary};
pub use multipole::{Direction, Multipole, MultipoleSettings, MultipoleSummary, Patterns};
pub use number::{Number, Times};
pub use preconditioned::Preconditioned;
