//! A scene of waves: what a file describes, ready to be cut into facets.

use std::ops::Range;
use std::path::Path;

use fredholm_mesh::Mesh;
use fredholm_waves::material::Material;
use fredholm_waves::{Ground, Wave, WaveError};

use super::choices::{FrequenciesEntry, Spacing, SweepEntry};
use super::format::SceneEntry;
use super::receiver::{Receiver, receivers, share};
use super::settings::{Settings, settings};
use super::sources::{Placed, placed};
use super::surface::{Part, parts};
use super::{check, material};
use crate::check::{Finding, Warning};
use crate::error::{ErrorKind, SceneError};
use crate::files::Files;
use crate::format::At;
use crate::import::is_mesh;
use crate::parse::parse;
use crate::resolve::Reading;
use crate::source::Source;

/// Most frequencies of a scene.
const MOST_FREQUENCIES: usize = 10_000;

/// A part of a scene file that an error is about.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum About {
    /// The scene as a whole.
    Scene,
    /// The method.
    Method,
    /// The solver.
    Solver,
    /// The frequencies.
    Frequencies,
    /// The ground plane.
    Ground,
    /// A surface of the mesh, by its number.
    Surface(usize),
    /// A source, by its number.
    Source(usize),
    /// A receiver, by its number.
    Receiver(usize),
}

/// A scene of waves and the files it names, read and checked. Lengths in metres.
///
/// ```
/// use fredholm_scene::waves::{Cuts, WaveScene};
///
/// let text = r#"
///     [wave]
///     frequencies_hz = [1e9]
///
///     [[source]]
///     kind = "plane-wave"
///     travel = [0, 0, -1]
///     polarisation = [1, 0, 0]
///
///     [[surface]]
///     name = "plate"
///     quad = [[0, 0, 0], [0.3, 0, 0], [0.3, 0.3, 0], [0, 0.3, 0]]
///     edge = 0.1
///
///     [[receiver]]
///     name = "back"
///     far = { theta_degrees = 0, phi_degrees = 0 }
/// "#;
/// let scene = WaveScene::from_str(text, "plate.toml")?;
/// let cut = scene.cut(Cuts { wavelength: 0.3, stretch: 1.0, whole: false })?;
/// assert_eq!((cut.facets(), cut.mesh()?.len()), (9, 9));
/// assert!(scene.check()?.is_empty());
/// # Ok::<(), fredholm_scene::SceneError>(())
/// ```
#[derive(Debug)]
pub struct WaveScene {
    source: Source,
    sha256: String,
    entry: SceneEntry,
    waves: Vec<Wave>,
    settings: Settings,
    ground: Option<Ground>,
    sources: Vec<Placed>,
    parts: Vec<Part>,
    receivers: Vec<Receiver>,
    notes: Vec<Warning>,
    findings: Vec<Finding>,
}

/// Whether a file is a scene of waves: it has a table `wave`. What cannot be read is none.
#[must_use]
pub fn is_wave_scene(path: &Path) -> bool {
    // A mesh is not looked into, nor is the text read as a table, which takes many times its size.
    let text = if is_mesh(path) { None } else { Source::load(path).ok() };
    text.is_some_and(|source| source.text.lines().any(is_of_waves))
}

/// Whether a line begins the table `wave`, or sets something in it.
fn is_of_waves(line: &str) -> bool {
    let key = line.trim_start().trim_start_matches('[').trim_start();
    key.strip_prefix("wave").is_some_and(|rest| rest.trim_start().starts_with([']', '.', '=']))
}

impl WaveScene {
    /// Reads a scene file and the files it names.
    ///
    /// # Errors
    /// [`SceneError`], with file and line, for anything that is wrong with them.
    pub fn load(path: impl AsRef<Path>) -> Result<Self, SceneError> {
        Self::from_source(Source::load(path.as_ref())?)
    }

    /// Reads a scene from text. Files that it names are looked for in the folder of `path`.
    ///
    /// # Errors
    /// [`SceneError`], with file and line, for anything that is wrong with it.
    pub fn from_str(text: &str, path: impl AsRef<Path>) -> Result<Self, SceneError> {
        Self::from_source(Source::of(path.as_ref(), text.to_owned()))
    }

