//! One bounce: physical optics, J = 2 n × H_i, and the magnetic form M = 2 n × E_i.
//!
//! On an infinite perfectly conducting plane these currents are exact (C. A. Balanis, Advanced
//! Engineering Electromagnetics, 2nd ed., Wiley 2012, § 7.10). [`Shadow`] says which facets carry
//! them; n is the normal on the lit side.

mod fresnel;

use crate::material::Material;
use crate::source::Origin;
use fresnel::fresnel;

use crate::{
    ComplexVector, Current, Facet, Field, Gate, Kind, Radiator, Sampling, Scatterer, Source, SurfaceCurrent,
    Wave, WaveError,
};
use fredholm_mesh::Vec3;
use rayon::prelude::*;

/// The treatment of shadows. One must be used throughout: a blocked scattered field, or an
/// unblocked one of lit facets only, counts the shadow twice or never.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Shadow {
    /// A: facets see what nothing blocks (iterative physical optics).
    #[default]
    Geometric,
    /// B: nothing blocks; the currents radiate the shadow (D. Gershenzon, Y. Brick, A. Boag, IEEE
    /// Trans. Antennas Propag. 66 (2018) 871, doi:10.1109/TAP.2017.2783324).
    Radiated,
    /// C: the magnetic field equation of closed bodies, of which physical optics is the first term.
    Exact,
    /// C, and j times the same on a second surface λ/4 inside, which takes away the resonances of
    /// the interior (R. A. Shore, A. D. Yaghjian, IEEE Trans. Antennas Propag. 53 (2005) 1706).
    ExactDual,
    /// M = 2 n × E on lit facets, n turned to the observer for every pair, and nothing blocks (G.
    /// Viennot, thesis, Limoges 2012, eq. 2.15 and annex B).
    Thesis,
}

impl Shadow {
    /// All treatments.
    pub const ALL: [Self; 5] = [Self::Geometric, Self::Radiated, Self::Exact, Self::ExactDual, Self::Thesis];

    /// The name in scene files.
    #[must_use]
    pub fn name(self) -> &'static str {
        match self {
            Self::Geometric => "geometric",
            Self::Radiated => "radiated",
            Self::Exact => "exact",
            Self::ExactDual => "exact-dual",
            Self::Thesis => "thesis",
        }
    }

    /// Whether it is an equation for the currents, without approximation: of closed conductors.
    #[must_use]
    pub fn is_equation(self) -> bool {
        matches!(self, Self::Exact | Self::ExactDual)
    }

    /// To which side the currents radiate.
    #[must_use]
    pub fn gate(self) -> Gate {
        if self == Self::Thesis { Gate::ObserverSide } else { Gate::Open }
    }

    /// Refuses a scatterer that the treatment is not made for.
    ///
    /// # Errors
    /// [`WaveError::NotClosed`] for a sheet and the exact equation, [`WaveError::NotConductor`] for
    /// other materials and the exact equation or the thesis.
    pub fn check(self, scatterer: &Scatterer) -> Result<(), WaveError> {
        if self.is_equation() || self == Self::Thesis {
            scatterer.check_conductor("this treatment of shadows")?;
        }
        let sheet = scatterer.facets().iter().position(|facet| facet.kind == Kind::Sheet);
        match sheet {
            Some(facet) if self.is_equation() => Err(WaveError::NotClosed { facet }),
            _ => Ok(()),
        }
    }
}

/// The currents of one bounce, which can be asked for anywhere on the surface.
pub struct PhysicalOptics<'a> {
    scatterer: &'a Scatterer,
    sources: &'a [&'a dyn Source],
    wave: Wave,
    shadow: Shadow,
    /// Per source and facet: the side that is lit, +1 or −1 by the normal, or 0.
    lit: Vec<Vec<f64>>,
}

impl<'a> PhysicalOptics<'a> {
    /// Finds what each source lights.
    ///
    /// # Errors
    /// [`WaveError::NotClosed`] for a sheet and the exact equation.
    pub fn new(
        scatterer: &'a Scatterer,
        wave: Wave,
        sources: &'a [&'a dyn Source],
        shadow: Shadow,
    ) -> Result<Self, WaveError> {
        shadow.check(scatterer)?;
        let lit = sources.iter().map(|source| lit(scatterer, source.origin(), shadow)).collect();
        Ok(Self { scatterer, sources, wave, shadow, lit })
    }

    /// The side of each facet (+1 along the normal, −1 against it, 0 none) that a source, by its
    /// index, lights.
    ///
    /// # Panics
    /// There is no such source.
    #[must_use]
    pub fn lit(&self, source: usize) -> &[f64] {
        &self.lit[source]
    }

    /// The current of one source at a point of a facet that it lights.
    pub(crate) fn of_source(&self, source: usize, facet: usize, q: Vec3) -> Current {
        let (side, source) = (self.lit[source][facet], self.sources[source]);
        let (shape, towards) = (&self.scatterer.facets()[facet], source.origin().seen_from(q));
        let material = self.scatterer.material(shape);
        response(material, &self.wave, (shape, side, towards), source.field(&self.wave, q), self.shadow)
    }

    pub(crate) fn origins(&self) -> impl Iterator<Item = Origin> {
        self.sources.iter().map(|source| source.origin())
    }

    pub(crate) fn scatterer(&self) -> &Scatterer {
        self.scatterer
    }

    pub(crate) fn wave(&self) -> Wave {
        self.wave
    }

    pub(crate) fn gate(&self) -> Gate {
        self.shadow.gate()
    }

    /// 2 n × H_i at the point `p` (m), n that of a facet.
    pub(crate) fn on(&self, facet: &Facet, p: Vec3) -> ComplexVector {
        crate::source::incident(self.sources, &self.wave, p).h.crossed_by(facet.normal) * 2.0
    }

    /// Whether any source lights a facet.
    #[must_use]
    pub fn is_lit(&self, facet: usize) -> bool {
        self.lit.iter().any(|lit| lit[facet] != 0.0)
    }

    /// These currents, ready to radiate.
    #[must_use]
    pub fn radiator(&'a self, sampling: Sampling) -> Radiator<'a> {
        Radiator::new(self.scatterer, self.wave, self, self.shadow.gate(), sampling)
    }
}

