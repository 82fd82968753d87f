//! The radiation integral: E and H of surface currents at any point, all components and all near
//! terms.
//!
//! E(r) = ∫ (element of J + element of M) dA, see [`electric_element`](crate::electric_element). A
//! facet far from a point is its Gauss points, as many as its phase 2kh asks for; closer than the
//! reach of that rule (see the error bounds in `rule`) it is integrated for that point alone, with
//! more points, and next to it by a nearly singular rule. So the field at a point does not depend
//! on the other points, nor on the number of threads.
//!
//! Currents radiate in free space: nothing is occluded on the way to a point. Lengths in metres.

mod far;
mod kernel;
mod linear_phase;
mod near;

pub use far::{FarField, Pattern, cross_section, even_directions, polar_frame};
pub(crate) use kernel::{Element, Evaluate, Group, Observers};
pub(crate) use near::Run;

use crate::element::dual;
use crate::rule::{phase_error, points_for_phase, points_of, reach, regular};
use crate::{ComplexVector, Facet, Field, Scatterer, SurfaceCurrent, Wave, WaveError};
use fredholm_mesh::Vec3;
use pulp::Arch;
use rayon::prelude::*;
use std::sync::OnceLock;

/// Points that one task takes.
const CHUNK: usize = 64;

/// To which side a facet radiates.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Gate {
    /// To both: what a current does.
    #[default]
    Open,
    /// To both, with the normal turned to the observer: opposite signs on the two sides (G.
    /// Viennot, thesis, Limoges 2012, annex B.4.1).
    ObserverSide,
}

/// How facets are sampled.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Sampling {
    /// As many Gauss points as this relative error asks for.
    Tolerance(f64),
    /// One point, the centre: the rule of currents that are known there only.
    Midpoint,
}

/// The relative error of the radiation integral where nothing else is asked for.
pub const TOLERANCE: f64 = 1e-3;

/// Surface currents, ready to radiate.
pub struct Radiator<'a> {
    scatterer: &'a Scatterer,
    current: &'a dyn SurfaceCurrent,
    wave: Wave,
    gate: Gate,
    sampling: Sampling,
    /// Made when the first field is asked for: what is known in closed form does without.
    samples: OnceLock<Samples>,
    arch: Arch,
}

/// The currents at the points of the far rule.
#[derive(Default)]
struct Samples {
    groups: Vec<Group>,
    runs: Vec<Run>,
    /// Empty where no current of the kind flows: those of one kind cost one pass and one list.
    electric: Vec<Element>,
    magnetic: Vec<Element>,
}

impl<'a> Radiator<'a> {
    /// Samples the currents when the first field is asked for.
    #[must_use]
    pub fn new(
        scatterer: &'a Scatterer,
        wave: Wave,
        current: &'a dyn SurfaceCurrent,
        gate: Gate,
        sampling: Sampling,
    ) -> Self {
        let (samples, arch) = (OnceLock::new(), Arch::new());
        Self { scatterer, current, wave, gate, sampling, samples, arch }
    }

    /// Bytes of the currents of a scatterer once they are sampled: on conductors of one kind, and
    /// on the facets of these numbers that carry any.
    #[must_use]
    pub fn bytes(
        scatterer: &Scatterer,
        wave: &Wave,
        sampling: Sampling,
        carries: &(dyn Fn(usize) -> bool + Sync),
    ) -> u64 {
        let points = |(index, facet): (usize, &Facet)| {
            if carries(index) { points_of(facet, points_a_side(facet, wave, sampling)) } else { 0 }
        };
        let points: usize = scatterer.facets().par_iter().enumerate().map(points).sum();
        let kinds = if scatterer.check_conductor("").is_ok() { 1 } else { 2 };
        (kinds * points * size_of::<Element>() + scatterer.facets().len() * size_of::<Group>()) as u64
    }

    fn samples(&self) -> &Samples {
        self.samples.get_or_init(|| Samples::of(self))
    }

    fn tolerance(&self) -> f64 {
        tolerance(self.sampling)
    }

    /// Elements that the far rule has, of electric and of magnetic currents.
    #[must_use]
    pub fn elements(&self) -> usize {
        self.samples().electric.len() + self.samples().magnetic.len()
    }

