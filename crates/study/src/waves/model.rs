//! From a scene file to what is computed.

use std::path::{Path, PathBuf};

use fredholm_linop::Solver;
use fredholm_waves::material::Material;
use fredholm_waves::source::PlaneWave;
use fredholm_waves::{Complex64, Origin, Shadow, Source, Wave, WaveError};

use super::CouplingStorage;
use super::choice::{Asked, Taken, taken};
use super::format::{ReceiverEntry, SceneEntry, WaveEntry};
use super::geometry::{Geometry, materials};
use super::located::SceneText;
use super::memory::{plan as memory_of, sampled};
use super::receivers::{Places, Receiver, receivers};
use super::sources::{Placed, placed};
use crate::error::Error;
use crate::memory::{self, Limit, Plan};
use crate::size::Bytes;

/// How to need less memory.
const HELP: &str = "take longer edges, or fewer points and directions of receivers";
/// Residual where the scene does not say.
const TOLERANCE: f64 = 1e-6;
/// Iterations where the scene does not say.
const ITERATIONS: u32 = 500;

/// How many bounces are summed.
pub(crate) enum Method {
    /// So many.
    Bounces(usize),
    /// All, by a solver.
    Solver { solver: Box<dyn Solver<Complex64>>, tolerance: f64, max_iterations: usize },
}

impl Method {
    /// As it is reported.
    pub(crate) fn name(&self) -> String {
        match self {
            Self::Bounces(1) => "one bounce".to_owned(),
            Self::Bounces(bounces) => format!("{bounces} bounces"),
            Self::Solver { solver, .. } => solver.name().to_owned(),
        }
    }
}

/// One frequency.
pub(crate) struct Band {
    pub(crate) wave: Wave,
    pub(crate) materials: Vec<Material>,
}

/// What a scene file asks for.
pub(crate) struct Model {
    pub(crate) text: SceneText,
    pub(crate) title: Option<String>,
    pub(crate) bands: Vec<Band>,
    pub(crate) shadow: Shadow,
    pub(crate) method: Method,
    /// Whether edge currents are added.
    pub(crate) edge_currents: bool,
    /// Why this method, where the scene left it open.
    pub(crate) reason: Option<String>,
    /// What should be known of the method.
    pub(crate) warnings: Vec<String>,
    pub(crate) sources: Vec<Box<dyn Source>>,
    /// The source, where it is a single plane wave.
    pub(crate) plane_wave: Option<PlaneWave>,
    pub(crate) geometry: Geometry,
    /// The same with edges twice as long, where errors are to be estimated.
    pub(crate) coarse: Option<Geometry>,
    pub(crate) receivers: Vec<Receiver>,
    surfaces: Vec<std::ops::Range<usize>>,
    /// Whether the coupling is stored, where it is said.
    pub(crate) storage: Option<CouplingStorage>,
    /// Memory of everything but a coupling, and what all may take.
    pub(crate) plan: Plan,
    pub(crate) limit: Limit,
}

impl Model {
    /// Reads a scene file and cuts its surfaces, where they fit the memory asked for.
    pub(crate) fn load(path: &Path, memory: Option<Bytes>) -> Result<Self, Error> {
        Self::read(path, memory, [false, true], &memory_of)
    }

    /// The same where the fields are sampled, so many batches at once.
    pub(crate) fn load_sampled(path: &Path, memory: Option<Bytes>, batches: u32) -> Result<Self, Error> {
        Self::read(path, memory, [false; 2], &|facets, entry| sampled(facets, entry, batches))
    }

    /// The same with errors estimated, whether the scene asks for it or not.
    pub(crate) fn load_estimated(path: &Path, memory: Option<Bytes>) -> Result<Self, Error> {
        Self::read(path, memory, [true, false], &memory_of)
    }

