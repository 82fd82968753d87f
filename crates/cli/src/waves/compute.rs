//! The currents and the fields at all frequencies.

use std::ops::ControlFlow;

use fredholm_linop::{MultiVector, Observer, Progress, SecondKind, Solver, Stop, StopReason};
use fredholm_mesh::Vec3;
use fredholm_report::{FarRow, WaveCurrents, WaveRow};
use fredholm_waves::{
    Bounced, Bounces, Complex64, ComplexVector, Current, Discretisation, EdgeCurrents, FacetCurrents,
    FarField, Field, PhysicalOptics, Radiator, Sampling, Scatterer, Shadow, Source, System, TOLERANCE, Wave,
    WaveError, cross_section, incident,
};
use rayon::prelude::*;

use super::estimate;
use super::geometry::Geometry;
use super::model::{Band, Method};
use super::receivers::{Places, Receiver};
use super::record::Solved;
use super::{Model, Outcome};
use crate::failure::{Ending, Failure};
use crate::interrupt::{Interrupt, nothing_saved};
use crate::memory;
use crate::size::Bytes;
use crate::stages::Stages;

/// Solvers that ask for products only: where the matrix does not fit, they compute it anew each time.
const PRODUCTS_ONLY: [&str; 4] = ["neumann", "gmres", "bicgstab", "anderson"];

type Vectors = MultiVector<Complex64>;

/// Computes everything that the model asks for.
pub(crate) fn compute(model: &Model, stages: &mut Stages) -> Result<Outcome, Failure> {
    let as_asked = Variant { name: "", geometry: &model.geometry, shadow: model.shadow };
    let mut outcome = variant(model, as_asked, stages)?;
    if let Some(coarse) = &model.coarse {
        let coarser = variant(model, Variant { name: ", long edges", geometry: coarse, ..as_asked }, stages)?;
        outcome.mesh_errors = estimate::mesh(&outcome.near, &coarser.near);
        if estimate::has_magnetic_form(model) {
            let shadow = Shadow::Thesis;
            let magnetic = variant(model, Variant { name: ", magnetic form", shadow, ..as_asked }, stages)?;
            outcome.form_errors = estimate::form(&outcome.near, &magnetic.near);
        }
    }
    Ok(outcome)
}

/// One of the runs that a model may need.
#[derive(Clone, Copy)]
struct Variant<'a> {
    /// What is added to the names of its stages.
    name: &'a str,
    geometry: &'a Geometry,
    shadow: Shadow,
}

fn variant(model: &Model, variant: Variant<'_>, stages: &mut Stages) -> Result<Outcome, Failure> {
    let mut outcome = Outcome::default();
    for band in &model.bands {
        let refused = |error: WaveError| model.refused(&error, None);
        let scatterer = variant.geometry.scatterer(band.materials.clone()).map_err(refused)?;
        scatterer.check_resolution(&band.wave).map_err(refused)?;
        let sources: Vec<&dyn Source> = model.sources.iter().map(AsRef::as_ref).collect();
        let first = PhysicalOptics::new(&scatterer, band.wave, &sources, variant.shadow).map_err(refused)?;
        let task = Task { model, variant, band, scatterer: &scatterer, first: &first, sources: &sources };
        task.carry_out(stages, &mut outcome)?;
    }
    Ok(outcome)
}

/// One frequency.
struct Task<'a> {
    model: &'a Model,
    variant: Variant<'a>,
    band: &'a Band,
    scatterer: &'a Scatterer,
    first: &'a PhysicalOptics<'a>,
    sources: &'a [&'a dyn Source],
}

