//! `fredholm shoot`: progressive radiosity without the matrix.

mod args;
mod light;
mod summary;

use std::ops::ControlFlow;
use std::path::Path;
use std::time::Instant;

use fredholm_coupling::{Emitters, Groups, MeshError};
use fredholm_iterative::{Frame, MultilevelShooting};
use fredholm_linop::{Columns, Lazy, MultiVector};
use fredholm_report::{
    FieldStep, RunReport, SHOOTING_FORMAT, ShootingRecord, Shot, write_shooting, write_shot_picture,
};
use serde_json::json;

pub(crate) use args::{EXAMPLES, ShootArgs};
use light::Light;

use super::solve::{report_failure, title, view_of};
use crate::failure::{Ending, Failure};
use crate::interrupt::Interrupt;
use crate::memory;
use crate::options::ProblemOptions;
use crate::problem::Open;
use crate::record;
use crate::solution::solve_failure;
use crate::stages::Stages;
use crate::start::Start;

/// Shoots until the share asked for is distributed, and writes the field so far.
pub(crate) fn shoot(args: &ShootArgs) -> Result<Ending, Failure> {
    let start = Start {
        scene: &args.scene,
        output: args.output.as_ref(),
        threads: args.threads,
        memory: args.memory,
        log: args.log,
    };
    start.run(|folder, stages| run(args, folder, stages))
}

fn run(args: &ShootArgs, folder: &Path, stages: &mut Stages) -> Result<Ending, Failure> {
    let scene = Open::load(&args.problem(), args.keep, stages)?;
    let light = stages.run("exposure", || Light::new(&scene))?;
    let groups = stages.run("groups", || Ok(light.groups(&scene)))?;
    let tolerance = scene.options.form_factor_tolerance;
    let emitters = Emitters::new(scene.patches(), &groups, &scene.occluders, tolerance);
    let job = Job { args, folder, scene: &scene, light: &light, groups: &groups };
    stages.begin_saving()?;
    let (console, interrupt) = (stages.console, stages.interrupt);
    let watch = |shot: &Shot, number: usize| {
        let share = shot.distributed / args.share;
        console.advance(share, &|| format!("{number} shots, {:.1} % distributed", 100.0 * shot.distributed));
        !interrupt.requested()
    };
    let (shots, steps, received, unshot) = stages.run("shots", || job.shoot(&emitters, &watch))?;
    let go_on = || if interrupt.requested() { ControlFlow::Break(()) } else { ControlFlow::Continue(()) };
    let error = stages.run("errors", || light.error(&scene, (&received, &unshot), &go_on))?;
    let record = shooting_record(args, &scene, (shots, error), &emitters, stages);
    stages.run("results", || job.write(&received, &steps, &record))?;
    let record = ShootingRecord { timings: stages.timings().to_vec(), ..record };
    conclude(args, folder, &record, stages)
}

/// The shots, fields on the way, what each element has received, W, and what it has still to send, W/m².
type Shots = (Vec<Shot>, Vec<FieldStep>, MultiVector<f64>, MultiVector<f64>);

/// Numbers of all fields on the way that are kept for the page.
const KEPT: usize = 1 << 21;

/// A scene that is shot through, and where its results go.
struct Job<'a> {
    args: &'a ShootArgs,
    folder: &'a Path,
    scene: &'a Open,
    light: &'a Light,
    groups: &'a Groups,
}

