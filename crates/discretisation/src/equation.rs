//! The equation x(p) = b(p) + ρ(p) ∫_S k(p, q) x(q) dA(q) that is discretised.
//!
//! G. Peyré's article, eq. 1.41 and 3.1. ρ is constant on every element and may differ from
//! right-hand side to right-hand side (band); the transfer H is common to all right-hand sides.

use crate::{DiscretisationError, Site, Transfer};
use fredholm_linop::MultiVector;

/// A source b(p) in a right-hand side, W/m².
pub type Source<'a> = dyn Fn(&Site, usize) -> f64 + Sync + 'a;

/// H and ρ.
#[derive(Clone, Copy)]
pub struct Equation<'a> {
    /// H.
    pub(crate) transfer: &'a dyn Transfer,
    /// ρ, elements × right-hand sides.
    pub(crate) reflectance: &'a MultiVector<f64>,
}

impl<'a> Equation<'a> {
    /// `reflectance` is ρ, elements × right-hand sides.
    ///
    /// # Errors
    /// [`DiscretisationError::Dimension`] where it does not fit the surface.
    pub fn new(
        transfer: &'a dyn Transfer,
        reflectance: &'a MultiVector<f64>,
    ) -> Result<Self, DiscretisationError> {
        let (elements, found) = (transfer.surface().len(), reflectance.dim());
        if elements != found {
            return Err(DiscretisationError::Dimension { what: "the reflectance", found, elements });
        }
        Ok(Self { transfer, reflectance })
    }

    /// H.
    #[must_use]
    pub fn transfer(&self) -> &'a dyn Transfer {
        self.transfer
    }

    /// ρ, elements × right-hand sides.
    #[must_use]
    pub fn reflectance(&self) -> &'a MultiVector<f64> {
        self.reflectance
    }

    /// Number of right-hand sides.
    #[must_use]
    pub fn rhs_count(&self) -> usize {
        self.reflectance.rhs_count()
    }
}
