//! The methods, one a file.

mod collocation;
mod degenerate_kernel;
mod galerkin;
mod least_squares;
mod nystrom;
mod rhs_matrices;
mod zonal;

pub use collocation::Collocation;
pub use degenerate_kernel::DegenerateKernel;
pub use galerkin::Galerkin;
pub use least_squares::LeastSquares;
pub use nystrom::Nystrom;
