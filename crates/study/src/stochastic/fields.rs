//! Scenes of waves by random sampling: what can be sampled, and one run of it.

use fredholm_linop::Watch;
use fredholm_mesh::Vec3;
use fredholm_montecarlo::waves::{
    Aim, AmplitudeParticles, Bounces, FieldEstimate, FieldEstimator, FieldParticles, FieldTracing,
    Scattering, SurfaceSampling,
};
use fredholm_montecarlo::{BATCHES_AT_ONCE, Stop};
use fredholm_scene::waves::Places;
use fredholm_waves::{PhysicalOptics, Shadow, Wave, WaveError};

use super::options::{PathOptions, TraceStop};
use super::tracer::failure;
use crate::error::{Error, ErrorKind};
use crate::waves::{Band, Method, Model};

/// Names of the methods that sample the fields of scenes of waves.
pub const FIELD_METHODS: [&str; 6] = [
    "surface-sampling",
    "field-particles",
    "field-particles-uniform",
    "field-particles-cosine",
    "field-particles-von-mises-fisher",
    "amplitude-particles",
];

/// Samples of a batch, and in all, where nothing is asked for.
const SAMPLES_OF_A_BATCH: u32 = 1024;
const USUAL_SAMPLES: u64 = 1 << 16;
/// Radius of a cell of amplitude particles over the wavelength, and rays that leave each for the
/// second bounce.
const CELL_RADIUS_OVER_WAVELENGTH: f64 = 0.1;
const RAYS_OF_A_CELL: u32 = 16;

/// A point of a receiver: the number of the receiver, its own, and where it lies (m).
pub(crate) type FieldPoint = (usize, usize, Vec3);

/// All points of the receivers that have some.
pub(crate) fn field_points(model: &Model) -> Vec<FieldPoint> {
    let near = model.receivers.iter().map(|receiver| match &receiver.places {
        Places::Near { points, .. } => points.len(),
        _ => 0,
    });
    let mut all = Vec::with_capacity(near.sum());
    for (number, receiver) in model.receivers.iter().enumerate() {
        if let Places::Near { points, .. } = &receiver.places {
            all.extend(points.iter().enumerate().map(|(index, &point)| (number, index, point)));
        }
    }
    all
}

/// How fields are sampled.
pub(crate) struct FieldRun {
    method: String,
    bounces: Bounces,
    seed: u64,
    batch: u32,
    stop: Stop,
}

impl FieldRun {
    /// Refuses what cannot be sampled.
    pub(crate) fn new(
        method: &str,
        paths: &PathOptions,
        stop: &TraceStop,
        model: &Model,
        watch: &dyn Watch,
    ) -> Result<Self, Error> {
        admit(method, paths, model)?;
        let batch = paths.batch.unwrap_or(SAMPLES_OF_A_BATCH);
        let stop = Stop {
            batches: batches(paths, stop),
            // Every frequency has its share of the time.
            seconds: stop.seconds.map(|all| all / model.bands.len() as f64),
            error: stop.error,
        };
        Ok(Self { method: method.to_owned(), bounces: bounces(model, watch), seed: paths.seed, batch, stop })
    }

    /// Batches that are in memory at once.
    pub(crate) fn at_once(paths: &PathOptions, stop: &TraceStop) -> u32 {
        batches(paths, stop)
            .and_then(|all| u32::try_from(all).ok())
            .map_or(BATCHES_AT_ONCE, |all| all.min(BATCHES_AT_ONCE))
    }

    /// Bounces that are summed.
    pub(crate) fn bounces(&self) -> usize {
        if self.bounces == Bounces::One { 1 } else { 2 }
    }

