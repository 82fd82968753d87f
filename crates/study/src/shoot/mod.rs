//! Progressive radiosity without the matrix.

mod light;

use std::time::Instant;

use fredholm_coupling::{Emitters, Groups, MeshError};
use fredholm_iterative::{Frame, MultilevelShooting};
use fredholm_linop::{Columns, Lazy, MultiVector, Watch};
use fredholm_report::{
    FieldStep, ResultFolder, RunReport, SHOOTING_FORMAT, ShootingRecord, Shot, write_shooting,
    write_shot_picture,
};
use serde_json::json;

use light::Light;

use crate::error::Error;
use crate::memory;
use crate::options::{Precision, ProblemOptions, ProblemSettings, SceneSource};
use crate::problem::Open;
use crate::record;
use crate::size::Bytes;
use crate::solution::solve_failure;
use crate::solve::{Ended, report_failure, title, view_of};
use crate::stages::Stages;

/// What is asked of [`shoot`].
#[derive(Clone, Debug)]
pub struct ShootOptions {
    /// Share of the power of the solution to distribute, above 0 and below 1.
    pub share: f64,
    /// Shots allowed.
    pub max_shots: u32,
    /// Numbers of shots after which a picture is written.
    pub pictures: Vec<u64>,
    /// Whether no picture is drawn, neither on the way nor at the end.
    pub no_pictures: bool,
    /// Whether report.html is left out.
    pub no_report: bool,
    /// Memory for columns that are kept for the next shot from there.
    pub keep: Bytes,
    /// Threads of the run; see [`ProblemOptions`].
    pub threads: Option<u16>,
    /// Error asked for in a row of form factors; see [`ProblemOptions`].
    pub form_factor_tolerance: Option<f64>,
    /// Memory allowed; see [`ProblemOptions`].
    pub memory: Option<Bytes>,
}

impl Default for ShootOptions {
    fn default() -> Self {
        Self {
            share: 0.9,
            max_shots: 100_000,
            pictures: vec![1, 10, 100],
            no_pictures: false,
            no_report: false,
            keep: Bytes(32 << 20),
            threads: None,
            form_factor_tolerance: None,
            memory: None,
        }
    }
}

impl ShootOptions {
    /// The problem; the solver is shooting itself.
    fn problem(&self) -> ProblemOptions {
        ProblemOptions {
            threads: self.threads,
            form_factor_tolerance: self.form_factor_tolerance,
            storage: Some(Precision::F64),
            memory: self.memory,
            ..ProblemOptions::default()
        }
    }
}

/// Shoots until the share asked for is distributed, and writes the field so far into a folder, with
/// pictures on the way. The record returned has the time of writing too.
///
/// # Errors
/// What is wrong with the scene; [`Resources`](crate::ErrorKind::Resources) before memory is taken
/// that the limit does not allow; [`Files`](crate::ErrorKind::Files) with what could not be
/// written.
pub fn shoot(
    source: impl Into<SceneSource>,
    asked: &ShootOptions,
    folder: &ResultFolder,
    watch: &dyn Watch,
) -> Result<(ShootingRecord, Ended), Error> {
    shoot_scene(&source.into(), asked, folder, watch)
}

/// [`shoot`], compiled once and not for each kind of source.
fn shoot_scene(
    source: &SceneSource,
    asked: &ShootOptions,
    folder: &ResultFolder,
    watch: &dyn Watch,
) -> Result<(ShootingRecord, Ended), Error> {
    let mut stages = Stages::new(watch);
    let pictures = usize::from(!asked.no_pictures);
    let scene = Open::load(source, &asked.problem(), (asked.keep, pictures), &mut stages)?;
    let light = stages.run("exposure", || Light::new(&scene))?;
    let groups = stages.run("groups", || Ok(light.groups(&scene)))?;
    let tolerance = scene.options.form_factor_tolerance;
    let emitters = Emitters::new(scene.patches(), &groups, &scene.occluders, tolerance);
    let job = Job { asked, folder, scene: &scene, light: &light, groups: &groups };
    stages.begin_saving()?;
    let (shots, steps, received, unshot) = stages.run("shots", || job.shoot(&emitters, watch))?;
    let error = stages.run("errors", || light.error(&scene, (&received, &unshot), watch))?;
    let record = shooting_record(asked, &scene, (shots, error), &emitters, &stages);
    stages.run("results", || job.write(&received, &steps, &record))?;
    let record = ShootingRecord { timings: stages.timings().to_vec(), ..record };
    let ended = ended(&record, &stages);
    Ok((record, ended))
}

/// The shots, fields on the way, what each element has received, W, and what it has still to send,
/// W/m².
type Shots = (Vec<Shot>, Vec<FieldStep>, MultiVector<f64>, MultiVector<f64>);

/// Numbers of all fields on the way that are kept for the page.
const KEPT_NUMBERS: usize = 1 << 21;

/// A scene that is shot through, and where its results go.
struct Job<'a> {
    asked: &'a ShootOptions,
    folder: &'a ResultFolder,
    scene: &'a Open,
    light: &'a Light,
    groups: &'a Groups,
}