impl SurfaceCurrent for PhysicalOptics<'_> {
    fn at(&self, facet: usize, q: Vec3) -> Current {
        let mut sum = Current::default();
        for source in (0..self.sources.len()).filter(|&source| self.lit[source][facet] != 0.0) {
            let current = self.of_source(source, facet, q);
            sum.j += current.j;
            sum.m += current.m;
        }
        sum
    }
}

/// The current that a wave makes on a facet that it meets on `side`, coming from the direction
/// `towards` its source.
pub(crate) fn response(
    material: &Material,
    wave: &Wave,
    (facet, side, towards): (&Facet, f64, Vec3),
    incident: Field,
    shadow: Shadow,
) -> Current {
    match material {
        Material::Conductor => conductor(facet.normal * side, incident, shadow),
        material => fresnel(material, wave, facet, side, towards, incident),
    }
}

/// The current on a perfect conductor, `normal` on the lit side.
fn conductor(normal: Vec3, incident: Field, shadow: Shadow) -> Current {
    if shadow == Shadow::Thesis {
        Current { j: ComplexVector::ZERO, m: incident.e.crossed_by(normal) * 2.0 }
    } else {
        Current { j: incident.h.crossed_by(normal) * 2.0, m: ComplexVector::ZERO }
    }
}

fn lit(scatterer: &Scatterer, origin: Origin, shadow: Shadow) -> Vec<f64> {
    let side = |facet: &Facet| match shadow {
        // It knows no lit side: all facets carry the current of their own normal.
        Shadow::Exact | Shadow::ExactDual => 1.0,
        // The sign of the side is in the gate.
        Shadow::Thesis => facet.side(origin.seen_from(facet.centre)).abs(),
        Shadow::Radiated => facet.side(origin.seen_from(facet.centre)),
        Shadow::Geometric => {
            let side = facet.side(origin.seen_from(facet.centre));
            if side != 0.0 && scatterer.sees(facet.centre, origin) { side } else { 0.0 }
        }
    };
    scatterer.facets().par_iter().map(side).collect()
}

#[cfg(test)]
#[allow(clippy::float_cmp, reason = "sides are exact")]
mod tests {
    use super::*;
    use crate::source::{HertzianDipole, PlaneWave};
    use crate::surface::{cube, facing_plates, plate};

    fn along_y() -> PlaneWave {
        PlaneWave::new(Vec3::Y, Vec3::Z, 1.0.into()).unwrap()
    }

    #[test]
    fn a_cube_is_lit_in_front_and_a_sheet_from_either_side() {
        let (wave, source) = (Wave::new(1e9).unwrap(), along_y());
        let cube = cube(0.5, 0.1).unwrap();
        let sources: [&dyn Source; 1] = [&source];
        let optics = PhysicalOptics::new(&cube, wave, &sources, Shadow::Geometric).unwrap();
        for (facet, lit) in cube.facets().iter().zip(optics.lit(0)) {
            assert!((*lit == 1.0) == (facet.normal.y < -0.5), "{facet:?}");
        }
        let sheet = plate(0.5, 0.1).unwrap();
        for (travel, side) in [(Vec3::Y, 1.0), (Vec3::NEG_Y, -1.0)] {
            let source = PlaneWave::new(travel, Vec3::Z, 1.0.into()).unwrap();
            let sources: [&dyn Source; 1] = [&source];
            let optics = PhysicalOptics::new(&sheet, wave, &sources, Shadow::Geometric).unwrap();
            assert!(optics.lit(0).iter().all(|&lit| lit == side));
        }
        let exact = PhysicalOptics::new(&sheet, wave, &sources, Shadow::Exact);
        assert_eq!(exact.err(), Some(WaveError::NotClosed { facet: 0 }));
    }

    #[test]
    fn what_stands_before_a_plate_takes_its_light_in_the_geometric_treatment_only() {
        let wave = Wave::new(1e9).unwrap();
        let plates = facing_plates(1.0, 2.0, 0.25).unwrap();
        // From far out on the −x side the first plate hides the second.
        let source = HertzianDipole::new(Vec3::new(-6.0, 0.0, 0.0), Vec3::Z, 1.0.into()).unwrap();
        let sources: [&dyn Source; 1] = [&source];
        let lit = |shadow| PhysicalOptics::new(&plates, wave, &sources, shadow).unwrap().lit(0).to_vec();
        let half = plates.facets().len() / 2;
        assert!(lit(Shadow::Geometric)[..half].iter().all(|&side| side == -1.0));
        assert!(lit(Shadow::Geometric)[half..].iter().filter(|&&side| side == 0.0).count() > half / 2);
        assert!(lit(Shadow::Radiated).iter().all(|&side| side != 0.0));
    }
}
