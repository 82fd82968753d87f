//! H, the coupling without the reflectance: (H x)(p) = ∫_S k(p, q) x(q) dA(q), as points and
//! weights on every element.
//!
//! All discretisations are built from one question: which points (u, v) and weights w of element j
//! give ∫_j k(p, q) f(q) dA(q) ≈ Σ w f(u, v) for the polynomials f of a basis. The weights hold
//! kernel, visibility and area, so that the strategy (plain Gauss points, exact parts seen, points
//! graded towards a peak) is the transfer's own. k in 1/m², weights dimensionless.

mod flat;
mod near;
mod smooth;

pub use flat::FlatLambert;
pub(crate) use flat::RECEIVER_POINTS_BEYOND_DEGREE;
pub use smooth::{Kernel, SmoothTransfer};

use crate::surface::Rules;
use crate::{DiscretisationError, Site, Space, Surface};
use fredholm_linop::{Dense, LinopError, MultiVector, PackedSymmetric};
use fredholm_quadrature::PlanePoint;
use rayon::prelude::*;

/// What [`Transfer::send`] calls with the index of a site and the points and weights for it.
pub type Sink<'a> = dyn FnMut(usize, &[PlanePoint]) + 'a;

/// The integral operator with kernel k on a surface.
pub trait Transfer: Sync {
    /// The surface.
    fn surface(&self) -> &Surface;

    /// k(p, q) times the visibility of the two points, 1/m².
    fn kernel(&self, p: &Site, q: &Site) -> f64;

    /// Whether k is so smooth between two elements that the points of a plain rule do: not close to
    /// each other, nothing between.
    fn is_regular(&self, i: usize, j: usize) -> bool;

    /// Calls `each` for every site with points and weights on element `j`, for polynomials of
    /// `degree`. The sites must lie on one element. A site that sees nothing of j may be left out.
    fn send(&self, sites: &[Site], j: usize, degree: usize, each: &mut Sink);

    /// Called whenever an assembly has the rows of another element, from any thread.
    fn advance(&self) {}

    /// The rules for integrals over the receiving element, for polynomials of `degree`.
    fn outer(&self, degree: usize) -> Rules;

    /// ∫_i ∫_j k dA dA (m²) of all pairs where the transfer has a better way than points, else
    /// `None`. `sizes` in the result are the areas that receive and send.
    ///
    /// # Errors
    /// No memory for the matrix.
    fn exchanges(&self) -> Option<Result<Exchanges, DiscretisationError>> {
        None
    }
}

/// Integrals over pairs of elements, exact to the tolerance of the transfer.
#[derive(Clone, Debug)]
pub struct Exchanges {
    /// ∫_i ∫_j k dA dA, m².
    pub matrix: PackedSymmetric<f64>,
    /// Areas of the elements, whole and exposed.
    pub sizes: Vec<fredholm_coupling::Extent>,
}

/// Adds (H φ_j)(p) for all functions of the space at sites of one element to `rows`: sites ×
/// unknowns, row by row.
pub(crate) fn fill_rows(transfer: &dyn Transfer, space: &Space, sites: &[Site], rows: &mut [f64]) {
    let n = space.dim();
    for j in 0..space.surface().len() {
        transfer.send(sites, j, space.degree(), &mut |at, points| {
            let moments = space.moments(j, points);
            let row = &mut rows[at * n..(at + 1) * n];
            space.dofs(j).iter().zip(moments).for_each(|(&dof, moment)| row[dof] += moment);
        });
    }
    transfer.advance();
}

/// (H f)(p) for a function f of site and right-hand side, at sites p of one element: sites ×
/// right-hand sides.
pub(crate) fn irradiance_at(
    transfer: &dyn Transfer,
    rhs_count: usize,
    degree: usize,
    sites: &[Site],
    f: &dyn Fn(&Site, usize) -> f64,
) -> MultiVector<f64> {
    let surface = transfer.surface();
    let mut sums = MultiVector::zeros(sites.len(), rhs_count);
    for j in 0..surface.len() {
        transfer.send(sites, j, degree, &mut |at, points| {
            for p in points {
                let q = surface.site(j, p.u, p.v);
                let row = sums.row_mut(at).iter_mut().enumerate();
                row.for_each(|(rhs, sum)| *sum += p.weight * f(&q, rhs));
            }
        });
    }
    sums
}

/// A function of the elements, evaluated in parallel for all and joined in their order: rows ×
/// right-hand sides.
pub(crate) fn by_element(
    surface: &Surface,
    rhs_count: usize,
    rows: impl Fn(usize) -> MultiVector<f64> + Send + Sync,
) -> MultiVector<f64> {
    let parts: Vec<_> = (0..surface.len()).into_par_iter().map(rows).collect();
    let all: Vec<&[f64]> = parts.iter().flat_map(|part| (0..part.dim()).map(|at| part.row(at))).collect();
    MultiVector::from_fn(all.len(), rhs_count, |at, rhs| all[at][rhs])
}

/// The square matrix of a discontinuous space; `fill` gets the element and the rows of its
/// unknowns, zeros, in parallel.
pub(crate) fn matrix_by_element(
    space: &Space,
    fill: impl Fn(usize, &mut [f64]) + Sync,
) -> Result<Dense<f64>, LinopError> {
    let n = space.dim();
    let mut entries = Dense::zeros(n)?.into_vec();
    let mut rest = &mut entries[..];
    let mut blocks = Vec::with_capacity(space.surface().len());
    for i in 0..space.surface().len() {
        let (block, tail) = rest.split_at_mut(space.dofs(i).len() * n);
        blocks.push(block);
        rest = tail;
    }
    blocks.into_par_iter().enumerate().for_each(|(i, block)| fill(i, block));
    Dense::new(n, entries)
}
