//! The currents and the fields at all frequencies.

use std::slice;

use fredholm_linop::Steps;
use fredholm_mesh::Vec3;
use fredholm_report::{FarRow, FarTotal, WaveCurrents, WaveRow};
use fredholm_scene::waves::{Places, direction};
use fredholm_waves::material::Material;
use fredholm_waves::medium::IMPEDANCE;
use fredholm_waves::{
    Bounced, Complex64, ComplexVector, Current, EdgeCurrents, FacetCurrents, FarField, Field, Kind,
    PhysicalOptics, Radiator, Sampling, Scatterer, Shadow, Source, System, TOLERANCE, Wave, WaveError,
    cross_section, even_directions, field_inside, incident,
};
use rayon::prelude::*;

use super::balance::{Balancing, Reciprocity, of_sources, power};
use super::choice::in_one_plane;
use super::estimate::{self, Estimated, Stating};
use super::galerkin;
use super::geometry::Geometry;
use super::interpolation;
use super::model::Band;
use super::monostatic::Sweep;
use super::over_frequency::MOST_PICTURED;
use super::record::Solved;
use super::solving::{self, Solution};
use super::{Model, Outcome};
use crate::error::Error;
use crate::stages::{Signals, Stages, Unstaged};

/// Most elements of edges that errors are stated from.
const MOST_ELEMENTS: f64 = 2e5;
/// Directions in which the mean field of a wave of a sweep is taken.
const MEAN_FIELD_DIRECTIONS: usize = 100;

