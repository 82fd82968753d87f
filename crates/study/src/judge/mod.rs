//! Whether another tracer agrees with reference values: its faces or its pixels, place by place.
//!
//! Of each place t = (y − x)/√(s² + δ²): y is the mean over the tracer's independent runs and s its
//! standard error, x the reference, δ the standard deviation of its known errors and of rounding. t
//! is taken for Student's, with one degree of freedom less than the tracer has runs, or the
//! reference has batches where these are fewer. Besides single faces or pixels, surfaces or tiles
//! of pixels and the whole are compared: their means show what no single place does. The statistics
//! are those of [`crosscheck`](crate::crosscheck).

mod known;

use std::path::{Path, PathBuf};

use fredholm_linop::Watch;
use fredholm_montecarlo::statistics::{Comparison, Crosscheck, Moments, Place, Suite, crosscheck};
use fredholm_report::{
    JUDGE_FORMAT, JudgeRecord, JudgedPlace, Measured, ReferenceRecord, ResultFolder, read_reference_record,
    write_judgement,
};

use known::Known;

use crate::crosscheck::record::PLACES_NAMED;
use crate::crosscheck::{MultipleTests, Power, Verdict, verdict};
use crate::error::{Error, ErrorKind};
use crate::solve::report_failure;
use crate::stages::Stages;
use crate::stochastic::failure;

/// Relative standard deviation of rounding where nothing is said: of a tracer that sums up many
/// samples in single precision.
const ROUNDING: f64 = 1e-5;

/// What is asked of [`judge()`].
#[derive(Clone, Debug)]
pub struct JudgeOptions {
    /// Probability of a false alarm that is allowed.
    pub significance: f64,
    /// How the number of tests is taken into account.
    pub correction: MultipleTests,
    /// Whether the values have no random error, as those of a deterministic program.
    pub exact: bool,
    /// Relative standard deviation of rounding. None: 1e-5; no less than that of the numbers in the
    /// files.
    pub rounding: Option<f64>,
}

impl Default for JudgeOptions {
    fn default() -> Self {
        Self { significance: 0.01, correction: MultipleTests::default(), exact: false, rounding: None }
    }
}

/// Judges what a tracer has found by a bundle of [`reference`](crate::reference()), and writes what
/// that came to into a folder.
///
/// `files` are tables of faces (`.csv`: irradiance in W/m²), or pictures (`.npy`, `.exr`: radiance
/// in W/(m² sr); `.npz` as [`trace`](crate::trace) writes them); several of them, or a stack of
/// pictures, are independent runs, from whose spread the tracer's error is estimated. A single
/// table, or an `.npz`, may state standard errors instead.
///
/// # Errors
/// [`ErrorKind::Input`] for files that cannot be used or whose error is not known,
/// [`ErrorKind::Files`] for those that cannot be read or written.
pub fn judge(
    bundle: impl AsRef<Path>,
    files: &[PathBuf],
    asked: &JudgeOptions,
    folder: &ResultFolder,
    watch: &dyn Watch,
) -> Result<(JudgeRecord, Verdict), Error> {
    judge_bundle(bundle.as_ref(), files, asked, folder, watch)
}

/// [`judge`], compiled once and not for each kind of source.
fn judge_bundle(
    bundle: &Path,
    files: &[PathBuf],
    asked: &JudgeOptions,
    folder: &ResultFolder,
    watch: &dyn Watch,
) -> Result<(JudgeRecord, Verdict), Error> {
    let mut stages = Stages::new(watch).part("judge");
    let record = read_reference_record(bundle).map_err(report_failure)?;
    let (known, measured) = stages.run("files", || read(bundle, &record, files))?;
    let rounding = asked.rounding.unwrap_or(ROUNDING).max(measured.rounding);
    let values = known.values();
    let errors = known.errors(&values, rounding);
    let found = Found::new(&known, &measured, asked.exact)?;
    let compared = found.compared(asked, (&values, &errors))?;
    let power = Power::new(&known.places, &values, &compared);
    let verdict = verdict(&compared, &power);
    let sides = Sides { known: &known, values: &values, errors: &errors, found: &found, record: &record };
    let places: Vec<JudgedPlace> = compared.places.iter().map(|place| sides.judged(place)).collect();
    let suite = Suite::new(&sides.uncertain(&compared));
    let judged = JudgeRecord {
        format: JUDGE_FORMAT.to_owned(),
        version: env!("CARGO_PKG_VERSION").to_owned(),
        bundle: bundle.display().to_string(),
        scene_sha256: record.scene_sha256.clone(),
        files: files.iter().map(|file| file.display().to_string()).collect(),
        quantity: known.quantity().to_owned(),
        verdict: verdict.name().to_owned(),
        significance: asked.significance,
        correction: asked.correction.correction().name().to_owned(),
        seeds: measured.seeds.len(),
        error_from: found.from.to_owned(),
        rounding,
        places: places.len(),
        significant: compared.significant,
        power: power.record(),
        score_mean: suite.mean,
        score_variance: suite.variance,
        worst: compared.worst(PLACES_NAMED).iter().map(|place| sides.judged(place)).collect(),
        timings: stages.timings().to_vec(),
    };
    write_judgement(folder, &places, known.shape, &judged).map_err(report_failure)?;
    Ok((judged, verdict))
}

