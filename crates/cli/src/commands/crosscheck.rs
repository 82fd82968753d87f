//! `fredholm crosscheck`.

use std::path::Path;

use fredholm_report::{CrosscheckPower, CrosscheckRecord, WorstPlace};
use fredholm_study::{Error, Verdict};

use crate::args::CrosscheckArgs;
use crate::ending::Ending;
use crate::output;
use crate::start::Start;
use crate::summary::{Lines, times};

/// Solves and traces a scene, and says whether the two agree.
pub(crate) fn crosscheck(args: &CrosscheckArgs) -> Result<Ending, Error> {
    let start = Start::of(&args.problem, args.output.as_ref(), "crosscheck", args.log);
    start.run(|folder, terminal| {
        let scene = &args.problem.scene;
        let (record, verdict) = fredholm_study::crosscheck(scene, &args.options(), folder, terminal)?;
        if !args.log.quiet {
            summarise(folder.path(), &record, verdict)?;
        }
        Ok(verdict.into())
    })
}

fn summarise(folder: &Path, record: &CrosscheckRecord, verdict: Verdict) -> Result<(), Error> {
    let mut lines = Lines::default();
    let CrosscheckRecord { significant, places, significance, correction, .. } = record;
    let verdict = match verdict {
        Verdict::Undecided => "undecided: too little was sampled to say that they agree".to_owned(),
        verdict => format!("they {}", verdict.name()),
    };
    lines.add(
        "verdict",
        format!("{verdict}: {significant} of {places} places apart at {significance} ({correction})"),
    );
    lines.add_some("power", record.power.as_ref().map(power));
    lines.add(
        "scores",
        format!("mean {:.3}, mean of squares {:.3}", record.score_mean, record.score_variance),
    );
    for place in &record.worst {
        lines.add("worst", worst(place));
    }
    lines.add(
        "traced",
        format!(
            "{}, {} batches, standard error {:.2} %",
            record.method,
            record.batches,
            100.0 * record.relative_error
        ),
    );
    lines.add("time", times(&record.timings));
    output::print(&lines.under(&format!("{} → {}", record.scene, folder.display())))
}

/// What would have been found.
fn power(power: &CrosscheckPower) -> String {
    let percent =
        |part: Option<f64>| part.map_or_else(|| "any".to_owned(), |x| format!("{:.2} %", 100.0 * x));
    format!(
        "a deviation of the whole by {} would have been found nine times out of ten, of a typical surface by {}, of a typical face by {}",
        percent(power.whole),
        percent(power.surface),
        percent(power.face)
    )
}

/// One of the places farthest apart, in words.
fn worst(place: &WorstPlace) -> String {
    let ([x, y, z], relative) = (place.centroid, 100.0 * place.relative);
    let (score, number, of) = (place.z, place.face, &place.surface);
    let head = format!("z = {score:+.2}, {relative:+.2} %");
    let at = format!("at ({x:.3}, {y:.3}, {z:.3})");
    match place.kind.as_str() {
        "whole" => format!("{head}: the whole, band {}", place.band),
        "surface" => format!("{head}: surface {of}, band {}", place.band),
        "face" => format!("{head}: face {number} of {of}, {at}, band {}", place.band),
        kind => format!("{head}: {kind} {number} of {of}, {at}, {}", place.band),
    }
}
