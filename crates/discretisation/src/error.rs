//! What can be wrong with a discretisation, and how to mend it.

use fredholm_coupling::CouplingError;
use fredholm_linop::{LinopError, SolveError};
use fredholm_quadrature::RuleError;
use fredholm_visibility::VisibilityError;
use thiserror::Error;

/// Why there is no discrete system, or no solution of it.
#[derive(Clone, Debug, Error, PartialEq)]
#[non_exhaustive]
pub enum DiscretisationError {
    /// No discretisation has this name.
    #[error("there is no discretisation `{name}`; there are {known}")]
    Unknown {
        /// The name asked for.
        name: String,
        /// All names, joined by commas.
        known: String,
    },
    /// Arrays that do not fit the surface.
    #[error("{what} has {found} entries, but the surface has {elements} elements")]
    Dimension {
        /// What does not fit.
        what: &'static str,
        /// Entries found.
        found: usize,
        /// Elements of the surface.
        elements: usize,
    },
    /// Elements that share unknowns differ in reflectance.
    #[error(
        "element {element} shares an unknown with one of another reflectance; put them on different faces or take a discontinuous basis"
    )]
    Reflectance {
        /// The later of the two elements.
        element: usize,
    },
    /// The functions of the basis cannot be told apart by the rule.
    #[error("the mass matrix of element {element} is not positive definite; the element is degenerate")]
    Degenerate {
        /// First element of the block.
        element: usize,
    },
    /// A quadrature rule that does not exist.
    #[error(transparent)]
    Rule(#[from] RuleError),
    /// A form-factor matrix that cannot be assembled.
    #[error(transparent)]
    Coupling(#[from] CouplingError),
    /// Elements that no visibility can be computed for.
    #[error(transparent)]
    Visibility(#[from] VisibilityError),
    /// A matrix that cannot be built.
    #[error(transparent)]
    Linop(#[from] LinopError),
    /// A system that cannot be solved.
    #[error(transparent)]
    Solve(#[from] SolveError),
}