    fn read(
        path: &Path,
        memory: Option<Bytes>,
        [estimated, chooses]: [bool; 2],
        memory_of: &dyn Fn(u128, &SceneEntry) -> Plan,
    ) -> Result<Self, Error> {
        let text = SceneText::read(path)?;
        let entry: SceneEntry = text.parse()?;
        let bands = bands(&text, &entry)?;
        let asked = asked(&text, &entry.wave)?;
        let placed = sources(&text, &entry)?;
        let plane_wave = if let [only] = placed.as_slice() { only.plane_wave } else { None };
        let shortest = bands.iter().map(|band| band.wave.wavelength()).fold(f64::INFINITY, f64::min);
        let limit = memory::limit(memory);
        let admit = |facets| memory_of(facets, &entry).admit(limit, HELP);
        let cut = |stretch| Geometry::new(&text, &entry.surface, shortest, stretch, &admit);
        let geometry = cut(1.0)?;
        let Taken { shadow, method, edge_currents, reason, warnings } =
            if chooses { taken(asked, &geometry, &bands) } else { asked.plain() };
        let coarse = (estimated || entry.wave.get_ref().estimate_errors).then(|| cut(2.0)).transpose()?;
        let facets = geometry.mesh.len() + coarse.as_ref().map_or(0, |coarse| coarse.mesh.len());
        let plan = memory_of(facets as u128, &entry);
        plan.admit(limit, HELP)?;
        let receivers = receivers(&text, &entry.receiver)?;
        let surfaces = entry.surface.iter().map(toml::Spanned::span).collect();
        let sources = placed.into_iter().map(|placed| placed.source).collect();
        let title = entry.title;
        Ok(Self {
            text,
            title,
            bands,
            shadow,
            method,
            edge_currents,
            reason,
            warnings,
            sources,
            plane_wave,
            geometry,
            coarse,
            receivers,
            surfaces,
            storage: None,
            plan,
            limit,
        })
    }

    /// The scene file.
    pub(crate) fn path(&self) -> &PathBuf {
        &self.text.path
    }

    /// Whether facets may be of any size: one bounce of plane waves, looked at from far away only.
    pub(crate) fn is_closed_form(&self) -> bool {
        let far = |receiver: &Receiver| !matches!(receiver.places, Places::Near { .. });
        let plane = self.sources.iter().all(|source| matches!(source.origin(), Origin::Direction(_)));
        matches!(self.method, Method::Bounces(1))
            && self.coarse.is_none()
            && plane
            && self.receivers.iter().all(far)
    }

    /// Whether any receiver is there for the sources of the scene.
    pub(crate) fn has_bistatic(&self) -> bool {
        self.receivers.iter().any(|receiver| !matches!(receiver.places, Places::Monostatic(_)))
    }

    /// Whether any receiver sends its own waves.
    pub(crate) fn has_sweep(&self) -> bool {
        self.receivers.iter().any(|receiver| matches!(receiver.places, Places::Monostatic(_)))
    }

    /// What the library says, at the surface or receiver that it is about.
    pub(crate) fn refused(&self, error: &WaveError, receiver: Option<&Receiver>) -> Error {
        let facet = match error {
            WaveError::Coarse { facet, .. }
            | WaveError::NotClosed { facet }
            | WaveError::NotConductor { facet, .. } => Some(*facet),
            _ => None,
        };
        let surface = facet.and_then(|facet| self.surfaces.get(self.geometry.mesh.surface_of(facet)));
        let span = receiver.map(|receiver| receiver.span.clone()).or_else(|| surface.cloned());
        self.text.refused(span.unwrap_or(0..0), error)
    }
}

/// Whether a file is a scene of waves: it has a table `wave`. What cannot be read is none.
pub(crate) fn is_scene(path: &Path) -> bool {
    let table = SceneText::read(path).and_then(|text| text.parse::<toml::Table>());
    table.is_ok_and(|table| table.contains_key("wave"))
}

/// The sources, at least one unless all receivers send their own waves.
fn sources(text: &SceneText, entry: &SceneEntry) -> Result<Vec<Placed>, Error> {
    let own = |receiver: &toml::Spanned<ReceiverEntry>| receiver.get_ref().monostatic.is_some();
    if entry.source.is_empty() && !entry.receiver.iter().all(own) {
        let help = "add a [[source]] such as kind = \"plane-wave\"";
        return Err(text.fault(text.end(), "the scene has no source", help));
    }
    entry.source.iter().map(|source| placed(text, source)).collect()
}

