//! Iterative solvers of (I − D K) x = b, one algorithm a file.
//!
//! A scheme is one file here and one entry in the registry, see [`entries`]. Every scheme is a
//! [`fredholm_linop::Solver`]; all report the same residual ‖b − A x‖₂/‖b‖₂ per right-hand side,
//! see [`fredholm_linop::Monitor`].

mod core;

mod anderson;
mod bicgstab;
mod block_gauss_seidel;
mod block_jacobi;
mod cg_psi;
mod cg_theta;
mod chebyshev;
mod estimates;
mod gauss_seidel;
mod gmres;
mod group_shooting;
mod hgs1;
mod hgs2;
mod hybrid;
mod jacobi;
mod minres;
mod multilevel;
mod neumann;
mod pcg_ic;
mod pcg_jacobi;
mod pcg_ssor;
mod progressive;
mod registry;
mod sor;
mod southwell;
mod ssor;

pub use anderson::Anderson;
pub use bicgstab::Bicgstab;
pub use block_gauss_seidel::BlockGaussSeidel;
pub use block_jacobi::BlockJacobi;
pub use cg_psi::CgPsi;
pub use cg_theta::CgTheta;
pub use chebyshev::Chebyshev;
pub use estimates::{gauss_seidel_radius, ritz_values};
pub use gauss_seidel::GaussSeidel;
pub use gmres::Gmres;
pub use group_shooting::GroupShooting;
pub use hgs1::Hgs1;
pub use hgs2::Hgs2;
pub use hybrid::Hybrid;
pub use jacobi::Jacobi;
pub use minres::Minres;
pub use multilevel::{Frame, MultilevelShooting};
pub use neumann::Neumann;
pub use pcg_ic::PcgCholesky;
pub use pcg_jacobi::PcgJacobi;
pub use pcg_ssor::PcgSsor;
pub use progressive::{Progressive, with_ambient};
pub use registry::{entries, solvers};
pub use sor::{Sor, Sur};
pub use southwell::Southwell;
pub use ssor::Ssor;