/// Computes everything that the model asks for.
pub(crate) fn compute(model: &Model, stages: &mut Stages) -> Result<Outcome, Error> {
    let as_asked = Variant { name: "", geometry: &model.geometry, shadow: model.shadow };
    let mut outcome = variant(model, as_asked, stages)?;
    if let Some(coarse) = &model.coarse {
        let coarser = variant(model, Variant { name: ", long edges", geometry: coarse, ..as_asked }, stages)?;
        outcome.mesh_errors = estimate::mesh(&outcome, &coarser);
        if estimate::has_magnetic_form(model) {
            let shadow = Shadow::Thesis;
            let magnetic = variant(model, Variant { name: ", magnetic form", shadow, ..as_asked }, stages)?;
            outcome.form_errors = estimate::form(&outcome, &magnetic);
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

fn variant(model: &Model, variant: Variant<'_>, stages: &mut Stages) -> Result<Outcome, Error> {
    if let Some(accuracy) = interpolation::accuracy(model) {
        let mut compute = |band: &Band, outcome: &mut Outcome| match model.galerkin {
            Some(equations) => {
                let bodies = (variant.geometry, variant.name);
                galerkin::run(model, slice::from_ref(band), bodies, equations, (stages, outcome))
            }
            None => at_frequency(model, variant, band, stages, outcome),
        };
        return interpolation::swept(model, accuracy, &mut compute);
    }
    let mut outcome = Outcome::default();
    if let Some(equations) = model.galerkin {
        let bodies = (variant.geometry, variant.name);
        galerkin::run(model, &model.bands, bodies, equations, (stages, &mut outcome))?;
        return Ok(outcome);
    }
    if model.bands.len() <= MOST_PICTURED {
        for band in &model.bands {
            at_frequency(model, variant, band, stages, &mut outcome)?;
        }
        return Ok(outcome);
    }
    let (watch, count) = (stages.watch, model.bands.len());
    let steps = Steps::new(watch, count as u64, "frequencies");
    stages.run(&format!("{count} frequencies{}", variant.name), || {
        let unstaged = Unstaged(watch);
        let mut inner = Stages::new(&unstaged);
        for band in &model.bands {
            at_frequency(model, variant, band, &mut inner, &mut outcome)?;
            if steps.add(1).is_break() {
                return Err(Error::cancelled());
            }
        }
        Ok(outcome)
    })
}

/// The fields of the currents that the sources alone drive, as a system radiates them: they take the
/// time of those of a solution.
pub(super) fn incident_fields(model: &Model, stages: &mut Stages) -> Result<(), Error> {
    let as_asked = Variant { name: "", geometry: &model.geometry, shadow: model.shadow };
    for band in &model.bands {
        with_task(model, as_asked, band, &mut |task| task.radiate_incident(stages))?;
    }
    Ok(())
}

fn at_frequency(
    model: &Model,
    variant: Variant<'_>,
    band: &Band,
    stages: &mut Stages,
    outcome: &mut Outcome,
) -> Result<(), Error> {
    with_task(model, variant, band, &mut |task| task.carry_out(stages, outcome))
}

fn with_task(
    model: &Model,
    variant: Variant<'_>,
    band: &Band,
    run: &mut dyn FnMut(&Task<'_>) -> Result<(), Error>,
) -> Result<(), Error> {
    let refused = |error: WaveError| model.refused(&error, None);
    let scatterer = variant.geometry.scatterer(&band.materials).map_err(refused)?;
    if !model.is_closed_form() {
        scatterer.check_resolution(&band.wave).map_err(refused)?;
    }
    let sources = model.sources();
    let first = PhysicalOptics::new(&scatterer, band.wave, &sources, variant.shadow).map_err(refused)?;
    let task = Task { model, variant, band, scatterer: &scatterer, first: &first, sources: &sources };
    run(&task)
}

/// A far field along θ̂ and φ̂, and the squares of its error (V²), where that is known, and of
/// itself.
pub(super) type Echo = ([Complex64; 2], (Option<f64>, f64));

/// One frequency.
#[derive(Clone, Copy)]
pub(super) struct Task<'a> {
    pub(super) model: &'a Model,
    variant: Variant<'a>,
    band: &'a Band,
    pub(super) scatterer: &'a Scatterer,
    pub(super) first: &'a PhysicalOptics<'a>,
    pub(super) sources: &'a [&'a dyn Source],
}

impl Task<'_> {
    fn carry_out(&self, stages: &mut Stages, outcome: &mut Outcome) -> Result<(), Error> {
        let name = format!("{} MHz{}", self.band.wave.frequency() / 1e6, self.variant.name);
        let signals = &stages.signals();
        let system = stages.run(&format!("coupling at {name}"), || self.system(signals))?;
        let system = system.as_ref();
        if self.model.has_bistatic() {
            let (currents, solved) =
                stages.run(&format!("currents at {name}"), || self.currents(system, signals))?;
            let left = self.left(solved.residuals.last().copied(), system.is_some());
            stages.run(&format!("fields at {name}"), || self.radiate(system, &currents, left, outcome))?;
            let values = currents.values().iter().map(current).collect();
            outcome.currents.push(WaveCurrents { name: name.clone(), values });
            outcome.solved.push(solved);
        }
        // Estimates are made of the fields at receivers only.
        if self.variant.name.is_empty() && self.model.has_sweep() {
            stages.run(&format!("sweep at {name}"), || self.sweep(system, signals, outcome))?;
        }
        Ok(())
    }

    fn radiate_incident(&self, stages: &mut Stages) -> Result<(), Error> {
        let signals = &stages.signals();
        let system =
            solving::lazy(self.model, self.scatterer, (self.band.wave, self.variant.shadow), &[], signals)?;
        let currents = system.currents(&system.right_hand_side(&[self.first]), 0);
        // A residual, whatever it is, has the error stated, which is a part of the fields.
        stages.run("fields", || self.radiate(Some(&system), &currents, Some(1.0), &mut Outcome::default()))
    }

    fn refused(&self, error: &WaveError) -> Error {
        self.model.refused(error, None)
    }

    fn system(&self, signals: &Signals<'_>) -> Result<Option<System<'_>>, Error> {
        solving::system(
            self.model,
            self.scatterer,
            (self.band.wave, self.variant.shadow, self.first),
            signals,
        )
    }

    /// The currents at the centres of the facets.
    fn currents(
        &self,
        system: Option<&System<'_>>,
        signals: &Signals<'_>,
    ) -> Result<(FacetCurrents, Solved), Error> {
        let Some(system) = system else {
            let residuals = self.first_residuals(signals)?;
            let currents = FacetCurrents::sampled(self.scatterer, self.first);
            return Ok((currents, Solved { residuals, ..self.solved(None) }));
        };
        let b = system.right_hand_side(&[self.first]);
        let solution = solving::solution(&self.model.method, system, &b, signals)?;
        Ok((system.currents(&solution.x, 0), self.solved(Some(solution))))
    }

    fn solved(&self, solution: Option<Solution>) -> Solved {
        let (frequency, facets) = (self.band.wave.frequency(), self.scatterer.facets().len());
        let (residuals, reason) =
            solution.map_or((Vec::new(), None), |solution| (solution.residuals, solution.reason));
        Solved { frequency, facets, solution: self.model.method.name(), residuals, reason }
    }

    /// What a second bounce would add, where errors are to be estimated; it is not asked of the
    /// runs that do so.
    fn first_residuals(&self, signals: &Signals<'_>) -> Result<Vec<f64>, Error> {
        if self.model.coarse.is_none() || !self.variant.name.is_empty() {
            return Ok(Vec::new());
        }
        let system =
            solving::lazy(self.model, self.scatterer, (self.band.wave, self.variant.shadow), &[], signals)?;
        let b = system.right_hand_side(&[self.first]);
        Ok(solving::bounced(&system, &b, 1, signals)?.residuals)
    }

    /// The sweeps of the receivers that ask for one.
    fn sweep(
        &self,
        system: Option<&System<'_>>,
        signals: &Signals<'_>,
        outcome: &mut Outcome,
    ) -> Result<(), Error> {
        let sweep = Sweep { task: *self, system };
        for (index, receiver) in self.model.receivers.iter().enumerate() {
            if let Places::Monostatic(angles) = &receiver.places {
                let (rows, worst, stated) = sweep.run(index, angles, signals)?;
                outcome.stated_errors.extend(stated);
                outcome.reciprocity.extend(Reciprocity::of(&rows));
                outcome.monostatic.extend(rows);
                outcome.solved.push(self.solved(worst));
            }
        }
        Ok(())
    }

    /// Fields at all receivers; what is left of the bounces is `residual`, where it is known.
    fn radiate(
        &self,
        system: Option<&System<'_>>,
        currents: &FacetCurrents,
        residual: Option<f64>,
        outcome: &mut Outcome,
    ) -> Result<(), Error> {
        let Some(system) = system else {
            let radiator = self.first.radiator(Sampling::Tolerance(TOLERANCE));
            return self.receive(&radiator, None, residual, outcome);
        };
        let all = Bounced::new(self.scatterer, self.first, currents);
        self.receive(&system.radiator(&all), Some(&all), residual, outcome)
    }

    /// `all` are the currents where there is more than one bounce.
    fn receive(
        &self,
        radiator: &Radiator<'_>,
        all: Option<&Bounced<'_>>,
        residual: Option<f64>,
        outcome: &mut Outcome,
    ) -> Result<(), Error> {
        let edges = self.edges(all)?;
        let small = edges.as_ref().map_or(0, EdgeCurrents::small);
        if small > 0 && self.variant.name.is_empty() {
            outcome.notes.push(format!(
                "{small} edges have no edge currents at {} MHz: they, or their faces, are below half a wavelength; method = \"efie\" has them",
                self.band.wave.frequency() / 1e6
            ));
        }
        let power = power(self.model, self.band, &|p| {
            near(radiator, edges.as_ref(), &[p]).ok().map(|fields| fields[0].e)
        });
        let far_of = |directions: &[Vec3]| self.far(radiator, all.is_none(), edges.as_ref(), directions);
        if self.variant.name.is_empty() && self.is_told_apart() {
            let facets = self.scatterer.facets().len() as f64;
            let solved = if all.is_some() { facets * facets } else { 0.0 };
            let edges = edges.as_ref().map_or(0, EdgeCurrents::len) as f64;
            let conductors = self.band.materials.iter().all(|material| *material == Material::Conductor);
            let balancing = Balancing {
                model: self.model,
                band: self.band,
                geometry: self.variant.geometry,
                elements: facets + 4.0 * edges,
                pairs: solved,
                power,
                absorbed: conductors.then_some(0.0),
            };
            let far = |u: &[Vec3]| {
                let far = far_of(u).map_err(|error| self.refused(&error))?;
                Ok(far.into_iter().map(|far| far.amplitude).collect())
            };
            outcome.balances.extend(balancing.balance(&far)?);
        }
        let stating = self.stating(radiator, all, residual)?;
        for (index, receiver) in self.model.receivers.iter().enumerate() {
            let refused = |error: WaveError| self.model.refused(&error, Some(receiver));
            let indicator = match &receiver.places {
                Places::Near { points, .. } => {
                    let scattered = near(radiator, edges.as_ref(), points).map_err(refused)?;
                    let rows = near_rows(self.model, self.band, index, points, &scattered);
                    outcome.near.extend(rows.map_err(refused)?);
                    let fields: Vec<ComplexVector> = scattered.iter().map(|field| field.e).collect();
                    let edge = |edges: &EdgeCurrents, p: Vec3| edges.fields(&[p])[0].e;
                    stating.as_ref().map(|stating| stating.indicator(points, &fields, &edge))
                }
                Places::Far(angles) => {
                    let directions = directions(angles);
                    let far = far_of(&directions).map_err(refused)?;
                    let rows = far.iter().zip(angles).enumerate();
                    outcome.far.extend(rows.map(|(i, (far, angles))| {
                        far_row((self.model, self.band, power), [index, i], *angles, far)
                    }));
                    let fields: Vec<ComplexVector> = far.iter().map(|far| far.amplitude).collect();
                    let edge = |edges: &EdgeCurrents, u: Vec3| edges.far_amplitude(u);
                    stating.as_ref().map(|stating| stating.indicator(&directions, &fields, &edge))
                }
                Places::Monostatic(_) => None,
            };
            if let (Some(indicator), Some(residual)) = (indicator, residual) {
                let frequency = self.band.wave.frequency();
                let relative = indicator.error() + residual;
                outcome.stated_errors.push(Estimated { receiver: index, frequency, relative });
            }
        }
        Ok(())
    }

    /// What the error is stated from: of conductors that are all closed, or all sheets, where the
    /// bounces are known.
    fn stating(
        &self,
        radiator: &Radiator<'_>,
        all: Option<&Bounced<'_>>,
        residual: Option<f64>,
    ) -> Result<Option<Stating>, Error> {
        let conductors = self.scatterer.check_conductor("").is_ok();
        if residual.is_none()
            || !self.is_told_apart()
            || !conductors
            || !self.variant.name.is_empty()
            || self.model.shadow == Shadow::Thesis
        {
            return Ok(None);
        }
        let refused = |error: WaveError| self.refused(&error);
        let inside =
            field_inside(self.scatterer, &self.band.wave, self.sources, radiator).map_err(refused)?;
        if let Some(inside) = inside {
            return Ok(Some(Stating::Inside { inside, equation: self.model.shadow.is_equation() }));
        }
        if self.scatterer.facets().iter().any(|facet| facet.kind == Kind::Closed) {
            return Ok(None);
        }
        if EdgeCurrents::predicted(self.scatterer, &self.band.wave) > MOST_ELEMENTS {
            return Ok(None);
        }
        let edges = self.known_edges(all)?;
        // Where no edge is one that the theory knows, nothing is.
        let known = !edges.is_empty() && edges.small() == 0;
        Ok(known.then_some(Stating::Edges { edges, added: self.model.edge_currents }))
    }

    /// Whether errors are stated of this frequency: of sweeps of many only the lowest and the
    /// highest, since one bounce takes less than its error.
    fn is_told_apart(&self) -> bool {
        let bands = &self.model.bands;
        let mut ends = [bands.first(), bands.last()].into_iter().flatten();
        bands.len() <= MOST_PICTURED || ends.any(|band| std::ptr::eq(band, self.band))
    }

    /// The far fields in some directions; of one bounce of plane waves in closed form.
    fn far(
        &self,
        radiator: &Radiator<'_>,
        one_bounce: bool,
        edges: Option<&EdgeCurrents>,
        directions: &[Vec3],
    ) -> Result<Vec<FarField>, WaveError> {
        let closed = if one_bounce { self.first.linear_phase_far_field(directions) } else { None };
        let mut far = closed.unwrap_or_else(|| radiator.far_field(directions))?;
        if let Some(edges) = edges {
            let add = |far: &mut FarField| far.amplitude += edges.far_amplitude(far.direction);
            far.par_iter_mut().for_each(add);
        }
        Ok(far)
    }

    /// The edge currents, where they are asked for; the magnetic form has none.
    fn edges(&self, all: Option<&Bounced<'_>>) -> Result<Option<EdgeCurrents>, Error> {
        if !self.model.edge_currents || self.variant.shadow == Shadow::Thesis {
            return Ok(None);
        }
        self.known_edges(all).map(Some)
    }

    fn known_edges(&self, all: Option<&Bounced<'_>>) -> Result<EdgeCurrents, Error> {
        let found = match all {
            Some(all) => EdgeCurrents::of_bounces(self.scatterer, self.band.wave, self.sources, all),
            None => EdgeCurrents::new(self.scatterer, self.band.wave, self.sources),
        };
        found.map_err(|error| self.refused(&error))
    }

    /// What is left of the bounces, relative to the first, where `last` is the last residual and
    /// several are summed: nothing for one bounce where there can be no second.
    pub(super) fn left(&self, last: Option<f64>, several: bool) -> Option<f64> {
        if !several && (self.is_flat() || self.all_closed()) { last.or(Some(0.0)) } else { last }
    }

    /// The same with other sources.
    pub(super) fn lit_by<'b>(&self, first: &'b PhysicalOptics<'b>, sources: &'b [&'b dyn Source]) -> Task<'b>
    where
        Self: 'b,
    {
        Task { first, sources, ..*self }
    }

    pub(super) fn wave(&self) -> Wave {
        self.band.wave
    }

    pub(super) fn shadow(&self) -> Shadow {
        self.variant.shadow
    }

    /// The far field towards u along θ̂ and φ̂, and the squares of its error (V²), where `residual`
    /// is known, and of itself.
    pub(super) fn echo(
        &self,
        u: Vec3,
        radiator: &Radiator<'_>,
        all: Option<&Bounced<'_>>,
        residual: Option<f64>,
    ) -> Result<Echo, Error> {
        let refused = |error: WaveError| self.refused(&error);
        let edges = self.edges(all)?;
        let back = self.far(radiator, all.is_none(), edges.as_ref(), &[u]).map_err(refused)?;
        let Some(back) = back.first() else { return Ok(([Complex64::ZERO; 2], (None, 0.0))) };
        let found = back.amplitude.norm_squared();
        let error = match (self.stating(radiator, all, residual)?, residual) {
            (Some(stating), Some(residual)) => {
                let edge = |edges: &EdgeCurrents, u: Vec3| edges.far_amplitude(u);
                let relative = stating.indicator(&[u], &[back.amplitude], &edge).error() + residual;
                let size = match stating {
                    Stating::Edges { .. } => found,
                    Stating::Inside { .. } => {
                        let far =
                            radiator.far_field(&even_directions(MEAN_FIELD_DIRECTIONS)).map_err(refused)?;
                        let sum: f64 = far.iter().map(|far| far.amplitude.norm_squared()).sum();
                        found.max(sum / far.len() as f64)
                    }
                };
                Some(relative * relative * size)
            }
            _ => None,
        };
        Ok((back.polar(), (error, found)))
    }

    fn all_closed(&self) -> bool {
        self.scatterer.facets().iter().all(|facet| facet.kind == Kind::Closed)
    }

    /// Whether all facets are in one plane.
    fn is_flat(&self) -> bool {
        in_one_plane(self.scatterer.occluders().patches(), self.scatterer.extent())
    }
}

/// A row a point, with the fields of the sources.
pub(super) fn near_rows(
    model: &Model,
    band: &Band,
    receiver: usize,
    points: &[Vec3],
    scattered: &[Field],
) -> Result<Vec<WaveRow>, WaveError> {
    let sources = model.sources();
    let row = |(index, (&p, scattered)): (usize, (&Vec3, &Field))| {
        let incident = incident(&sources, &band.wave, p);
        if !incident.is_finite() {
            return Err(WaveError::InSource { receiver: index });
        }
        Ok(WaveRow {
            receiver,
            index,
            position: p.to_array(),
            frequency: band.wave.frequency(),
            incident: pair(incident.e, incident.h),
            scattered: pair(scattered.e, scattered.h),
        })
    };
    points.par_iter().zip(scattered).enumerate().map(row).collect()
}

/// A row of a direction: numbers of receiver and direction, and its angles, degrees; `power` is
/// what located sources supply, W.
pub(super) fn far_row(
    (model, band, power): (&Model, &Band, Option<f64>),
    at: [usize; 2],
    angles: [f64; 2],
    far: &FarField,
) -> FarRow {
    let [theta, phi] = far.polar();
    let section = |wave: fredholm_waves::source::PlaneWave| {
        [theta, phi].map(|part| cross_section(part, wave.amplitude()))
    };
    FarRow {
        receiver: at[0],
        index: at[1],
        theta_degrees: angles[0],
        phi_degrees: angles[1],
        frequency: band.wave.frequency(),
        amplitude: [theta.re, theta.im, phi.re, phi.im],
        cross_section: model.plane_wave.map(section),
        total: of_sources(model, band, far.direction).map(|sources| {
            let all = FarField { amplitude: far.amplitude + sources, ..*far };
            let [theta, phi] = all.polar();
            let per_angle = all.amplitude.norm_squared() / (2.0 * IMPEDANCE);
            let gain = power.map_or(f64::NAN, |power| 4.0 * std::f64::consts::PI * per_angle / power);
            FarTotal { amplitude: [theta.re, theta.im, phi.re, phi.im], gain }
        }),
    }
}

/// The unit vectors of directions given as θ and φ, degrees.
pub(super) fn directions(angles: &[[f64; 2]]) -> Vec<Vec3> {
    angles.iter().map(|&[theta, phi]| direction(theta, phi)).collect()
}

/// The scattered fields at some points.
fn near(
    radiator: &Radiator<'_>,
    edges: Option<&EdgeCurrents>,
    points: &[Vec3],
) -> Result<Vec<Field>, WaveError> {
    let mut scattered = radiator.fields(points)?;
    if let Some(edges) = edges {
        scattered.iter_mut().zip(edges.fields(points)).for_each(|(field, more)| *field += more);
    }
    Ok(scattered)
}

pub(super) fn current(current: &Current) -> [f64; 12] {
    pair(current.j, current.m)
}

/// Components of two vectors, real parts first.
pub(super) fn pair(a: ComplexVector, b: ComplexVector) -> [f64; 12] {
    let part = |i: usize| if i < 6 { a.components()[i / 2] } else { b.components()[i / 2 - 3] };
    std::array::from_fn(|i| if i.is_multiple_of(2) { part(i).re } else { part(i).im })
}
