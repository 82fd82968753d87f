//! Least squares: x_h minimises ‖x_h − ρ H x_h − b‖ in L².
//!
//! G. Peyré's article, eq. 1.52: ⟨û_i, û_j⟩ x = ⟨b, û_i⟩ with û = u − ρ H u. The integrals are sums
//! over the points s of the outer rule: with E the matrix of û_j(s) and W the weights, EᵀW E x =
//! EᵀW b. ρ enters squared, so each reflectance has its own matrix. The rows are divided by the
//! diagonal, which changes no iterate of Gauss–Seidel, and that converges: the matrix is symmetric
//! positive definite. Order k + 1 in L²; the iterated solution reaches 2k + 2 as for Galerkin.
//! Memory: points × unknowns.

use super::galerkin::projection;
use super::rhs_matrices::RhsMatrices;
use crate::gram::gram;
use crate::mass::Mass;
use crate::transfer::fill_rows;
use crate::{Degree, Discretisation, DiscretisationError, Equation, Site, Source, Space, Surface, System};
use fredholm_linop::{Dense, LinearOperator, LinopError, MultiVector};
use rayon::prelude::*;

/// Least squares with one degree.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct LeastSquares(pub Degree);

impl Discretisation for LeastSquares {
    fn name(&self) -> &'static str {
        ["least-squares-0", "least-squares-1", "least-squares-2"][self.0.number()]
    }

    fn summary(&self) -> &'static str {
        [
            "Least residual in the mean square, constant on every element",
            "Least residual in the mean square, P1 or Q1 on every element",
            "Least residual in the mean square, P2 or Q2 on every element",
        ][self.0.number()]
    }

    fn degree(&self) -> Degree {
        self.0
    }

    fn space<'a>(&self, surface: &'a Surface) -> Result<Space<'a>, DiscretisationError> {
        Space::discontinuous(surface, self.0.number())
    }

    /// The samples; for each reflectance the weighted samples and a matrix.
    fn numbers(&self, space: &Space, reflectances: usize) -> u128 {
        let n = space.dim() as u128;
        let each = (self.0.number() + crate::transfer::RECEIVER_POINTS_BEYOND_DEGREE).pow(2);
        let samples = space.surface().len() as u128 * each as u128 * n;
        samples + reflectances as u128 * (samples + n * n)
    }

    fn discretise<'a>(&self, equation: Equation<'a>) -> Result<Box<dyn System + 'a>, DiscretisationError> {
        let space = self.space(equation.transfer().surface())?;
        let mass = Mass::new(&space, equation.transfer().outer(self.0.number()))?;
        let samples = Samples::new(&equation, &space, &mass)?;
        let mut system =
            Residual { equation, space, mass, samples, by_reflectance: Vec::new(), matrices: none() };
        system.assemble()?;
        Ok(Box::new(system))
    }
}

fn none() -> RhsMatrices {
    RhsMatrices { matrices: Vec::new(), of_rhs: Vec::new(), dim: 0 }
}

/// (H φ_j)(s) at the points s of all elements, points × unknowns.
struct Samples {
    sites: Vec<(Site, f64)>,
    rows: Vec<f64>,
    dim: usize,
}

impl Samples {
    fn new(equation: &Equation, space: &Space, mass: &Mass) -> Result<Self, LinopError> {
        let n = space.dim();
        let placed: Vec<_> = (0..space.surface().len()).map(|i| mass.sites(space, i)).collect();
        let sites = placed.concat();
        let mut rows = reserve(sites.len().saturating_mul(n))?;
        let mut rest = &mut rows[..];
        let mut blocks = Vec::with_capacity(placed.len());
        for points in placed {
            let (block, tail) = rest.split_at_mut(points.len() * n);
            blocks.push((points, block));
            rest = tail;
        }
        blocks.into_par_iter().for_each(|(points, block)| {
            let sites: Vec<Site> = points.iter().map(|(site, _)| *site).collect();
            fill_rows(equation.transfer(), space, &sites, block);
        });
        Ok(Self { sites, rows, dim: n })
    }

    fn row(&self, s: usize) -> &[f64] {
        &self.rows[s * self.dim..(s + 1) * self.dim]
    }
}

fn reserve(len: usize) -> Result<Vec<f64>, LinopError> {
    let mut values = Vec::new();
    let bytes = (len as u64).saturating_mul(8);
    let what = "the samples of a least-squares system";
    values.try_reserve_exact(len).map_err(|_| LinopError::Memory { what, bytes })?;
    values.resize(len, 0.0);
    Ok(values)
}

/// √W E of one reflectance, points × unknowns, and the inverse diagonal of EᵀW E.
struct Rhs {
    weighted: Vec<f64>,
    scale: Vec<f64>,
}

struct Residual<'a> {
    equation: Equation<'a>,
    space: Space<'a>,
    mass: Mass,
    samples: Samples,
    by_reflectance: Vec<Rhs>,
    matrices: RhsMatrices,
}