impl Job<'_> {
    /// Shoots until the share that was asked for is distributed.
    fn shoot(&self, emitters: &Emitters, watch: &dyn Watch) -> Result<Shots, Error> {
        let columns = Lazy::new(emitters, self.asked.keep.as_u64());
        let places = self.groups.places();
        let frame = Frame { order: self.groups.order(), groups: &places, areas: &self.light.exposed };
        let mut shooting =
            MultilevelShooting::new(&columns, frame, self.light.scaling(), &self.light.exitance)
                .map_err(solve_failure)?;
        let (mut shots, mut steps, mut seconds): (Vec<Shot>, Vec<FieldStep>, f64) =
            (Vec::new(), Vec::new(), 0.0);
        let mut distributed = shooting.distributed();
        while distributed < self.asked.share && shots.len() < self.asked.max_shots as usize {
            let started = Instant::now();
            let Some(group) = shooting.shoot() else { break };
            distributed = shooting.distributed();
            seconds += started.elapsed().as_secs_f64();
            let (elements, columns) = (places[group].len() as u64, columns.computed());
            shots.push(Shot { elements, columns, seconds, distributed });
            self.picture(shots.len() as u64, &shooting)?;
            if self.keeps(shots.len(), steps.len()) {
                let label = format!("{} shot{}", shots.len(), if shots.len() == 1 { "" } else { "s" });
                let irradiance = self.light.irradiance(&shooting.received()).as_slice().to_vec();
                steps.push(FieldStep { label, irradiance });
            }
            watch.advance(distributed / self.asked.share, &|| {
                format!("{} shots, {:.1} % distributed", shots.len(), 100.0 * distributed)
            });
            if watch.go_on().is_break() {
                break;
            }
        }
        Ok((shots, steps, shooting.received(), shooting.unshot()))
    }

    /// Whether the field after so many shots is kept for the page: after 1, 3, 10, 30 … of them, as
    /// long as there is room.
    fn keeps(&self, shots: usize, kept: usize) -> bool {
        let power = 10_usize.pow(shots.ilog10());
        let numbers = self.light.exitance.dim() * self.light.exitance.rhs_count();
        let room = (kept + 1) * numbers <= KEPT_NUMBERS;
        !self.asked.no_report && (shots == power || shots == 3 * power) && room
    }

    /// Writes a picture, where one is asked for after this many shots.
    fn picture(&self, shots: u64, shooting: &MultilevelShooting) -> Result<(), Error> {
        if self.asked.no_pictures || !self.asked.pictures.contains(&shots) {
            return Ok(());
        }
        self.light.field(self.scene, &shooting.received(), &shooting.with_ambient(), |field| {
            let view = view_of(self.scene.scene.camera(), field);
            write_shot_picture(self.folder, shots, field, &view).map_err(report_failure)
        })
    }

    /// Writes the field that follows from what the elements have received, and the record.
    fn write(
        &self,
        received: &MultiVector<f64>,
        steps: &[FieldStep],
        record: &ShootingRecord,
    ) -> Result<(), Error> {
        self.light.field(self.scene, received, &self.light.means(received), |field| {
            let view = view_of(self.scene.scene.camera(), field);
            let title = title(&self.scene.scene);
            let report = RunReport { title: &title, view: &view, steps: ("Shots", steps), links: None };
            let report = (!self.asked.no_report).then_some(&report);
            let view = (!self.asked.no_pictures).then_some(&view);
            write_shooting(self.folder, field, record, view, report).map_err(report_failure)
        })
    }
}

fn shooting_record(
    asked: &ShootOptions,
    scene: &Open,
    (shots, error): (Vec<Shot>, Option<MeshError>),
    emitters: &Emitters,
    stages: &Stages,
) -> ShootingRecord {
    let ProblemSettings { form_factor_tolerance, threads, .. } = scene.options;
    ShootingRecord {
        format: SHOOTING_FORMAT.to_owned(),
        version: env!("CARGO_PKG_VERSION").to_owned(),
        scene: scene.scene.path().display().to_string(),
        scene_sha256: scene.scene.sha256().to_owned(),
        options: json!({
            "share": asked.share,
            "max_shots": asked.max_shots,
            "keep_bytes": asked.keep.as_u64(),
            "form_factor_tolerance": form_factor_tolerance,
            "threads": threads,
        }),
        bands: scene.scene.bands().to_vec(),
        elements: scene.mesh.len() as u64,
        groups: emitters.count() as u64,
        drawn: !asked.no_pictures,
        reached: shots.last().is_none_or(|shot| shot.distributed >= asked.share),
        mesh_error: error.as_ref().map(record::mesh_error),
        form_factor_error: emitters.largest_error(),
        peak_memory_bytes: memory::peak_bytes(),
        warnings: scene.warnings.clone(),
        shots,
        timings: stages.timings().to_vec(),
    }
}

fn ended(record: &ShootingRecord, stages: &Stages) -> Ended {
    match record.reached {
        _ if stages.is_cancelled() => Ended::Interrupted,
        true => Ended::Done,
        false => Ended::NotConverged,
    }
}
