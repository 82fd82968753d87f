//! From a scene file to what is computed.

use std::path::Path;
use std::sync::Arc;

use fredholm_linop::Solver;
use fredholm_moments::Order;
use fredholm_scene::waves::{self as scene, About, Cuts, Places, Settings, Shadows, WaveScene};
use fredholm_scene::{ErrorKind as SceneFault, SceneError};
use fredholm_waves::material::Material;
use fredholm_waves::source::PlaneWave;
use fredholm_waves::{Complex64, Origin, Shadow, Source, Wave, WaveError};

use super::CouplingStorage;
use super::choice::{Asked, Taken, taken};
use super::galerkin::{Equations, order};
use super::geometry::Geometry;
use super::memory::{plan as memory_of, sampled};
use crate::error::Error;
use crate::memory::{self, Limit, Plan};
use crate::options::{admit_file, of_waves};
use crate::problem::scene_failure;
use crate::size::Bytes;
use crate::stages::Stages;

/// How to need less memory.
const MEMORY_HELP: &str = "take longer edges, or fewer points and directions of receivers";
/// Residual where the scene does not say.
const USUAL_RESIDUAL: f64 = 1e-6;
/// Iterations where the scene does not say.
const USUAL_ITERATIONS: u32 = 500;
/// Solvers of equations where the scene does not say: of those by products, and of those whose
/// matrix is stored and may be ill-conditioned, general or symmetric.
pub(super) const BY_PRODUCTS: &str = "gmres";
pub(super) const BY_MATRIX: &str = "lu";
pub(super) const BY_SYMMETRIC_MATRIX: &str = "ldlt";

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
    /// The conductor, then those of the scene.
    pub(crate) materials: Vec<Material>,
}

/// A receiver with its places.
#[derive(Clone)]
pub(crate) struct Receiver {
    pub(crate) name: String,
    pub(crate) places: Places,
    /// Its number in the scene.
    pub(super) number: usize,
}

impl Receiver {
    /// The angle that directions of the far field step through, and its degrees.
    pub(crate) fn angles(&self) -> (&'static str, Vec<f64>) {
        let (Places::Far(angles) | Places::Monostatic(angles)) = &self.places else {
            return ("angle", Vec::new());
        };
        let over_phi = angles.iter().all(|angle| angle[0].total_cmp(&angles[0][0]).is_eq());
        let degrees = angles.iter().map(|angle| angle[usize::from(over_phi)]).collect();
        (if over_phi { "φ" } else { "θ" }, degrees)
    }

    /// Whether it is in directions of the far field, not at points.
    pub(crate) fn places_are_directions(&self) -> bool {
        !matches!(self.places, Places::Near { .. })
    }
}

/// What a scene file asks for.
pub(crate) struct Model {
    pub(crate) scene: Arc<WaveScene>,
    pub(crate) bands: Vec<Band>,
    pub(crate) shadow: Shadow,
    /// The equations of boundary elements, where they are taken instead of currents on facets.
    pub(crate) galerkin: Option<Equations>,
    pub(crate) method: Method,
    /// Whether edge currents are added.
    pub(crate) edge_currents: bool,
    /// Why this method, where the scene left it open.
    pub(crate) reason: Option<String>,
    /// The source, where it is a single plane wave.
    pub(crate) plane_wave: Option<PlaneWave>,
    pub(crate) geometry: Geometry,
    /// The same with edges twice as long, where errors are to be estimated.
    pub(crate) coarse: Option<Geometry>,
    pub(crate) receivers: Vec<Receiver>,
    /// What is allowed, but probably not meant, and what should be known of the method.
    pub(crate) warnings: Vec<String>,
    /// Whether powers are compared, where that is cheap beside the rest.
    pub(crate) balanced: bool,
    /// Whether the coupling is stored, where it is said.
    pub(crate) storage: Option<CouplingStorage>,
    /// Memory of everything but a coupling, and what all may take.
    pub(crate) plan: Plan,
    pub(crate) limit: Limit,
}

