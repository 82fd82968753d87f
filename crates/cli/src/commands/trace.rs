//! `fredholm trace`.

use std::path::Path;

use fredholm_study::{Error, FIELD_METHODS, Traced};

use crate::args::TraceArgs;
use crate::ending::Ending;
use crate::output;
use crate::start::Start;
use crate::summary::{Lines, times};

/// Traces a scene and writes the results.
pub(crate) fn trace(args: &TraceArgs) -> Result<Ending, Error> {
    let start = Start::of(&args.problem, args.output.as_ref(), "trace", args.log);
    start.run(|folder, terminal| {
        let scene = &args.problem.scene;
        let (traced, ended) = fredholm_study::trace(scene, &args.options(), folder, terminal)?;
        if !args.log.quiet {
            let fields = FIELD_METHODS.contains(&args.method.as_str());
            let lines = if fields { fields_of(&traced) } else { light_of(&traced, args, folder.path()) };
            let heading = format!("{} → {}", traced.record.solver, folder.path().display());
            output::print(&lines.under(&heading))?;
        }
        Ok(ended.into())
    })
}

fn fields_of(Traced { record, fields, .. }: &Traced) -> Lines {
    let mut lines = Lines::default();
    lines.add("fields", format!("{fields} points and frequencies in receivers.csv"));
    lines.add("result", &record.stop_reason);
    lines.add("time", times(&record.timings));
    lines
}

fn light_of(Traced { record, seconds, .. }: &Traced, args: &TraceArgs, folder: &Path) -> Lines {
    let mut lines = Lines::default();
    let drawn = !args.no_pictures;
    lines.add_some("picture", drawn.then(|| folder.join("image.png").display().to_string()));
    let count = |name: &str| record.work.get(name).copied().unwrap_or(0);
    let [batches, samples, paths, rays] = ["batches", "samples_of_a_batch", "paths", "rays"].map(count);
    lines.add("samples", format!("{batches} batches of {samples}, {paths} paths, {rays} rays"));
    lines.add("result", &record.stop_reason);
    lines.add("time", format!("{seconds:.2} s of tracing"));
    lines
}
