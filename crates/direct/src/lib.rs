//! Direct solvers of (I − D K) x = b.
//!
//! A solver is one file here and one line in [`solvers`]. All report the same residual ‖b − A x‖₂/‖b‖₂ per lane as the
//! iterative ones, see [`fredholm_linop::Monitor`].

mod dense_lu;
mod factorisation;

pub use dense_lu::DenseLu;
pub use faer::traits::ComplexField;

use fredholm_linop::{Scalar, Solver};

/// All solvers of this crate, by name. T is f64 or Complex64.
///
/// ```
/// let names: Vec<_> = fredholm_direct::solvers::<f64>().iter().map(|solver| solver.name()).collect();
/// assert_eq!(names, ["lu"]);
/// ```
#[must_use]
pub fn solvers<T: Scalar + ComplexField>() -> Vec<Box<dyn Solver<T>>> {
    vec![Box::new(DenseLu)]
}
