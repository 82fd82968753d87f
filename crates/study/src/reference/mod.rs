//! Reference values with stated errors, to check other tracers with.

use fredholm_linop::Watch;
use fredholm_montecarlo::light::PathTracing;
use fredholm_montecarlo::light::pixels::PixelSampling;
use fredholm_montecarlo::{Enclosure, State, relative_l2};
use fredholm_report::{
    Exposure, Pixels, REFERENCE_FORMAT, ReferencePixels, ReferenceRecord, ReferenceTable, ResultFolder, View,
    write_reference,
};
use fredholm_scene::{Camera, ExportFormat, Scene};

use crate::error::{Error, ErrorKind};
use crate::exchange::{camera, outline, write};
use crate::options::{ProblemOptions, SceneSource, SolveSettings};
use crate::problem::{Problem, pictures, with_results};
use crate::solution::{Solution, compute};
use crate::solve::{report_failure, title, view_camera};
use crate::stages::Stages;
use crate::stochastic::{
    PathOptions, PixelTracer, TraceStop, Tracer, control, controlled, controlling, enclosure, expected_error,
    face_means, faces, with_tracing,
};

/// The script that renders the scene with Mitsuba and judges it, and its name.
const JUDGE_MITSUBA: &str = include_str!("judge_mitsuba.py");
const SCRIPT_NAME: &str = "judge_mitsuba.py";
/// Error that is asked for where nothing is.
const USUAL_ERROR: f64 = 0.002;
/// Error of a row of form factors where neither the caller nor the scene asks for one: small beside
/// what is compared.
const FORM_FACTORS: f64 = 1e-5;

/// Longer side of the picture where no size is asked for, pixels: the error of every pixel is to be
/// small, which takes many samples.
const USUAL_PIXELS_A_SIDE: u32 = 64;
/// Largest side that may be asked for, pixels.
const MOST_PIXELS_A_SIDE: u32 = 4096;
/// Samples of a pixel where nothing is asked for.
const SAMPLES: u32 = 1024;
/// Batches of a pixel: so many that its standard error is well known, of at least so many samples
/// that they share out the pixel.
const BATCHES: u32 = 128;
const SAMPLES_OF_A_BATCH: u32 = 16;
/// Bytes of a pixel and of each of its bands, in memory and in the file.
const BYTES_OF_A_PIXEL: u128 = 18;
const BYTES_OF_A_BAND: u128 = 32;

/// What is asked of [`reference()`].
#[derive(Clone, Debug, Default)]
pub struct ReferenceOptions {
    /// Width and height of the picture, pixels, each from 1 to 4096. None: the camera's, its longer
    /// side no more than 64.
    pub size: Option<[u32; 2]>,
    /// Samples of each pixel, at least. None: 1024.
    pub spp: Option<u32>,
    /// Whether report.html is left out.
    pub no_report: bool,
    /// How paths are made.
    pub paths: PathOptions,
    /// When tracing ends; without anything at a standard error of 0.2 %.
    pub stop: TraceStop,
    /// What decides the size and the effort; form factors are computed to 1e-5 where nothing is
    /// said.
    pub problem: ProblemOptions,
}

/// Solves a scene, traces it with the solution as control variate, and writes the irradiance of
/// every face and the radiosity of every pixel with their stated errors into a folder, with the
/// scene for Mitsuba 3 and pbrt-v4 where its bands are colours or grey, and a script that judges
/// Mitsuba. The record is returned.
///
/// The camera is that of the scene; without one it takes in the whole scene. An eye that would see
/// a wall from behind is moved through it.
///
/// # Errors
/// What is wrong with the scene or the options; [`Resources`](crate::ErrorKind::Resources) before
/// memory is taken that the limit does not allow; [`Interrupted`](crate::ErrorKind::Interrupted)
/// for a run that was cancelled.
pub fn reference(
    source: impl Into<SceneSource>,
    asked: &ReferenceOptions,
    folder: &ResultFolder,
    watch: &dyn Watch,
) -> Result<ReferenceRecord, Error> {
    reference_scene(&source.into(), asked, folder, watch)
}

/// [`reference`], compiled once and not for each kind of source.
fn reference_scene(
    source: &SceneSource,
    asked: &ReferenceOptions,
    folder: &ResultFolder,
    watch: &dyn Watch,
) -> Result<ReferenceRecord, Error> {
    let mut stages = Stages::new(watch).part("reference");
    let (problem, settings) = load(source, asked, &mut stages)?;
    let camera = sized(camera(&problem.scene)?, asked.size)?;
    let solution = compute(&problem, &settings, &mut stages)?;
    let scene = enclosure(&problem.scene, &problem.mesh)?;
    let state = traced(asked, &problem, (&scene, &solution), &mut stages)?;
    let sampling = sampling(asked);
    let pixels = pictured(asked, &scene, (&camera, sampling), &mut stages)?;
    let table = table(&problem, &solution, &state);
    let chosen = problem.scene.camera().is_none_or(|own| own.eye != camera.eye);
    let seen = seen(&camera, chosen, sampling, &pixels);
    if pixels.covered.iter().all(|&share| share == 0.0) {
        stages.watch.warn("the camera sees no lit side of any surface: all pixels are black");
    }
    let record = record(&problem, &table, (&state, seen), &stages);
    scenes(&problem, &camera, folder)?;
    let (title, view) =
        (title(&problem.scene), View { camera: view_camera(&camera), exposure: Exposure::Auto });
    let report = (!asked.no_report).then_some((title.as_str(), &view));
    write_reference(folder, &problem.mesh, (&table, &pixels), &record, report).map_err(report_failure)?;
    Ok(record)
}

