//! From a file to patches with rows, that fit the memory.

use std::fmt::Display;
use std::sync::Arc;

use fredholm_coupling::form_factor::PairIntegrator;
use fredholm_coupling::{Receiver, Targets, sky};
use fredholm_mesh::{Bounds, Patch};
use fredholm_scene::{Geometry, Rows, Surfaces};
use fredholm_visibility::Occluders;

use super::SKY;
use super::method::{BUDGET, Chosen};
use super::options::{Settings, ViewFactorOptions};
use super::plan::{help, plan};
use crate::error::{Error, ErrorKind};
use crate::memory::Plan;
use crate::options::{SceneSource, admit_file};
use crate::problem::scene_failure;
use crate::stages::Stages;

/// Patches of the sky.
const SKY_PATCHES: usize = 6;

/// What the matrix is computed of.
pub(super) struct Problem {
    pub(super) geometry: Geometry,
    pub(super) options: Settings,
    pub(super) rows: Rows,
    pub(super) plan: Plan,
    pub(super) occluders: Occluders,
    pub(super) receivers: Vec<Receiver>,
    /// Another method than the fast assembly.
    pub(super) method: Option<Chosen>,
    surfaces: Surfaces,
    sky: Vec<Patch>,
}

impl Problem {
    /// Reads and meshes; refuses before memory is taken what does not fit.
    pub(super) fn load(asked: &ViewFactorOptions, stages: &mut Stages) -> Result<Self, Error> {
        let method = method(asked)?;
        admit_file(asked.input.path(), asked.memory)?;
        let geometry = stages.run("geometry", || geometry(&asked.input))?;
        let options = Settings::new(asked, &geometry, method.as_ref());
        let more = if options.sky { SKY_PATCHES } else { 0 };
        let count = usize::try_from(geometry.predicted_elements()).unwrap_or(usize::MAX).saturating_add(more);
        // The number of rows is not known before the mesh; it is at least 1.
        let admit =
            |plan: &Plan, stages: &Stages| stages.admit(plan, options.memory_limit(), &help(&options));
        admit(&plan(count, 1, &options), stages)?;
        let surfaces = stages.run("mesh", || geometry.surfaces().map_err(scene_failure))?;
        let rows = with_sky(surfaces.rows(options.by()), more);
        let plan = plan(rows.row_of.len(), rows.names.len(), &options);
        admit(&plan, stages)?;
        let receivers = asked.points.receivers();
        let sky = if options.sky { sky_around(&surfaces, &receivers, asked)? } else { Vec::new() };
        let prepare = || Occluders::new(surfaces.mesh.occluders()).map_err(|error| named(asked, error));
        let occluders = stages.run("visibility", prepare)?;
        Ok(Self { geometry, options, rows, plan, occluders, receivers, method, surfaces, sky })
    }

    /// The patches, those of the sky last.
    pub(super) fn patches(&self) -> impl Iterator<Item = &Patch> {
        self.surfaces.mesh.patches().chain(&self.sky)
    }