impl Job<'_> {
    /// Shoots until the share that was asked for is distributed.
    fn shoot(&self, emitters: &Emitters, watch: &dyn Fn(&Shot, usize) -> bool) -> Result<Shots, Failure> {
        let columns = Lazy::new(emitters, u64::try_from(self.args.keep.0).unwrap_or(u64::MAX));
        let places = self.groups.places();
        let frame = Frame { order: self.groups.order(), groups: &places, areas: &self.light.exposed };
        let mut shooting =
            MultilevelShooting::new(&columns, frame, self.light.scaling(), &self.light.exitance)
                .map_err(solve_failure)?;
        let (mut shots, mut steps, mut seconds): (Vec<Shot>, Vec<FieldStep>, f64) =
            (Vec::new(), Vec::new(), 0.0);
        let mut distributed = shooting.distributed();
        while distributed < self.args.share && shots.len() < self.args.max_shots as usize {
            let started = Instant::now();
            let Some(group) = shooting.shoot() else { break };
            distributed = shooting.distributed();
            seconds += started.elapsed().as_secs_f64();
            let (elements, columns) = (places[group].len() as u64, columns.computed());
            shots.push(Shot { elements, columns, seconds, distributed });
            self.picture(shots.len() as u64, &shooting)?;
            if self.keeps(shots.len(), steps.len()) {
                let label = format!("{} shot{}", shots.len(), if shots.len() == 1 { "" } else { "s" });
                steps.push(FieldStep {
                    label,
                    irradiance: self.light.irradiance(&shooting.received()).as_slice().to_vec(),
                });
            }
            if !watch(&shots[shots.len() - 1], shots.len()) {
                break;
            }
        }
        Ok((shots, steps, shooting.received(), shooting.unshot()))
    }

    /// Whether the field after so many shots is kept for the page: after 1, 3, 10, 30 … of them, as
    /// long as there is room.
    fn keeps(&self, shots: usize, kept: usize) -> bool {
        let power = 10_usize.pow(shots.ilog10());
        let numbers = self.light.exitance.dim() * self.light.exitance.lanes();
        !self.args.no_report && (shots == power || shots == 3 * power) && (kept + 1) * numbers <= KEPT
    }

    /// Writes a picture, where one is asked for after this many shots.
    fn picture(&self, shots: u64, shooting: &MultilevelShooting) -> Result<(), Failure> {
        if self.args.no_pictures || !self.args.pictures.contains(&shots) {
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
    ) -> Result<(), Failure> {
        self.light.field(self.scene, received, &self.light.means(received), |field| {
            let view = view_of(self.scene.scene.camera(), field);
            let title = title(&self.scene.scene);
            let report = RunReport { title: &title, view: &view, steps: ("Shots", steps) };
            let report = (!self.args.no_report).then_some(&report);
            let view = (!self.args.no_pictures).then_some(&view);
            write_shooting(self.folder, field, record, view, report).map_err(report_failure)
        })
    }
}

fn conclude(
    args: &ShootArgs,
    folder: &Path,
    record: &ShootingRecord,
    stages: &Stages,
) -> Result<Ending, Failure> {
    record.warnings.iter().for_each(|warning| stages.console.warn(warning));
    if !args.log.quiet {
        summary::print(folder, record, !args.no_pictures)?;
    }
    Ok(ending(record, stages.interrupt))
}

fn shooting_record(
    args: &ShootArgs,
    scene: &Open,
    (shots, error): (Vec<Shot>, Option<MeshError>),
    emitters: &Emitters,
    stages: &Stages,
) -> ShootingRecord {
    let ProblemOptions { form_factor_tolerance, threads, .. } = scene.options;
    ShootingRecord {
        format: SHOOTING_FORMAT.to_owned(),
        version: env!("CARGO_PKG_VERSION").to_owned(),
        scene: scene.scene.path().display().to_string(),
        scene_sha256: scene.scene.sha256().to_owned(),
        options: json!({
            "share": args.share,
            "max_shots": args.max_shots,
            "keep_bytes": u64::try_from(args.keep.0).unwrap_or(u64::MAX),
            "form_factor_tolerance": form_factor_tolerance,
            "threads": threads,
        }),
        bands: scene.scene.bands().to_vec(),
        elements: scene.mesh.len() as u64,
        groups: emitters.count() as u64,
        reached: shots.last().is_none_or(|shot| shot.distributed >= args.share),
        mesh_error: error.as_ref().map(record::mesh_error),
        form_factor_error: emitters.largest_error(),
        peak_memory_bytes: memory::peak_bytes(),
        warnings: scene.warnings.clone(),
        shots,
        timings: stages.timings().to_vec(),
    }
}

fn ending(record: &ShootingRecord, interrupt: &Interrupt) -> Ending {
    match record.reached {
        _ if interrupt.requested() => Ending::Interrupted,
        true => Ending::Done,
        false => Ending::NotConverged,
    }
}