impl Task<'_> {
    fn carry_out(&self, stages: &mut Stages, outcome: &mut Outcome) -> Result<(), Failure> {
        let name = format!("{} MHz{}", self.band.wave.frequency() / 1e6, self.variant.name);
        let interrupt = stages.interrupt;
        let (system, currents, solved) =
            stages.run(&format!("currents at {name}"), || self.currents(interrupt))?;
        stages.run(&format!("fields at {name}"), || self.radiate(system.as_ref(), &currents, outcome))?;
        outcome.currents.push(WaveCurrents { name, values: currents.values().iter().map(current).collect() });
        outcome.solved.push(solved);
        Ok(())
    }

    fn refused(&self, error: &WaveError) -> Failure {
        self.model.refused(error, None)
    }

    /// The currents at the centres of the facets, and the system they solve where there is more than one bounce.
    fn currents(
        &self,
        interrupt: &Interrupt,
    ) -> Result<(Option<System<'_>>, FacetCurrents, Solved), Failure> {
        let facets = self.scatterer.facets().len();
        let frequency = self.band.wave.frequency();
        let known = Solved { frequency, facets, residuals: Vec::new(), reason: None };
        match &self.model.method {
            Method::Bounces(1) => {
                let residuals = self.first_residuals(interrupt)?;
                let currents = FacetCurrents::sampled(self.scatterer, self.first);
                Ok((None, currents, Solved { residuals, ..known }))
            }
            Method::Bounces(count) => {
                let system = self.lazy()?;
                let (x, residuals) = self.bounced(&system, *count, interrupt)?;
                let currents = system.currents(&x, 0);
                Ok((Some(system), currents, Solved { residuals, ..known }))
            }
            Method::Solver { solver, tolerance, max_iterations } => {
                let system = self.system(&**solver)?;
                let stop = Stop { tolerance: *tolerance, max_iterations: *max_iterations };
                let (x, solved) = self.solve(&system, &**solver, &stop, interrupt)?;
                let currents = system.currents(&x, 0);
                Ok((Some(system), currents, Solved { facets, ..solved }))
            }
        }
    }

    fn lazy(&self) -> Result<System<'_>, Failure> {
        System::lazy(self.scatterer, self.band.wave, self.variant.shadow)
            .map_err(|error| self.refused(&error))
    }

    fn system(&self, solver: &dyn Solver<Complex64>) -> Result<System<'_>, Failure> {
        coupled(self.model, self.scatterer, self.band.wave, self.variant.shadow, &[solver])
    }

    /// The currents after so many bounces, and the residual after each.
    fn bounced(
        &self,
        system: &System<'_>,
        count: usize,
        interrupt: &Interrupt,
    ) -> Result<(Vectors, Vec<f64>), Failure> {
        let b = system.right_hand_side(&[self.first]);
        let mut poll =
            || if interrupt.requested() { ControlFlow::Break(()) } else { ControlFlow::Continue(()) };
        let sum = Bounces::sum(system.coupling(), &b, count, &mut poll).ok_or_else(nothing_saved)?;
        let residuals: Vec<f64> = sum.residuals.iter().filter_map(|lanes| lanes.first().copied()).collect();
        // A next bounce stronger than what comes from the sources: the sum is no approximation of anything.
        match residuals.last() {
            Some(&last) if count > 1 && last > 1.0 => Err(diverged("the sum of bounces", &residuals)),
            _ => Ok((sum.x, residuals)),
        }
    }

    /// What a second bounce would add, where errors are to be estimated and there is one.
    fn first_residuals(&self, interrupt: &Interrupt) -> Result<Vec<f64>, Failure> {
        if self.model.coarse.is_none() {
            return Ok(Vec::new());
        }
        Ok(self.bounced(&self.lazy()?, 1, interrupt)?.1)
    }

    fn solve(
        &self,
        system: &System<'_>,
        solver: &dyn Solver<Complex64>,
        stop: &Stop,
        interrupt: &Interrupt,
    ) -> Result<(Vectors, Solved), Failure> {
        let b = system.right_hand_side(&[self.first]);
        let unsuitable = |error| Failure::new(Ending::Input, error);
        let one = Vectors::from_fn(b.dim(), 1, |_, _| Complex64::ONE);
        let a =
            SecondKind::new(system.coupling(), one).map_err(|error| Failure::new(Ending::Input, error))?;
        let mut x = Vectors::zeros(b.dim(), 1);
        let report = solver.solve(&a, &b, &mut x, stop, &mut Watch(interrupt)).map_err(unsuitable)?;
        let residuals: Vec<f64> =
            report.history.iter().filter_map(|entry| entry.residuals.first().copied()).collect();
        match report.reason {
            StopReason::Interrupted => Err(nothing_saved()),
            StopReason::Diverged => Err(diverged(solver.name(), &residuals)),
            reason => {
                let frequency = self.band.wave.frequency();
                Ok((x, Solved { frequency, facets: 0, residuals, reason: Some(reason) }))
            }
        }
    }

    /// Fields at all receivers.
    fn radiate(
        &self,
        system: Option<&System<'_>>,
        currents: &FacetCurrents,
        outcome: &mut Outcome,
    ) -> Result<(), Failure> {
        let Some(system) = system else {
            return self.receive(&self.first.radiator(Sampling::Tolerance(TOLERANCE)), outcome);
        };
        let all = Bounced::new(self.scatterer, self.first, currents);
        self.receive(&system.radiator(&all), outcome)
    }

    fn receive(&self, radiator: &Radiator<'_>, outcome: &mut Outcome) -> Result<(), Failure> {
        let edges = self.edges()?;
        for (index, receiver) in self.model.receivers.iter().enumerate() {
            let refused = |error: WaveError| self.model.refused(&error, Some(receiver));
            match &receiver.places {
                Places::Near { points, .. } => {
                    let mut scattered = radiator.fields(points).map_err(refused)?;
                    if let Some(edges) = &edges {
                        scattered
                            .iter_mut()
                            .zip(edges.fields(points))
                            .for_each(|(field, more)| *field += more);
                    }
                    let rows = self.rows(index, points, &scattered).map_err(refused)?;
                    outcome.near.extend(rows);
                }
                Places::Far(angles) => {
                    let mut far = radiator.far_field(&Receiver::directions(angles)).map_err(refused)?;
                    if let Some(edges) = &edges {
                        let add = |far: &mut FarField| far.amplitude += edges.far_amplitude(far.direction);
                        far.par_iter_mut().for_each(add);
                    }
                    let rows = far.iter().zip(angles).enumerate();
                    outcome.far.extend(rows.map(|(i, (far, angles))| self.far_row([index, i], *angles, far)));
                }
            }
        }
        Ok(())
    }

    /// The edge currents, where they are asked for; the magnetic form has none.
    fn edges(&self) -> Result<Option<EdgeCurrents>, Failure> {
        if !self.model.edge_currents || self.variant.shadow == Shadow::Thesis {
            return Ok(None);
        }
        let found = EdgeCurrents::new(self.scatterer, self.band.wave, self.sources);
        found.map(Some).map_err(|error| self.refused(&error))
    }

    fn rows(&self, receiver: usize, points: &[Vec3], scattered: &[Field]) -> Result<Vec<WaveRow>, WaveError> {
        let row = |(index, (&p, scattered)): (usize, (&Vec3, &Field))| {
            let incident = incident(self.sources, &self.band.wave, p);
            if !incident.is_finite() {
                return Err(WaveError::InSource { receiver: index });
            }
            Ok(WaveRow {
                receiver,
                index,
                position: p.to_array(),
                frequency: self.band.wave.frequency(),
                incident: pair(incident.e, incident.h),
                scattered: pair(scattered.e, scattered.h),
            })
        };
        points.par_iter().zip(scattered).enumerate().map(row).collect()
    }

    fn far_row(&self, at: [usize; 2], angles: [f64; 2], far: &FarField) -> FarRow {
        let [theta, phi] = far.polar();
        let section = |wave: fredholm_waves::source::PlaneWave| {
            [theta, phi].map(|part| cross_section(part, wave.amplitude()))
        };
        FarRow {
            receiver: at[0],
            index: at[1],
            theta_degrees: angles[0],
            phi_degrees: angles[1],
            frequency: self.band.wave.frequency(),
            amplitude: [theta.re, theta.im, phi.re, phi.im],
            cross_section: self.model.plane_wave.map(section),
        }
    }
}