    fn from_source(source: Source) -> Result<Self, SceneError> {
        let entry: SceneEntry = parse(&source)?;
        let mut files = Files::beside(&source.path);
        let waves = waves(&source, &entry.wave.frequencies_hz)?;
        for wave in &waves {
            material::materials(&source, &entry, wave)?;
        }
        let settings = settings(&source, &entry.wave)?;
        let ground =
            entry.wave.ground.as_ref().map(|given| {
                Ground::new(given.height_m).map_err(|error| refused(&source, given.span(), &error))
            });
        let ground = ground.transpose()?;
        let sources = sources(&source, &entry, ground)?;
        let mut reading = Reading::new(&source, &mut files);
        let parts = parts(&mut reading, &entry)?;
        let Reading { notes, findings, .. } = reading;
        let receivers = receivers(&source, &entry.receiver)?;
        let sha256 = files.fingerprint(&source.text);
        Ok(Self {
            source,
            sha256,
            entry,
            waves,
            settings,
            ground,
            sources,
            parts,
            receivers,
            notes,
            findings,
        })
    }

    /// The scene file.
    #[must_use]
    pub fn path(&self) -> &Path {
        &self.source.path
    }

    /// What the scene is called.
    #[must_use]
    pub fn title(&self) -> Option<&str> {
        self.entry.title.as_deref()
    }

    /// SHA-256 of the scene file and the files it names, in hexadecimal.
    #[must_use]
    pub fn sha256(&self) -> &str {
        &self.sha256
    }

    /// The frequencies, at least one, in the order of the file.
    #[must_use]
    pub fn waves(&self) -> &[Wave] {
        &self.waves
    }

    /// What the scene says of the method.
    #[must_use]
    pub fn settings(&self) -> &Settings {
        &self.settings
    }

    /// The same scene with the currents found in another way than it says itself.
    #[must_use]
    pub fn with_settings(self, settings: Settings) -> Self {
        Self { settings, ..self }
    }

    /// The ground plane, above which everything is.
    #[must_use]
    pub fn ground(&self) -> Option<Ground> {
        self.ground
    }

    /// The sources, above a ground plane with what it reflects of them.
    #[must_use]
    pub fn sources(&self) -> &[Placed] {
        &self.sources
    }

    /// The receivers, at least one.
    #[must_use]
    pub fn receivers(&self) -> &[Receiver] {
        &self.receivers
    }

    /// Names of the surfaces of the mesh.
    pub fn surface_names(&self) -> impl Iterator<Item = &str> {
        self.parts.iter().map(|part| part.name.as_str())
    }

    /// The materials at one frequency: the conductor, then those of the scene by name.
    ///
    /// # Errors
    /// [`SceneError`] for a material that is none at this frequency.
    pub fn materials(&self, wave: &Wave) -> Result<Vec<Material>, SceneError> {
        material::materials(&self.source, &self.entry, wave)
    }

    /// The materials of the surfaces of the mesh, by their numbers in
    /// [`materials`](Self::materials).
    pub fn materials_of_surfaces(&self) -> impl Iterator<Item = usize> {
        self.parts.iter().map(|part| part.material)
    }

    /// What was mended in mesh files while they were read.
    #[must_use]
    pub fn notes(&self) -> &[Warning] {
        &self.notes
    }

    /// An error about a part of the file.
    #[must_use]
    pub fn error(
        &self,
        about: About,
        kind: ErrorKind,
        what: impl AsRef<str>,
        help: impl AsRef<str>,
    ) -> SceneError {
        self.source.error(kind, self.span(about), what, help)
    }

    /// What the library of waves says about a part of the file; `mesh` tells to which surface a
    /// facet belongs.
    #[must_use]
    pub fn refused(&self, about: About, error: &WaveError, mesh: Option<&Mesh>) -> SceneError {
        let facet = match error {
            WaveError::Coarse { facet, .. }
            | WaveError::NotClosed { facet }
            | WaveError::Thin { facet, .. }
            | WaveError::NotConductor { facet, .. } => Some(*facet),
            _ => None,
        };
        let surface = facet.zip(mesh).map(|(facet, mesh)| About::Surface(mesh.surface_of(facet)));
        refused(&self.source, self.span(surface.filter(|_| about == About::Scene).unwrap_or(about)), error)
    }

    /// Looks at the geometry as a whole: whether closed bodies are closed and turned one way,
    /// whether bodies overlap, and whether sources and receivers lie inside of them.
    ///
    /// # Errors
    /// [`SceneError`] for what has no meaning: a body that is declared closed and is not, faces
    /// that are turned differently from their neighbours, a source inside a body or on a surface,
    /// bodies that cross in an equation of closed bodies.
    pub fn check(&self) -> Result<Vec<Warning>, SceneError> {
        let mut warnings = self.notes.clone();
        warnings.extend(check::check(self)?);
        Ok(warnings)
    }

