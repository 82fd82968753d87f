//! Scenes of waves by random sampling.

use std::path::Path;

use fredholm_montecarlo::waves::FieldEstimate;
use fredholm_report::{
    ReportError, RunRecord, SampledField, write_atomically, write_run, write_sampled_fields,
};
use serde_json::json;

use super::TraceArgs;
use super::files::prepare;
use super::saved::{Origin, STATE};
use crate::commands::solve::report_failure;
use crate::failure::{Ending, Failure};
use crate::interrupt::nothing_saved;
use crate::output;
use crate::stages::Stages;
use crate::stochastic::{FieldRun, field_points};
use crate::summary::Lines;
use crate::waves::Model;

/// Samples the fields of a scene of waves and writes them.
pub(super) fn run(args: &TraceArgs, folder: &Path, stages: &mut Stages) -> Result<Ending, Failure> {
    admit(args)?;
    let batches = FieldRun::at_once(&args.paths, &args.stop);
    let load = || Model::load_sampled(&args.problem.scene, args.problem.memory, batches);
    let model = stages.run("scene", load)?;
    stages.console.admit(&model.plan, model.limit);
    let run = FieldRun::new(&args.method, &args.paths, &args.stop, &model, stages)?;
    let origin = Origin::new(args, &model.text.sha256(), run.bounces());
    let earlier: Vec<FieldEstimate> = if args.go_on { origin.earlier(folder)? } else { Vec::new() };
    stages.begin_saving()?;
    let states = sampled(&run, &model, earlier, stages)?;
    let record = record(args, &model, (&run, &states), stages);
    let rows = rows(&model, &states);
    prepare(folder)?;
    write(folder, &rows, (&origin, &states), &record).map_err(report_failure)?;
    if !args.log.quiet {
        summarise(folder, &rows, &record)?;
    }
    Ok(if record.partial { Ending::Interrupted } else { Ending::Done })
}

/// Options of light that fields do not take.
fn admit(args: &TraceArgs) -> Result<(), Failure> {
    if !args.control && args.spp.is_none() {
        return Ok(());
    }
    let text = format!("{} takes neither --control nor --spp\n  help: leave them out", args.method);
    Err(Failure::new(Ending::Input, text))
}

/// The estimates of all frequencies, going on from earlier ones.
fn sampled(
    run: &FieldRun,
    model: &Model,
    earlier: Vec<FieldEstimate>,
    stages: &mut Stages,
) -> Result<Vec<FieldEstimate>, Failure> {
    let mut earlier = earlier.into_iter();
    let mut states = Vec::new();
    for band in &model.bands {
        let name = format!("fields at {} MHz", band.wave.frequency() / 1e6);
        let watched = Stages::new(stages.console, stages.interrupt);
        let before = earlier.next();
        let state = stages.run(&name, || run.sample(model, band, before, &watched))?;
        if state.batches() < 2 {
            return Err(nothing_saved());
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
    args: &TraceArgs,
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
        scene_sha256: model.text.sha256(),
        options: json!({ "method": args.method, "paths": args.paths, "stop": args.stop, "frequencies": frequencies }),
        timings: stages.timings().to_vec(),
        means: "random samples; standard errors in receivers.csv".to_owned(),
        solver: args.method.clone(),
        stop_reason: states.last().map_or(String::new(), |state| run.reason(state)),
        partial: stages.interrupt.requested(),
        ..RunRecord::default()
    }
}

fn write(
    folder: &Path,
    rows: &[SampledField],
    (origin, states): (&Origin, &[FieldEstimate]),
    record: &RunRecord,
) -> Result<(), ReportError> {
    write_atomically(&folder.join("receivers.csv"), |out| write_sampled_fields(rows, out))?;
    write_atomically(&folder.join(STATE), |out| origin.save(&states, out))?;
    write_atomically(&folder.join("run.json"), |out| write_run(record, out))
}

fn summarise(folder: &Path, rows: &[SampledField], record: &RunRecord) -> Result<(), Failure> {
    let mut lines = Lines::default();
    lines.add("fields", format!("{} points and frequencies in receivers.csv", rows.len()));
    lines.add("result", &record.stop_reason);
    lines.add("time", crate::summary::times(&record.timings));
    output::print(&lines.under(&format!("{} → {}", record.solver, folder.display())))
}
