//! The files of a traced run.

use std::collections::BTreeMap;

use fredholm_montecarlo::State;
use fredholm_report::{
    Counts, FaceEstimates, Field, PIXELS, Picture, Pixels, REPORT, ReportError, ReportModel, ReportPage,
    ResultFolder, RunRecord, TRACE_STATE, View, face_quantities, render, write_face_estimates, write_run,
};
use serde_json::Value;

use super::InForce;
use super::saved::Origin;
use crate::error::Error;
use crate::memory;
use crate::record::received;
use crate::solve::{report_failure, title, view_of};
use crate::stages::Stages;
use crate::stochastic::Ground;

fn work(state: &State) -> BTreeMap<String, u64> {
    let counters = [
        ("batches", state.batches()),
        ("samples_of_a_batch", state.samples.into()),
        ("paths", state.paths),
        ("rays", state.rays),
    ];
    counters.map(|(name, count)| (name.to_owned(), count)).into()
}

/// The estimates as a field on the mesh, to be looked at and written.
pub(super) struct Estimates<'a> {
    ground: &'a Ground,
    state: &'a State,
    radiosity: Vec<f64>,
    exitance: Vec<f64>,
}

impl<'a> Estimates<'a> {
    pub(super) fn new(ground: &'a Ground, state: &'a State) -> Self {
        let (rho, exitance) = (ground.scene.reflectance(&ground.mesh), ground.scene.exitance(&ground.mesh));
        let reflected = state.patches.mean().iter().zip(&rho).zip(&exitance);
        let radiosity = reflected.map(|((e, rho), m)| m + rho * e).collect();
        Self { ground, state, radiosity, exitance }
    }

    fn field(&self) -> Result<Field<'_>, Error> {
        let (mesh, bands) = (&self.ground.mesh, self.ground.scene.bands());
        Field::new(mesh, bands, self.state.patches.mean(), &self.radiosity)
            .and_then(|field| field.with_exitance(&self.exitance))
            .map_err(report_failure)
    }

    /// Everything that is worth knowing of the run.
    pub(super) fn record(
        &self,
        options: &InForce<'_>,
        reason: String,
        stages: &Stages,
    ) -> Result<RunRecord, Error> {
        let (scene, mesh) = (&self.ground.scene, &self.ground.mesh);
        Ok(RunRecord {
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
            peak_memory_bytes: memory::peak_bytes(),
            means: "random paths; standard errors in faces.csv".to_owned(),
            solver: self.state.method.clone(),
            work: work(self.state),
            stop_reason: reason,
            received: received(&self.field()?),
            standard_error: Some(self.state.relative_error()),
            warnings: self.ground.warnings.clone(),
            partial: stages.is_cancelled(),
            ..RunRecord::default()
        })
    }

    /// Where pictures are taken from.
    pub(super) fn view(&self) -> Result<View, Error> {
        Ok(view_of(self.ground.scene.camera(), &self.field()?))
    }

    /// The picture of the pixels, or else of the means of the elements.
    fn picture(&self, pixels: Option<&Pixels>) -> Result<Picture, Error> {
        let view = self.view()?;
        let picture = match pixels {
            Some(pixels) => pixels.picture(self.ground.scene.bands(), view.exposure),
            None => render(&self.field()?, &view.camera, view.exposure),
        };
        picture.map_err(report_failure)
    }

    /// Writes the files, with a picture and the page where these are wanted; `run.json` last.
    pub(super) fn write(
        &self,
        folder: &ResultFolder,
        origin: &Origin,
        (drawn, pixels, report): (bool, Option<&Pixels>, bool),
        record: &RunRecord,
    ) -> Result<(), Error> {
        let (mesh, bands, state) = (&self.ground.mesh, self.ground.scene.bands(), self.state);
        let errors = state.groups.standard_errors();
        let faces = FaceEstimates::new(mesh, bands, state.groups.mean(), &errors).map_err(report_failure)?;
        let picture = drawn.then(|| self.picture(pixels)).transpose()?;
        let (field, view) = (self.field()?, self.view()?);
        let write = || -> Result<(), ReportError> {
            folder.write("faces.csv", |out| write_face_estimates(&faces, out))?;
            if let Some(picture) = &picture {
                folder.write("image.png", |out| picture.write_png(out))?;
            }
            if let Some(pixels) = pixels {
                folder.write(PIXELS, |out| pixels.write_npz(out))?;
            }
            if report {
                let what = ("Standard error of E, face", "s(E)", "W/m²");
                let errors = face_quantities(mesh, bands, &errors, what);
                let model = ReportModel { values: &errors, ..ReportModel::lit(&field, &view) };
                let title = title(&self.ground.scene);
                let page = ReportPage::of_trace(&title, &field, record, model, picture.as_ref());
                folder.write(REPORT, |out| page.write(out))?;
            }
            folder.write(TRACE_STATE, |out| origin.save(state, out))?;
            folder.write("run.json", |out| write_run(record, out)).map(drop)
        };
        write().map_err(report_failure)
    }
}
