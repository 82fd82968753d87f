//! `fredholm converge`.

use std::path::Path;

use fredholm_report::{REFINEMENT_FILES, RefinementRecord};
use fredholm_study::{Error, Watch};

use crate::args::ConvergeArgs;
use crate::ending::Ending;
use crate::output;
use crate::start::Start;
use crate::summary::Lines;

/// Solves a scene on finer and finer meshes and writes what that tells.
pub(crate) fn converge(args: &ConvergeArgs) -> Result<Ending, Error> {
    let start = Start::of(&args.problem, args.output.as_ref(), "converge", args.log);
    start.run(|folder, terminal| {
        let scene = &args.problem.scene;
        let (record, ended) = fredholm_study::converge(scene, &args.options(), folder, terminal)?;
        record.warnings.iter().for_each(|warning| terminal.warn(warning));
        if !args.log.quiet {
            print(folder.path(), &record)?;
        }
        Ok(ended.into())
    })
}

/// Bands whose verdict is shown.
const BANDS: usize = 8;

/// Prints the table of levels and the verdicts.
fn print(folder: &Path, record: &RefinementRecord) -> Result<(), Error> {
    let mut lines = Lines::default();
    lines.add("plot", folder.join(REFINEMENT_FILES[1]).display().to_string());
    lines.add("discretisation", &record.discretisation);
    (0..record.levels.len()).for_each(|at| lines.add(&format!("level {at}"), level(record, at)));
    record.bands.iter().take(BANDS).for_each(|band| lines.add(&band.band, &band.verdict));
    if record.bands.len() > BANDS {
        lines.add("", format!("and {} bands more: see {}", record.bands.len() - BANDS, REFINEMENT_FILES[2]));
    }
    record.warnings.iter().for_each(|warning| lines.add("warning", warning));
    output::print(&lines.under(&format!("{} → {}", record.scene, folder.display())))
}

/// A level, with the worst band's difference to the finest and, where there is one, the smallest order.
fn level(record: &RefinementRecord, at: usize) -> String {
    let level = &record.levels[at];
    let worst = record.bands.iter().map(|band| band.differences[at]).fold(0.0, f64::max);
    let finest = at + 1 == record.levels.len();
    let distance = if finest { String::new() } else { format!(", {worst:.1e} from the finest") };
    let orders = record.bands.iter().filter_map(|band| band.orders[at]);
    let order = orders.reduce(f64::min).map(|order| format!(", order {order:.2}")).unwrap_or_default();
    format!(
        "{} elements, {} unknowns, h {:.4} m, {:.2} s{distance}{order}",
        level.elements, level.unknowns, level.h, level.seconds
    )
}
