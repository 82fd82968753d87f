//! Conductors by boundary elements: the electric and the combined field integral equation with
//! Rao–Wilton–Glisson functions on triangles (crate `moments`, docs/moments.md).

use std::slice;

use fredholm_linop::{LinearOperator, MultiVector};
use fredholm_mesh::Vec3;
use fredholm_moments::{Basis, Conductor, Currents, Equation, MomentsError, Surface};
use fredholm_report::{MonostaticRow, WaveCurrents};
use fredholm_scene::ErrorKind as SceneFault;
use fredholm_scene::waves::{About, Places};
use fredholm_waves::material::Material;
use fredholm_waves::{Complex64, Current, FarField, Field, Indicator, Kind, Source, even_directions};

use super::balance::{Balancing, Reciprocity, power};
use super::compute::{current, directions, far_row, near_rows};
use super::estimate::Estimated;
use super::geometry::Geometry;
use super::model::{Band, Receiver};
use super::monostatic::plane_waves;
use super::record::Solved;
use super::solving::{Solution, solved};
use super::{Method, Model, Outcome};
use crate::error::Error;
use crate::memory::Plan;
use crate::prediction::of_threads;
use crate::problem::scene_failure;
use crate::stages::{Signals, Stages};

/// Relative error of the integrals over each pair of triangles, below that of usual meshes.
const INTEGRALS: f64 = 1e-3;
/// Directions in which the mean scattered field is taken that errors are compared with.
const DIRECTIONS: usize = 200;
/// Copies of the right-hand sides that a solver holds.
const VECTORS: u128 = 3;

/// The functions on the triangles of a mesh.
pub(super) fn basis(model: &Model, geometry: &Geometry) -> Result<Basis, Error> {
    let surface = Surface::from_mesh(&geometry.mesh).map_err(|error| refused(model, &error))?;
    Basis::new(surface).map_err(|error| refused(model, &error))
}

/// What the library of boundary elements says.
fn refused(model: &Model, error: &MomentsError) -> Error {
    let help = error.help().unwrap_or("correct the surfaces");
    scene_failure(model.scene.error(About::Method, SceneFault::Geometry, error.to_string(), help))
}

/// Computes everything that the model asks for on one of its meshes.
pub(super) fn run(
    model: &Model,
    (geometry, name): (&Geometry, &str),
    equation: Equation,
    stages: &mut Stages,
) -> Result<Outcome, Error> {
    let basis = basis(model, geometry)?;
    let first = name.is_empty();
    let edge = longest_edge(geometry, &basis, equation).filter(|_| first);
    let mut outcome = Outcome::default();
    for band in &model.bands {
        check_conductor(model, band)?;
        let name = format!("{} MHz{name}", band.wave.frequency() / 1e6);
        Task { model, geometry, basis: &basis, band, equation, edge, first }.carry_out(
            &name,
            stages,
            &mut outcome,
        )?;
    }
    Ok(outcome)
}

/// The longest edge of sheets, m, which tells the error of the electric equation.
fn longest_edge(geometry: &Geometry, basis: &Basis, equation: Equation) -> Option<f64> {
    let known = equation == Equation::Electric && geometry.kinds().iter().all(|kind| *kind == Kind::Sheet);
    known.then(|| basis.topology().longest_edge(basis.surface()))
}

fn check_conductor(model: &Model, band: &Band) -> Result<(), Error> {
    let other = |&material: &usize| band.materials[material] != Material::Conductor;
    let Some(surface) = model.scene.materials_of_surfaces().position(|material| other(&material)) else {
        return Ok(());
    };
    let what = format!("{} knows perfect conductors only", model.method_name());
    let help = "leave the material out, or take method = \"physical-optics\"";
    Err(scene_failure(model.scene.error(About::Surface(surface), SceneFault::Value, what, help)))
}

/// One frequency.
struct Task<'a> {
    model: &'a Model,
    geometry: &'a Geometry,
    basis: &'a Basis,
    band: &'a Band,
    equation: Equation,
    /// The longest edge, m, where the error is stated from it.
    edge: Option<f64>,
    /// Whether this is the run itself, not one that errors are estimated from.
    first: bool,
}