/// What is taken where a scene names no method.
#[derive(Clone, Copy, PartialEq, Eq)]
enum Unnamed {
    /// One bounce with geometric shadows.
    Plain,
    /// What suits the scene.
    Chosen,
    /// What suits the scene of all but boundary elements.
    OnFacets,
}

impl Model {
    /// Reads a scene file and cuts its surfaces, where they fit the memory asked for.
    pub(crate) fn load(path: &Path, memory: Option<Bytes>) -> Result<Self, Error> {
        Self::read(path, memory, (false, Unnamed::Chosen), &memory_of)
    }

    /// The same with currents on facets, which solvers are compared on.
    pub(crate) fn load_on_facets(path: &Path, memory: Option<Bytes>) -> Result<Self, Error> {
        Self::read(path, memory, (false, Unnamed::OnFacets), &memory_of)
    }

    /// The same where the fields are sampled, so many batches at once.
    pub(crate) fn load_sampled(path: &Path, memory: Option<Bytes>, batches: u32) -> Result<Self, Error> {
        Self::read(path, memory, (false, Unnamed::Plain), &|facets, scene| sampled(facets, scene, batches))
    }

    /// The same with errors estimated, whether the scene asks for it or not.
    pub(crate) fn load_estimated(path: &Path, memory: Option<Bytes>) -> Result<Self, Error> {
        Self::read(path, memory, (true, Unnamed::Plain), &memory_of)
    }

    /// The same with currents found in another way than the scene says; `settings` are made of its
    /// own.
    pub(crate) fn load_with(
        path: &Path,
        memory: Option<Bytes>,
        settings: &dyn Fn(&Settings) -> Settings,
    ) -> Result<Self, Error> {
        let scene = scene_of(path, memory)?;
        let settings = settings(scene.settings());
        Self::of(scene.with_settings(settings), memory, (false, Unnamed::Plain), &memory_of)
    }

    fn read(
        path: &Path,
        memory: Option<Bytes>,
        how: (bool, Unnamed),
        memory_of: &dyn Fn(u128, &WaveScene) -> Plan,
    ) -> Result<Self, Error> {
        Self::of(scene_of(path, memory)?, memory, how, memory_of)
    }

    fn of(
        scene: WaveScene,
        memory: Option<Bytes>,
        (estimated, unnamed): (bool, Unnamed),
        memory_of: &dyn Fn(u128, &WaveScene) -> Plan,
    ) -> Result<Self, Error> {
        let scene = Arc::new(scene);
        let settings = scene.settings();
        let estimated = estimated || settings.estimate_errors;
        let asked = asked(&scene)?;
        let bands = bands(&scene)?;
        let limit = memory::limit(memory);
        let admit = |facets| memory_of(facets, &scene).admit(limit, MEMORY_HELP);
        let wavelength = scene.waves().iter().map(Wave::wavelength).fold(f64::INFINITY, f64::min);
        let cut = |stretch, whole| Geometry::new(&scene, Cuts { wavelength, stretch, whole }, &admit);
        let whole = !estimated && asked.method.as_ref().is_some_and(|method| is_closed_form(&scene, method));
        let geometry = cut(1.0, whole)?;
        let named = galerkin(settings);
        let Taken { shadow, galerkin, method, edge_currents, reason, warnings } =
            if unnamed == Unnamed::Plain || named.is_some() {
                asked.plain()
            } else {
                let boundary_elements = unnamed == Unnamed::Chosen;
                let fits = |bytes| Plan::default().hold("the matrix", bytes).fits(limit);
                taken(asked, (&geometry, &bands), boundary_elements, &fits)
            };
        let galerkin = named.or(galerkin);
        if scene.ground().is_some() && galerkin.is_none() {
            let what = "the ground is known to boundary elements only, which are not taken here";
            let help = "take method = \"efie\", \"cfie\" or \"pmchwt\", or write the ground as a surface";
            return Err(scene_failure(scene.error(About::Ground, SceneFault::Value, what, help)));
        }
        // One bounce that was not asked for may do without cutting, too.
        let geometry =
            if !whole && !estimated && is_closed_form(&scene, &method) { cut(1.0, true)? } else { geometry };
        let coarse = estimated.then(|| cut(2.0, false)).transpose()?;
        let facets = geometry.mesh.len() + coarse.as_ref().map_or(0, |coarse| coarse.mesh.len());
        let plan = memory_of(facets as u128, &scene);
        plan.admit(limit, MEMORY_HELP)?;
        let doubts = scene.check().map_err(scene_failure)?;
        Ok(Self {
            bands,
            shadow,
            galerkin,
            method,
            edge_currents,
            reason,
            plane_wave: only_plane_wave(&scene),
            geometry,
            coarse,
            receivers: receivers(&scene),
            warnings: doubts.iter().map(ToString::to_string).chain(warnings).collect(),
            balanced: true,
            storage: None,
            plan,
            limit,
            scene,
        })
    }