    /// What the pieces of the surfaces are, and what is remarkable about them.
    #[must_use]
    pub fn findings(&self) -> Vec<Finding> {
        let mut findings = self.findings.clone();
        findings.extend(check::findings(self));
        findings
    }

    pub(super) fn parts(&self) -> &[Part] {
        &self.parts
    }

    pub(super) fn source(&self) -> &Source {
        &self.source
    }

    pub(super) fn span(&self, about: About) -> Range<usize> {
        let wave = &self.entry.wave;
        match about {
            About::Scene => Some(0..0),
            About::Method => Some(wave.method.as_ref().map_or(wave.span(), At::span)),
            About::Ground => Some(wave.ground.as_ref().map_or(wave.span(), At::span)),
            About::Frequencies => Some(wave.frequencies_hz.span()),
            About::Solver => Some(wave.solver.as_ref().map_or(wave.span(), At::span)),
            About::Surface(number) => self.parts.get(number).map(|part| part.span.clone()),
            About::Source(number) => self.entry.source.get(number).map(At::span),
            About::Receiver(number) => self.receivers.get(number).map(|receiver| receiver.span.clone()),
        }
        .unwrap_or(0..0)
    }
}

/// What the library of waves says about the piece at `span`.
pub(super) fn refused(source: &Source, span: Range<usize>, error: &WaveError) -> SceneError {
    let kind = match error {
        WaveError::Mesh(_) => ErrorKind::Geometry,
        WaveError::Linop(_) => ErrorKind::TooLarge,
        _ => ErrorKind::Value,
    };
    source.error(kind, span, error.to_string(), error.help().unwrap_or("correct the entry that begins here"))
}

/// The sources, at least one unless all receivers send their own waves.
fn sources(source: &Source, entry: &SceneEntry, ground: Option<Ground>) -> Result<Vec<Placed>, SceneError> {
    if entry.source.is_empty() && !entry.receiver.iter().all(|receiver| receiver.monostatic.is_some()) {
        let help = "add a [[source]] such as kind = \"plane-wave\"";
        let end = source.text.len();
        return Err(source.error(ErrorKind::Empty, end..end, "the scene has no source", help));
    }
    entry.source.iter().map(|entry| placed(source, entry).map(|placed| placed.above(ground))).collect()
}

fn waves(source: &Source, entry: &At<FrequenciesEntry>) -> Result<Vec<Wave>, SceneError> {
    let wave = |frequency: f64, span: Range<usize>| {
        Wave::new(frequency).map_err(|error| refused(source, span, &error))
    };
    let too_many = |count: usize| {
        let what = format!("there are {count} frequencies");
        source.value_error(entry, what, &format!("ask for at most {MOST_FREQUENCIES}"))
    };
    match &**entry {
        FrequenciesEntry::List(list) if list.is_empty() => {
            let help = "write frequencies_hz = [1e9], say";
            Err(source.value_error(entry, "there is no frequency".to_owned(), help))
        }
        FrequenciesEntry::List(list) if list.len() > MOST_FREQUENCIES => Err(too_many(list.len())),
        FrequenciesEntry::List(list) => list.iter().map(|f| wave(**f, f.span())).collect(),
        FrequenciesEntry::Sweep(sweep) => {
            let count = *sweep.points;
            if count == 0 {
                let what = "the sweep has no frequency".to_owned();
                return Err(source.value_error(&sweep.points, what, "ask for at least 1 point"));
            }
            if count as usize > MOST_FREQUENCIES {
                return Err(too_many(count as usize));
            }
            wave(*sweep.from, sweep.from.span())?;
            wave(*sweep.to, sweep.to.span())?;
            (0..count).map(|i| wave(sweep.at(i), entry.span())).collect()
        }
    }
}

impl SweepEntry {
    /// Frequency number i, Hz; the ends are exact.
    fn at(&self, i: u32) -> f64 {
        let (from, to, share) = (*self.from, *self.to, share(i, *self.points));
        if i > 0 && i + 1 == *self.points {
            return to;
        }
        match self.spacing {
            Spacing::Linear => from + (to - from) * share,
            Spacing::Logarithmic => from * (to / from).powf(share),
        }
    }
}