impl Task<'_> {
    fn carry_out(&self, name: &str, stages: &mut Stages, outcome: &mut Outcome) -> Result<(), Error> {
        let signals = &stages.signals();
        let conductor = Conductor::new(self.basis, self.band.wave, self.equation, INTEGRALS)
            .map_err(|error| refused(self.model, &error))?;
        self.admit(&conductor, signals)?;
        let coupling = stages.run(&format!("coupling at {name}"), || {
            conductor.operator().coupling().map_err(|error| refused(self.model, &error))
        })?;
        if self.model.has_bistatic() {
            let sources = self.model.sources();
            let b = conductor.right_hand_side(&[&sources]);
            let solution =
                stages.run(&format!("currents at {name}"), || self.solve(&coupling, &b, signals))?;
            let currents = Currents::new(self.basis, self.band.wave, &solution.x.lane(0), None);
            let error = self.error(&currents, solution.residuals.last())?;
            stages.run(&format!("fields at {name}"), || self.receive(&currents, error.as_ref(), outcome))?;
            let values = self.on_facets(&currents).iter().map(current).collect();
            outcome.currents.push(WaveCurrents { name: name.to_owned(), values });
            outcome.solved.push(self.record(solution));
        }
        for (index, receiver) in self.model.receivers.iter().enumerate() {
            if let Places::Monostatic(angles) = &receiver.places {
                let sweep = || self.sweep(&conductor, &coupling, (index, angles), signals);
                let (rows, solution) = stages.run(&format!("sweep at {name}"), sweep)?;
                outcome.reciprocity.extend(Reciprocity::of(&rows));
                outcome.monostatic.extend(rows);
                outcome.solved.push(self.record(solution));
            }
        }
        Ok(())
    }

    /// Refuses a matrix that does not fit, before it is made.
    fn admit(&self, conductor: &Conductor<'_>, signals: &Signals<'_>) -> Result<(), Error> {
        let unknowns = self.basis.len();
        let lanes = self.lanes() as u128;
        let Method::Solver { solver, .. } = &self.model.method else { return Ok(()) };
        let plan: Plan = self
            .model
            .plan
            .clone()
            .hold(format!("the matrix of {unknowns} unknowns"), conductor.operator().dense_bytes().into())
            .hold("the solver", solver.bytes(unknowns, self.lanes()).into())
            .hold("the right-hand sides", VECTORS * lanes * unknowns as u128 * size_of::<Complex64>() as u128)
            .aside(of_threads(solver.addresses()));
        plan.admit(self.model.limit, "take longer edges, or method = \"physical-optics\"")?;
        plan.tell(self.model.limit, signals.watch);
        Ok(())
    }

    /// Most right-hand sides that are solved for at once.
    fn lanes(&self) -> usize {
        let of = |receiver: &Receiver| match &receiver.places {
            Places::Monostatic(angles) => 2 * angles.len(),
            _ => 1,
        };
        self.model.receivers.iter().map(of).max().unwrap_or(1)
    }

    fn solve(
        &self,
        coupling: &dyn LinearOperator<Complex64>,
        b: &MultiVector<Complex64>,
        signals: &Signals<'_>,
    ) -> Result<Solution, Error> {
        solved(coupling, b, &self.model.method, signals)
    }

    fn record(&self, solution: Solution) -> Solved {
        let (frequency, facets) = (self.band.wave.frequency(), self.geometry.mesh.len());
        Solved { frequency, facets, residuals: solution.residuals, reason: solution.reason }
    }

    /// The expected error of the scattered field, where it is known.
    fn error(&self, currents: &Currents<'_>, residual: Option<&f64>) -> Result<Option<MeanError>, Error> {
        let (Some(edge), Some(residual)) = (self.edge, residual) else { return Ok(None) };
        let relative = Indicator::BoundaryElements(edge / self.band.wave.wavelength()).error() + residual;
        let far = self.far(currents, &even_directions(DIRECTIONS))?;
        let mean = far.iter().map(|far| far.amplitude.norm_squared()).sum::<f64>() / far.len() as f64;
        let Some(bounds) = self.geometry.mesh.bounds() else { return Ok(None) };
        let centre = 0.5 * (bounds.min + bounds.max);
        Ok(Some(MeanError { relative, mean: mean.sqrt(), centre, radius: bounds.max.distance(centre) }))
    }

    /// Fields at all receivers of the scene's sources.
    fn receive(
        &self,
        currents: &Currents<'_>,
        error: Option<&MeanError>,
        outcome: &mut Outcome,
    ) -> Result<(), Error> {
        let power = power(self.model, self.band, &|p| currents.fields(&[p]).ok().map(|fields| fields[0].e));
        if self.first {
            let unknowns = self.basis.len() as f64;
            let balancing = Balancing {
                model: self.model,
                band: self.band,
                geometry: self.geometry,
                elements: unknowns,
                // An entry of the matrix takes some ten times as long as a direction of an element.
                pairs: 10.0 * unknowns * unknowns,
                power,
            };
            let far = |u: &[Vec3]| Ok(self.far(currents, u)?.into_iter().map(|far| far.amplitude).collect());
            outcome.balances.extend(balancing.balance(&far)?);
        }
        for (index, receiver) in self.model.receivers.iter().enumerate() {
            let relative = match &receiver.places {
                Places::Near { points, .. } => {
                    let scattered = self.near(currents, index, points)?;
                    let rows = near_rows(self.model, self.band, index, points, &scattered);
                    let rows = rows.map_err(|error| self.model.refused(&error, Some(receiver)))?;
                    outcome.near.extend(rows);
                    let squares = scattered.iter().map(|field| field.e.norm_squared());
                    error.map(|error| {
                        error.relative(squares, points.iter().map(|&p| error.centre.distance(p)))
                    })
                }
                Places::Far(angles) => {
                    let far = self.far(currents, &directions(angles))?;
                    let rows = far.iter().zip(angles).enumerate();
                    outcome.far.extend(rows.map(|(i, (far, angles))| {
                        far_row((self.model, self.band, power), [index, i], *angles, far)
                    }));
                    let squares = far.iter().map(|far| far.amplitude.norm_squared());
                    error.map(|error| error.relative_far(squares))
                }
                Places::Monostatic(_) => None,
            };
            if let Some(relative) = relative {
                let frequency = self.band.wave.frequency();
                outcome.stated_errors.push(Estimated { receiver: index, frequency, relative });
            }
        }
        Ok(())
    }

    fn near(&self, currents: &Currents<'_>, receiver: usize, points: &[Vec3]) -> Result<Vec<Field>, Error> {
        currents.fields(points).map_err(|error| {
            let (about, what) = (About::Receiver(receiver), error.to_string());
            let help = error.help().unwrap_or("move the points");
            scene_failure(self.model.scene.error(about, SceneFault::Geometry, what, help))
        })
    }

    fn far(&self, currents: &Currents<'_>, directions: &[Vec3]) -> Result<Vec<FarField>, Error> {
        currents.far_field(directions).map_err(|error| refused(self.model, &error))
    }

    /// What plane waves from these directions send back, all solved for together.
    fn sweep(
        &self,
        conductor: &Conductor<'_>,
        coupling: &dyn LinearOperator<Complex64>,
        (receiver, angles): (usize, &[[f64; 2]]),
        signals: &Signals<'_>,
    ) -> Result<(Vec<MonostaticRow>, Solution), Error> {
        let directions = directions(angles);
        let waves = plane_waves(&directions).map_err(|error| self.model.refused(&error, None))?;
        let sources: Vec<&dyn Source> = waves.iter().map(|wave| wave as &dyn Source).collect();
        let lanes: Vec<&[&dyn Source]> = sources.iter().map(slice::from_ref).collect();
        let solution = self.solve(coupling, &conductor.right_hand_side(&lanes), signals)?;
        let mut rows = Vec::with_capacity(angles.len());
        for (index, (&[theta_degrees, phi_degrees], u)) in angles.iter().zip(&directions).enumerate() {
            signals.check()?;
            let mut scattering = [[0.0; 2]; 4];
            for along in 0..2 {
                let x = solution.x.lane(2 * index + along);
                let currents = Currents::new(self.basis, self.band.wave, &x, None);
                for (part, far) in
                    self.far(&currents, slice::from_ref(u))?.iter().flat_map(FarField::polar).enumerate()
                {
                    scattering[2 * along + part] = [far.re, far.im];
                }
            }
            let frequency = self.band.wave.frequency();
            rows.push(MonostaticRow { receiver, index, theta_degrees, phi_degrees, frequency, scattering });
        }
        Ok((rows, solution))
    }

    /// J at the centres of the facets: of a quadrilateral the mean of its two triangles.
    fn on_facets(&self, currents: &Currents<'_>) -> Vec<Current> {
        let mut next = 0;
        let mut facet = |sides: usize| {
            let count = sides - 2;
            let triangles = next..next + count;
            next += count;
            let sum = triangles
                .map(|triangle| currents.electric(triangle))
                .fold(fredholm_waves::ComplexVector::ZERO, |sum, j| sum + j);
            Current { j: sum * (1.0 / count as f64), ..Current::default() }
        };
        self.geometry.mesh.patches().map(|patch| facet(patch.sides())).collect()
    }
}