/// The reference, and all files as one.
fn read(bundle: &Path, record: &ReferenceRecord, files: &[PathBuf]) -> Result<(Known, Measured), Error> {
    let is_table = |file: &PathBuf| file.extension().is_some_and(|e| e.eq_ignore_ascii_case("csv"));
    let tables = files.iter().filter(|file| is_table(file)).count();
    if files.is_empty() || (tables > 0 && tables < files.len()) {
        let text = "tables of faces and pictures, or nothing at all, cannot be judged together".to_owned();
        let help = "give one or more .csv files, or one or more .npy, .npz and .exr files";
        return Err(Error::new(ErrorKind::Input, text).with_help(help));
    }
    let known = if tables > 0 { Known::faces(bundle, record) } else { Known::pixels(bundle, record) }?;
    let mut all = Measured::default();
    for file in files {
        let one = known.read(file)?;
        all.seeds.extend(one.seeds);
        // The spread of several says more than what each says of itself.
        all.sigma = one.sigma.filter(|_| files.len() == 1);
        all.rounding = all.rounding.max(one.rounding);
    }
    Ok((known, all))
}

/// Mean and standard error of a tracer at all places.
struct Found {
    mean: Vec<f64>,
    error: Vec<f64>,
    /// Where the error comes from.
    from: &'static str,
    /// Batches behind the less certain of both sides.
    batches: u64,
}

impl Found {
    fn new(known: &Known, measured: &Measured, exact: bool) -> Result<Self, Error> {
        let Measured { seeds, sigma, .. } = measured;
        let mut moments = Moments::new(known.places.means(&seeds[0]).len());
        for seed in seeds {
            moments.push(&known.places.means(seed));
        }
        let mean = moments.mean().to_vec();
        if exact {
            let error = vec![0.0; mean.len()];
            return Ok(Self { mean, error, from: "exact", batches: known.batches });
        }
        if seeds.len() > 1 {
            let batches = moments.count().min(known.batches);
            return Ok(Self { mean, error: moments.standard_errors(), from: "seeds", batches });
        }
        if let Some(sigma) = sigma {
            let error = known.combined(sigma);
            return Ok(Self { mean, error, from: "sigma", batches: known.batches });
        }
        let text =
            "the random error of the tracer is not known: there is one run, and nothing says its error";
        Err(Error::new(ErrorKind::Input, text.to_owned()).with_help(
            "give several files of different seeds, a stack of pictures, or columns sigma_BAND in a table; \
             of a program without random error say --exact",
        ))
    }

    fn compared(
        &self,
        asked: &JudgeOptions,
        (values, errors): (&[f64], &[f64]),
    ) -> Result<Crosscheck, Error> {
        let comparison = Comparison {
            deterministic: values,
            deterministic_error: errors,
            stochastic: &self.mean,
            standard_error: &self.error,
            single: &vec![0.0; values.len()],
            batches: self.batches,
        };
        crosscheck(&comparison, asked.correction.correction(), asked.significance).map_err(failure)
    }
}

/// Both sides at all places.
struct Sides<'a> {
    known: &'a Known,
    values: &'a [f64],
    errors: &'a [f64],
    found: &'a Found,
    record: &'a ReferenceRecord,
}

