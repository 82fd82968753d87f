//! What a scene of waves and its mesh are, and what its fields will take; nothing is solved.

use std::path::{Path, PathBuf};

use fredholm_linop::{Dense, Watch};
use fredholm_scene::Finding;
use fredholm_scene::waves::Receiver;
use fredholm_waves::{Complex64, System, Wave, WaveError};

use super::{CouplingStorage, Model, WaveOptions, forecast, galerkin, solving};
use crate::error::Error;
use crate::memory::{Limit, Plan};
use crate::size::Bytes;
use crate::stages::Stages;

/// A valid scene of waves, its mesh, and what its fields will take.
#[derive(Debug)]
pub struct CheckedWaves {
    /// The scene file.
    pub path: PathBuf,
    /// What the scene is called.
    pub title: Option<String>,
    /// The method as scenes name it, with what blocks waves where that is a choice.
    pub method: String,
    /// How many bounces are summed, or the solver.
    pub solution: String,
    /// The frequencies, Hz.
    pub frequencies: Vec<f64>,
    /// Facets.
    pub facets: usize,
    /// Surfaces.
    pub surfaces: usize,
    /// The coupling, where there is more than one bounce.
    pub coupling: Option<CheckedCoupling>,
    /// Points and directions of all receivers.
    pub places: u128,
    /// Memory by use, the coupling and its solver included.
    pub plan: Plan,
    /// Memory allowed.
    pub limit: Limit,
    /// Seconds that everything takes one thread, from a run on fewer facets; none where nothing is
    /// known.
    pub seconds: Option<f64>,
    /// Threads.
    pub threads: usize,
    /// What the pieces of the surfaces are, and what is remarkable about them.
    pub findings: Vec<Finding>,
    /// What is allowed, but probably not meant.
    pub warnings: Vec<String>,
}

/// The coupling of the facets or edges of a scene of waves.
#[derive(Clone, Copy, Debug)]
pub struct CheckedCoupling {
    /// Unknowns.
    pub unknowns: usize,
    /// Bytes of its matrix if that were stored whole.
    pub whole: Bytes,
    /// How a run holds it, unless an option says otherwise.
    pub storage: CouplingStorage,
}

/// Validates a scene of waves, tells what its mesh is, and predicts what its fields will take.
///
/// # Errors
/// What is wrong with the scene, with line and column.
pub fn check_waves(
    scene: impl AsRef<Path>,
    asked: &WaveOptions,
    watch: &dyn Watch,
) -> Result<CheckedWaves, Error> {
    check_waves_of_file(scene.as_ref(), asked, watch)
}

/// [`check_waves`], compiled once and not for each kind of source.
fn check_waves_of_file(scene: &Path, asked: &WaveOptions, watch: &dyn Watch) -> Result<CheckedWaves, Error> {
    let mut stages = Stages::new(watch);
    let mut model = stages.run("scene", || Model::load(scene, asked.memory))?;
    let (plan, coupling) = stages.run("mesh", || admitted(&model))?;
    let findings = stages.run("report", || Ok(model.scene.findings()))?;
    let checked = CheckedWaves {
        path: model.path().to_owned(),
        title: model.scene.title().map(str::to_owned),
        method: model.method_in_words(),
        solution: model.method.name(),
        frequencies: model.scene.waves().iter().map(Wave::frequency).collect(),
        facets: model.geometry.mesh.len(),
        surfaces: model.geometry.mesh.surfaces().len(),
        coupling,
        places: model.scene.receivers().iter().map(Receiver::count).sum(),
        plan,
        limit: model.limit,
        seconds: None,
        threads: rayon::current_num_threads(),
        findings,
        warnings: model.warnings.clone(),
    };
    // A trial on fewer facets might hold its coupling otherwise.
    model.storage = coupling.map(|coupling| coupling.storage);
    let unknowns = coupling.map(|coupling| coupling.unknowns);
    // Trials on coarse meshes are too small for multipoles, whose time grows in another way.
    let by_multipoles = model.storage == Some(CouplingStorage::Multipole);
    let seconds = stages.run("sample", || {
        Ok(if by_multipoles { None } else { forecast::seconds(&mut model, unknowns, watch) })
    })?;
    stages.check()?;
    Ok(CheckedWaves { seconds, ..checked })
}

/// The memory of a run, and the coupling, where there is one, of a scatterer that the method
/// admits at all frequencies.
fn admitted(model: &Model) -> Result<(Plan, Option<CheckedCoupling>), Error> {
    let coupling = |unknowns, storage| {
        let whole = Bytes(Dense::<Complex64>::bytes(unknowns).into());
        CheckedCoupling { unknowns, whole, storage }
    };
    if let Some(equations) = model.galerkin {
        let (plan, storage, unknowns) = galerkin::plan(model, equations)?;
        return Ok((plan, Some(coupling(unknowns, storage))));
    }
    let refused = |error: WaveError| model.refused(&error, None);
    let mut most = (model.plan.clone(), None);
    for (i, band) in model.bands.iter().enumerate() {
        let scatterer = model.geometry.scatterer(&band.materials).map_err(refused)?;
        model.shadow.check(&scatterer).map_err(refused)?;
        if !model.is_closed_form() {
            scatterer.check_resolution(&band.wave).map_err(refused)?;
        }
        let (plan, storage) = solving::plan(model, &scatterer, band.wave)?;
        // Frequencies come one after the other: the one that holds most counts.
        if i == 0 || plan.peak().0 > most.0.peak().0 {
            most = (plan, storage.map(|storage| coupling(System::unknowns(&scatterer), storage)));
        }
    }
    Ok(most)
}
