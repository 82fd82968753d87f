//! The system x = b + K x of a scatterer, its sources and a treatment of shadows, and the currents it gives.

use super::inner::{FACTOR, inner_points};
use super::nystrom::tangential;
use super::{NystromCoupling, galerkin};
use crate::rule::{points_for_phase, regular};
use crate::{
    Complex64, ComplexVector, Current, Facet, FacetCurrents, PhysicalOptics, Radiator, Sampling, Scatterer,
    Shadow, SurfaceCurrent, TOLERANCE, Wave, WaveError,
};
use fredholm_linop::{Dense, LinearOperator, MultiVector};

/// How the equation is made discrete.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Discretisation {
    /// Values at the centres.
    #[default]
    Nystrom,
    /// Means over the facets.
    Galerkin,
}

/// Where K comes from.
enum Coupling<'a> {
    Lazy(NystromCoupling<'a>),
    Stored(Dense<Complex64>),
}

/// K and what the treatment of shadows makes of currents.
pub struct System<'a> {
    scatterer: &'a Scatterer,
    wave: Wave,
    shadow: Shadow,
    discretisation: Discretisation,
    coupling: Coupling<'a>,
}

impl<'a> System<'a> {
    /// The system with K stored as 2N × 2N numbers, see [`System::bytes`].
    ///
    /// # Errors
    /// Those of [`NystromCoupling::new`] and [`galerkin`].
    pub fn stored(
        scatterer: &'a Scatterer,
        wave: Wave,
        shadow: Shadow,
        discretisation: Discretisation,
    ) -> Result<Self, WaveError> {
        let dense = match discretisation {
            Discretisation::Nystrom => NystromCoupling::new(scatterer, wave, shadow)?.dense_matrix()?,
            Discretisation::Galerkin => galerkin(scatterer, &wave, shadow, TOLERANCE)?,
        };
        Ok(Self { scatterer, wave, shadow, discretisation, coupling: Coupling::Stored(dense) })
    }

    /// The system with K evaluated anew in every application, by Nyström.
    ///
    /// # Errors
    /// Those of [`NystromCoupling::new`].
    pub fn lazy(scatterer: &'a Scatterer, wave: Wave, shadow: Shadow) -> Result<Self, WaveError> {
        let coupling = Coupling::Lazy(NystromCoupling::new(scatterer, wave, shadow)?);
        Ok(Self { scatterer, wave, shadow, discretisation: Discretisation::Nystrom, coupling })
    }

    /// Bytes of the stored K of so many facets.
    #[must_use]
    pub fn bytes(facets: usize) -> u64 {
        Dense::<Complex64>::bytes(facets.saturating_mul(2))
    }

    /// K.
    #[must_use]
    pub fn coupling(&self) -> &dyn LinearOperator<Complex64> {
        match &self.coupling {
            Coupling::Lazy(lazy) => lazy,
            Coupling::Stored(dense) => dense,
        }
    }

    /// b: one lane for each of the given incident fields, as the currents of one bounce.
    #[must_use]
    pub fn right_hand_side(&self, incident: &[&PhysicalOptics<'_>]) -> MultiVector<Complex64> {
        let facets = self.scatterer.facets();
        let mut b = MultiVector::zeros(2 * facets.len(), incident.len());
        // A second surface that does not fit is refused with the coupling.
        let inner = inner_points(self.scatterer, &self.wave, self.shadow).ok().flatten();
        for (l, optics) in incident.iter().enumerate() {
            for (i, facet) in facets.iter().enumerate() {
                let mut current = self.known(self.sampled(*optics, i, facet));
                if let Some(points) = &inner {
                    current += optics.on(facet, points[i]) * FACTOR;
                }
                (b.row_mut(2 * i)[l], b.row_mut(2 * i + 1)[l]) =
                    (current.dot(facet.tangents[0]), current.dot(facet.tangents[1]));
            }
        }
        b
    }

    /// Lane `l` of a solution as currents on the facets.
    #[must_use]
    pub fn currents(&self, x: &MultiVector<Complex64>, l: usize) -> FacetCurrents {
        let current = |(i, facet): (usize, &Facet)| {
            let value = tangential(facet, [x.row(2 * i)[l], x.row(2 * i + 1)[l]]);
            if self.shadow == Shadow::Thesis {
                Current { j: ComplexVector::ZERO, m: value }
            } else {
                Current { j: value, m: ComplexVector::ZERO }
            }
        };
        FacetCurrents::new(self.scatterer.facets().iter().enumerate().map(current).collect())
    }

    /// Currents that are known at the centres, ready to radiate.
    #[must_use]
    pub fn radiator<'b>(&self, currents: &'b dyn SurfaceCurrent) -> Radiator<'b>
    where
        'a: 'b,
    {
        let sampling = match self.discretisation {
            Discretisation::Nystrom => Sampling::Midpoint,
            Discretisation::Galerkin => Sampling::Tolerance(TOLERANCE),
        };
        Radiator::new(self.scatterer, self.wave, currents, self.shadow.gate(), sampling)
    }

    /// The current of a facet: its value at the centre or its mean.
    fn sampled(&self, optics: &dyn SurfaceCurrent, i: usize, facet: &Facet) -> Current {
        let points = match self.discretisation {
            Discretisation::Nystrom => 1,
            Discretisation::Galerkin => points_for_phase(self.wave.wavenumber() * facet.edge(), TOLERANCE),
        };
        let mut mean = Current::default();
        for (q, weight) in regular(facet, points) {
            let Current { j, m } = optics.at(i, q);
            mean.j += j * (weight / facet.area);
            mean.m += m * (weight / facet.area);
        }
        mean
    }

    /// The current that is the unknown.
    fn known(&self, current: Current) -> ComplexVector {
        if self.shadow == Shadow::Thesis { current.m } else { current.j }
    }
}

/// The currents of one bounce, exact everywhere, and the rest constant on the facets.
pub struct Bounced<'a> {
    first: &'a PhysicalOptics<'a>,
    rest: FacetCurrents,
}

impl<'a> Bounced<'a> {
    /// Takes all currents at the centres; what is not of the first bounce is the rest.
    #[must_use]
    pub fn new(scatterer: &Scatterer, first: &'a PhysicalOptics<'a>, all: &FacetCurrents) -> Self {
        let known = FacetCurrents::sampled(scatterer, first);
        let rest = |(all, known): (&Current, &Current)| Current { j: all.j - known.j, m: all.m - known.m };
        Self { first, rest: FacetCurrents::new(all.values().iter().zip(known.values()).map(rest).collect()) }
    }
}

impl SurfaceCurrent for Bounced<'_> {
    fn at(&self, facet: usize, q: fredholm_mesh::Vec3) -> Current {
        let (first, rest) = (self.first.at(facet, q), self.rest.at(facet, q));
        Current { j: first.j + rest.j, m: first.m + rest.m }
    }
}
