//! `fredholm shoot`: progressive radiosity without the matrix.

use std::path::Path;

use fredholm_report::{SHOOTING_FILES, ShootingRecord};
use fredholm_study::{Bytes, Error, Watch};

use crate::args::ShootArgs;
use crate::ending::Ending;
use crate::output;
use crate::start::Start;
use crate::summary::Lines;

/// Shoots until the share asked for is distributed, and writes the field so far.
pub(crate) fn shoot(args: &ShootArgs) -> Result<Ending, Error> {
    let start = Start {
        scene: &args.scene,
        output: args.output.as_ref(),
        verb: "shoot",
        threads: args.threads,
        memory: args.memory,
        log: args.log,
    };
    start.run(|folder, terminal| {
        let (record, ended) = fredholm_study::shoot(&args.scene, &args.options(), folder, terminal)?;
        record.warnings.iter().for_each(|warning| terminal.warn(warning));
        if !args.log.quiet {
            print(folder.path(), &record, !args.no_pictures)?;
        }
        Ok(ended.into())
    })
}

/// Prints what came of the shots.
fn print(folder: &Path, record: &ShootingRecord, drawn: bool) -> Result<(), Error> {
    let mut lines = Lines::default();
    lines.add_some("picture", drawn.then(|| folder.join(SHOOTING_FILES[3]).display().to_string()));
    lines.add(
        "size",
        format!("{} elements, {} of them and of their groups can shoot", record.elements, record.groups),
    );
    lines.add("shots", shots(record));
    lines.add("error", error(record));
    lines.add("form factors", format!("estimated error of one {:.1e} at most", record.form_factor_error));
    lines.add_some("memory", record.peak_memory_bytes.map(|peak| format!("{} at most", Bytes(peak.into()))));
    lines.add(
        "time",
        record
            .timings
            .iter()
            .map(|t| format!("{} {:.2} s", t.stage, t.seconds))
            .collect::<Vec<_>>()
            .join(", "),
    );
    output::print(&lines.under(&format!("{} → {}", record.scene, folder.display())))
}

/// The stated error in the worst band.
fn error(record: &ShootingRecord) -> String {
    let worst = record.mesh_error.as_ref().and_then(|e| e.relative_l2.iter().copied().reduce(f64::max));
    worst.map_or_else(
        || "not estimated: that takes a run that was not interrupted".to_owned(),
        |worst| {
            format!(
                "the irradiance of the faces is right within {worst:.1e} (mesh and unshot light; L2, worst band; estimate)"
            )
        },
    )
}

fn shots(record: &ShootingRecord) -> String {
    let Some(last) = record.shots.last() else { return "none: nothing shines".to_owned() };
    let state = if record.reached { "" } else { ", which is less than was asked for" };
    format!(
        "{} from {} columns in {:.2} s: {:.2} % of the power distributed{state}",
        record.shots.len(),
        last.columns,
        last.seconds,
        100.0 * last.distributed
    )
}
