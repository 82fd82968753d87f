//! Collocation: x_h(p_i) = b(p_i) + ρ Σ_j (H φ_j)(p_i) x_j at the nodes p_i of a discontinuous
//! Lagrange basis.
//!
//! G. Peyré's article, eq. 1.47 and 1.48. The nodes are the Gauss points of quads and the 1, 3 or 6
//! points of symmetric rules on triangles. Order k + 1 in L²; the iterated solution reaches 2k + 2
//! where the nodes are Gauss points, and on triangles k + 2 rounded up to an even number where
//! pairs of triangles form parallelograms: K. E. Atkinson, *The Numerical Solution of Integral
//! Equations of the Second Kind*, Cambridge University Press 1997, sections 3.4 and 5.1,
//! doi:10.1017/CBO9780511626340.

use crate::system::{at_nodes, product, spread};
use crate::transfer::{fill_rows, matrix_by_element};
use crate::{Degree, Discretisation, DiscretisationError, Equation, Site, Source, Space, Surface, System};
use fredholm_linop::{Dense, LinearOperator, LinopError, MultiVector};

/// Collocation with one degree.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Collocation(pub Degree);

impl Discretisation for Collocation {
    fn name(&self) -> &'static str {
        ["collocation-0", "collocation-1", "collocation-2"][self.0.number()]
    }

    fn summary(&self) -> &'static str {
        [
            "Collocation at the middle of every element, constant on each",
            "Collocation at 3 or 4 points of every element, P1 or Q1 on each",
            "Collocation at 6 or 9 points of every element, P2 or Q2 on each",
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
        let matrix = collocation_matrix(&equation, &space)?;
        Ok(Box::new(AtNodes { equation, space, matrix }))
    }
}

/// (H φ_j)(p_i).
pub(super) fn collocation_matrix(equation: &Equation, space: &Space) -> Result<Dense<f64>, LinopError> {
    matrix_by_element(space, |i, block| {
        fill_rows(equation.transfer(), space, &space.nodes_of(i), block);
    })
}

struct AtNodes<'a> {
    equation: Equation<'a>,
    space: Space<'a>,
    matrix: Dense<f64>,
}

impl System for AtNodes<'_> {
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

    fn value(&self, _: &Source, x: &MultiVector<f64>, site: &Site, rhs: usize) -> f64 {
        self.space.value(x, rhs, site.element, site.u, site.v)
    }
}