impl Sides<'_> {
    fn judged(&self, place: &Place) -> JudgedPlace {
        let at = place.index;
        let (kind, number, name, band) = self.known.named(at);
        JudgedPlace {
            kind: kind.into(),
            place: number,
            name,
            band: self.record.bands[band].clone(),
            reference: [self.values[at], self.errors[at]],
            found: [self.found.mean[at], self.found.error[at]],
            z: place.z,
            p: place.p,
            significant: place.significant,
        }
    }

    /// The scores of faces or pixels, without those where neither side has a random error.
    fn uncertain(&self, compared: &Crosscheck) -> Vec<f64> {
        let single = &compared.places[..self.known.places.of_faces()];
        let own = |place: &&Place| {
            self.found.error[place.index] > 0.0 || self.known.reference.errors[place.index] > 0.0
        };
        single.iter().filter(own).map(|place| place.z).collect()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::problem::scene_failure;
    use crate::solve::view_camera;
    use crate::stochastic::{PixelTracer, TraceStop, enclosure};
    use crate::{Quiet, ReferenceOptions, reference};
    use fredholm_mesh::Vec3;
    use fredholm_montecarlo::density::{Cosine, DirectionDensity, UniformHemisphere};
    use fredholm_montecarlo::light::pixels::PixelSampling;
    use fredholm_montecarlo::light::{PathTracing, Switches};
    use fredholm_scene::Scene;
    use std::fs;

    const TEST_SCENE: &str = r#"
bands = ["r", "g"]
[camera]
eye = [0.1, 0.1, 1.4]
target = [1.4, 1.6, 0.9]
vertical_fov_degrees = 75
width = 12
height = 9
[materials.wall]
reflectance = [0.7, 0.5]
[materials.lamp]
reflectance = 0.2
exitance = [10.0, 8.0]
[[surface]]
name = "walls"
material = "wall"
box = { min = [0, 0, 0], max = [2, 2, 2], inward = true }
divide = [2, 2]
[[surface]]
name = "screen"
material = "wall"
quad = [[0.9, 1.5, 0.2], [1.6, 1.0, 0.2], [1.6, 1.0, 1.1], [0.9, 1.5, 1.1]]
two_sided = true
[[surface]]
name = "lamp"
material = "lamp"
back_material = "wall"
two_sided = true
quad = [[0.9, 0.9, 1.8], [0.9, 1.4, 1.8], [1.4, 1.4, 1.8], [1.4, 0.9, 1.8]]
"#;

    fn scene(text: &str) -> Scene {
        Scene::from_str(text, "room.toml").unwrap()
    }

    /// The room with one text in the place of another.
    fn with(old: &str, new: &str) -> String {
        assert!(TEST_SCENE.contains(old), "{old}");
        TEST_SCENE.replace(old, new)
    }

    /// The pixels of a scene by our own paths, as a traced run writes them.
    fn pictured(text: &str, paths: PathTracing, seed: u64, path: &Path) {
        let scene = scene(text);
        let mesh = scene.mesh().map_err(scene_failure).unwrap();
        let (walls, camera) = (enclosure(&scene, &mesh).unwrap(), *scene.camera().unwrap());
        let rays = view_camera(&camera).rays().unwrap();
        let (walls, size) = (&walls, [camera.width, camera.height]);
        let sampling = PixelSampling { seed, batches: 64, samples: 32 };
        let see = Box::new(move |x, y| walls.cast(camera.eye, rays(x, y)));
        let tracer = PixelTracer { scene: walls, estimator: Box::new(paths), size, sampling, see };
        let pixels = tracer.trace(&Quiet).unwrap();
        pixels.write_npz(&mut fs::File::create(path).unwrap()).unwrap();
    }

    /// Draws even directions and takes them for those of the cosine.
    struct NoCosine;

    impl DirectionDensity for NoCosine {
        fn sample(&self, numbers: [f64; 2]) -> Vec3 {
            UniformHemisphere.sample(numbers)
        }

        fn pdf(&self, direction: Vec3) -> f64 {
            Cosine.pdf(direction)
        }
    }

    fn claim(folder: &Path) -> ResultFolder {
        ResultFolder::claim(folder).unwrap()
    }

    #[test]
    fn what_is_right_agrees_and_every_planted_fault_is_found() {
        let folder = tempfile::tempdir().unwrap();
        let bundle = folder.path().join("bundle");
        let stop = TraceStop { error: Some(0.01), ..TraceStop::default() };
        let asked = ReferenceOptions { spp: Some(4096), stop, ..ReferenceOptions::default() };
        reference(scene(TEST_SCENE), &asked, &claim(&bundle), &Quiet).unwrap();
        let plain = || PathTracing::continuous(Switches::default());
        let short = Switches { bounces: Some(4), ..Switches::default() };
        let dark =
            "quad = [[0.9, 1.5, 0.2], [1.6, 1.0, 0.2], [1.6, 1.0, 1.1], [0.9, 1.5, 1.1]]\ntwo_sided = true";
        let turned = "quad = [[0.9, 1.5, 0.2], [0.9, 1.5, 1.1], [1.6, 1.0, 1.1], [1.6, 1.0, 0.2]]";
        let lamp = "quad = [[0.91, 0.9, 1.8], [0.91, 1.4, 1.8], [1.41, 1.4, 1.8], [1.41, 0.9, 1.8]]";
        let old_lamp = "quad = [[0.9, 0.9, 1.8], [0.9, 1.4, 1.8], [1.4, 1.4, 1.8], [1.4, 0.9, 1.8]]";
        let cases = [
            ("nothing", TEST_SCENE.to_owned(), plain(), Verdict::Agree),
            ("reflectance 2 % off", with("[0.7, 0.5]", "[0.714, 0.51]"), plain(), Verdict::Disagree),
            ("five bounces", TEST_SCENE.to_owned(), PathTracing::continuous(short), Verdict::Disagree),
            ("flipped patch", with(dark, turned), plain(), Verdict::Disagree),
            ("lamp 1 cm off", with(old_lamp, lamp), plain(), Verdict::Disagree),
            (
                "no cosine",
                TEST_SCENE.to_owned(),
                plain().with_directions(Box::new(NoCosine)),
                Verdict::Disagree,
            ),
        ];
        for (what, text, paths, expected) in cases {
            let found = folder.path().join("found.npz");
            pictured(&text, paths, 7, &found);
            let out = folder.path().join(what);
            let asked = JudgeOptions::default();
            let (record, verdict) = judge(&bundle, &[found], &asked, &claim(&out), &Quiet).unwrap();
            println!("{what}: {} apart, mean z² {:.2}", record.significant, record.score_variance);
            assert_eq!(verdict, expected, "{what}: {:?}", record.worst);
            assert!(out.join("judge.json").exists() && out.join("judge.png").exists());
        }
    }

    #[test]
    fn tables_of_faces_are_judged_and_what_is_not_known_is_said() {
        let folder = tempfile::tempdir().unwrap();
        let [one, two] = ["one", "two"].map(|name| folder.path().join(name));
        let stop = TraceStop { error: Some(0.01), ..TraceStop::default() };
        let mut asked =
            ReferenceOptions { spp: Some(32), size: Some([4, 3]), stop, ..ReferenceOptions::default() };
        reference(scene(TEST_SCENE), &asked, &claim(&one), &Quiet).unwrap();
        asked.paths.seed = 2;
        reference(scene(TEST_SCENE), &asked, &claim(&two), &Quiet).unwrap();
        let (out, table) = (folder.path().join("out"), two.join("reference.csv"));
        let options = JudgeOptions::default();
        let (record, verdict) =
            judge(&one, std::slice::from_ref(&table), &options, &claim(&out), &Quiet).unwrap();
        assert_eq!((verdict, record.error_from.as_str()), (Verdict::Agree, "sigma"), "{:?}", record.worst);
        // Of one face 20 % more.
        let text = fs::read_to_string(&table).unwrap();
        let mut lines: Vec<String> = text.lines().map(str::to_owned).collect();
        let mut cells: Vec<String> = lines[3].split(',').map(str::to_owned).collect();
        cells[6] = (1.2 * cells[6].parse::<f64>().unwrap()).to_string();
        lines[3] = cells.join(",");
        fs::write(&table, lines.join("\n")).unwrap();
        let (record, verdict) =
            judge(&one, std::slice::from_ref(&table), &options, &claim(&out), &Quiet).unwrap();
        assert_eq!((verdict, record.worst[0].place), (Verdict::Disagree, 2), "{:?}", record.worst);
        let bare: Vec<String> = lines.iter().map(|line| line.replace("E_error", "sd")).collect();
        fs::write(&table, bare.join("\n")).unwrap();
        let failed = |files: &[PathBuf], what: &str| {
            let error = judge(&one, files, &options, &claim(&out), &Quiet).unwrap_err().to_string();
            assert!(error.contains(what), "{error}");
        };
        failed(std::slice::from_ref(&table), "the random error of the tracer is not known");
        failed(&[table, one.join("pixels.npz")], "cannot be judged together");
        failed(&[], "cannot be judged together");
        fs::write(one.join("reference.json"), "{\"format\": \"fredholm-reference-1\"}").unwrap();
        failed(&[two.join("pixels.npz")], "make the bundle again");
    }
}
