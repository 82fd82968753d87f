//! Solvers compared on the coupling of a scene: iterations, residuals, the spectral radius, and
//! which of them diverge.

use fredholm_linop::{SecondKind, Solver, Stop, StopReason};
use fredholm_report::{ComparisonRun, WAVE_COMPARISON_FORMAT, WaveComparison, WaveComparisonCase};
use fredholm_waves::{Complex64, PhysicalOptics, System, WaveError, spectral_radius};
use serde_json::json;

use super::model::Band;
use super::solving::{Vectors, coupled};
use super::{Model, registry};
use crate::error::{Error, ErrorKind};
use crate::stages::{Signals, Stages};
use crate::trial;

/// Applications that the spectral radius is estimated from.
const RADIUS_APPLICATIONS: usize = 200;

/// Runs the solvers, given as texts such as `gmres:restart=100`, at every frequency.
pub(crate) fn compare(
    model: &Model,
    solvers: &[String],
    stop: &Stop,
    stages: &mut Stages,
) -> Result<WaveComparison, Error> {
    if model.galerkin.is_some() {
        let what = format!("solvers are compared on currents on facets, not on {}", model.method_name());
        let error = Error::new(ErrorKind::Input, what);
        return Err(error.with_help("take method = \"mfie\" or \"physical-optics\""));
    }
    let mut cases = Vec::new();
    for band in &model.bands {
        cases.push(case(model, band, (solvers, stop), stages)?);
    }
    Ok(WaveComparison {
        format: WAVE_COMPARISON_FORMAT.to_owned(),
        version: env!("CARGO_PKG_VERSION").to_owned(),
        scene: model.path().display().to_string(),
        options: json!({
            "solvers": solvers,
            "tolerance": stop.tolerance,
            "max_iterations": stop.max_iterations,
            "method": model.method_name(),
            "shadows": model.shadows_name(),
            "start": "x = 0",
        }),
        cases,
        timings: stages.timings().to_vec(),
    })
}

fn case(
    model: &Model,
    band: &Band,
    (solvers, stop): (&[String], &Stop),
    stages: &mut Stages,
) -> Result<WaveComparisonCase, Error> {
    let refused = |error: WaveError| model.refused(&error, None);
    let scatterer = model.geometry.scatterer(&band.materials).map_err(refused)?;
    scatterer.check_resolution(&band.wave).map_err(refused)?;
    let sources = model.sources();
    let first = PhysicalOptics::new(&scatterer, band.wave, &sources, model.shadow).map_err(refused)?;
    let name = format!("{} MHz", band.wave.frequency() / 1e6);
    let signals = &stages.signals();
    let made = solvers.iter().map(|text| build(text)).collect::<Result<Vec<_>, _>>()?;
    let system = stages.run(&format!("coupling at {name}"), || {
        let all: Vec<&dyn Solver<Complex64>> = made.iter().map(AsRef::as_ref).collect();
        let products = (RADIUS_APPLICATIONS + 40 * all.len()) as f64;
        coupled(model, &scatterer, (band.wave, model.shadow), (&all, products), signals)
    })?;
    let radius = stages.run(&format!("spectral radius at {name}"), || radius(&system, signals))?;
    let b = system.right_hand_side(&[&first]);
    let mut solved = Vec::new();
    for (text, solver) in solvers.iter().zip(&made) {
        let work = || run(&system, &b, (text, &**solver), stop, signals);
        solved.push(stages.run(&format!("{text} at {name}"), work)?);
    }
    let (reference, runs) = judged(&solved);
    let (frequency, unknowns) = (band.wave.frequency(), b.dim() as u64);
    Ok(WaveComparisonCase { frequency, unknowns, spectral_radius: radius, reference, runs })
}

fn build(text: &str) -> Result<Box<dyn Solver<Complex64>>, Error> {
    registry::build(text).map_err(|error| Error::new(ErrorKind::Input, error))
}

fn radius(system: &System<'_>, signals: &Signals<'_>) -> Result<f64, Error> {
    spectral_radius(system.coupling(), RADIUS_APPLICATIONS, signals.watch).ok_or_else(Error::cancelled)
}

fn run(
    system: &System<'_>,
    b: &Vectors,
    (text, solver): (&str, &dyn Solver<Complex64>),
    stop: &Stop,
    signals: &Signals<'_>,
) -> Result<(ComparisonRun, Option<Vectors>), Error> {
    let one = Vectors::from_fn(b.dim(), 1, |_, _| Complex64::ONE);
    let a = SecondKind::new(system.coupling(), one).map_err(|error| Error::new(ErrorKind::Input, error))?;
    let mut x = Vectors::zeros(b.dim(), 1);
    match solver.solve(&a, b, &mut x, stop, &mut signals.clone()) {
        Ok(report) if report.reason == StopReason::Interrupted => Err(Error::cancelled()),
        Ok(report) => Ok((trial::ran(text, &report), (report.reason != StopReason::Diverged).then_some(x))),
        Err(error) => Ok((trial::refused(text, error.to_string()), None)),
    }
}

/// The runs with their errors against the solution of the smallest residual, and whose that is.
fn judged(solved: &[(ComparisonRun, Option<Vectors>)]) -> (String, Vec<ComparisonRun>) {
    let answers = solved.iter().filter(|(run, x)| x.is_some() && run.residual.is_finite());
    let best = answers.min_by(|(a, _), (b, _)| a.residual.total_cmp(&b.residual));
    let best = best.and_then(|(run, x)| Some((run.solver.clone(), x.clone()?)));
    let error = |x: &Option<Vectors>| match (x, &best) {
        (Some(x), Some((_, answer))) => distance(x, answer),
        _ => f64::NAN,
    };
    let runs = solved.iter().map(|(run, x)| ComparisonRun { error: error(x), ..run.clone() }).collect();
    (best.map_or_else(|| "none".to_owned(), |(name, _)| name), runs)
}

/// ‖x − y‖₂/‖y‖₂.
fn distance(x: &Vectors, y: &Vectors) -> f64 {
    let mut gap = x.clone();
    gap.set_difference(x, y);
    let norm = |v: &Vectors| v.norms().first().copied().unwrap_or(0.0);
    if norm(y) > 0.0 { norm(&gap) / norm(y) } else { norm(&gap) }
}
