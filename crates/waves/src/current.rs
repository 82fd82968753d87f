//! Surface currents: J (A/m) and M (V/m) on the facets of a scatterer.

use crate::{ComplexVector, Scatterer};
use fredholm_mesh::Vec3;

/// The currents at a point of a surface.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Current {
    /// Electric current J, A/m.
    pub j: ComplexVector,
    /// Magnetic current M, V/m.
    pub m: ComplexVector,
}

/// Currents that can be asked for anywhere on the surface.
pub trait SurfaceCurrent: Sync {
    /// The currents at the point `q` (m) of this facet.
    fn at(&self, facet: usize, q: Vec3) -> Current;
}

/// Currents that are constant on every facet.
#[derive(Clone, Debug, PartialEq)]
pub struct FacetCurrents {
    values: Vec<Current>,
}

impl FacetCurrents {
    /// One current a facet.
    #[must_use]
    pub fn new(values: Vec<Current>) -> Self {
        Self { values }
    }

    /// The currents, facet by facet.
    #[must_use]
    pub fn values(&self) -> &[Current] {
        &self.values
    }

    /// Those of `current` at the centres of the facets.
    #[must_use]
    pub fn sampled(scatterer: &Scatterer, current: &dyn SurfaceCurrent) -> Self {
        let at = |(i, facet): (usize, &crate::Facet)| current.at(i, facet.centre);
        Self { values: scatterer.facets().iter().enumerate().map(at).collect() }
    }
}

impl SurfaceCurrent for FacetCurrents {
    fn at(&self, facet: usize, _: Vec3) -> Current {
        self.values[facet]
    }
}
