//! Galerkin: ⟨x_h − ρ H x_h − b, φ_i⟩ = 0 for all trial functions, with the L² product on the
//! surface.
//!
//! G. Peyré's article, eq. 1.56. With M the mass matrix and G_ij = ⟨φ_i, H φ_j⟩ the system is (I −
//! R M⁻¹ G) x = M⁻¹ ⟨b, φ⟩: ρ is constant over the support of a function, so that R and M commute
//! and one K = M⁻¹ G serves all right-hand sides. H φ_j is integrated by the transfer for every
//! point of the outer rule on i. Order k + 1 in L², and 2k + 2 for the iterated solution: I. H.
//! Sloan, Math. Comp. 30 (1976) 758, doi:10.2307/2005395.
//!
//! The constant basis uses the transfer's own integrals over pairs where it has them
//! ([`zonal`](super::zonal)).

use super::zonal::Zonal;
use crate::lagrange::MOST_NODES;
use crate::mass::Mass;
use crate::system::{product, spread};
use crate::transfer::fill_rows;
use crate::{Degree, Discretisation, DiscretisationError, Equation, Site, Source, Space, Surface, System};
use fredholm_linop::{Dense, LinearOperator, MultiVector};
use rayon::prelude::*;

/// Largest angle between normals across which a conforming basis is continuous, degrees.
const SMOOTH_DEGREES: f64 = 30.0;

/// Galerkin's method with one degree.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Galerkin {
    /// Degree of the basis.
    pub degree: Degree,
    /// Continuous within faces, across edges where the normals differ by at most 30°. Without
    /// effect on constants.
    pub conforming: bool,
}

impl Discretisation for Galerkin {
    fn name(&self) -> &'static str {
        match (self.degree, self.conforming) {
            (Degree::Constant, _) => "galerkin-0",
            (Degree::Linear, false) => "galerkin-1",
            (Degree::Linear, true) => "galerkin-1-conforming",
            (Degree::Quadratic, false) => "galerkin-2",
            (Degree::Quadratic, true) => "galerkin-2-conforming",
        }
    }

    fn summary(&self) -> &'static str {
        match (self.degree, self.conforming) {
            (Degree::Constant, _) => "Galerkin with constants: radiosity in the classical sense",
            (Degree::Linear, false) => "Galerkin with P1 or Q1 on every element",
            (Degree::Linear, true) => "Galerkin with P1 or Q1, continuous within smooth faces",
            (Degree::Quadratic, false) => "Galerkin with P2 or Q2 on every element",
            (Degree::Quadratic, true) => "Galerkin with P2 or Q2, continuous within smooth faces",
        }
    }

    fn degree(&self) -> Degree {
        self.degree
    }

    fn space<'a>(&self, surface: &'a Surface) -> Result<Space<'a>, DiscretisationError> {
        let degree = self.degree.number();
        if self.conforming {
            Space::conforming(surface, degree, SMOOTH_DEGREES)
        } else {
            Space::discontinuous(surface, degree)
        }
    }

    /// The matrix and the rows that wait to be added to it; a conforming basis projects by blocks
    /// as large as the matrix at most.
    fn numbers(&self, space: &Space, _: usize) -> u128 {
        let n = space.dim() as u128;
        let blocks = if self.conforming { 2 * n * n } else { 0 };
        n * n + (ELEMENTS_OF_A_RUN * MOST_NODES) as u128 * n + blocks
    }

    fn discretise<'a>(&self, equation: Equation<'a>) -> Result<Box<dyn System + 'a>, DiscretisationError> {
        let degree = self.degree.number();
        if degree == 0
            && let Some(exchanges) = equation.transfer().exchanges()
        {
            return Ok(Box::new(Zonal::new(equation, exchanges?)?));
        }
        let space = self.space(equation.transfer().surface())?;
        one_reflectance(&equation, &space)?;
        let mass = Mass::new(&space, equation.transfer().outer(degree))?;
        let matrix = projected(&equation, &space, &mass)?;
        Ok(Box::new(Projected { equation, space, mass, matrix }))
    }
}

