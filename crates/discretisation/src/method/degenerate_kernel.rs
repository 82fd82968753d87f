//! Degenerate kernel: k(p, q) ≈ Σ_j φ_j(p) k(p_j, q), so that x = b + Σ_j y_j φ_j with (I − R H_n)
//! y = R (H b)(p_i).
//!
//! G. Peyré's article, eq. 1.31 to 1.33 and 1.40: the kernel is interpolated in p at the nodes of
//! the elements. ⟨a_k, b_j⟩ = ∫ k(p_j, q) φ_k(q) dA is the matrix of collocation, but the unknowns
//! are the reflected part y alone, and b is kept as it is: where b jumps or peaks within elements
//! that is what the method is for. Order k + 1 in L², the iterated solution as for collocation: K.
//! E. Atkinson, *The Numerical Solution of Integral Equations of the Second Kind*, Cambridge
//! University Press 1997, section 2.3, doi:10.1017/CBO9780511626340.

use super::collocation::collocation_matrix;
use crate::system::{product, spread};
use crate::transfer::{by_element, irradiance_at};
use crate::{Degree, Discretisation, DiscretisationError, Equation, Site, Source, Space, Surface, System};
use fredholm_linop::{Dense, LinearOperator, MultiVector};

/// Interpolation of the kernel with one degree.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct DegenerateKernel(pub Degree);

impl Discretisation for DegenerateKernel {
    fn name(&self) -> &'static str {
        ["degenerate-kernel-0", "degenerate-kernel-1", "degenerate-kernel-2"][self.0.number()]
    }

    fn summary(&self) -> &'static str {
        [
            "Kernel constant in the receiving point on every element; the source is kept as it is",
            "Kernel interpolated by P1 or Q1 in the receiving point; the source is kept as it is",
            "Kernel interpolated by P2 or Q2 in the receiving point; the source is kept as it is",
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
        Ok(Box::new(Reflected { equation, space, matrix }))
    }
}

struct Reflected<'a> {
    equation: Equation<'a>,
    space: Space<'a>,
    matrix: Dense<f64>,
}

impl Reflected<'_> {
    /// (H b)(p_i).
    fn direct(&self, source: &Source) -> MultiVector<f64> {
        let (transfer, rhs_count) = (self.equation.transfer(), self.equation.rhs_count());
        let rows =
            |i| irradiance_at(transfer, rhs_count, self.space.degree(), &self.space.nodes_of(i), source);
        by_element(self.space.surface(), rhs_count, rows)
    }
}

impl System for Reflected<'_> {
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
        let (mut direct, factor) = (self.direct(source), self.factor());
        direct.as_mut_slice().iter_mut().zip(factor.as_slice()).for_each(|(b, rho)| *b *= rho);
        direct
    }

    fn irradiance(&self, source: &Source, x: &MultiVector<f64>) -> MultiVector<f64> {
        let mut irradiance = product(&self.matrix, x);
        let direct = self.direct(source);
        irradiance.as_mut_slice().iter_mut().zip(direct.as_slice()).for_each(|(e, d)| *e += d);
        irradiance
    }

    fn value(&self, source: &Source, x: &MultiVector<f64>, site: &Site, rhs: usize) -> f64 {
        source(site, rhs) + self.space.value(x, rhs, site.element, site.u, site.v)
    }
}
