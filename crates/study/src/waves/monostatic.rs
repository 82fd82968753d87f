//! Monostatic sweeps: plane waves from every direction, along θ̂ and φ̂, and what each sends back
//! along both.

use fredholm_mesh::Vec3;
use fredholm_report::MonostaticRow;
use fredholm_waves::source::PlaneWave;
use fredholm_waves::{
    Bounced, Complex64, EdgeCurrents, PhysicalOptics, Sampling, Scatterer, Shadow, Source, System, TOLERANCE,
    Wave, WaveError, polar_frame,
};
use rayon::prelude::*;

use super::compute::directions;
use super::registry::by_products;
use super::solving::{Solution, solution};
use super::{Method, Model};
use crate::error::Error;
use crate::stages::Signals;

/// Directions that are solved for together.
const TOGETHER: usize = 8;

/// What a sweep is made on.
pub(super) struct Sweep<'a> {
    pub(super) model: &'a Model,
    pub(super) scatterer: &'a Scatterer,
    pub(super) wave: Wave,
    pub(super) shadow: Shadow,
    /// None where one bounce is all.
    pub(super) system: Option<&'a System<'a>>,
}

/// Rows of a sweep, and how the worst part of it was solved.
pub(super) type Swept = (Vec<MonostaticRow>, Option<Solution>);

impl Sweep<'_> {
    /// Goes through the directions of a receiver, given by its index.
    pub(super) fn run(
        &self,
        receiver: usize,
        angles: &[[f64; 2]],
        signals: &Signals<'_>,
    ) -> Result<Swept, Error> {
        let (mut rows, mut worst): Swept = (Vec::new(), None);
        // A factorisation serves all waves; others need memory for every wave that they solve for.
        let together = match &self.model.method {
            Method::Solver { solver, .. } if !by_products().contains(&solver.name()) => angles.len().max(1),
            _ => TOGETHER,
        };
        for (chunk, angles) in angles.chunks(together).enumerate() {
            signals.check()?;
            let (echoes, solution) = self.echoes(&directions(angles), signals)?;
            let row = |(i, (angles, echo)): (usize, (&[f64; 2], &[Complex64; 4]))| MonostaticRow {
                receiver,
                index: chunk * together + i,
                theta_degrees: angles[0],
                phi_degrees: angles[1],
                frequency: self.wave.frequency(),
                scattering: echo.map(|s| [s.re, s.im]),
            };
            rows.extend(angles.iter().zip(&echoes).enumerate().map(row));
            let last = |solution: &Option<Solution>| {
                solution.as_ref().and_then(|s| s.residuals.last().copied()).unwrap_or(-1.0)
            };
            worst = if last(&solution) > last(&worst) { solution } else { worst };
        }
        Ok((rows, worst))
    }

    /// S_θθ, S_φθ, S_θφ, S_φφ (m), received then incident, of some directions.
    fn echoes(
        &self,
        directions: &[Vec3],
        signals: &Signals<'_>,
    ) -> Result<(Vec<[Complex64; 4]>, Option<Solution>), Error> {
        let refused = |error: WaveError| self.model.refused(&error, None);
        let waves = plane_waves(directions).map_err(refused)?;
        let sources: Vec<[&dyn Source; 1]> = waves.iter().map(|wave| [wave as &dyn Source]).collect();
        let optics: Vec<PhysicalOptics<'_>> = sources
            .iter()
            .map(|sources| PhysicalOptics::new(self.scatterer, self.wave, sources, self.shadow))
            .collect::<Result<_, _>>()
            .map_err(refused)?;
        let lanes: Vec<&PhysicalOptics<'_>> = optics.iter().collect();
        let solve = |system: &System<'_>| {
            solution(&self.model.method, system, &system.right_hand_side(&lanes), signals)
        };
        let solution = self.system.map(solve).transpose()?;
        let back = |lane: usize| {
            let u = directions[lane / 2];
            let known = solution.as_ref().map(|solution| (solution, lane));
            self.back(u, (&optics[lane], &sources[lane]), known)
        };
        let pairs: Vec<[Complex64; 2]> =
            (0..waves.len()).into_par_iter().map(back).collect::<Result<_, _>>().map_err(refused)?;
        let echoes = pairs.chunks_exact(2).map(|pair| [pair[0][0], pair[0][1], pair[1][0], pair[1][1]]);
        Ok((echoes.collect(), solution))
    }

    /// The far field towards u along θ̂ and φ̂, of one incident wave.
    fn back(
        &self,
        u: Vec3,
        (first, sources): (&PhysicalOptics<'_>, &[&dyn Source]),
        known: Option<(&Solution, usize)>,
    ) -> Result<[Complex64; 2], WaveError> {
        let mut edges = None;
        let mut far = if let (Some(system), Some((solution, lane))) = (self.system, known) {
            let currents = system.currents(&solution.x, lane);
            let all = Bounced::new(self.scatterer, first, &currents);
            if self.model.edge_currents {
                edges = Some(EdgeCurrents::of_bounces(self.scatterer, self.wave, sources, &all)?);
            }
            system.radiator(&all).far_field(&[u])?
        } else {
            if self.model.edge_currents {
                edges = Some(EdgeCurrents::new(self.scatterer, self.wave, sources)?);
            }
            let closed = first.linear_phase_far_field(&[u]);
            closed.unwrap_or_else(|| first.radiator(Sampling::Tolerance(TOLERANCE)).far_field(&[u]))?
        };
        if let Some(edges) = edges {
            for far in &mut far {
                far.amplitude += edges.far_amplitude(far.direction);
            }
        }
        Ok(far.first().map_or([Complex64::ZERO; 2], fredholm_waves::FarField::polar))
    }
}

/// Waves of 1 V/m from these directions, along θ̂ and φ̂ in turn.
pub(super) fn plane_waves(directions: &[Vec3]) -> Result<Vec<PlaneWave>, WaveError> {
    let pair = |&u: &Vec3| polar_frame(u).map(|along| PlaneWave::new(-u, along, Complex64::ONE));
    directions.iter().flat_map(pair).collect()
}
