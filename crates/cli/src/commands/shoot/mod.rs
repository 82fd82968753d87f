//! `fredholm shoot`: progressive radiosity without the matrix.

mod args;
mod light;
mod summary;

use std::path::Path;
use std::time::Instant;

use fredholm_coupling::Emitters;
use fredholm_iterative::{Frame, MultilevelShooting};
use fredholm_linop::{Columns, Lazy};
use fredholm_report::{SHOOTING_FORMAT, ShootingRecord, Shot, write_shooting, write_shot_picture};
use serde_json::json;

pub(crate) use args::{EXAMPLES, ShootArgs};
use light::Light;

use super::solve::{report_failure, view_of};
use crate::failure::{Ending, Failure};
use crate::interrupt::Interrupt;
use crate::options::ProblemOptions;
use crate::problem::Open;
use crate::solution::solve_failure;
use crate::stages::Stages;
use crate::{console, folder, memory, threads};

/// Shoots until the share asked for is distributed, and writes the field so far.
pub(crate) fn shoot(args: &ShootArgs) -> Result<Ending, Failure> {
    let interrupt = Interrupt::install(args.log.log)?;
    let folder = folder::of(args.output.as_ref(), &args.scene);
    folder::probe(&folder)?;
    let console = console::choose(args.log);
    let mut stages = Stages::new(&*console, &interrupt);
    let count = args.threads.map_or_else(threads::default_count, usize::from);
    threads::pool(count)?.install(|| run(args, &folder, &mut stages))
}

fn run(args: &ShootArgs, folder: &Path, stages: &mut Stages) -> Result<Ending, Failure> {
    let scene = Open::load(&args.problem(), args.keep, stages)?;
    let light = stages.run("exposure", || Light::new(&scene))?;
    let tolerance = scene.options.form_factor_tolerance;
    let groups = stages.run("groups", || Ok(light.groups(&scene)))?;
    let places = groups.places();
    let emitters = Emitters::new(scene.patches(), &groups, &scene.occluders, tolerance);
    let columns = Lazy::new(&emitters, u64::try_from(args.keep.0).unwrap_or(u64::MAX));
    let frame = Frame { order: groups.order(), groups: &places, areas: &light.exposed };
    let mut shooting = MultilevelShooting::new(&columns, frame, light.scaling(), light.exitance.clone())
        .map_err(solve_failure)?;
    stages.begin_saving()?;
    let mut picture = |shots: u64, shooting: &MultilevelShooting| {
        let shown = shooting.with_ambient();
        light.field(&scene, shooting.received(), &shown, |field| {
            write_shot_picture(folder, shots, field, &view_of(scene.scene.camera(), field))
                .map_err(report_failure)
        })
    };
    let run = Run { args, columns: &columns, places: &places };
    let (console, interrupt) = (stages.console, stages.interrupt);
    let go_on = |distributed: f64, shots: usize| {
        console.advance(distributed / args.share, &|| {
            format!("{shots} shots, {:.1} % distributed", 100.0 * distributed)
        });
        !interrupt.requested()
    };
    let shots = stages.run("shots", || run.shoot(&mut shooting, &mut picture, &go_on))?;
    let record = record(args, &scene, shots, &emitters, stages);
    let means = light.means(shooting.received());
    stages.run("results", || {
        light.field(&scene, shooting.received(), &means, |field| {
            write_shooting(folder, field, &record, &view_of(scene.scene.camera(), field))
                .map_err(report_failure)
        })
    })?;
    let record = ShootingRecord { timings: stages.timings().to_vec(), ..record };
    record.warnings.iter().for_each(|warning| stages.console.warn(warning));
    if !args.log.quiet {
        summary::print(folder, &record)?;
    }
    Ok(ending(&record, stages.interrupt))
}

/// What a run of shots needs.
struct Run<'a> {
    args: &'a ShootArgs,
    columns: &'a Lazy<'a, f64>,
    places: &'a [std::ops::Range<usize>],
}

impl Run<'_> {
    fn shoot(
        &self,
        shooting: &mut MultilevelShooting,
        picture: &mut dyn FnMut(u64, &MultilevelShooting) -> Result<(), Failure>,
        go_on: &dyn Fn(f64, usize) -> bool,
    ) -> Result<Vec<Shot>, Failure> {
        let (mut shots, mut seconds): (Vec<Shot>, f64) = (Vec::new(), 0.0);
        let mut distributed = shooting.distributed();
        while distributed < self.args.share && shots.len() < self.args.max_shots as usize {
            let started = Instant::now();
            let Some(group) = shooting.shoot() else { break };
            distributed = shooting.distributed();
            seconds += started.elapsed().as_secs_f64();
            let (elements, columns) = (self.places[group].len() as u64, self.columns.computed());
            shots.push(Shot { elements, columns, seconds, distributed });
            let number = shots.len() as u64;
            if self.args.pictures.contains(&number) {
                picture(number, shooting)?;
            }
            if !go_on(distributed, shots.len()) {
                break;
            }
        }
        Ok(shots)
    }
}

fn record(
    args: &ShootArgs,
    scene: &Open,
    shots: Vec<Shot>,
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
        form_factor_error: emitters.largest_error(),
        peak_memory_bytes: memory::peak().and_then(|peak| u64::try_from(peak.0).ok()),
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