/// The error of a scattered field, spread evenly over all directions.
///
/// What was measured is the error over the whole sphere, relative to the field there. Where a
/// receiver gets less than the mean field, the error is a larger part of it.
struct MeanError {
    /// Over all directions.
    relative: f64,
    /// Root mean square of the far amplitude over all directions, V.
    mean: f64,
    /// Middle of the body, m.
    centre: Vec3,
    /// Radius of a ball that holds the body, m: fields within are not expected to be larger.
    radius: f64,
}

impl MeanError {
    /// The error relative to the field at some points, from |E|² (V²/m²) and the distances from the
    /// middle, m.
    fn relative(&self, squares: impl Iterator<Item = f64>, distances: impl Iterator<Item = f64>) -> f64 {
        let mean = |distance: f64| self.mean / distance.max(self.radius);
        self.over(squares, distances.map(|distance| mean(distance).powi(2)).sum())
    }

    /// The same in directions, from the squares of the amplitudes, V².
    fn relative_far(&self, squares: impl ExactSizeIterator<Item = f64>) -> f64 {
        let count = squares.len() as f64;
        self.over(squares, count * self.mean * self.mean)
    }

    fn over(&self, squares: impl Iterator<Item = f64>, expected: f64) -> f64 {
        let found: f64 = squares.sum();
        if found > 0.0 { self.relative * (expected / found).sqrt().max(1.0) } else { self.relative }
    }
}