    /// What computes the form factors between surfaces.
    pub(super) fn integrator(&self) -> PairIntegrator<'_> {
        self.budgeted(PairIntegrator::new(
            self.surfaces.mesh.patches(),
            &self.occluders,
            self.options.tolerance,
        ))
    }

    /// With a budget for rows, where that is asked for.
    fn budgeted<'a>(&self, pairs: PairIntegrator<'a>) -> PairIntegrator<'a> {
        if self.options.method == BUDGET { pairs.with_row_budget() } else { pairs }
    }

    /// The elements of the surfaces.
    pub(super) fn elements(&self) -> Vec<&Patch> {
        self.surfaces.mesh.patches().collect()
    }

    /// An element by its number and its row.
    pub(super) fn describe(&self, element: usize) -> String {
        format!("element {element} (`{}`)", self.rows.names[self.rows.row_of[element]])
    }

    /// What computes the form factors to the sky, where there is one: the patches of the sky come
    /// last.
    pub(super) fn sky_integrator(&self) -> Option<PairIntegrator<'_>> {
        let pairs = || PairIntegrator::new(self.patches(), &self.occluders, self.options.tolerance);
        let integrator = || self.budgeted(pairs());
        (!self.sky.is_empty()).then(integrator)
    }

    /// The tolerance asked of a pair, or of a row, where the method has one.
    pub(super) fn asked(&self) -> Option<f64> {
        match &self.method {
            None => Some(self.options.tolerance),
            Some(method) => method.tolerance(),
        }
    }

    /// Rows of the elements of the surfaces.
    pub(super) fn row_of(&self) -> &[usize] {
        &self.rows.row_of[..self.surfaces.mesh.len()]
    }

    /// What the points look at.
    pub(super) fn targets<'a>(&'a self, patches: &'a [&'a Patch]) -> Targets<'a> {
        Targets {
            patches,
            row_of: &self.rows.row_of,
            rows: self.rows.names.len(),
            occluders: &self.occluders,
        }
    }

    /// Areas of the rows, m².
    pub(super) fn areas(&self) -> Vec<f64> {
        self.per_row(self.patches().map(Patch::area))
    }

    /// Sums of values of the elements over the rows; elements of the sky may be left out.
    pub(super) fn per_row(&self, values: impl Iterator<Item = f64>) -> Vec<f64> {
        let mut sums = vec![0.0; self.rows.names.len()];
        self.rows.row_of.iter().zip(values).for_each(|(&row, value)| sums[row] += value);
        sums
    }

    /// Number of rows without that of the sky, which is the last.
    pub(super) fn surface_rows(&self) -> usize {
        self.rows.names.len() - usize::from(!self.sky.is_empty())
    }

    /// Whether every element of the surfaces is a row.
    pub(super) fn is_unmerged(&self) -> bool {
        self.surface_rows() == self.row_of().len()
    }
}

fn geometry(input: &SceneSource) -> Result<Geometry, Error> {
    match input {
        SceneSource::File(path) => Geometry::load(path).map_err(scene_failure),
        SceneSource::Scene(scene) => Ok(Geometry::from(Arc::clone(scene))),
    }
}

/// The method asked for. A tolerance that nothing would look at is refused.
fn method(asked: &ViewFactorOptions) -> Result<Option<Chosen>, Error> {
    let chosen = Chosen::new(&asked.method, asked.setting.as_deref(), asked.tolerance)?;
    let unread = asked.tolerance.is_some() && !asked.sky;
    if chosen.as_ref().is_some_and(|method| unread && method.tolerance().is_none()) {
        let text = format!("--tolerance: the method {} has none; give its --setting", asked.method);
        return Err(Error::new(ErrorKind::Input, text));
    }
    Ok(chosen)
}

/// Adds the row of the sky, which is black.
fn with_sky(mut rows: Rows, patches: usize) -> Rows {
    if patches > 0 {
        let row = rows.names.len();
        rows.row_of.extend(std::iter::repeat_n(row, patches));
        rows.names.push(SKY.to_owned());
        rows.emissivity.iter_mut().for_each(|emissivity| emissivity.push(1.0));
    }
    rows
}

/// The sky around the surfaces and the points.
fn sky_around(
    surfaces: &Surfaces,
    receivers: &[Receiver],
    asked: &ViewFactorOptions,
) -> Result<Vec<Patch>, Error> {
    let corners = surfaces.mesh.bounds().into_iter().flat_map(|bounds| [bounds.min, bounds.max]);
    let bounds = Bounds::around(corners.chain(receivers.iter().map(|receiver| receiver.point)));
    bounds.map_or_else(|| Ok(Vec::new()), |bounds| sky(bounds).map_err(|error| named(asked, error)))
}

fn named(asked: &ViewFactorOptions, error: impl Display) -> Error {
    Error::new(ErrorKind::Input, format!("{}: {error}", asked.input.path().display()))
}
