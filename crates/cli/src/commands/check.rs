//! `fredholm check`.

use std::io::Write;
use std::path::Path;
use std::sync::Arc;

use fredholm_report::{Back, Camera, Field, Side, render_sides, write_atomically};
use fredholm_scene::{Report, Scene};

use super::solve::{report_failure, view_camera};
use crate::args::CheckArgs;
use crate::duration::in_words;
use crate::failure::{Ending, Failure};
use crate::interrupt::Interrupt;
use crate::options::ProblemOptions;
use crate::problem::{Problem, scene_failure, with_results};
use crate::stages::Stages;
use crate::summary::{Lines, extent};
use crate::{console, folder, memory, output, sample, threads};

/// Name of the picture.
const PICTURE: &str = "check.png";
/// Seconds for the matrix from which on another way is named.
const LONG: f64 = 600.0;
/// What is named where the matrix is too much.
const INSTEAD: &str = "solve --accuracy 5% needs no matrix: links between groups of elements take its place";

/// Validates a scene, tells what its mesh is and predicts what its solution will take.
pub(crate) fn check(args: &CheckArgs) -> Result<Ending, Failure> {
    let interrupt = Interrupt::install(args.log.log)?;
    if let Some(folder) = &args.output {
        folder::probe(folder, "-o DIR")?;
    }
    let console = console::choose(args.log);
    let mut stages = Stages::new(&*console, &interrupt);
    memory::tell(args.problem.memory, &*console);
    let ended = threads::pool(args.problem.threads)?.install(|| report(args, &mut stages));
    memory::conclude(&*console);
    ended
}

fn report(args: &CheckArgs, stages: &mut Stages) -> Result<Ending, Failure> {
    let scene = stages.run("scene", || Scene::load(&args.problem.scene).map_err(scene_failure))?;
    let scene = Arc::new(scene);
    let found = stages.run("report", || Ok(scene.report()))?;
    let mut lines = Lines::default();
    geometry(&scene, &found, &mut lines);
    if let Some(folder) = &args.output {
        let path = folder.join(PICTURE);
        stages.run("picture", || picture(&scene, &found, &path))?;
        lines.add("picture", path.display().to_string());
    }
    let options = ProblemOptions::new(&args.problem, scene.solve());
    let more = |plan, scene: &Scene, n| with_results(plan, scene, n, (1, 0));
    let problem = match Problem::refined(Arc::clone(&scene), options, (1, &more), stages) {
        // That is what was asked; what the mesh is is told all the same.
        Err(failure) if failure.ending == Ending::Resources => {
            if !args.log.quiet {
                too_large(&scene, &failure, lines)?;
            }
            return Ok(Ending::Done);
        }
        loaded => loaded?,
    };
    // The sample is one of pairs of elements.
    let seconds = if problem.is_radiosity() {
        Some(stages.run("sample", || Ok(sample::assembly_seconds(&problem)))?)
    } else {
        None
    };
    if args.log.quiet {
        return Ok(Ending::Done);
    }
    solution(&problem, seconds, &mut lines);
    problem.warnings.iter().for_each(|warning| lines.add("warning", warning));
    output::print(&lines.under(&format!("{}: a valid scene", scene.path().display())))?;
    Ok(Ending::Done)
}

/// Says that the matrix does not fit, and what to do.
fn too_large(scene: &Scene, failure: &Failure, mut lines: Lines) -> Result<(), Failure> {
    lines.add("memory", failure.to_string());
    lines.add("instead", INSTEAD);
    scene.notes().iter().for_each(|note| lines.add("warning", note.to_string()));
    let heading = format!("{}: a valid scene whose matrix does not fit", scene.path().display());
    output::print(&lines.under(&heading))
}

/// What the solution will take.
fn solution(problem: &Problem, seconds: Option<f64>, lines: &mut Lines) {
    let mesh = &problem.mesh;
    let [elements, faces, surfaces] =
        [mesh.len(), mesh.faces().len(), mesh.surfaces().len()].map(|count| count as u64);
    lines.add("size", extent(elements, faces, surfaces));
    lines.add("occluders", format!("{} flat pieces", mesh.occluders().len()));
    lines
        .add("unknowns", format!("{} in each band, by {}", problem.unknowns, problem.options.discretisation));
    lines.add("memory", format!("{}: {}", problem.plan.peak(), problem.plan));
    lines.add("memory limit", problem.options.memory_limit().to_string());
    let (threads, solver) = (problem.options.threads, &problem.options.solver);
    let time = |seconds: f64| {
        format!("{} for the form factors on {threads} threads, then {solver}", in_words(seconds))
    };
    lines.add_some("time", seconds.map(time));
    lines.add_some("instead", seconds.filter(|&seconds| seconds > LONG).map(|_| INSTEAD.to_owned()));
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

/// Draws the mesh by its sides.
fn picture(scene: &Scene, found: &Report, path: &Path) -> Result<(), Failure> {
    let camera = match scene.camera() {
        Some(camera) => view_camera(camera),
        None => framing(scene)?,
    };
    let side = |shown: &fredholm_scene::Shown| {
        let back = match (shown.wall, shown.two_sided) {
            (true, _) => Back::Hidden,
            (false, true) => Back::Lit,
            (false, false) => Back::Dark,
        };
        Side { patch: shown.patch, back, marked: shown.meets }
    };
    let sides: Vec<Side> = found.shown.iter().map(side).collect();
    let picture = render_sides(&sides, &found.open, &camera).map_err(report_failure)?;
    let folder = path.parent().unwrap_or(Path::new(""));
    std::fs::create_dir_all(folder)
        .map_err(|error| Failure::new(Ending::Files, format!("cannot make {}: {error}", folder.display())))?;
    write_atomically(path, |out: &mut dyn Write| picture.write_png(out)).map_err(report_failure)
}

/// A camera that sees the whole scene.
fn framing(scene: &Scene) -> Result<Camera, Failure> {
    let mesh = scene.face_mesh().map_err(scene_failure)?;
    let (bands, zero) = (["grey".to_owned()], vec![0.0; mesh.len()]);
    let lamps = scene.exitance(&mesh);
    let emits: Vec<f64> = lamps.chunks_exact(scene.bands().len()).map(|lamp| lamp.iter().sum()).collect();
    let field = Field::new(&mesh, &bands, &zero, &zero).and_then(|field| field.with_exitance(&emits));
    Ok(Camera::framing(&field.map_err(report_failure)?))
}