    /// The fields at one frequency, from the beginning or from where an earlier run ended; Ctrl-C
    /// ends it before.
    pub(crate) fn sample(
        &self,
        model: &Model,
        band: &Band,
        earlier: Option<FieldEstimate>,
        watch: &dyn Watch,
    ) -> Result<FieldEstimate, Error> {
        let refused = |error: WaveError| model.refused(&error, None);
        let scatterer = model.geometry.scatterer(&band.materials).map_err(refused)?;
        scatterer.check_conductor("the sampling of fields").map_err(refused)?;
        let sources = model.sources();
        let optics =
            PhysicalOptics::new(&scatterer, band.wave, &sources, Shadow::Geometric).map_err(refused)?;
        let problem = Scattering::new(&scatterer, &optics, band.wave, self.bounces).map_err(failure)?;
        let method = estimator(&self.method, &band.wave);
        let points: Vec<Vec3> = field_points(model).into_iter().map(|(_, _, point)| point).collect();
        let tracing = FieldTracing::new(&problem, &*method, &points, (self.seed, self.batch));
        let mut state = earlier.unwrap_or_else(|| tracing.start());
        tracing.go_on(&mut state, &self.stop, watch).map_err(failure)?;
        Ok(state)
    }

    /// Why the sampling of a frequency has ended, in words.
    pub(crate) fn reason(&self, state: &FieldEstimate) -> String {
        let error = state.relative_error();
        let what = self.stop.ended(state.batches(), error, state.seconds);
        let bounces = if self.bounces == Bounces::One { "one bounce" } else { "two bounces" };
        format!("{what}, {bounces}, standard error {:.3} % (L2 over the points)", 100.0 * error)
    }
}

/// Batches in all, where their number is known.
fn batches(paths: &PathOptions, stop: &TraceStop) -> Option<u64> {
    let samples = stop.samples.or(stop.is_empty().then_some(USUAL_SAMPLES));
    samples.map(|all| all.div_ceil(paths.batch.unwrap_or(SAMPLES_OF_A_BATCH).into()).max(2))
}

fn admit(method: &str, paths: &PathOptions, model: &Model) -> Result<(), Error> {
    let refused = |text: String, help: &str| Err(Error::new(ErrorKind::Input, text).with_help(help));
    if model.galerkin.is_some() || model.shadow != Shadow::Geometric {
        let name = model.method_in_words();
        let help = "method = \"physical-optics\" with shadows = \"geometric\" in [wave], or `fredholm waves`";
        return refused(format!("{name} cannot be sampled"), help);
    }
    if !paths.is_plain() {
        let text = format!("{method} takes --seed and --batch, but neither --points nor switches of paths");
        return refused(text, "leave them out");
    }
    if field_points(model).is_empty() {
        let text = "fields are sampled at points, and no receiver has any".to_owned();
        return refused(text, "add a [[receiver]] with points, line, circle or grid");
    }
    Ok(())
}

/// How many bounces are sampled of those that a scene asks for, with a warning of what is left out.
fn bounces(model: &Model, watch: &dyn Watch) -> Bounces {
    if model.edge_currents {
        watch.warn("edge currents are not sampled");
    }
    match model.method {
        Method::Bounces(1) => Bounces::One,
        Method::Bounces(2) => Bounces::Two,
        _ => {
            watch.warn(
                "two bounces are sampled, not more: the signs of a random walk over bounces cancel too slowly",
            );
            Bounces::Two
        }
    }
}

fn estimator(name: &str, wave: &Wave) -> Box<dyn FieldEstimator> {
    match name {
        "field-particles" => Box::new(FieldParticles::new(Aim::Facets)),
        "field-particles-uniform" => Box::new(FieldParticles::new(Aim::Sphere)),
        "field-particles-cosine" => Box::new(FieldParticles::new(Aim::Cosine)),
        "field-particles-von-mises-fisher" => Box::new(FieldParticles::new(Aim::Lobe(None))),
        "amplitude-particles" => {
            Box::new(AmplitudeParticles::new(CELL_RADIUS_OVER_WAVELENGTH * wave.wavelength(), RAYS_OF_A_CELL))
        }
        _ => Box::new(SurfaceSampling),
    }
}