    /// Tells what the memory is and what is probably not meant.
    pub(crate) fn tell(&self, stages: &Stages) {
        stages.tell(&self.plan, self.limit);
        self.warnings.iter().for_each(|warning| stages.watch.warn(warning));
    }

    /// The scene file.
    pub(crate) fn path(&self) -> &Path {
        self.scene.path()
    }

    /// The method, as scenes name it.
    pub(crate) fn method_name(&self) -> &'static str {
        match (self.galerkin, self.shadow) {
            (Some(Equations::Electric), _) => scene::Method::Efie,
            (Some(Equations::Combined), _) => scene::Method::Cfie,
            (Some(Equations::Dielectric), _) => scene::Method::Pmchwt,
            (None, Shadow::Geometric | Shadow::Radiated) => scene::Method::PhysicalOptics,
            (None, Shadow::Exact) => scene::Method::Mfie,
            (None, Shadow::ExactDual) => scene::Method::DualSurfaceMfie,
            (None, Shadow::Thesis) => scene::Method::Thesis,
        }
        .name()
    }

    /// The order of the functions of boundary elements.
    pub(crate) fn order(&self) -> Option<u32> {
        self.galerkin.map(|_| u32::from(order(self) == Order::First))
    }

    /// What blocks waves, as scenes name it, where that is a choice.
    pub(crate) fn shadows_name(&self) -> Option<&'static str> {
        match (self.galerkin, self.shadow) {
            (None, Shadow::Geometric) => Some(Shadows::Geometric.name()),
            (None, Shadow::Radiated) => Some(Shadows::Radiated.name()),
            _ => None,
        }
    }

    /// The method with what blocks waves.
    pub(crate) fn method_in_words(&self) -> String {
        let shadows = self.shadows_name().map(|name| format!(", {name} shadows"));
        let order = (self.order() == Some(1)).then(|| ", functions of order 1".to_owned());
        format!("{}{}", self.method_name(), shadows.or(order).unwrap_or_default())
    }

    /// The sources.
    pub(crate) fn sources(&self) -> Vec<&dyn Source> {
        sources(&self.scene)
    }

    /// Whether facets may be of any size: one bounce of plane waves, looked at from far away only.
    pub(crate) fn is_closed_form(&self) -> bool {
        self.coarse.is_none() && is_closed_form(&self.scene, &self.method)
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
        let about = receiver.map_or(About::Scene, |receiver| About::Receiver(receiver.number));
        scene_failure(self.scene.refused(about, error, Some(&self.geometry.mesh)))
    }
}

/// The scene of a file, where reading it is within the memory asked for.
pub(super) fn scene_of(path: &Path, memory: Option<Bytes>) -> Result<WaveScene, Error> {
    admit_file(path, memory)?;
    WaveScene::load(path).map_err(|error| of_waves(path, error))
}

