//! The contract between couplings and solvers of x = b + K x: scalars, multivectors, operators,
//! solvers.
//!
//! An operator K is anything that implements [`LinearOperator`]: [`Dense`], [`PackedSymmetric`], or
//! one that never stores its entries. [`SecondKind`] makes A = I − D K of it, and a [`Solver`]
//! finds x with A x = b. Several bands (right-hand sides) share one pass over the entries of K:
//! they are the neighbours in a row of a [`MultiVector`].
//!
//! One [`Monitor`] defines the residual ‖b − A x‖₂/‖b‖₂, per right-hand side, for all solvers.
//!
//! ```
//! use fredholm_linop::{LinearOperator, MultiVector, PackedSymmetric, SecondKind};
//!
//! // Two facing plates: G_12 = 0.5 m², areas 1 m², reflectance 0.8 and 0.4.
//! let exchange = PackedSymmetric::new(2, vec![0.0, 0.5, 0.0])?;
//! let reflection = MultiVector::from_vec(2, 1, vec![0.8, 0.4])?;
//! let system = SecondKind::new(&exchange, reflection)?;
//!
//! let radiosity = MultiVector::from_vec(2, 1, vec![1.0, 0.5])?;
//! let mut exitance = MultiVector::zeros(2, 1);
//! system.apply(&radiosity, &mut exitance);
//! assert_eq!(exitance.as_slice(), [1.0 - 0.8 * 0.5 * 0.5, 0.5 - 0.4 * 0.5 * 1.0]);
//! # Ok::<(), fredholm_linop::LinopError>(())
//! ```

mod catalogue;
mod dense;
mod error;
mod lazy;
mod monitor;
mod multivector;
mod operator;
mod packed;
mod scalar;
mod scheme;
mod second_kind;
mod solver;
mod sweep;
mod watch;

pub use catalogue::{Access, Entry, OptionError, Options, build};
pub use dense::Dense;
pub use error::{LinopError, SolveError};
pub use lazy::{Columns, Lazy};
pub use monitor::Monitor;
pub use multivector::MultiVector;
pub use operator::{LinearOperator, Symmetry};
pub use packed::{PackedSymmetric, Storage};
pub use scalar::{OfScalar, Scalar};
pub use scheme::{Context, Halt, Iteration, Scheme, solve_by_steps};
pub use second_kind::SecondKind;
pub use solver::{Observer, Progress, Quiet, Record, Report, Solver, Stop, StopReason, Work};
pub use sweep::{Relax, Sweep, Visit};
pub use watch::{Steps, Watch};
