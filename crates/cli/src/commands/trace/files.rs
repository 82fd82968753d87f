//! The files of a traced run.

use std::collections::BTreeMap;
use std::io;
use std::path::Path;

use fredholm_montecarlo::State;
use fredholm_report::{
    Counts, FaceEstimates, Field, ReportError, RunRecord, render, write_atomically, write_face_estimates,
    write_run,
};
use serde_json::Value;

use super::InForce;
use crate::commands::solve::{report_failure, view_of};
use crate::failure::Failure;
use crate::memory;
use crate::stages::Stages;
use crate::stochastic::Ground;

/// What `--continue` reads.
pub(super) const STATE: &str = "trace.json";

/// Everything that is worth knowing of a traced run.
pub(super) fn record(
    ground: &Ground,
    state: &State,
    options: &InForce<'_>,
    reason: String,
    stages: &Stages,
) -> RunRecord {
    let (scene, mesh) = (&ground.scene, &ground.mesh);
    RunRecord {
        version: env!("CARGO_PKG_VERSION").to_owned(),
        scene: scene.path().display().to_string(),
        scene_sha256: scene.sha256().to_owned(),
        options: serde_json::to_value(options).unwrap_or(Value::Null),
        bands: scene.bands().to_vec(),
        counts: Counts {
            surfaces: mesh.surfaces().len() as u64,
            faces: mesh.faces().len() as u64,
            elements: mesh.len() as u64,
            occluders: mesh.occluders().len() as u64,
            bands: scene.bands().len() as u64,
            ..Counts::default()
        },
        timings: stages.timings().to_vec(),
        peak_memory_bytes: memory::peak().and_then(|peak| u64::try_from(peak.0).ok()),
        means: "random paths; standard errors in faces.csv".to_owned(),
        solver: state.method.clone(),
        work: work(state),
        stop_reason: reason,
        warnings: ground.warnings.clone(),
        partial: stages.interrupt.requested(),
        ..RunRecord::default()
    }
}

fn work(state: &State) -> BTreeMap<String, u64> {
    let counters = [
        ("batches", state.batches()),
        ("samples_of_a_batch", state.samples.into()),
        ("paths", state.paths),
        ("rays", state.rays),
    ];
    counters.map(|(name, count)| (name.to_owned(), count)).into()
}

/// Writes the files; `run.json` last.
pub(super) fn write(
    folder: &Path,
    ground: &Ground,
    state: &State,
    record: &RunRecord,
) -> Result<(), Failure> {
    let (mesh, bands) = (&ground.mesh, ground.scene.bands());
    let errors = state.groups.standard_errors();
    let faces = FaceEstimates::new(mesh, bands, state.groups.mean(), &errors).map_err(report_failure)?;
    let (rho, exitance) = (ground.scene.reflectance(mesh), ground.scene.exitance(mesh));
    let irradiance = state.patches.mean();
    let radiosity: Vec<f64> =
        irradiance.iter().zip(&rho).zip(&exitance).map(|((e, rho), m)| m + rho * e).collect();
    let field = Field::new(mesh, bands, irradiance, &radiosity)
        .and_then(|field| field.with_exitance(&exitance))
        .map_err(report_failure)?;
    let view = view_of(ground.scene.camera(), &field);
    let picture = render(&field, &view.camera, view.exposure).map_err(report_failure)?;
    let write = || -> Result<(), ReportError> {
        write_atomically(&folder.join("faces.csv"), |out| write_face_estimates(&faces, out))?;
        write_atomically(&folder.join("image.png"), |out| picture.write_png(out))?;
        write_atomically(&folder.join(STATE), |out| {
            serde_json::to_writer(out, state).map_err(io::Error::from)
        })?;
        write_atomically(&folder.join("run.json"), |out| write_run(record, out))
    };
    prepare(folder)?;
    write().map_err(report_failure)
}

/// Makes the folder and removes the mark of completeness of an older result.
pub(super) fn prepare(folder: &Path) -> Result<(), Failure> {
    let failed = |source| report_failure(ReportError::Write { path: folder.to_owned(), source });
    std::fs::create_dir_all(folder).map_err(failed)?;
    match std::fs::remove_file(folder.join("run.json")) {
        Err(error) if error.kind() != io::ErrorKind::NotFound => Err(failed(error)),
        _ => Ok(()),
    }
}