    /// E and H at these points (m), in parallel.
    ///
    /// # Errors
    /// [`WaveError::OnSurface`] for a point on a facet, [`WaveError::NotFinite`] for one that is
    /// none.
    pub fn fields(&self, points: &[Vec3]) -> Result<Vec<Field>, WaveError> {
        if points.iter().any(|p| !p.is_finite()) {
            return Err(WaveError::NotFinite { what: "a coordinate of a receiver" });
        }
        let mut fields = vec![Field::ZERO; points.len()];
        let chunks = fields.par_chunks_mut(CHUNK).zip(points.par_chunks(CHUNK)).enumerate();
        chunks.try_for_each(|(chunk, (out, points))| {
            self.far_part(points, out);
            let places = points.iter().zip(out).enumerate();
            places.into_iter().try_for_each(|(i, (&p, out))| {
                *out += self.near_part(chunk * CHUNK + i, p)?;
                Ok::<(), WaveError>(())
            })
        })?;
        Ok(fields)
    }

    /// What the facets radiate that a point is not near to.
    fn far_part(&self, points: &[Vec3], out: &mut [Field]) {
        let mut part = [Field::ZERO; CHUNK];
        let samples = self.samples();
        for (elements, magnetic) in [(&samples.electric, false), (&samples.magnetic, true)] {
            if elements.is_empty() {
                continue;
            }
            let part = &mut part[..points.len()];
            let (wavenumber, groups) = (self.wave.wavenumber(), &samples.groups);
            self.arch.dispatch(Evaluate { wavenumber, groups, elements, points, observers: None, out: part });
            let turned = |field: Field| if magnetic { dual(field) } else { field };
            out.iter_mut().zip(part.iter()).for_each(|(out, &field)| *out += turned(field));
        }
    }
}

impl Samples {
    fn of(radiator: &Radiator<'_>) -> Self {
        let mut samples = Self::default();
        let (mut electric, mut magnetic) = (Vec::new(), Vec::new());
        let mut first = 0;
        for (index, facet) in radiator.scatterer.facets().iter().enumerate() {
            electric.clear();
            magnetic.clear();
            let n = points_a_side(facet, &radiator.wave, radiator.sampling);
            for (q, weight) in regular(facet, n) {
                let current = radiator.current.at(index, q);
                electric.push(element(q, current.j, weight));
                magnetic.push(element(q, current.m, weight));
            }
            if electric.iter().chain(&magnetic).all(Element::is_dark) {
                continue;
            }
            let near = near(facet, &radiator.wave, (n, tolerance(radiator.sampling)));
            samples.groups.push(Group {
                centre: facet.centre.into(),
                normal: facet.normal.into(),
                near_squared: near * near,
                behind: if radiator.gate == Gate::Open { 1.0 } else { -1.0 },
                facet: index,
                first,
                count: electric.len(),
            });
            append(&mut samples.electric, first, &electric);
            append(&mut samples.magnetic, first, &magnetic);
            first += electric.len();
        }
        samples.runs = Run::all(&samples.groups);
        samples
    }
}

/// Appends the elements of a facet to all before, which are `first`: dark ones are left out until
/// one is not.
fn append(all: &mut Vec<Element>, first: usize, more: &[Element]) {
    if all.is_empty() && more.iter().all(Element::is_dark) {
        return;
    }
    all.resize(first, Element::DARK);
    all.extend_from_slice(more);
}

fn tolerance(sampling: Sampling) -> f64 {
    match sampling {
        Sampling::Tolerance(tolerance) => tolerance.max(1e-12),
        Sampling::Midpoint => TOLERANCE,
    }
}

/// Largest phase over a facet, rad: the wave to the observer and the current both turn by up to k
/// a metre.
fn phase(facet: &Facet, wave: &Wave) -> f64 {
    2.0 * wave.wavenumber() * facet.edge()
}

/// Gauss points a side of a facet.
fn points_a_side(facet: &Facet, wave: &Wave, sampling: Sampling) -> usize {
    match sampling {
        Sampling::Midpoint => 1,
        Sampling::Tolerance(_) => points_for_phase(phase(facet, wave), tolerance(sampling)),
    }
}

/// Distance from the centre of a facet, m, up to which so many points a side are too few.
fn near(facet: &Facet, wave: &Wave, (n, tolerance): (usize, f64)) -> f64 {
    0.5 * facet.diameter * reach(n, phase_error(n, phase(facet, wave)).clamp(tolerance, 0.1))
}

fn element(q: Vec3, current: ComplexVector, weight: f64) -> Element {
    let moment = current * (weight / (4.0 * std::f64::consts::PI));
    Element { position: q.into(), re: moment.re.into(), im: moment.im.into() }
}
