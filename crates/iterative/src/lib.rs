//! Iterative solvers of (I − D K) x = b, one algorithm a file.
//!
//! A solver is one file here and one line in [`solvers`]. All report the same residual ‖b − A x‖₂/‖b‖₂ per lane, see
//! [`fredholm_linop::Monitor`].

mod diagonal;
mod gauss_seidel;
mod southwell;

pub use gauss_seidel::GaussSeidel;
pub use southwell::Southwell;

use fredholm_linop::{Scalar, Solver};

/// All solvers of this crate, by name.
///
/// ```
/// let names: Vec<_> = fredholm_iterative::solvers::<f64>().iter().map(|solver| solver.name()).collect();
/// assert_eq!(names, ["gauss-seidel", "southwell"]);
/// ```
#[must_use]
pub fn solvers<T: Scalar>() -> Vec<Box<dyn Solver<T>>> {
    vec![Box::new(GaussSeidel), Box::new(Southwell)]
}
