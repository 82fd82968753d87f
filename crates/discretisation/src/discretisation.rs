//! The contract of a discretisation.

use crate::{DiscretisationError, Equation, System};

/// A way to turn the integral equation into a linear system.
pub trait Discretisation: Send + Sync {
    /// The name it is chosen by: lower case, words joined by hyphens, ending in its degree or number of points.
    fn name(&self) -> &'static str;

    /// What it does, in one line.
    fn summary(&self) -> &'static str;

    /// Builds the system.
    ///
    /// # Errors
    /// No memory, or a surface that does not suit the method.
    fn discretise<'a>(&self, equation: Equation<'a>) -> Result<Box<dyn System + 'a>, DiscretisationError>;
}