/// Checks that elements which share an unknown have the same ρ.
fn one_reflectance(equation: &Equation, space: &Space) -> Result<(), DiscretisationError> {
    let factor = spread(equation, space);
    for element in 0..space.surface().len() {
        let own = equation.reflectance().row(element);
        if space.dofs(element).iter().any(|&dof| factor.row(dof) != own) {
            return Err(DiscretisationError::Reflectance { element });
        }
    }
    Ok(())
}

/// M⁻¹ G.
fn projected(equation: &Equation, space: &Space, mass: &Mass) -> Result<Dense<f64>, DiscretisationError> {
    let n = space.dim();
    let mut values = Dense::zeros(n)?.into_vec();
    let block = |i| tested_rows(equation, space, mass, i);
    // Runs keep the blocks that wait for their turn small; their length does not show in the
    // result.
    for start in (0..space.surface().len()).step_by(ELEMENTS_OF_A_RUN) {
        let run = start..(start + ELEMENTS_OF_A_RUN).min(space.surface().len());
        let blocks: Vec<Vec<f64>> = run.clone().into_par_iter().map(block).collect();
        for (i, block) in run.zip(blocks) {
            for (&dof, row) in space.dofs(i).iter().zip(block.chunks_exact(n.max(1))) {
                let entries = &mut values[dof * n..(dof + 1) * n];
                entries.iter_mut().zip(row).for_each(|(entry, value)| *entry += value);
            }
        }
    }
    mass.solve(&mut values, n);
    Ok(Dense::new(n, values)?)
}

/// Elements whose rows are computed before they are added up.
const ELEMENTS_OF_A_RUN: usize = 64;

/// ∫_i φ_a H φ_j dA for the functions a of element i: functions × unknowns.
fn tested_rows(equation: &Equation, space: &Space, mass: &Mass, i: usize) -> Vec<f64> {
    let (n, count) = (space.dim(), space.dofs(i).len());
    let placed = mass.sites(space, i);
    let sites: Vec<Site> = placed.iter().map(|(site, _)| *site).collect();
    let mut rows = vec![0.0; sites.len() * n];
    fill_rows(equation.transfer(), space, &sites, &mut rows);
    let mut tested = vec![0.0; count * n];
    for ((site, weight), row) in placed.iter().zip(rows.chunks_exact(n.max(1))) {
        let values = space.basis(i).values(site.u, site.v);
        for (phi, tested) in values.iter().zip(tested.chunks_exact_mut(n.max(1))) {
            tested.iter_mut().zip(row).for_each(|(sum, value)| *sum += weight * phi * value);
        }
    }
    tested
}

/// Coefficients of the L² projection of a function of the site, its index among those of the
/// element, and the right-hand side.
pub(super) fn projection(
    space: &Space,
    mass: &Mass,
    rhs_count: usize,
    f: &dyn Fn(&Site, usize, usize) -> f64,
) -> MultiVector<f64> {
    let mut sums = MultiVector::zeros(space.dim(), rhs_count);
    for i in 0..space.surface().len() {
        for (at, (site, weight)) in mass.sites(space, i).into_iter().enumerate() {
            let values = space.basis(i).values(site.u, site.v);
            for (&dof, phi) in space.dofs(i).iter().zip(values) {
                let row = sums.row_mut(dof).iter_mut().enumerate();
                row.for_each(|(rhs, sum)| *sum += weight * phi * f(&site, at, rhs));
            }
        }
    }
    mass.solve(sums.as_mut_slice(), rhs_count);
    sums
}

struct Projected<'a> {
    equation: Equation<'a>,
    space: Space<'a>,
    mass: Mass,
    matrix: Dense<f64>,
}

impl System for Projected<'_> {
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
        projection(&self.space, &self.mass, self.equation.rhs_count(), &|site, _, rhs| source(site, rhs))
    }

    fn irradiance(&self, _: &Source, x: &MultiVector<f64>) -> MultiVector<f64> {
        product(&self.matrix, x)
    }

    fn value(&self, _: &Source, x: &MultiVector<f64>, site: &Site, rhs: usize) -> f64 {
        self.space.value(x, rhs, site.element, site.u, site.v)
    }
}
