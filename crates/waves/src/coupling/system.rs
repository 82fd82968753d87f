//! The system x = b + K x of a scatterer, its sources and a treatment of shadows, and the currents
//! it gives.

use super::inner::{INNER_FACTOR, inner_points};
use super::material::{UNKNOWNS, current, values};
use super::nystrom::tangential;
use super::{MaterialCoupling, NystromCoupling, galerkin};
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
    Conductors(NystromCoupling<'a>),
    Materials(MaterialCoupling<'a>),
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
    /// The system with K stored, see [`System::bytes`]; by Nyström where there are other materials
    /// than conductors.
    ///
    /// # Errors
    /// Those of [`NystromCoupling::new`], [`MaterialCoupling::new`] and [`galerkin`].
    pub fn stored(
        scatterer: &'a Scatterer,
        wave: Wave,
        shadow: Shadow,
        discretisation: Discretisation,
    ) -> Result<Self, WaveError> {
        let conductors = scatterer.check_conductor("").is_ok();
        let dense = match discretisation {
            Discretisation::Galerkin => galerkin(scatterer, &wave, shadow, TOLERANCE)?,
            Discretisation::Nystrom if conductors => {
                NystromCoupling::new(scatterer, wave, shadow)?.dense_matrix()?
            }
            Discretisation::Nystrom => MaterialCoupling::new(scatterer, wave, shadow)?.dense_matrix()?,
        };
        Ok(Self { scatterer, wave, shadow, discretisation, coupling: Coupling::Stored(dense) })
    }

    /// The system with K evaluated anew in every application, by Nyström.
    ///
    /// # Errors
    /// Those of [`NystromCoupling::new`] and [`MaterialCoupling::new`].
    pub fn lazy(scatterer: &'a Scatterer, wave: Wave, shadow: Shadow) -> Result<Self, WaveError> {
        let coupling = if scatterer.check_conductor("").is_ok() {
            Coupling::Conductors(NystromCoupling::new(scatterer, wave, shadow)?)
        } else {
            Coupling::Materials(MaterialCoupling::new(scatterer, wave, shadow)?)
        };
        Ok(Self { scatterer, wave, shadow, discretisation: Discretisation::Nystrom, coupling })
    }

    /// Complex unknowns: two a facet, four where there are other materials than conductors.
    #[must_use]
    pub fn unknowns(scatterer: &Scatterer) -> usize {
        let each = if scatterer.check_conductor("").is_ok() { 2 } else { UNKNOWNS };
        scatterer.facets().len().saturating_mul(each)
    }

    /// Bytes of [`lazy`](Self::lazy) besides the scatterer, at most: before anything is computed.
    #[must_use]
    pub fn lazy_bytes(scatterer: &Scatterer, wave: &Wave, shadow: Shadow) -> u64 {
        if scatterer.check_conductor("").is_ok() {
            NystromCoupling::bytes(scatterer, wave, shadow)
        } else {
            MaterialCoupling::bytes(scatterer, shadow)
        }
    }

    /// Bytes of the stored K.
    #[must_use]
    pub fn bytes(scatterer: &Scatterer) -> u64 {
        Dense::<Complex64>::bytes(Self::unknowns(scatterer))
    }

    /// K.
    #[must_use]
    pub fn coupling(&self) -> &dyn LinearOperator<Complex64> {
        match &self.coupling {
            Coupling::Conductors(lazy) => lazy,
            Coupling::Materials(lazy) => lazy,
            Coupling::Stored(dense) => dense,
        }
    }

    /// b: one right-hand side for each of the given incident fields, as the currents of one bounce.
    #[must_use]
    pub fn right_hand_side(&self, incident: &[&PhysicalOptics<'_>]) -> MultiVector<Complex64> {
        let mut b = MultiVector::zeros(self.coupling().dim(), incident.len());
        // A second surface that does not fit is refused with the coupling.
        let inner = inner_points(self.scatterer, &self.wave, self.shadow).ok().flatten();
        for (l, optics) in incident.iter().enumerate() {
            for (i, facet) in self.scatterer.facets().iter().enumerate() {
                let mut current = self.sampled(*optics, i, facet);
                if let Some(points) = &inner {
                    current.j += optics.on(facet, points[i]) * INNER_FACTOR;
                }
                self.put(&mut b, (i, l), current);
            }
        }
        b
    }

    /// Unknowns of a facet.
    fn each(&self) -> usize {
        self.coupling().dim() / self.scatterer.facets().len().max(1)
    }

    /// Writes the unknowns of facet i in right-hand side l.
    fn put(&self, b: &mut MultiVector<Complex64>, (i, l): (usize, usize), current: Current) {
        let (each, facet) = (self.each(), &self.scatterer.facets()[i]);
        let known = if self.shadow == Shadow::Thesis { current.m } else { current.j };
        let conductor = facet.tangents.map(|t| known.dot(t));
        let material = values(facet, current);
        let values = if each == UNKNOWNS { &material[..] } else { &conductor[..] };
        values.iter().enumerate().for_each(|(a, value)| b.row_mut(each * i + a)[l] = *value);
    }

    /// Right-hand side `l` of a solution as currents on the facets.
    #[must_use]
    pub fn currents(&self, x: &MultiVector<Complex64>, l: usize) -> FacetCurrents {
        let each = self.each();
        let current = |(i, facet): (usize, &Facet)| {
            let value = |a: usize| x.row(each * i + a)[l];
            if each == UNKNOWNS {
                return current(facet, std::array::from_fn(value));
            }
            let known = tangential(facet, std::array::from_fn(value));
            if self.shadow == Shadow::Thesis {
                Current { j: ComplexVector::ZERO, m: known }
            } else {
                Current { j: known, m: ComplexVector::ZERO }
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
