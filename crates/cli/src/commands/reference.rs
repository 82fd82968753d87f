//! `fredholm reference`.

use fredholm_study::{Error, References};

use crate::args::ReferenceArgs;
use crate::ending::Ending;
use crate::output;
use crate::start::Start;
use crate::summary::{Lines, times};

/// Solves, traces and writes the bundle.
pub(crate) fn reference(args: &ReferenceArgs) -> Result<Ending, Error> {
    let start = Start::of(&args.problem, args.output.as_ref(), "reference", args.log);
    start.run(|folder, terminal| {
        let scene = &args.problem.scene;
        let References { record, faces } =
            fredholm_study::reference(scene, &args.options(), folder, terminal)?;
        if !args.log.quiet {
            let mut lines = Lines::default();
            lines.add("values", format!("{faces} faces, {} bands", record.bands.len()));
            lines.add("stated error", format!("{:.3} % (RMS over faces)", 100.0 * record.relative_error));
            let seen = &record.pixels;
            let picture = format!(
                "{} × {} pixels, {:.3} % (RMS)",
                seen.width,
                seen.height,
                100.0 * seen.relative_error
            );
            lines.add("picture", picture);
            lines.add("time", times(&record.timings));
            output::print(&lines.under(&format!("{} → {}", record.scene, folder.path().display())))?;
        }
        Ok(Ending::Done)
    })
}