fn sources(scene: &WaveScene) -> Vec<&dyn Source> {
    scene.sources().iter().map(|placed| &*placed.source as &dyn Source).collect()
}

fn only_plane_wave(scene: &WaveScene) -> Option<PlaneWave> {
    if let [only] = scene.sources() { only.plane_wave } else { None }
}

fn is_closed_form(scene: &WaveScene, method: &Method) -> bool {
    matches!(method, Method::Bounces(1))
        && sources(scene).iter().all(|source| matches!(source.origin(), Origin::Direction(_)))
        && !scene.receivers().iter().any(scene::Receiver::is_near)
}

fn receivers(scene: &WaveScene) -> Vec<Receiver> {
    let receiver = |(number, receiver): (usize, &scene::Receiver)| Receiver {
        name: receiver.name.clone(),
        places: receiver.places(),
        number,
    };
    scene.receivers().iter().enumerate().map(receiver).collect()
}

fn bands(scene: &WaveScene) -> Result<Vec<Band>, Error> {
    let band = |wave: &Wave| Ok(Band { wave: *wave, materials: scene.materials(wave)? });
    scene.waves().iter().map(band).collect::<Result<_, SceneError>>().map_err(scene_failure)
}

/// What a scene says of the method.
fn asked(scene: &WaveScene) -> Result<Asked, Error> {
    let settings = scene.settings();
    Ok(Asked {
        shadow: shadow(settings),
        optics: settings.method == Some(scene::Method::PhysicalOptics),
        ground: scene.ground().is_some(),
        method: method(scene)?,
        edge_currents: settings.edge_currents,
        solver: settings.solver.is_some(),
        waves: scene.receivers().iter().filter(|receiver| receiver.is_monostatic()).map(incident).sum(),
    })
}

/// Incident waves of a monostatic receiver.
fn incident(receiver: &scene::Receiver) -> usize {
    usize::try_from(2 * receiver.count()).unwrap_or(usize::MAX)
}

/// The treatment of shadows that is asked for.
fn shadow(settings: &Settings) -> Option<Shadow> {
    match (settings.method, settings.shadows) {
        (Some(scene::Method::Mfie), _) => Some(Shadow::Exact),
        (Some(scene::Method::DualSurfaceMfie), _) => Some(Shadow::ExactDual),
        (Some(scene::Method::Thesis), _) => Some(Shadow::Thesis),
        (_, Some(Shadows::Radiated)) => Some(Shadow::Radiated),
        (_, Some(Shadows::Geometric)) => Some(Shadow::Geometric),
        (_, None) => None,
    }
}

/// The equations of boundary elements that a method asks for.
fn galerkin(settings: &Settings) -> Option<Equations> {
    match settings.method {
        Some(scene::Method::Efie) => Some(Equations::Electric),
        Some(scene::Method::Cfie) => Some(Equations::Combined),
        Some(scene::Method::Pmchwt) => Some(Equations::Dielectric),
        _ => None,
    }
}

/// The bounces or the solver, where they are asked for.
fn method(scene: &WaveScene) -> Result<Option<Method>, Error> {
    let settings = scene.settings();
    let usual = match (galerkin(settings), settings.method) {
        (Some(equations), _) => Some(equations.direct_solver()),
        (None, Some(method)) if method.is_equation() => Some(BY_PRODUCTS),
        _ => None,
    };
    let name = settings.solver.as_deref().or(usual);
    let Some(name) = name else { return Ok(settings.bounces.map(|n| Method::Bounces(n as usize))) };
    let tolerance = settings.tolerance.unwrap_or(USUAL_RESIDUAL);
    let max_iterations = settings.max_iterations.unwrap_or(USUAL_ITERATIONS) as usize;
    let solver = super::registry::build(name).map_err(|error| {
        let help = "correct the name or the options";
        scene_failure(scene.error(About::Solver, SceneFault::Name, error.to_string(), help))
    })?;
    Ok(Some(Method::Solver { solver, tolerance, max_iterations }))
}