/// The system for these solvers: stored where it fits, else evaluated anew for those that ask for products only.
pub(super) fn coupled<'a>(
    model: &Model,
    scatterer: &'a Scatterer,
    wave: Wave,
    shadow: Shadow,
    solvers: &[&dyn Solver<Complex64>],
) -> Result<System<'a>, Failure> {
    let (facets, unknowns) = (scatterer.facets().len(), System::unknowns(scatterer));
    let solver = solvers.iter().map(|solver| solver.bytes(unknowns, 1)).max().unwrap_or(0);
    let needed = u128::from(System::bytes(scatterer)) + u128::from(solver);
    let limit = memory::default_limit();
    let refused = |error: WaveError| model.refused(&error, None);
    if needed <= limit.0 {
        return System::stored(scatterer, wave, shadow, Discretisation::Nystrom).map_err(refused);
    }
    if solvers.iter().all(|solver| PRODUCTS_ONLY.contains(&solver.name())) {
        return System::lazy(scatterer, wave, shadow).map_err(refused);
    }
    let text = format!(
        "the coupling of {facets} facets and its solver would take {}, and {limit} may be used\n  help: mesh coarser, or take a solver that needs no matrix: {}",
        Bytes(needed),
        PRODUCTS_ONLY.join(", ")
    );
    Err(Failure::new(Ending::Resources, text))
}

fn diverged(solver: &str, residuals: &[f64]) -> Failure {
    let reached = residuals.iter().copied().fold(f64::INFINITY, f64::min);
    let text = format!(
        "{solver} diverges after {} iterations (best residual {reached:.1e}); nothing was written\n  help: a closed body near a resonance or a cavity has no convergent series of bounces; take another solver",
        residuals.len().saturating_sub(1)
    );
    Failure::new(Ending::NotConverged, text)
}

/// Stops the solver at a signal.
pub(super) struct Watch<'a>(pub(super) &'a Interrupt);

impl<T> Observer<T> for Watch<'_> {
    fn observe(&mut self, _: &Progress<'_, T>) -> ControlFlow<()> {
        Observer::<T>::poll(self)
    }

    fn poll(&mut self) -> ControlFlow<()> {
        if self.0.requested() { ControlFlow::Break(()) } else { ControlFlow::Continue(()) }
    }
}

fn current(current: &Current) -> [f64; 12] {
    pair(current.j, current.m)
}

/// Components of two vectors, real parts first.
fn pair(a: ComplexVector, b: ComplexVector) -> [f64; 12] {
    let part = |i: usize| if i < 6 { a.components()[i / 2] } else { b.components()[i / 2 - 3] };
    std::array::from_fn(|i| if i.is_multiple_of(2) { part(i).re } else { part(i).im })
}
