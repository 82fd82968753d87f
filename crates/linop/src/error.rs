//! What can be wrong with operators and systems, and how to mend it. Unknowns and right-hand sides
//! are counted from 0.

use thiserror::Error;

/// An operator or vector that cannot be built.
#[derive(Clone, Debug, Error, PartialEq)]
#[non_exhaustive]
pub enum LinopError {
    /// The number of entries does not fit the dimension.
    #[error("{what} needs {expected} entries, but {found} were given")]
    Length {
        /// What was to be built.
        what: &'static str,
        /// Entries needed.
        expected: u128,
        /// Entries given.
        found: usize,
    },
    /// The diagonal factor does not fit the operator.
    #[error(
        "the diagonal factor is {found} unknowns × {rhs_count} right-hand sides, but the operator is {expected} × {operator_rhs}"
    )]
    Factor {
        /// Unknowns of the factor.
        found: usize,
        /// Right-hand sides of the factor.
        rhs_count: usize,
        /// Unknowns of the operator.
        expected: usize,
        /// Right-hand sides of the operator.
        operator_rhs: usize,
    },
    /// A number is NaN or infinite.
    #[error("{what} of unknown {unknown} in right-hand side {rhs} is not a finite number")]
    NotFinite {
        /// What the number is.
        what: &'static str,
        /// Index of the unknown.
        unknown: usize,
        /// Index of the right-hand side.
        rhs: usize,
    },
    /// A matrix is not as symmetric as was said.
    #[error(
        "the matrix is not symmetric as was said: its entries ({row}, {column}) and ({column}, {row}) contradict it"
    )]
    Asymmetric {
        /// Row of the first entry that contradicts it.
        row: usize,
        /// Column of it.
        column: usize,
    },
    /// The system has not enough memory.
    #[error("the system has no {bytes} bytes for {what}; use fewer unknowns or a method that stores less")]
    Memory {
        /// What was to be stored.
        what: &'static str,
        /// Bytes asked for.
        bytes: u64,
    },
}

/// A system that a solver cannot take, with the reason.
#[derive(Clone, Debug, Error, PartialEq)]
#[non_exhaustive]
pub enum SolveError {
    /// The method is not made for this system.
    #[error("{solver} does not suit this system: {reason}")]
    Unsuitable {
        /// Name of the solver.
        solver: &'static str,
        /// What the solver needs and what was found.
        reason: String,
    },
    /// A vector does not fit the system.
    #[error(
        "the {vector} is {found} unknowns × {found_rhs} right-hand sides, but the system is {expected} × {expected_rhs}"
    )]
    Shape {
        /// Which vector.
        vector: &'static str,
        /// Its unknowns.
        found: usize,
        /// Its right-hand sides.
        found_rhs: usize,
        /// Unknowns of the system.
        expected: usize,
        /// Right-hand sides of the system.
        expected_rhs: usize,
    },
    /// The tolerance is no bound.
    #[error("the tolerance is {value}, but must be a number of at least 0")]
    Tolerance {
        /// What was given.
        value: f64,
    },
    /// The matrix has no inverse in double precision.
    #[error(
        "the matrix of right-hand side {rhs} is singular to working precision; the system has no unique solution (is the reflectance below 1?)"
    )]
    Singular {
        /// Index of the right-hand side.
        rhs: usize,
    },
    /// The matrix is not positive definite, as the method needs it.
    #[error(
        "{solver} does not suit this system: the matrix of right-hand side {rhs} is not positive definite (is the reflectance below 1?); minres, gmres and lu do without"
    )]
    Indefinite {
        /// Name of the solver.
        solver: &'static str,
        /// Index of the right-hand side.
        rhs: usize,
    },
    /// An operator or vector cannot be built.
    #[error(transparent)]
    Linop(#[from] LinopError),
}
