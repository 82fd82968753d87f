//! Scenes of waves by random sampling.

use std::path::Path;

use fredholm_montecarlo::waves::{
    Aim, AmplitudeParticles, Bounces, FieldEstimate, FieldEstimator, FieldParticles, Scattering,
    SurfaceSampling, estimate,
};
use fredholm_report::{
    ReportError, RunRecord, SampledField, write_atomically, write_run, write_sampled_fields,
};
use fredholm_waves::{PhysicalOptics, Shadow, Source, Wave, WaveError};
use serde_json::json;

use super::TraceArgs;
use super::files::prepare;
use crate::commands::solve::report_failure;
use crate::failure::{Ending, Failure};
use crate::interrupt::nothing_saved;
use crate::output;
use crate::stages::Stages;
use crate::stochastic::failure;
use crate::summary::Lines;
use crate::waves::{Band, Method, Model, Places};

/// Names of the methods.
pub(super) const METHODS: [&str; 3] = ["surface-sampling", "field-particles", "amplitude-particles"];

/// Samples of a batch, and in all, where nothing is asked for.
const BATCH: u32 = 1024;
const SAMPLES: u64 = 1 << 16;
/// Radius of a cell of amplitude particles over the wavelength, and rays that leave each for the second bounce.
const CELL: f64 = 0.1;
const SECOND: u32 = 16;

/// Samples the fields of a scene of waves and writes them.
pub(super) fn run(args: &TraceArgs, folder: &Path, stages: &mut Stages) -> Result<Ending, Failure> {
    let model = stages.run("scene", || Model::load(&args.problem.scene))?;
    let bounces = admitted(args, &model, stages)?;
    let mut rows = Vec::new();
    for band in &model.bands {
        let name = format!("fields at {} MHz", band.wave.frequency() / 1e6);
        stages.run(&name, || sampled(args, &model, band, bounces, &mut rows))?;
    }
    if stages.interrupt.requested() {
        return Err(nothing_saved());
    }
    let record = record(args, &model, bounces, stages);
    prepare(folder)?;
    write(folder, &rows, &record).map_err(report_failure)?;
    if !args.log.quiet {
        summarise(folder, &rows, &record)?;
    }
    Ok(Ending::Done)
}

/// What can be sampled, and how many bounces.
fn admitted(args: &TraceArgs, model: &Model, stages: &Stages) -> Result<Bounces, Failure> {
    let refused = |text: String| Err(Failure::new(Ending::Input, text));
    if model.shadow != Shadow::Geometric {
        return refused(format!(
            "shadows `{}` cannot be sampled\n  help: shadow = \"geometric\" in [wave], or `fredholm waves`",
            model.shadow.name()
        ));
    }
    if args.control || args.go_on || args.stop.seconds.is_some() || args.stop.to.is_some() {
        return refused(format!(
            "{} stops at a number of samples and takes neither --control, --continue, --seconds nor --to\n  help: --samples",
            args.method
        ));
    }
    match model.method {
        Method::Bounces(1) => Ok(Bounces::One),
        Method::Bounces(2) => Ok(Bounces::Two),
        _ => {
            stages.console.warn(
                "two bounces are sampled, not more: the signs of a random walk over bounces cancel too slowly",
            );
            Ok(Bounces::Two)
        }
    }
}

fn sampled(
    args: &TraceArgs,
    model: &Model,
    band: &Band,
    bounces: Bounces,
    rows: &mut Vec<SampledField>,
) -> Result<(), Failure> {
    let refused = |error: WaveError| model.refused(&error, None);
    let scatterer = model.geometry.scatterer(band.materials.clone()).map_err(refused)?;
    scatterer.check_conductor("the sampling of fields").map_err(refused)?;
    let sources: Vec<&dyn Source> = model.sources.iter().map(AsRef::as_ref).collect();
    let optics = PhysicalOptics::new(&scatterer, band.wave, &sources, Shadow::Geometric).map_err(refused)?;
    let problem = Scattering::new(&scatterer, &optics, band.wave, bounces).map_err(failure)?;
    let method = method(&args.method, &band.wave);
    let batch = args.paths.batch.unwrap_or(BATCH);
    let batches = args.stop.samples.unwrap_or(SAMPLES).div_ceil(batch.into()).clamp(2, u32::MAX.into());
    for receiver in &model.receivers {
        if let Places::Near { points, .. } = &receiver.places {
            let found = estimate(&problem, &*method, points, (args.paths.seed, batches as u32, batch));
            let place = (receiver.name.as_str(), band.wave.frequency());
            rows.extend(points.iter().enumerate().map(|(i, p)| row(place, i, p.to_array(), &found)));
        }
    }
    Ok(())
}

fn method(name: &str, wave: &Wave) -> Box<dyn FieldEstimator> {
    match name {
        "field-particles" => Box::new(FieldParticles::new(Aim::Lobe(None))),
        "amplitude-particles" => Box::new(AmplitudeParticles::new(CELL * wave.wavelength(), SECOND)),
        _ => Box::new(SurfaceSampling),
    }
}

fn row(
    (receiver, frequency): (&str, f64),
    index: usize,
    position: [f64; 3],
    found: &FieldEstimate,
) -> SampledField {
    let [x, y, z] = found.mean()[index].components();
    let error = found.standard_errors()[index];
    let e = [x.re, x.im, y.re, y.im, z.re, z.im];
    SampledField { receiver: receiver.to_owned(), index, position, frequency, e, error }
}

fn record(args: &TraceArgs, model: &Model, bounces: Bounces, stages: &Stages) -> RunRecord {
    RunRecord {
        version: env!("CARGO_PKG_VERSION").to_owned(),
        scene: model.path().display().to_string(),
        options: json!({ "method": args.method, "paths": args.paths, "samples": args.stop.samples }),
        timings: stages.timings().to_vec(),
        means: "random samples; standard errors in receivers.csv".to_owned(),
        solver: args.method.clone(),
        stop_reason: format!(
            "all samples drawn, {} summed",
            if bounces == Bounces::One { "one bounce" } else { "two bounces" }
        ),
        ..RunRecord::default()
    }
}

fn write(folder: &Path, rows: &[SampledField], record: &RunRecord) -> Result<(), ReportError> {
    write_atomically(&folder.join("receivers.csv"), |out| write_sampled_fields(rows, out))?;
    write_atomically(&folder.join("run.json"), |out| write_run(record, out))
}

fn summarise(folder: &Path, rows: &[SampledField], record: &RunRecord) -> Result<(), Failure> {
    let norm = |row: &SampledField| row.e.iter().map(|x| x * x).sum::<f64>();
    let (size, error) =
        rows.iter().fold((0.0, 0.0), |(size, error), row| (size + norm(row), error + row.error * row.error));
    let mut lines = Lines::default();
    lines.add("fields", format!("{} points and frequencies in receivers.csv", rows.len()));
    lines.add("result", &record.stop_reason);
    lines.add("standard error", format!("{:.2} % (L2 over all points)", 100.0 * f64::sqrt(error / size)));
    lines.add("time", crate::summary::times(&record.timings));
    output::print(&lines.under(&format!("{} → {}", record.solver, folder.display())))
}
