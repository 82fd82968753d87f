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
use crate::rule::{phase_error, points_for_phase, reach, regular};
use crate::{ComplexVector, Facet, Field, Scatterer, SurfaceCurrent, Wave, WaveError};
use fredholm_mesh::Vec3;
use pulp::Arch;
use rayon::prelude::*;

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
    tolerance: f64,
    groups: Vec<Group>,
    runs: Vec<Run>,
    electric: Vec<Element>,
    magnetic: Vec<Element>,
    arch: Arch,
}

impl<'a> Radiator<'a> {
    /// Samples the currents.
    #[must_use]
    pub fn new(
        scatterer: &'a Scatterer,
        wave: Wave,
        current: &'a dyn SurfaceCurrent,
        gate: Gate,
        sampling: Sampling,
    ) -> Self {
        let tolerance = match sampling {
            Sampling::Tolerance(tolerance) => tolerance.max(1e-12),
            Sampling::Midpoint => TOLERANCE,
        };
        let mut radiator = Self {
            scatterer,
            current,
            wave,
            gate,
            tolerance,
            groups: Vec::new(),
            runs: Vec::new(),
            electric: Vec::new(),
            magnetic: Vec::new(),
            arch: Arch::new(),
        };
        for (index, facet) in scatterer.facets().iter().enumerate() {
            radiator.sample(index, facet, sampling == Sampling::Midpoint);
        }
        radiator.complete();
        radiator
    }

    /// What is left to do when all facets are sampled.
    fn complete(&mut self) {
        self.runs = Run::all(&self.groups);
        // Currents of one kind only cost one pass.
        for elements in [&mut self.electric, &mut self.magnetic] {
            if elements.iter().all(Element::is_dark) {
                elements.clear();
            }
        }
    }

    /// Largest phase over a facet, rad: the wave to the observer and the current both turn by up to
    /// k a metre.
    fn phase(&self, facet: &Facet) -> f64 {
        2.0 * self.wave.wavenumber() * facet.edge()
    }

    fn sample(&mut self, index: usize, facet: &Facet, midpoint: bool) {
        let phase = self.phase(facet);
        let n = if midpoint { 1 } else { points_for_phase(phase, self.tolerance) };
        let near = 0.5 * facet.diameter * reach(n, phase_error(n, phase).clamp(self.tolerance, 0.1));
        let first = self.electric.len();
        for (q, weight) in regular(facet, n) {
            let current = self.current.at(index, q);
            self.electric.push(element(q, current.j, weight));
            self.magnetic.push(element(q, current.m, weight));
        }
        if self.electric[first..].iter().chain(&self.magnetic[first..]).all(Element::is_dark) {
            self.electric.truncate(first);
            self.magnetic.truncate(first);
            return;
        }
        let behind = if self.gate == Gate::Open { 1.0 } else { -1.0 };
        self.groups.push(Group {
            centre: facet.centre.into(),
            normal: facet.normal.into(),
            near_squared: near * near,
            behind,
            facet: index,
            first,
            count: self.electric.len() - first,
        });
    }

    /// Elements that the far rule has, of electric and of magnetic currents.
    #[must_use]
    pub fn elements(&self) -> usize {
        self.electric.len() + self.magnetic.len()
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
        for (elements, magnetic) in [(&self.electric, false), (&self.magnetic, true)] {
            if elements.is_empty() {
                continue;
            }
            let part = &mut part[..points.len()];
            let (wavenumber, groups) = (self.wave.wavenumber(), &self.groups);
            self.arch.dispatch(Evaluate { wavenumber, groups, elements, points, observers: None, out: part });
            let turned = |field: Field| if magnetic { dual(field) } else { field };
            out.iter_mut().zip(part.iter()).for_each(|(out, &field)| *out += turned(field));
        }
    }
}

fn element(q: Vec3, current: ComplexVector, weight: f64) -> Element {
    let moment = current * (weight / (4.0 * std::f64::consts::PI));
    Element { position: q.into(), re: moment.re.into(), im: moment.im.into() }
}