/// The camera with a picture of the size asked for, or else of a longer side that is not too long.
fn sized(camera: Camera, asked: Option<[u32; 2]>) -> Result<Camera, Error> {
    let longer = camera.width.max(camera.height).max(1);
    let less = |side: u32| {
        let scaled = f64::from(side) * f64::from(USUAL_PIXELS_A_SIDE.min(longer)) / f64::from(longer);
        (scaled.round() as u32).max(1)
    };
    let [width, height] = asked.unwrap_or([less(camera.width), less(camera.height)]);
    if ![width, height].iter().all(|side| (1..=MOST_PIXELS_A_SIDE).contains(side)) {
        let text = format!("a picture of {width} × {height} pixels is asked for");
        let error = Error::new(ErrorKind::Input, text);
        return Err(error.with_help(format!("give each side from 1 to {MOST_PIXELS_A_SIDE} pixels")));
    }
    Ok(Camera { width, height, ..camera })
}

fn sampling(asked: &ReferenceOptions) -> PixelSampling {
    let spp = asked.spp.unwrap_or(SAMPLES).max(1);
    let batches = (spp / SAMPLES_OF_A_BATCH).clamp(2, BATCHES);
    PixelSampling { seed: asked.paths.seed, batches, samples: spp.div_ceil(batches) }
}

/// The pixels of the camera, as any other tracer sees them: backs are black.
fn pictured(
    asked: &ReferenceOptions,
    scene: &Enclosure,
    (camera, sampling): (&Camera, PixelSampling),
    stages: &mut Stages,
) -> Result<Pixels, Error> {
    let rays = view_camera(camera).rays().map_err(report_failure)?;
    let (eye, size) = (camera.eye, [camera.width, camera.height]);
    let estimator = Box::new(PathTracing::continuous(asked.paths.switches()));
    let see = Box::new(move |x, y| scene.cast(eye, rays(x, y)));
    let tracer = PixelTracer { scene, estimator, size, sampling, see };
    let watch = stages.watch;
    stages.run("pixels", || tracer.trace(watch).ok_or_else(Error::cancelled))
}

/// The camera and how well its pixels are known.
fn seen(camera: &Camera, chosen: bool, sampling: PixelSampling, pixels: &Pixels) -> ReferencePixels {
    let even = vec![1.0; camera.width as usize * camera.height as usize];
    let [eye, target, up] = [camera.eye, camera.target, camera.up].map(|v| v.to_array());
    ReferencePixels {
        eye,
        target,
        up,
        vertical_fov_degrees: camera.vertical_fov_degrees,
        width: camera.width,
        height: camera.height,
        chosen,
        batches: sampling.batches,
        samples: sampling.samples,
        relative_error: relative_l2(&even, &pixels.radiosity, &pixels.standard_error).unwrap_or(0.0),
    }
}

/// Error over the own value, the median of what is not 0; 0 where nothing is.
fn median(values: &[f64], errors: &[f64]) -> f64 {
    let lit = values.iter().zip(errors).filter(|(value, _)| **value > 0.0);
    let mut shares: Vec<f64> = lit.map(|(value, error)| error / value).collect();
    shares.sort_by(f64::total_cmp);
    shares.get(shares.len() / 2).copied().unwrap_or(0.0)
}

/// Writes the scene for Mitsuba 3 and pbrt-v4, where its bands are colours or grey, and what judges
/// Mitsuba.
fn scenes(problem: &Problem, camera: &Camera, folder: &ResultFolder) -> Result<(), Error> {
    let Ok(mut outline) = outline(&problem.scene, None) else { return Ok(()) };
    outline.camera = Some(*camera);
    for format in [ExportFormat::Mitsuba, ExportFormat::Pbrt] {
        write(&outline, format, folder, "scene")?;
    }
    folder.write(SCRIPT_NAME, |out| out.write_all(JUDGE_MITSUBA.as_bytes())).map(drop).map_err(report_failure)
}

