//! The contract of a discretisation.

use crate::{Degree, DiscretisationError, Equation, Space, Surface, System};

/// A way to turn the integral equation into a linear system.
pub trait Discretisation: Send + Sync {
    /// The name it is chosen by: lower case, words joined by hyphens, ending in its degree or
    /// number of points.
    fn name(&self) -> &'static str;

    /// What it does, in one line.
    fn summary(&self) -> &'static str;

    /// Degree of the trial functions.
    fn degree(&self) -> Degree;

    /// Order at which the means of H x over faces converge where the field is smooth: twice the
    /// degree and two (I. H. Sloan, Math. Comp. 30 (1976) 758, doi:10.2307/2005395).
    fn order(&self) -> f64 {
        (2 * self.degree().number() + 2) as f64
    }

    /// The trial functions on a surface; their number is that of the unknowns.
    ///
    /// # Errors
    /// A surface that does not suit the method.
    fn space<'a>(&self, surface: &'a Surface) -> Result<Space<'a>, DiscretisationError>;

    /// Numbers of 8 bytes that the matrices hold at most while the system is built, for right-hand
    /// sides of so many different reflectances. `galerkin-0` on a transfer that has
    /// [`exchanges`](crate::Transfer::exchanges) takes half of that.
    fn numbers(&self, space: &Space, _reflectances: usize) -> u128 {
        (space.dim() as u128).pow(2)
    }

    /// Builds the system.
    ///
    /// # Errors
    /// No memory, or a surface that does not suit the method.
    fn discretise<'a>(&self, equation: Equation<'a>) -> Result<Box<dyn System + 'a>, DiscretisationError>;
}
