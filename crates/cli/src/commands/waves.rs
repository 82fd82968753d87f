//! `fredholm waves`.

use fredholm_study::{
    CheckedCoupling, CheckedWaves, CouplingStorage, Ended, Error, ErrorKind, Lines, ResultFolder, Watch,
    WaveCompareOptions, WaveMethod, WaveOptions, WaveRecord, check_waves, frequencies,
};

use crate::args::{CheckArgs, WavesArgs};
use crate::duration::on_threads;
use crate::ending::Ending;
use crate::output;
use crate::start::Start;
use crate::terminal::Terminal;

/// Computes a scene of waves and writes the results.
pub(crate) fn waves(args: &WavesArgs) -> Result<Ending, Error> {
    let start = Start {
        scene: &args.scene,
        output: args.output.as_ref(),
        verb: match (args.comparison(), args.methods.is_empty()) {
            (Some(_), _) => "compare",
            (None, false) => "methods",
            (None, true) => "",
        },
        threads: args.threads,
        memory: args.memory,
        log: args.log,
    };
    start.run(|folder, terminal| match args.comparison() {
        Some(comparison) => compare(args, &comparison, folder, terminal),
        None if !args.methods.is_empty() => compare_methods(args, folder, terminal),
        None => run(args, folder, terminal),
    })
}

fn run(args: &WavesArgs, folder: &ResultFolder, terminal: &Terminal) -> Result<Ending, Error> {
    let mut solved = fredholm_study::waves(&args.scene, &args.options(), terminal)?;
    solved.write(folder)?;
    if solved.ended() != Ended::Done {
        terminal.warn("the residual asked for was not reached; the results are those of the last iteration");
    }
    output::summarise(&WaveRecord(&solved.record()), folder.path(), args.log)?;
    Ok(solved.ended().into())
}

fn compare(
    args: &WavesArgs,
    comparison: &WaveCompareOptions,
    folder: &ResultFolder,
    terminal: &Terminal,
) -> Result<Ending, Error> {
    let (scene, options) = (&args.scene, args.options());
    let (record, ended) = fredholm_study::compare_waves(scene, &options, comparison, folder, terminal)?;
    output::summarise(&record, folder.path(), args.log)?;
    Ok(ended.into())
}

fn compare_methods(args: &WavesArgs, folder: &ResultFolder, terminal: &Terminal) -> Result<Ending, Error> {
    let (scene, options) = (&args.scene, args.options());
    let methods = WaveMethod::list(&args.methods).map_err(|text| Error::new(ErrorKind::Input, text))?;
    let (record, ended) = fredholm_study::compare_wave_methods(scene, &options, &methods, folder, terminal)?;
    output::summarise(&record, folder.path(), args.log)?;
    Ok(ended.into())
}

/// Validates a scene of waves, tells what its mesh is and predicts what its fields will take.
pub(super) fn check(args: &CheckArgs, terminal: &Terminal) -> Result<Ending, Error> {
    if args.output.is_some() {
        terminal.warn("scenes of waves are not drawn by check; -o is left aside");
    }
    if args.accuracy.is_some() {
        terminal.warn("scenes of waves are not solved to an accuracy; --accuracy is left aside");
    }
    let options = WaveOptions { memory: args.problem.memory, no_report: true, ..WaveOptions::default() };
    let checked = check_waves(&args.problem.scene, &options, terminal)?;
    if !args.log.quiet {
        output::report(&forecast(&checked))?;
    }
    Ok(Ending::Done)
}

fn forecast(checked: &CheckedWaves) -> String {
    let mut lines = Lines::default();
    lines.add_some("title", checked.title.clone());
    lines.add("method", format!("{}, {}", checked.method, checked.solution));
    lines.add("frequencies", frequencies(&checked.frequencies));
    lines.add("mesh", format!("{} facets on {} surfaces", checked.facets, checked.surfaces));
    checked.findings.iter().for_each(|finding| lines.add("found", finding.to_string()));
    lines.add("receivers", format!("{} points and directions", checked.places));
    lines.add("memory", format!("{}: {}", checked.plan.peak(), checked.plan));
    let coupling = |CheckedCoupling { unknowns, whole, storage }| {
        let how = match storage {
            CouplingStorage::Matrix => format!("in a matrix of {whole}"),
            CouplingStorage::Compressed => format!("in a compressed matrix, which whole would take {whole}"),
            CouplingStorage::Multipole => format!("by multipoles, whose matrix would take {whole}"),
            CouplingStorage::Products => {
                format!("whose products are computed anew; their matrix would take {whole}")
            }
        };
        format!("{unknowns} unknowns {how}")
    };
    lines.add_some("coupling", checked.coupling.map(coupling));
    lines.add("memory limit", checked.limit.to_string());
    lines.add_some("time", checked.seconds.map(|seconds| on_threads(seconds, checked.threads)));
    checked.warnings.iter().for_each(|warning| lines.add("warning", warning));
    lines.under(&format!("{}: a valid scene of waves", checked.path.display()))
}