/// What a scene says of the method, where that goes together.
fn asked(text: &SceneText, entry: &toml::Spanned<WaveEntry>) -> Result<Asked, Error> {
    let wave = entry.get_ref();
    let shadow = shadow(text, wave)?;
    let method = method(text, wave)?;
    let equation = shadow.is_some_and(Shadow::is_equation);
    if let (true, None | Some(Method::Bounces(_))) = (equation, &method) {
        let what = "the exact treatment is an equation, whose first bounces mean nothing by themselves";
        return Err(text.fault(entry.span(), what, "add solver = \"lu\", say"));
    }
    Ok(Asked { shadow, method, edge_currents: edge_currents(text, wave, shadow)? })
}

fn bands(text: &SceneText, entry: &SceneEntry) -> Result<Vec<Band>, Error> {
    let frequencies = &entry.wave.get_ref().frequencies_hz;
    if frequencies.get_ref().is_empty() {
        let help = "write frequencies_hz = [1e9], say";
        return Err(text.fault(frequencies.span(), "there is no frequency", help));
    }
    let band = |frequency: &toml::Spanned<f64>| {
        let wave = Wave::new(*frequency.get_ref()).map_err(|error| text.refused(frequency.span(), &error))?;
        Ok(Band { wave, materials: materials(text, entry, &wave)? })
    };
    frequencies.get_ref().iter().map(band).collect()
}

fn shadow(text: &SceneText, entry: &WaveEntry) -> Result<Option<Shadow>, Error> {
    let Some(name) = &entry.shadow else { return Ok(None) };
    let found = Shadow::ALL.into_iter().find(|shadow| shadow.name() == name.get_ref());
    found.map(Some).ok_or_else(|| {
        let known = Shadow::ALL.map(Shadow::name).join(", ");
        text.fault(name.span(), format!("unknown shadow `{}`", name.get_ref()), format!("known: {known}"))
    })
}

fn edge_currents(text: &SceneText, entry: &WaveEntry, shadow: Option<Shadow>) -> Result<Option<bool>, Error> {
    let Some(wanted) = &entry.edge_currents else { return Ok(None) };
    let other = shadow.is_some_and(|shadow| shadow.is_equation() || shadow == Shadow::Thesis);
    if *wanted.get_ref() && other {
        let what = "edge currents complete physical optics, not this treatment of shadows";
        return Err(text.fault(
            wanted.span(),
            what,
            "take shadow = \"geometric\", or leave edge_currents out",
        ));
    }
    Ok(Some(*wanted.get_ref()))
}

fn method(text: &SceneText, entry: &WaveEntry) -> Result<Option<Method>, Error> {
    let Some(name) = &entry.solver else {
        return match &entry.bounces {
            Some(bounces) if *bounces.get_ref() == 0 => {
                Err(text.fault(bounces.span(), "without a bounce nothing is scattered", "write at least 1"))
            }
            bounces => Ok(bounces.as_ref().map(|b| Method::Bounces(*b.get_ref() as usize))),
        };
    };
    if let Some(bounces) = &entry.bounces {
        let help = "keep one of them";
        return Err(text.fault(bounces.span(), "bounces and solver are both given", help));
    }
    let tolerance = entry.tolerance.as_ref().map_or(TOLERANCE, |t| *t.get_ref());
    if !(tolerance > 0.0 && tolerance < 1.0) {
        let span = entry.tolerance.as_ref().map_or(0..0, toml::Spanned::span);
        return Err(text.fault(span, "the tolerance is no number between 0 and 1", "write 1e-6, say"));
    }
    let max_iterations = entry.max_iterations.unwrap_or(ITERATIONS) as usize;
    let solver = super::registry::build(name.get_ref()).map_err(|error| {
        let message = error.to_string();
        let (what, help) = message.split_once("; ").unwrap_or((&message, "correct the name or the options"));
        text.fault(name.span(), what, help)
    })?;
    Ok(Some(Method::Solver { solver, tolerance, max_iterations }))
}
