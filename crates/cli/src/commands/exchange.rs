//! `fredholm export` and `fredholm convert`.

use std::path::Path;

use fredholm_study::{Error, Lines, Written};

use crate::args::{ConvertArgs, ExportArgs, LogArgs};
use crate::ending::Ending;
use crate::output;
use crate::start::Start;
use crate::terminal::Terminal;

/// Writes a scene for another program.
pub(crate) fn export(args: &ExportArgs) -> Result<Ending, Error> {
    let ExportArgs { scene, output, band, log, .. } = args;
    let start =
        Start { scene, output: output.as_ref(), verb: "export", threads: None, memory: None, log: *log };
    start.run_beside(|folder, terminal| {
        // The parser lets no other name pass.
        let Some(format) = args.format() else { return Ok(Ending::Input) };
        let written = fredholm_study::export(scene, format, band.as_deref(), folder, terminal)?;
        told(scene, &written, args.log)
    })
}

/// Writes a mesh as another format.
pub(crate) fn convert(args: &ConvertArgs) -> Result<Ending, Error> {
    let terminal = Terminal::new(args.log)?;
    let written = fredholm_study::convert(&args.from, &args.to, &terminal)?;
    told(&args.from, &written, args.log)
}

fn told(scene: &Path, written: &Written, log: LogArgs) -> Result<Ending, Error> {
    if log.quiet {
        return Ok(Ending::Done);
    }
    let mut lines = Lines::default();
    lines.add("geometry", format!("{} surfaces of {} polygons", written.surfaces, written.polygons));
    written.notes.iter().for_each(|note| lines.add("note", note));
    let main = written.files.first().map(|path| path.display().to_string()).unwrap_or_default();
    if let [_, others @ ..] = &written.files[..] {
        let more = others.first().map(|path| path.display().to_string());
        let count = others.len();
        lines.add_some(
            "besides",
            more.map(|path| if count > 1 { format!("{path} and {} more", count - 1) } else { path }),
        );
    }
    output::report(&lines.under(&format!("{} → {main}", scene.display())))?;
    Ok(Ending::Done)
}