/// The problem, with form factors more exact than for a picture.
fn load(
    source: &SceneSource,
    asked: &ReferenceOptions,
    stages: &mut Stages,
) -> Result<(Problem, SolveSettings), Error> {
    let [width, height] = asked.size.unwrap_or([USUAL_PIXELS_A_SIDE; 2]).map(u128::from);
    let pixel = |scene: &Scene| BYTES_OF_A_PIXEL + BYTES_OF_A_BAND * scene.bands().len() as u128;
    let more = |plan, scene: &Scene, n| {
        let pictures = pictures(scene, 1, (false, (0, false)));
        with_results(with_tracing(plan, scene, n), scene, n, (pictures, width * height * pixel(scene)))
    };
    let asked = &asked.problem;
    let mut problem = controlling(source, asked, &more, stages)?;
    let tolerance = asked.form_factor_tolerance.or(problem.scene.solve().form_factor_tolerance);
    problem.options.form_factor_tolerance = tolerance.unwrap_or(FORM_FACTORS);
    let settings = SolveSettings::of_control(problem.options.clone(), problem.scene.solve());
    Ok((problem, settings))
}

/// The irradiances.
fn traced(
    asked: &ReferenceOptions,
    problem: &Problem,
    (scene, solution): (&Enclosure, &Solution),
    stages: &mut Stages,
) -> Result<State, Error> {
    let known = control(scene, solution, false)?;
    let (watch, groups) = (stages.watch, faces(&problem.mesh, scene)?);
    let method = stages.run("trial", || Ok(controlled(scene, known, &groups, &asked.paths, watch)))?;
    let stop = asked.stop.or_to(USUAL_ERROR);
    let tracer = Tracer::new(scene, &method, groups, &asked.paths, &stop)?;
    let mut state = tracer.start();
    stages.run("tracing", || tracer.run(&mut state, watch))?;
    if stages.is_cancelled() { Err(Error::cancelled()) } else { Ok(state) }
}

fn table(problem: &Problem, solution: &Solution, state: &State) -> ReferenceTable {
    let (mesh, scene) = (&problem.mesh, &problem.scene);
    let mut factors = expected_error(problem, solution, false);
    reflect(&mut factors, problem);
    let error = state.groups.standard_errors().iter().zip(&factors).map(|(s, f)| s.hypot(*f)).collect();
    let material = |face: usize| &scene.materials()[mesh.surfaces()[mesh.faces()[face].surface].material];
    let all = || 0..mesh.faces().len();
    ReferenceTable {
        irradiance: state.groups.mean().to_vec(),
        error,
        deterministic: face_means(problem, solution),
        reflectance: all().flat_map(|face| material(face).reflectance.clone()).collect(),
        exitance: all().flat_map(|face| material(face).exitance.clone()).collect(),
    }
}

/// Adds to the errors that form factors leave in the irradiance of faces what comes of them where
/// they are reflected as light is: ρ/(1 − ρ) times their mean, with the largest reflectance.
fn reflect(errors: &mut [f64], problem: &Problem) {
    let (faces, bands) = (problem.mesh.faces(), problem.scene.bands().len());
    let reflectance = problem.scene.reflectance(&problem.mesh);
    let whole: f64 = faces.iter().map(|face| face.area).sum();
    for band in 0..bands {
        let of_band = errors.iter().skip(band).step_by(bands);
        let mean = of_band.zip(faces).map(|(error, face)| error * face.area).sum::<f64>() / whole;
        let rho = reflectance.iter().skip(band).step_by(bands).copied().fold(0.0, f64::max);
        errors.iter_mut().skip(band).step_by(bands).for_each(|error| *error += mean * rho / (1.0 - rho));
    }
}

fn record(
    problem: &Problem,
    table: &ReferenceTable,
    (state, pixels): (&State, ReferencePixels),
    stages: &Stages,
) -> ReferenceRecord {
    let conventions = [
        "lengths in m; irradiance E, radiosity B and exitance M in W/m²; an emitter has the radiance M/π",
        "faces are Lambertian, and lit on the side from which their corners run counter-clockwise",
        "E is the mean over the whole face; what is buried under an object counts as 0",
        "E_error is one standard deviation of all known errors: standard error and form factors",
        "pixels.npz: radiosity is the mean over a pixel, rows from the top; its radiance is radiosity/π",
        "pixels.npz: standard_error is one standard deviation of all known errors",
        "what is seen of nothing, or of the back of a face, counts as 0",
    ];
    let areas: Vec<f64> = problem.mesh.faces().iter().map(|face| face.area).collect();
    ReferenceRecord {
        format: REFERENCE_FORMAT.to_owned(),
        version: env!("CARGO_PKG_VERSION").to_owned(),
        scene: problem.scene.path().display().to_string(),
        scene_sha256: problem.scene.sha256().to_owned(),
        conventions: conventions.map(str::to_owned).to_vec(),
        method: "particles that carry what the deterministic solution has missed".to_owned(),
        bands: problem.scene.bands().to_vec(),
        faces: problem.mesh.faces().len(),
        relative_error: relative_l2(&areas, &table.irradiance, &table.error).unwrap_or(0.0),
        median_error: median(&table.irradiance, &table.error),
        form_factor_tolerance: problem.options.form_factor_tolerance,
        seed: state.seed,
        batches: state.batches(),
        pixels,
        timings: stages.timings().to_vec(),
    }
}
