//! Nyström: x_i = b(p_i) + ρ Σ_j w_j k(p_i, p_j) x_j at the points of a quadrature rule.
//!
//! G. Peyré's article, eq. 1.28, and 1.29 for the interpolant x(p) = b(p) + ρ(p) Σ_j w_j k(p, p_j)
//! x_j. The rule has m × m Gauss points on a quad and the 1, 3 or 6 points of degree 1, 2 and 4 on
//! a triangle, for m = 1, 2, 3. Order 2m; on triangles that holds where pairs of them form
//! parallelograms, and is 2m − 1 otherwise.
//!
//! Near and occluded elements would spoil the rule. There the weights are those of product
//! integration, ∫_j k(p, q) φ_b(q) dA with φ_b the Lagrange basis of the same points: local
//! correction, L. F. Canino et al., J. Comput. Phys. 146 (1998) 627, doi:10.1006/jcph.1998.6077.

use crate::system::{at_nodes, product, spread};
use crate::transfer::matrix_by_element;
use crate::{
    Degree, Discretisation, DiscretisationError, Equation, Site, Source, Space, Surface, System, Transfer,
};
use fredholm_linop::{Dense, LinearOperator, MultiVector};

/// Nyström's method with m × m points, m one more than the degree of the basis that interpolates at
/// them.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Nystrom(pub Degree);

impl Discretisation for Nystrom {
    fn name(&self) -> &'static str {
        ["nystrom-1", "nystrom-2", "nystrom-3"][self.0.number()]
    }

    fn summary(&self) -> &'static str {
        [
            "Nyström with the midpoint rule, order 2",
            "Nyström with 3 or 4 points an element, order 4",
            "Nyström with 6 or 9 points an element, order 6",
        ][self.0.number()]
    }

    fn degree(&self) -> Degree {
        self.0
    }

    fn space<'a>(&self, surface: &'a Surface) -> Result<Space<'a>, DiscretisationError> {
        Space::discontinuous(surface, self.0.number())
    }

    fn discretise<'a>(&self, equation: Equation<'a>) -> Result<Box<dyn System + 'a>, DiscretisationError> {
        let space = self.space(equation.transfer().surface())?;
        let points = Points::new(&space);
        let fill = |i: usize, block: &mut [f64]| {
            points.fill(equation.transfer(), &space, &space.nodes_of(i), block);
        };
        let matrix = matrix_by_element(&space, fill)?;
        Ok(Box::new(AtPoints { equation, space, points, matrix }))
    }
}

/// The points of the rule on all elements, with weights in m², one for each unknown.
struct Points(Vec<(Site, f64)>);

impl Points {
    fn new(space: &Space) -> Self {
        let surface = space.surface();
        Self((0..surface.len()).flat_map(|j| surface.place(j, space.basis(j).nodes())).collect())
    }

    /// Adds w_j k(p, p_j) for sites p of one element to `rows`, sites × unknowns.
    fn fill(&self, transfer: &dyn Transfer, space: &Space, sites: &[Site], rows: &mut [f64]) {
        let Some(first) = sites.first() else { return };
        let n = space.dim();
        for j in 0..space.surface().len() {
            if transfer.is_regular(first.element, j) {
                for (p, row) in sites.iter().zip(rows.chunks_exact_mut(n)) {
                    self.by_rule(transfer, p, space.dofs(j), row);
                }
            } else {
                corrected(transfer, space, sites, j, rows);
            }
        }
        transfer.advance();
    }

    fn by_rule(&self, transfer: &dyn Transfer, p: &Site, dofs: &[usize], row: &mut [f64]) {
        for &dof in dofs {
            let (q, weight) = &self.0[dof];
            row[dof] += weight * transfer.kernel(p, q);
        }
    }
}

/// Adds ∫_j k(p, q) φ(q) dA.
fn corrected(transfer: &dyn Transfer, space: &Space, sites: &[Site], j: usize, rows: &mut [f64]) {
    let n = space.dim();
    transfer.send(sites, j, space.degree(), &mut |at, points| {
        let moments = space.moments(j, points);
        space.dofs(j).iter().zip(moments).for_each(|(&dof, moment)| rows[at * n + dof] += moment);
    });
}

struct AtPoints<'a> {
    equation: Equation<'a>,
    space: Space<'a>,
    points: Points,
    matrix: Dense<f64>,
}

impl System for AtPoints<'_> {
    fn equation(&self) -> Equation<'_> {
        self.equation
    }

    fn space(&self) -> &Space<'_> {
        &self.space
    }

    fn coupling(&self) -> &dyn LinearOperator<f64> {
        &self.matrix
    }

    fn factor(&self) -> MultiVector<f64> {
        spread(&self.equation, &self.space)
    }

    fn right_hand_side(&self, source: &Source) -> MultiVector<f64> {
        at_nodes(&self.equation, &self.space, source)
    }

    fn irradiance(&self, _: &Source, x: &MultiVector<f64>) -> MultiVector<f64> {
        product(&self.matrix, x)
    }

    /// The polynomial through the points of the element.
    fn value(&self, _: &Source, x: &MultiVector<f64>, site: &Site, rhs: usize) -> f64 {
        self.space.value(x, rhs, site.element, site.u, site.v)
    }

    /// Nyström's interpolant.
    fn reconstruct(&self, source: &Source, x: &MultiVector<f64>, sites: &[Site]) -> MultiVector<f64> {
        let (n, rhs_count) = (self.space.dim(), self.equation.rhs_count());
        let mut rows = vec![0.0; sites.len() * n];
        self.points.fill(self.equation.transfer(), &self.space, sites, &mut rows);
        MultiVector::from_fn(sites.len(), rhs_count, |at, rhs| {
            let row = rows[at * n..(at + 1) * n].iter().enumerate();
            let irradiance: f64 = row.map(|(j, entry)| entry * x.row(j)[rhs]).sum();
            let rho = self.equation.reflectance().row(sites[at].element)[rhs];
            source(&sites[at], rhs) + rho * irradiance
        })
    }

    /// The interpolant already is one: x is put into the sum once more.
    fn iterated(&self, source: &Source, x: &MultiVector<f64>, sites: &[Site]) -> MultiVector<f64> {
        self.reconstruct(source, x, sites)
    }
}
