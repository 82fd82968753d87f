//! View-factor matrices: F_ij, the share of what leaves surface i that reaches surface j, with its
//! error; files and pictures of it.
//!
//! A_i F_ij = G_ij is symmetric; areas in m², factors dimensionless. Every file appears whole or
//! not at all.

mod csv;
mod error;
mod files;
mod heat_map;
mod histogram;
mod matrix;
mod npy;
mod npz;
mod record;
mod view3d;

pub use error::ViewFactorsError;
pub use files::{MatrixFormat, ViewFactorFiles, write_view_factors};
pub use heat_map::heat_map;
pub use histogram::write_closure_histogram;
pub(crate) use histogram::{bins, edge};
pub use matrix::{Factors, Sparse, SurfaceData, ViewFactors, ViewPoints};
pub(crate) use npy::write_texts;
pub use record::{ClosureChange, VIEW_FACTORS_FORMAT, ViewFactorsRecord, read_view_factors_record};
