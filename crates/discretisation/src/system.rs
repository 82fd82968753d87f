//! What a discretisation makes of the equation: a linear system A x = b with A = I − D K, and ways
//! to evaluate its solution anywhere.
//!
//! D holds the reflectances, so that one K serves all right-hand sides where the method allows it,
//! and every solver for [`SecondKind`] runs on it. The iterated solution b + ρ H x_h is that of I.
//! H. Sloan, Math. Comp. 30 (1976) 758, doi:10.2307/2005395: for smooth kernels it converges up to
//! twice as fast.

use crate::transfer::irradiance_at;
use crate::{Equation, Site, Source, Space};
use fredholm_linop::{LinearOperator, LinopError, MultiVector, SecondKind};

/// A discrete system of x = b + ρ H x. Vectors are unknowns × right-hand sides, in W/m² for light.
pub trait System: Sync {
    /// The equation.
    fn equation(&self) -> Equation<'_>;

    /// The trial functions; unknown j belongs to its function j.
    fn space(&self) -> &Space<'_>;

    /// K.
    fn coupling(&self) -> &dyn LinearOperator<f64>;

    /// D, unknowns × right-hand sides.
    fn factor(&self) -> MultiVector<f64>;

    /// The right-hand side for a source b(p).
    fn right_hand_side(&self, source: &Source) -> MultiVector<f64>;

    /// The irradiance H x_h in the trial space: its coefficients, unknowns × right-hand sides.
    fn irradiance(&self, source: &Source, x: &MultiVector<f64>) -> MultiVector<f64>;

    /// x_h at a site, in one right-hand side.
    fn value(&self, source: &Source, x: &MultiVector<f64>, site: &Site, rhs: usize) -> f64;

    /// The best reconstruction that belongs to the method at sites of one element, sites ×
    /// right-hand sides: x_h, or Nyström's interpolant.
    fn reconstruct(&self, source: &Source, x: &MultiVector<f64>, sites: &[Site]) -> MultiVector<f64> {
        let rhs_count = self.equation().rhs_count();
        MultiVector::from_fn(sites.len(), rhs_count, |at, rhs| self.value(source, x, &sites[at], rhs))
    }

    /// The iterated solution b + ρ H x_h at sites of one element, sites × right-hand sides.
    fn iterated(&self, source: &Source, x: &MultiVector<f64>, sites: &[Site]) -> MultiVector<f64> {
        let equation = self.equation();
        let field = |site: &Site, rhs: usize| self.value(source, x, site, rhs);
        let irradiance =
            irradiance_at(equation.transfer(), equation.rhs_count(), self.space().degree(), sites, &field);
        MultiVector::from_fn(sites.len(), equation.rhs_count(), |at, rhs| {
            let rho = equation.reflectance().row(sites[at].element)[rhs];
            source(&sites[at], rhs) + rho * irradiance.row(at)[rhs]
        })
    }

    /// A = I − D K.
    ///
    /// # Errors
    /// Reflectances that are not finite.
    fn operator(&self) -> Result<SecondKind<'_, f64>, LinopError> {
        SecondKind::new(self.coupling(), self.factor())
    }
}

/// K x.
pub(crate) fn product(coupling: &dyn LinearOperator<f64>, x: &MultiVector<f64>) -> MultiVector<f64> {
    let mut product = MultiVector::zeros(x.dim(), x.rhs_count());
    coupling.apply(x, &mut product);
    product
}

/// ρ of the element of every unknown.
pub(crate) fn spread(equation: &Equation, space: &Space) -> MultiVector<f64> {
    let mut factor = MultiVector::zeros(space.dim(), equation.rhs_count());
    for i in 0..space.surface().len() {
        for &dof in space.dofs(i) {
            factor.row_mut(dof).copy_from_slice(equation.reflectance().row(i));
        }
    }
    factor
}

/// The source at the nodes of a discontinuous space.
pub(crate) fn at_nodes(equation: &Equation, space: &Space, source: &Source) -> MultiVector<f64> {
    let sites = space.node_sites();
    MultiVector::from_fn(space.dim(), equation.rhs_count(), |dof, rhs| source(&sites[dof], rhs))
}