impl Residual<'_> {
    fn assemble(&mut self) -> Result<(), LinopError> {
        let of_rhs = self.rhs_by_reflectance();
        let count = of_rhs.iter().max().map_or(0, |last| last + 1);
        let mut matrices = Vec::with_capacity(count);
        for at in 0..count {
            let rhs = of_rhs.iter().position(|&other| other == at).unwrap_or(0);
            let (rhs, matrix) = self.normal_equations(rhs)?;
            self.by_reflectance.push(rhs);
            matrices.push(matrix);
        }
        self.matrices = RhsMatrices { matrices, of_rhs, dim: self.space.dim() };
        Ok(())
    }

    /// Numbers the different reflectances in the order of the right-hand sides.
    fn rhs_by_reflectance(&self) -> Vec<usize> {
        let columns: Vec<_> =
            (0..self.equation.rhs_count()).map(|rhs| self.equation.reflectance().vector(rhs)).collect();
        let mut different: Vec<&Vec<f64>> = Vec::new();
        let number = |column| {
            different.iter().position(|other| *other == column).unwrap_or_else(|| {
                different.push(column);
                different.len() - 1
            })
        };
        columns.iter().map(number).collect()
    }

    /// I − diag(EᵀW E)⁻¹ EᵀW E.
    fn normal_equations(&self, rhs: usize) -> Result<(Rhs, Dense<f64>), LinopError> {
        let n = self.space.dim();
        let weighted = self.residuals(rhs)?;
        let mut product = Dense::zeros(n)?.into_vec();
        gram(&weighted, n, &mut product);
        let scale: Vec<f64> = (0..n).map(|i| 1.0 / product[i * n + i]).collect();
        for (i, row) in product.chunks_exact_mut(n.max(1)).enumerate() {
            multiply(row, -scale[i]);
            row[i] += 1.0;
        }
        Ok((Rhs { weighted, scale }, Dense::new(n, product)?))
    }

    /// √W (φ − ρ H φ).
    fn residuals(&self, rhs: usize) -> Result<Vec<f64>, LinopError> {
        let n = self.space.dim();
        let mut weighted = reserve(self.samples.rows.len())?;
        for (s, (site, weight)) in self.samples.sites.iter().enumerate() {
            let rho = self.equation.reflectance().row(site.element)[rhs];
            let row = &mut weighted[s * n..(s + 1) * n];
            row.iter_mut().zip(self.samples.row(s)).for_each(|(e, h)| *e = -rho * h);
            let values = self.space.basis(site.element).values(site.u, site.v);
            self.space.dofs(site.element).iter().zip(values).for_each(|(&dof, phi)| row[dof] += phi);
            multiply(row, weight.sqrt());
        }
        Ok(weighted)
    }
}

fn multiply(row: &mut [f64], factor: f64) {
    for value in row {
        *value *= factor;
    }
}

impl System for Residual<'_> {
    fn equation(&self) -> Equation<'_> {
        self.equation
    }

    fn space(&self) -> &Space<'_> {
        &self.space
    }

    fn coupling(&self) -> &dyn LinearOperator<f64> {
        &self.matrices
    }

    fn factor(&self) -> MultiVector<f64> {
        MultiVector::from_fn(self.space.dim(), self.equation.rhs_count(), |_, _| 1.0)
    }

    /// diag(EᵀW E)⁻¹ EᵀW b.
    fn right_hand_side(&self, source: &Source) -> MultiVector<f64> {
        let n = self.space.dim();
        let mut sums = MultiVector::zeros(n, self.equation.rhs_count());
        for (rhs, &at) in self.matrices.of_rhs.iter().enumerate() {
            let Rhs { weighted, scale } = &self.by_reflectance[at];
            let mut column = vec![0.0; n];
            for ((site, weight), row) in self.samples.sites.iter().zip(weighted.chunks_exact(n.max(1))) {
                let factor = weight.sqrt() * source(site, rhs);
                column.iter_mut().zip(row).for_each(|(sum, e)| *sum += factor * e);
            }
            column.iter_mut().zip(scale).for_each(|(b, scale)| *b *= scale);
            sums.set_vector(rhs, &column);
        }
        sums
    }

    /// The projection of H x_h.
    fn irradiance(&self, _: &Source, x: &MultiVector<f64>) -> MultiVector<f64> {
        let rhs_count = self.equation.rhs_count();
        let at_samples = MultiVector::from_fn(self.samples.sites.len(), rhs_count, |s, rhs| {
            let row = self.samples.row(s).iter().enumerate();
            row.map(|(j, h)| h * x.row(j)[rhs]).sum()
        });
        let starts = self.first_samples();
        projection(&self.space, &self.mass, rhs_count, &|site, at, rhs| {
            at_samples.row(starts[site.element] + at)[rhs]
        })
    }

    fn value(&self, _: &Source, x: &MultiVector<f64>, site: &Site, rhs: usize) -> f64 {
        self.space.value(x, rhs, site.element, site.u, site.v)
    }
}

impl Residual<'_> {
    /// Index of the first sample of every element.
    fn first_samples(&self) -> Vec<usize> {
        let mut starts = vec![0; self.space.surface().len()];
        for (s, (site, _)) in self.samples.sites.iter().enumerate().rev() {
            starts[site.element] = s;
        }
        starts
    }
}
