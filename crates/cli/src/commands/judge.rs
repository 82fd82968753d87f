//! `fredholm judge`.

use fredholm_report::{JudgeRecord, JudgedPlace};
use fredholm_study::{Error, ResultFolder, Verdict};

use crate::args::JudgeArgs;
use crate::ending::Ending;
use crate::output;
use crate::start::Start;
use crate::summary::Lines;

/// Judges what a tracer has found by a bundle.
pub(crate) fn judge(args: &JudgeArgs) -> Result<Ending, Error> {
    let output = args.output.as_ref();
    let start =
        Start { scene: &args.bundle, output, verb: "judge", threads: None, memory: None, log: args.log };
    start.run(|folder, terminal| {
        let (record, verdict) =
            fredholm_study::judge(&args.bundle, &args.files, &args.options(), folder, terminal)?;
        if !args.log.quiet {
            summarise(folder, &record, verdict)?;
        }
        Ok(verdict.into())
    })
}

fn summarise(folder: &ResultFolder, record: &JudgeRecord, verdict: Verdict) -> Result<(), Error> {
    let mut lines = Lines::default();
    let JudgeRecord { significant, places, significance, correction, power, .. } = record;
    let said = match verdict {
        Verdict::Agree => "agrees",
        Verdict::Disagree => "disagrees",
        Verdict::Undecided => "undecided: too little was sampled to say that it agrees",
    };
    let apart = format!("{significant} of {places} places apart at {significance} ({correction})");
    lines.add("verdict", format!("{said}: {apart}"));
    let percent =
        |part: Option<f64>| part.map_or_else(|| "any".to_owned(), |x| format!("{:.2} %", 100.0 * x));
    let [one, several] =
        if record.quantity.contains("pixel") { ["pixel", "tile"] } else { ["face", "surface"] };
    lines.add(
        "power",
        format!(
            "a deviation of the whole by {} would have been found nine times out of ten, of a typical {several} by {}, of a typical {one} by {}",
            percent(power.whole),
            percent(power.surface),
            percent(power.face)
        ),
    );
    lines.add(
        "scores",
        format!("mean {:.3}, mean of squares {:.3}", record.score_mean, record.score_variance),
    );
    record.worst.iter().for_each(|place| lines.add("worst", worst(place)));
    lines.add(
        "compared",
        format!("{}, independent runs: {}, error from: {}", record.quantity, record.seeds, record.error_from),
    );
    output::print(&lines.under(&format!("{} → {}", record.bundle, folder.path().display())))
}

/// One of the places farthest apart, in words.
fn worst(place: &JudgedPlace) -> String {
    let ([known, _], [found, _]) = (place.reference, place.found);
    let relative =
        if known == 0.0 { String::new() } else { format!(", {:+.2} %", 100.0 * (found / known - 1.0)) };
    format!("z = {:+.2}{relative}: {}, band {}", place.z, place.name, place.band)
}
