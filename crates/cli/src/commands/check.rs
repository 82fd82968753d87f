//! `fredholm check`.

use fredholm_scene::waves::is_wave_scene;
use fredholm_scene::{Report, Scene};
use fredholm_study::{
    Checked, Error, Forecast, Lines, MemoryPlan, ResultFolder, ToAccuracy, claim_folder_to_add, extent,
};

use crate::args::CheckArgs;
use crate::duration::on_threads;
use crate::ending::Ending;
use crate::terminal::Terminal;
use crate::{output, start};

/// Name of the picture.
const PICTURE: &str = "check.png";
/// Seconds for the matrix from which on another way is named.
const LONG_RUN_SECONDS: f64 = 600.0;
/// What is named where the matrix is too much.
const INSTEAD_OF_MATRIX: &str =
    "solve --accuracy 5% needs no matrix: rays, or links between groups of elements, take its place";

/// Validates a scene, tells what its mesh is and predicts what its solution will take.
pub(crate) fn check(args: &CheckArgs) -> Result<Ending, Error> {
    let terminal = Terminal::new(args.log)?;
    let folder = args.output.as_ref().map(|folder| claim_folder_to_add(folder, "-o DIR")).transpose()?;
    let (threads, memory) = (args.problem.threads, args.problem.memory);
    start::run(&terminal, threads, memory, || report(args, folder.as_ref(), &terminal))
}

fn report(args: &CheckArgs, folder: Option<&ResultFolder>, terminal: &Terminal) -> Result<Ending, Error> {
    if is_wave_scene(&args.problem.scene) {
        return super::waves::check(args, terminal);
    }
    let picture = folder.map(|folder| folder.path().join(PICTURE));
    let (path, options) = (&args.problem.scene, args.problem.options());
    let asked = (&options, args.accuracy);
    let Checked { scene, report, forecast, to_accuracy } =
        fredholm_study::check(path, asked, folder.map(|folder| (folder, PICTURE)), terminal)?;
    if args.log.quiet {
        return Ok(Ending::Done);
    }
    let mut lines = Lines::default();
    geometry(&scene, &report, &mut lines);
    lines.add_some("picture", picture.map(|path| path.display().to_string()));
    if let Some(found) = &to_accuracy {
        lines.add("accuracy", format!("{:.2} %: {}", 100.0 * found.accuracy, found.way));
    }
    match (forecast, to_accuracy.filter(|found| !found.by_matrix)) {
        (forecast, Some(found)) => {
            chosen(forecast.as_ref().ok(), &found, &mut lines);
            scene.notes().iter().for_each(|note| lines.add("warning", note.to_string()));
            output::report(&lines.under(&format!("{}: a valid scene", scene.path().display())))?;
        }
        (Ok(forecast), None) => {
            solution(&forecast, &mut lines);
            output::report(&lines.under(&format!("{}: a valid scene", scene.path().display())))?;
        }
        (Err(error), None) => too_large(&scene, &error, lines)?,
    }
    Ok(Ending::Done)
}

/// Says that the matrix does not fit, and what to do.
fn too_large(scene: &Scene, error: &Error, mut lines: Lines) -> Result<(), Error> {
    lines.add("memory", error.to_string());
    lines.add("instead", INSTEAD_OF_MATRIX);
    scene.notes().iter().for_each(|note| lines.add("warning", note.to_string()));
    let heading = format!("{}: a valid scene whose matrix does not fit", scene.path().display());
    output::report(&lines.under(&heading))
}

/// What the solution to an accuracy will take that chooses its elements.
fn chosen(forecast: Option<&Forecast>, found: &ToAccuracy, lines: &mut Lines) {
    if let Some(Forecast { elements, faces, surfaces, .. }) = forecast {
        lines.add("size", extent(*elements as u64, *faces as u64, *surfaces as u64));
    }
    let memory = |plan: &MemoryPlan| format!("about {}: {plan}", plan.peak());
    lines.add_some("memory", found.plan.as_ref().map(memory));
    lines.add_some("memory limit", forecast.map(|forecast| forecast.limit.to_string()));
    lines.add_some("time", found.seconds.map(|seconds| on_threads(seconds, found.threads)));
}

/// What the solution will take.
fn solution(forecast: &Forecast, lines: &mut Lines) {
    let Forecast { elements, faces, surfaces, threads, solver, seconds, .. } = forecast;
    lines.add("size", extent(*elements as u64, *faces as u64, *surfaces as u64));
    lines.add("occluders", format!("{} flat pieces", forecast.occluders));
    lines.add("unknowns", format!("{} in each band, by {}", forecast.unknowns, forecast.discretisation));
    lines.add("memory", format!("{}: {}", forecast.plan.peak(), forecast.plan));
    lines.add("memory limit", forecast.limit.to_string());
    let time = |seconds| format!("{}, by {solver}", on_threads(seconds, *threads));
    lines.add_some("time", seconds.map(time));
    lines.add_some(
        "instead",
        seconds.filter(|&seconds| seconds > LONG_RUN_SECONDS).map(|_| INSTEAD_OF_MATRIX.to_owned()),
    );
    forecast.warnings.iter().for_each(|warning| lines.add("warning", warning));
}

/// What the scene and its mesh are.
fn geometry(scene: &Scene, found: &Report, lines: &mut Lines) {
    if let Some(title) = scene.title() {
        lines.add("title", title);
    }
    lines.add("bands", scene.bands().join(", "));
    let Report { pieces, components, closed, diagonal, .. } = found;
    lines.add(
        "mesh",
        format!(
            "{pieces} flat pieces that hang together in {components} objects, {closed} of them closed; {diagonal:.3} m from end to end"
        ),
    );
    found.findings.iter().for_each(|finding| lines.add("found", finding.to_string()));
}
