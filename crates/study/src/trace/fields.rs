//! Scenes of waves by random sampling.

use fredholm_montecarlo::waves::FieldEstimate;
use fredholm_report::{
    ReportError, ResultFolder, RunRecord, SampledField, TRACE_STATE, write_run, write_sampled_fields,
};
use serde_json::json;

use super::saved::Origin;
use super::{TraceOptions, Traced};
use crate::error::{Error, ErrorKind};
use crate::options::SceneSource;
use crate::solve::{Ended, report_failure};
use crate::stages::Stages;
use crate::stochastic::{FieldRun, field_points};
use crate::waves::Model;

/// Samples the fields of a scene of waves and writes them.
pub(super) fn run(
    source: &SceneSource,
    asked: &TraceOptions,
    folder: &ResultFolder,
    stages: &mut Stages,
) -> Result<(Traced, Ended), Error> {
    admit(asked)?;
    let batches = FieldRun::at_once(&asked.paths, &asked.stop);
    let load = || Model::load_sampled(source.path(), asked.problem.memory, batches);
    let model = stages.run("scene", load)?;
    model.tell(stages);
    let run = FieldRun::new(&asked.method, &asked.paths, &asked.stop, &model, stages.watch)?;
    let origin = Origin::new(asked, model.scene.sha256(), run.bounces());
    let earlier: Vec<FieldEstimate> = if asked.go_on { origin.earlier(folder)? } else { Vec::new() };
    stages.begin_saving()?;
    let states = sampled(&run, &model, earlier, stages)?;
    let record = record(asked, &model, (&run, &states), stages);
    let rows = rows(&model, &states);
    write(folder, &rows, (&origin, &states), &record).map_err(report_failure)?;
    let ended = if record.partial { Ended::Interrupted } else { Ended::Done };
    let seconds = states.iter().map(|state| state.seconds).sum();
    Ok((Traced { record, seconds, fields: rows.len() }, ended))
}

/// Options of light that fields do not take.
fn admit(asked: &TraceOptions) -> Result<(), Error> {
    if !asked.control && asked.spp.is_none() {
        return Ok(());
    }
    let text = format!("{} takes neither --control nor --spp", asked.method);
    Err(Error::new(ErrorKind::Input, text).with_help("leave them out"))
}

/// The estimates of all frequencies, going on from earlier ones.
fn sampled(
    run: &FieldRun,
    model: &Model,
    earlier: Vec<FieldEstimate>,
    stages: &mut Stages,
) -> Result<Vec<FieldEstimate>, Error> {
    let (mut earlier, watch) = (earlier.into_iter(), stages.watch);
    let mut states = Vec::new();
    for band in &model.bands {
        let name = format!("fields at {} MHz", band.wave.frequency() / 1e6);
        let before = earlier.next();
        let state = stages.run(&name, || run.sample(model, band, before, watch))?;
        if state.batches() < 2 {
            return Err(Error::cancelled());
        }
        states.push(state);
    }
    Ok(states)
}

/// A row a point and frequency.
fn rows(model: &Model, states: &[FieldEstimate]) -> Vec<SampledField> {
    let points = field_points(model);
    // A list that grows would be held twice over.
    let mut rows = Vec::with_capacity(points.len() * states.len());
    for (band, state) in model.bands.iter().zip(states) {
        let found = state.mean().into_iter().zip(state.standard_errors());
        for (&(receiver, index, point), (mean, error)) in points.iter().zip(found) {
            let [x, y, z] = mean.components();
            rows.push(SampledField {
                receiver: model.receivers[receiver].name.clone(),
                index,
                position: point.to_array(),
                frequency: band.wave.frequency(),
                e: [x.re, x.im, y.re, y.im, z.re, z.im],
                error,
            });
        }
    }
    rows
}

fn record(
    asked: &TraceOptions,
    model: &Model,
    (run, states): (&FieldRun, &[FieldEstimate]),
    stages: &Stages,
) -> RunRecord {
    let frequency = |(band, state): (&crate::waves::Band, &FieldEstimate)| {
        json!({ "frequency_hz": band.wave.frequency(), "batches": state.batches(), "samples_of_a_batch": state.samples(),
            "relative_error": state.relative_error(), "ended": run.reason(state) })
    };
    let frequencies: Vec<_> = model.bands.iter().zip(states).map(frequency).collect();
    RunRecord {
        version: env!("CARGO_PKG_VERSION").to_owned(),
        scene: model.path().display().to_string(),
        scene_sha256: model.scene.sha256().to_owned(),
        options: json!({ "method": asked.method, "paths": asked.paths, "stop": asked.stop, "frequencies": frequencies }),
        timings: stages.timings().to_vec(),
        means: "random samples; standard errors in receivers.csv".to_owned(),
        solver: asked.method.clone(),
        stop_reason: states.last().map_or(String::new(), |state| run.reason(state)),
        standard_error: states.iter().map(FieldEstimate::relative_error).reduce(f64::max),
        partial: stages.is_cancelled(),
        ..RunRecord::default()
    }
}

fn write(
    folder: &ResultFolder,
    rows: &[SampledField],
    (origin, states): (&Origin, &[FieldEstimate]),
    record: &RunRecord,
) -> Result<(), ReportError> {
    folder.write("receivers.csv", |out| write_sampled_fields(rows, out))?;
    folder.write(TRACE_STATE, |out| origin.save(&states, out))?;
    folder.write("run.json", |out| write_run(record, out)).map(drop)
}
