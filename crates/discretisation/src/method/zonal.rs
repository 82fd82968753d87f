//! Galerkin with constants from exact integrals over pairs: (I − R F) x = b, A_i F_ij = ∫_i ∫_j k
//! dA dA.
//!
//! C. M. Goral et al., SIGGRAPH 1984, doi:10.1145/800031.808601. It is the radiosity system of
//! [`Radiosity`], with its treatment of elements that are partly buried: x is the value on the
//! exposed part, the irradiance the mean over the whole element.

use crate::system::System;
use crate::transfer::Exchanges;
use crate::{DiscretisationError, Equation, Site, Source, Space};
use fredholm_coupling::Radiosity;
use fredholm_linop::{LinearOperator, MultiVector, PackedSymmetric};
use fredholm_quadrature::PlanePoint;

/// Points of the rule for the mean of the source: enough for what varies within an element of
/// constants.
const MEAN_POINTS: usize = 3;

pub(super) struct Zonal<'a> {
    equation: Equation<'a>,
    space: Space<'a>,
    matrix: PackedSymmetric<f64>,
    radiosity: Radiosity,
}

impl<'a> Zonal<'a> {
    pub(super) fn new(equation: Equation<'a>, exchanges: Exchanges) -> Result<Self, DiscretisationError> {
        let space = Space::discontinuous(equation.transfer().surface(), 0)?;
        let nothing = MultiVector::zeros(space.dim(), equation.rhs_count());
        let radiosity = Radiosity::new(exchanges.sizes, equation.reflectance().clone(), nothing)?;
        Ok(Self { equation, space, matrix: exchanges.matrix, radiosity })
    }

    /// Mean of the source over element i.
    fn mean(&self, source: &Source, i: usize, rhs: usize) -> f64 {
        let surface = self.space.surface();
        let rules = crate::surface::Rules::gauss(MEAN_POINTS);
        let rule: &[PlanePoint] = rules.of(surface.chart(i).sides());
        let (mut sum, mut area) = (0.0, 0.0);
        for (site, weight) in surface.place(i, rule) {
            sum += weight * source(&site, rhs);
            area += weight;
        }
        sum / area
    }
}

impl System for Zonal<'_> {
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
        self.radiosity.scaling()
    }

    fn right_hand_side(&self, source: &Source) -> MultiVector<f64> {
        MultiVector::from_fn(self.space.dim(), self.equation.rhs_count(), |i, rhs| self.mean(source, i, rhs))
    }

    fn irradiance(&self, _: &Source, x: &MultiVector<f64>) -> MultiVector<f64> {
        self.radiosity.means(&self.matrix, x).irradiance
    }

    fn value(&self, _: &Source, x: &MultiVector<f64>, site: &Site, rhs: usize) -> f64 {
        x.row(site.element)[rhs]
    }
}
