//! What can go wrong.

use fredholm_coupling::CouplingError;
use fredholm_linop::{LinopError, SolveError};
use fredholm_mesh::MeshError;
use fredholm_visibility::VisibilityError;
use thiserror::Error;

/// Why a scene cannot be solved by hierarchical radiosity.
#[derive(Debug, Error)]
#[non_exhaustive]
pub enum HierarchyError {
    /// Nothing to compute on.
    #[error("the mesh has no elements; give the scene a surface")]
    Empty,
    /// More nodes than an index can hold.
    #[error("the tree of elements has more than 2³² − 2 nodes; ask for less accuracy")]
    TooLarge,
    /// A vector that does not have one row for each input element.
    #[error("{what} has {found} rows, but there are {expected} input elements")]
    Shape {
        /// What it is.
        what: &'static str,
        /// Its rows.
        found: usize,
        /// Input elements.
        expected: usize,
    },
    /// An accuracy that is none.
    #[error("the accuracy {value} is not between 0 and 1; write one such as 0.01")]
    Accuracy {
        /// What was given.
        value: f64,
    },
    /// A goal that the scene does not have.
    #[error("there is no surface \"{name}\"; choose among {known}")]
    Goal {
        /// What was asked for.
        name: String,
        /// The names of the surfaces.
        known: String,
    },
    /// More memory than allowed, before the first solution.
    #[error("the coarsest links need {needed} bytes, but {limit} are allowed; allow more memory")]
    Memory {
        /// Bytes needed.
        needed: u64,
        /// Bytes allowed.
        limit: u64,
    },
    /// A saved state that does not belong to the scene, or is damaged.
    #[error("the saved state {why}; solve the scene again")]
    State {
        /// What is wrong with it.
        why: &'static str,
    },
    /// A state that could not be saved.
    #[error("cannot save the state: {why}")]
    Save {
        /// What stood in the way.
        why: String,
    },
    /// The caller asked to stop.
    #[error("stopped before there was a solution")]
    Interrupted,
    /// Geometry.
    #[error(transparent)]
    Mesh(#[from] MeshError),
    /// Occluders.
    #[error(transparent)]
    Visibility(#[from] VisibilityError),
    /// The system.
    #[error(transparent)]
    Coupling(#[from] CouplingError),
    /// Vectors and operators.
    #[error(transparent)]
    Linop(#[from] LinopError),
    /// The solver.
    #[error(transparent)]
    Solve(#[from] SolveError),
}
