//! What is sampled: lit surfaces, their first currents, and those of the second bounce.

use crate::MonteCarloError;
use crate::density::SurfaceDensity;
use fredholm_mesh::{Patch, Vec3};
use fredholm_visibility::Occluders;
use fredholm_waves::{
    ComplexVector, Facet, PhysicalOptics, Scatterer, SurfaceCurrent, Wave, electric_element,
};

/// How many bounces are summed.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Bounces {
    /// Physical optics.
    One,
    /// And what it lights.
    Two,
}

/// Surfaces that a ray meets beyond which a body is no longer looked through.
const MOST_SURFACES_MET: usize = 64;

/// A scatterer of conductors in an incident field.
pub struct Scattering<'a> {
    scatterer: &'a Scatterer,
    optics: &'a PhysicalOptics<'a>,
    wave: Wave,
    bounces: Bounces,
    facets: Occluders,
    surfaces: Vec<SurfaceDensity>,
    cumulated: Vec<f64>,
    /// Facets with a first current.
    lit: Vec<bool>,
}

/// A point of a facet.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Spot {
    pub(super) facet: usize,
    pub(super) point: Vec3,
}

impl<'a> Scattering<'a> {
    /// The first currents are those of `optics`, which must be of this scatterer and wave.
    ///
    /// # Errors
    /// [`MonteCarloError::Visibility`].
    pub fn new(
        scatterer: &'a Scatterer,
        optics: &'a PhysicalOptics<'a>,
        wave: Wave,
        bounces: Bounces,
    ) -> Result<Self, MonteCarloError> {
        let patches: Vec<Patch> = scatterer.facets().iter().map(|facet| facet.patch).collect();
        let mut sum = 0.0;
        let mut cumulate = |patch: &Patch| {
            sum += patch.area();
            sum
        };
        let lit = |(number, facet): (usize, &Facet)| optics.at(number, facet.centre).j != ComplexVector::ZERO;
        Ok(Self {
            lit: scatterer.facets().iter().enumerate().map(lit).collect(),
            scatterer,
            optics,
            wave,
            bounces,
            facets: Occluders::new(&patches)?,
            surfaces: patches.iter().map(SurfaceDensity::new).collect(),
            cumulated: patches.iter().map(&mut cumulate).collect(),
        })
    }

    /// Whether the second bounce is wanted.
    pub(super) fn twice(&self) -> bool {
        self.bounces == Bounces::Two
    }

    /// Sum of the areas, m².
    pub(super) fn area(&self) -> f64 {
        self.cumulated.last().copied().unwrap_or(0.0)
    }

    pub(super) fn facet(&self, spot: Spot) -> &Facet {
        &self.scatterer.facets()[spot.facet]
    }

    /// An even point of all surfaces.
    pub(super) fn spot(&self, [u, v]: [f64; 2]) -> Spot {
        let (facet, rest) = pick(&self.cumulated, u);
        Spot { facet, point: self.on(facet, [rest, v]) }
    }

    /// An even point of a facet, m.
    pub(super) fn on(&self, facet: usize, numbers: [f64; 2]) -> Vec3 {
        self.surfaces[facet].sample(numbers)
    }

    pub(super) fn facets(&self) -> &[Facet] {
        self.scatterer.facets()
    }

    /// Whether a facet is a sheet.
    pub(super) fn two_sided(&self, spot: Spot) -> bool {
        let facet = self.facet(spot);
        facet.side(-facet.normal) != 0.0
    }

    /// What may light a spot: lit facets, seen from their lit side, in front of it.
    pub(super) fn lights(&self, number: usize, facet: &Facet, spot: Spot) -> bool {
        let between = facet.centre - spot.point;
        number != spot.facet
            && self.facet(spot).side(between) != 0.0
            && facet.side(-between) != 0.0
            && self.lit[number]
    }

    /// Centre and radius of a ball around everything, m.
    pub(super) fn ball(&self) -> (Vec3, f64) {
        let sum = self.scatterer.facets().iter().map(|facet| facet.centre * facet.area).sum::<Vec3>();
        (sum / self.scatterer.area(), 0.5 * self.scatterer.extent())
    }

    /// All surfaces that a ray meets, from either side: currents radiate through bodies.
    pub(super) fn pierced(&self, origin: Vec3, direction: Vec3) -> Vec<Spot> {
        let (mut spots, mut from) = (Vec::new(), origin);
        while let Some(hit) = self.facets.closest(from, direction, f64::INFINITY) {
            spots.push(Spot { facet: hit.patch, point: hit.point });
            from = hit.point;
            if spots.len() == MOST_SURFACES_MET {
                break;
            }
        }
        spots
    }

    /// The first surface that a ray meets.
    pub(super) fn met(&self, origin: Vec3, direction: Vec3) -> Option<Spot> {
        let hit = self.facets.closest(origin, direction, f64::INFINITY)?;
        Some(Spot { facet: hit.patch, point: hit.point })
    }

    /// J₁, A/m.
    pub(super) fn first(&self, spot: Spot) -> ComplexVector {
        self.optics.at(spot.facet, spot.point).j
    }

    /// J₂ at `spot` of the first current of `area` m² at `from`, A/m; 0 where they do not face each
    /// other. Visibility is not asked.
    pub(super) fn second(&self, spot: Spot, from: Spot, area: f64) -> ComplexVector {
        let (here, there) = (self.facet(spot), self.facet(from));
        let between = from.point - spot.point;
        let side = here.side(between);
        if side == 0.0 || there.side(-between) == 0.0 || spot.facet == from.facet {
            return ComplexVector::ZERO;
        }
        let element = electric_element(&self.wave, self.first(from) * area, -between);
        element.h.crossed_by(here.normal * side) * 2.0
    }

    /// Whether nothing lies between two spots.
    pub(super) fn sees(&self, a: Spot, b: Spot) -> bool {
        self.facets.unoccluded(a.point, b.point)
    }

    /// E at a receiver of a current of so many m² at a spot, V/m.
    pub(super) fn radiated(
        &self,
        current: ComplexVector,
        spot: Spot,
        area: f64,
        receiver: Vec3,
    ) -> ComplexVector {
        electric_element(&self.wave, current * area, receiver - spot.point).e
    }
}

/// The place of a number in [0, 1) among running sums, and what is left of the number, even again
/// in [0, 1).
pub(super) fn pick(cumulated: &[f64], u: f64) -> (usize, f64) {
    let place = u * cumulated.last().copied().unwrap_or(0.0);
    let at = cumulated.partition_point(|&end| end <= place).min(cumulated.len() - 1);
    let start = if at == 0 { 0.0 } else { cumulated[at - 1] };
    (at, ((place - start) / (cumulated[at] - start)).clamp(0.0, 1.0 - f64::EPSILON))
}
