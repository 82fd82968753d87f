//! Multilevel fast multipoles: products with the matrix of a wave equation in time and memory that
//! grow hardly faster than the number of unknowns.
//!
//! Every entry between far groups is an integral over directions,
//!
//! ```text
//! Z_mn = c ∮ V_m(k̂)·F_n(k̂) T(k̂) d²k̂,   T of the series for the distance of two boxes (`series`),
//! ```
//!
//! with the pattern F that an unknown radiates and the pattern V that it is tested by, both with
//! two components across k̂ and relative to the middles of their boxes. Boxes form an octree.
//! Patterns are summed over a leaf, interpolated and shifted to the next larger boxes, translated
//! to boxes that are far although the larger ones are not, and taken back to the leaves by the
//! transposed steps. Boxes that are near stay whole. (W. C. Chew, J.-M. Jin, E. Michielssen, J.
//! Song, Fast and Efficient Algorithms in Computational Electromagnetics, Artech House 2001, ch. 3;
//! J. M. Song, C.-C. Lu, W. C. Chew, IEEE Trans. Antennas Propag. 45 (1997) 1488,
//! doi:10.1109/8.633855.)
//!
//! Two boxes are far where the series for the supports in them, as they are, has an error within
//! the tolerance, and loses no digits that single precision needs: everything is stored in single
//! precision and multiplied in double precision. A box is the work of one thread and sums in a
//! fixed order, so that products have the same bits for any number of threads.

mod boxes;
mod grid;
mod interpolation;
mod plan;
mod product;
mod series;

pub use grid::Direction;
pub use plan::{MultipoleSettings, MultipoleSummary};
pub use product::Multipole;

use crate::Entries;
use fredholm_mesh::Vec3;
use num_complex::Complex64;

/// Numbers for each direction of half a pattern: both components, real and imaginary.
pub(crate) const NUMBERS: usize = 4;

/// A matrix of which unknowns have far fields.
///
/// The pattern of an unknown is F = ∫ e^{jk k̂·(r − c)} f(r) dA for a real current f, so that that
/// of the opposite direction is its conjugate. It is tested by V = α F* + M with M(−k̂) = −M(k̂)*:
/// of the electric and the magnetic equation.
pub trait Patterns: Entries<Complex64> {
    /// k, 1/m.
    fn wavenumber(&self) -> f64;

    /// c, in front of the integral over all directions.
    fn factor(&self) -> Complex64;

    /// α.
    fn share(&self) -> f64;

    /// Whether there is an M.
    fn has_magnetic(&self) -> bool;

    /// How far the support of a group goes beyond its place, m.
    fn radius(&self, group: usize) -> f64;

    /// Writes for each unknown of some groups, relative to the centre c (m), for all directions of
    /// half the sphere: Re F_θ, Im F_θ, Re F_φ, Im F_φ and, where there is one, the same of M.
    fn write(&self, groups: &[usize], centre: Vec3, directions: &[Direction], out: &mut [f32]);
}
