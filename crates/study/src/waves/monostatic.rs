//! Monostatic sweeps: plane waves from every direction, along θ̂ and φ̂, and what each sends back
//! along both.

use fredholm_mesh::Vec3;
use fredholm_report::MonostaticRow;
use fredholm_waves::source::PlaneWave;
use fredholm_waves::{
    Bounced, Complex64, PhysicalOptics, Sampling, Source, System, TOLERANCE, WaveError, polar_frame,
};
use rayon::prelude::*;

use super::compute::{Task, directions};
use super::estimate::{Estimated, SweepError};
use super::solving::{Solution, directions_together, solution};
use crate::error::Error;
use crate::stages::Signals;

/// What a sweep is made on.
pub(super) struct Sweep<'a> {
    /// The frequency, whose sources are not those of the sweep.
    pub(super) task: Task<'a>,
    /// None where one bounce is all.
    pub(super) system: Option<&'a System<'a>>,
}

/// Rows of a sweep, how the worst part of it was solved, and the error stated of it.
pub(super) type Swept = (Vec<MonostaticRow>, Option<Solution>, Option<Estimated>);

/// What one wave sends back along θ̂ and φ̂, and of a sample the squares of the error, where it is
/// known, and of the field.
type Echo = ([Complex64; 2], Option<(Option<f64>, f64)>);

impl Sweep<'_> {
    /// Goes through the directions of a receiver, given by its index.
    pub(super) fn run(
        &self,
        receiver: usize,
        angles: &[[f64; 2]],
        signals: &Signals<'_>,
    ) -> Result<Swept, Error> {
        let (mut rows, mut worst) = (Vec::new(), None);
        let (frequency, mut stated) = (self.task.wave().frequency(), SweepError::default());
        let together = directions_together(self.task.model, angles.len());
        let count = angles.len();
        for (chunk, angles) in angles.chunks(together).enumerate() {
            signals.check()?;
            let sampled = |i: usize| SweepError::samples(chunk * together + i, count);
            let (echoes, solution) = self.echoes(&directions(angles), &sampled, signals)?;
            for (i, (angles, pair)) in angles.iter().zip(echoes.chunks_exact(2)).enumerate() {
                let back = [pair[0].0[0], pair[0].0[1], pair[1].0[0], pair[1].0[1]];
                rows.push(MonostaticRow {
                    receiver,
                    index: chunk * together + i,
                    theta_degrees: angles[0],
                    phi_degrees: angles[1],
                    frequency,
                    scattering: back.map(|s| [s.re, s.im]),
                });
                pair.iter().filter_map(|echo| echo.1).for_each(|(error, field)| stated.add(error, field));
            }
            worst = Solution::worse(worst, solution);
        }
        Ok((rows, worst, stated.estimated(receiver, frequency)))
    }

    /// What waves along θ̂ and φ̂ of some directions send back, in turn.
    fn echoes(
        &self,
        directions: &[Vec3],
        sampled: &(dyn Fn(usize) -> bool + Sync),
        signals: &Signals<'_>,
    ) -> Result<(Vec<Echo>, Option<Solution>), Error> {
        let refused = |error: WaveError| self.task.model.refused(&error, None);
        let waves = plane_waves(directions).map_err(refused)?;
        let sources: Vec<[&dyn Source; 1]> = waves.iter().map(|wave| [wave as &dyn Source]).collect();
        let optics: Vec<PhysicalOptics<'_>> = sources
            .iter()
            .map(|sources| {
                PhysicalOptics::new(self.task.scatterer, self.task.wave(), sources, self.task.shadow())
            })
            .collect::<Result<_, _>>()
            .map_err(refused)?;
        let excitations: Vec<&PhysicalOptics<'_>> = optics.iter().collect();
        let solve = |system: &System<'_>| {
            solution(&self.task.model.method, system, &system.right_hand_side(&excitations), signals)
        };
        let solution = self.system.map(solve).transpose()?;
        let back = |excitation: usize| {
            let u = directions[excitation / 2];
            let known = solution.as_ref().map(|solution| (solution, excitation));
            let task = self.task.lit_by(&optics[excitation], &sources[excitation]);
            self.back(u, task, known, sampled(excitation / 2))
        };
        let echoes: Vec<Echo> = (0..waves.len()).into_par_iter().map(back).collect::<Result<_, _>>()?;
        Ok((echoes, solution))
    }

    /// What one incident wave sends back towards u, and its error where it is asked for.
    fn back(
        &self,
        u: Vec3,
        task: Task<'_>,
        known: Option<(&Solution, usize)>,
        sampled: bool,
    ) -> Result<Echo, Error> {
        if let (Some(system), Some((solution, excitation))) = (self.system, known) {
            let currents = system.currents(&solution.x, excitation);
            let all = Bounced::new(task.scatterer, task.first, &currents);
            let left = task.left(solution.residual(), true);
            task.echo(u, &system.radiator(&all), Some(&all), left.filter(|_| sampled))
        } else {
            let left = task.left(None, false);
            task.echo(u, &task.first.radiator(Sampling::Tolerance(TOLERANCE)), None, left.filter(|_| sampled))
        }
        .map(|(back, stated)| (back, if sampled { Some(stated) } else { None }))
    }
}

/// Waves of 1 V/m from these directions, along θ̂ and φ̂ in turn.
pub(super) fn plane_waves(directions: &[Vec3]) -> Result<Vec<PlaneWave>, WaveError> {
    let pair = |&u: &Vec3| polar_frame(u).map(|along| PlaneWave::new(-u, along, Complex64::ONE));
    directions.iter().flat_map(pair).collect()
}
